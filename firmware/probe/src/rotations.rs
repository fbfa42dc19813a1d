//! `so3`: rotations in all their forms, with angles where the formulas change.

use so3::euler::RollPitchYaw;
use so3::{
    Geodesic, Matrix3, Rotation3, Unit, UnitQuaternion, Vector3, euler, exp, exp_taylor4,
    exp_taylor4_defect, exp_taylor4_derivatives, exp_taylor4_error_bound, exp_with_jacobian, hat,
    left_jacobian, left_jacobian_inverse, log, log_near, log_with_jacobian_inverse,
    nearest_rotation, orthogonality_defect, orthonormalize_step, quat, right_jacobian,
    right_jacobian_inverse, rotation_about, rotation_error, rotation_error_smoothed, small_angle,
    vee,
};

use crate::inputs::Stream;
use crate::{Real, Recorder, Subject};

/// Angles: none, tiny, in the series, at its end, beyond, about half a turn, several turns, lost.
const ANGLES: [f64; 11] = [
    0.0,
    1e-160,
    1e-9,
    1e-3,
    0.7,
    1.0,
    2.5,
    core::f64::consts::PI,
    core::f64::consts::PI - 1e-6,
    20.0,
    f64::NAN,
];

pub(crate) fn run<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>) {
    on.name = "so3";
    let mut stream = Stream::new(4);
    for angle in ANGLES {
        let axis: [T; 3] = stream.array(1.0);
        for axis in [axis, [T::ZERO, -T::ONE, T::ZERO]] {
            let axis = Unit::new_normalize(Vector3::from(axis));
            let w = axis.into_inner() * T::of(angle);
            let rot = on.call("exp", &w, |w| exp(w));
            vectors(on, &w);
            logarithms(on, &axis, &w, &rot);
            angles(on, &w, &rot);
            matrices(on, &rot);
            quaternions(on, &w, &rot);
            interpolations(on, &axis, &w, &rot);
        }
    }
}

fn vectors<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, w: &Vector3<T>) {
    let m = on.call("hat", w, |w| hat(w));
    on.call("vee", &m, |m| vee(m));
    on.call("left_jacobian", w, |w| left_jacobian(w));
    on.call("exp_with_jacobian", w, |w| exp_with_jacobian(w));
    on.call("right_jacobian", w, |w| right_jacobian(w));
    on.call("left_jacobian_inverse", w, |w| left_jacobian_inverse(w));
    on.call("right_jacobian_inverse", w, |w| right_jacobian_inverse(w));
    on.call("exp_taylor4", w, |w| exp_taylor4(w));
    on.call("exp_taylor4_derivatives", w, |w| exp_taylor4_derivatives(w));
    on.call("exp_taylor4_error_bound", w.x, exp_taylor4_error_bound);
    on.call("exp_taylor4_defect", w.x, exp_taylor4_defect);
    let square = w.norm_squared();
    on.call(
        "small_angle::coefficients",
        square,
        small_angle::coefficients,
    );
    on.call(
        "small_angle::inverse_coefficient",
        square,
        small_angle::inverse_coefficient,
    );
}

fn logarithms<T: Real, R: Recorder>(
    on: &mut Subject<'_, T, R>,
    axis: &Unit<Vector3<T>>,
    w: &Vector3<T>,
    rot: &Rotation3<T>,
) {
    on.call("log", rot, |rot| log(rot));
    on.call("log_with_jacobian_inverse", rot, |rot| {
        log_with_jacobian_inverse(rot)
    });
    on.call("log_near", (rot, w), |(rot, hint)| log_near(rot, hint));
    on.call("rotation_about", (axis, w.x), |(axis, angle)| {
        rotation_about(axis, angle)
    });
    let other = Rotation3::identity();
    on.call("rotation_error", (rot, &other), |(a, b)| {
        rotation_error(a, b)
    });
    on.call("rotation_error_smoothed", (rot, &other), |(a, b)| {
        rotation_error_smoothed(a, b)
    });
}

fn angles<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, w: &Vector3<T>, rot: &Rotation3<T>) {
    on.call("euler::rotation_x", w.x, euler::rotation_x);
    on.call("euler::rotation_y", w.y, euler::rotation_y);
    on.call("euler::rotation_z", w.z, euler::rotation_z);
    // The rates do not exist where the middle angle, pitch or roll, is a quarter turn.
    let quarter = Vector3::repeat(T::PI * T::HALF);
    for order in [RollPitchYaw::Zyx, RollPitchYaw::Zxy] {
        on.call("RollPitchYaw::angles", (order, rot), |(order, rot)| {
            order.angles(rot)
        });
        on.call(
            "RollPitchYaw::angles_near",
            (order, rot, w),
            |(order, rot, hint)| order.angles_near(rot, hint),
        );
        for rpy in [w, &quarter] {
            on.call("RollPitchYaw::rotation", (order, rpy), |(order, rpy)| {
                order.rotation(rpy)
            });
            on.call(
                "RollPitchYaw::omega_from_rates",
                (order, rpy),
                |(order, rpy)| order.omega_from_rates(rpy),
            );
            on.call(
                "RollPitchYaw::omega_bias",
                (order, rpy, w),
                |(order, rpy, rates)| order.omega_bias(rpy, rates),
            );
            let _ = on.call(
                "RollPitchYaw::rates_from_omega",
                (order, rpy),
                |(order, rpy)| order.rates_from_omega(rpy),
            );
        }
    }
}

fn matrices<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, rot: &Rotation3<T>) {
    let bent = rot.matrix() * T::of(1.001) + Matrix3::from_diagonal_element(T::of(1e-4));
    on.call("orthogonality_defect", &bent, |m| orthogonality_defect(m));
    let near = Rotation3::from_matrix_unchecked(bent);
    on.call("orthonormalize_step", &near, |rot| orthonormalize_step(rot));
    for m in [bent, -bent, Matrix3::zeros()] {
        let _ = on.call("nearest_rotation", &m, |m| nearest_rotation(m));
    }
}

fn quaternions<T: Real, R: Recorder>(
    on: &mut Subject<'_, T, R>,
    w: &Vector3<T>,
    rot: &Rotation3<T>,
) {
    let q = on.call("quat::from_rotation", rot, |rot| quat::from_rotation(rot));
    on.call("quat::to_rotation", &q, |q| quat::to_rotation(q));
    let xyzw = on.call("quat::to_xyzw", &q, |q| quat::to_xyzw(q));
    let wxyz = on.call("quat::to_wxyz", &q, |q| quat::to_wxyz(q));
    for doubled in [T::TWO, T::ZERO] {
        let _ = on.call(
            "quat::from_xyzw",
            xyzw.map(|x| x * doubled),
            quat::from_xyzw,
        );
        let _ = on.call(
            "quat::from_wxyz",
            wxyz.map(|x| x * doubled),
            quat::from_wxyz,
        );
    }
    let p: UnitQuaternion<T> = on.call("quat::exp", w, |w| quat::exp(w));
    on.call("quat::log", &p, |q| quat::log(q));
    let part = (&p, &UnitQuaternion::identity(), T::of(0.3));
    on.call("quat::slerp", part, |(a, b, f)| quat::slerp(a, b, f));
}

fn interpolations<T: Real, R: Recorder>(
    on: &mut Subject<'_, T, R>,
    axis: &Unit<Vector3<T>>,
    w: &Vector3<T>,
    rot: &Rotation3<T>,
) {
    let start = Rotation3::identity();
    on.call("Geodesic::new", (&start, w), |(start, w)| {
        Geodesic::new(*start, *w)
    });
    on.call("Geodesic::shortest", (&start, rot), |(start, end)| {
        Geodesic::shortest(start, end)
    });
    let turned = (&start, rot, w);
    on.call("Geodesic::near", turned, |(start, end, hint)| {
        Geodesic::near(start, end, hint)
    });
    let about = (&start, axis, w.x);
    let way = on.call("Geodesic::about", about, |(start, axis, x)| {
        Geodesic::about(start, axis, x)
    });
    on.call("Geodesic::at", (&way, T::of(0.25)), |(way, f)| way.at(f));
    on.call("Geodesic::rotation_vector", &way, |way| {
        *way.rotation_vector()
    });
}
