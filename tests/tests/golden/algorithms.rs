//! Dynamics, motions of frames, centroidal quantities, and steps on the manifold of configurations.

use nalgebra::SMatrix;
use rbd_core::{
    AbaWorkspace, Axes, BodyMotions, CentroidalMap, ComJacobian, Effort, Frame, FrameJacobian,
    Kinematics, MassMatrix, Motion, Posture, Tangent, Tree,
};
use saltus_tests::golden::Record;
use so3::Scalar;

use crate::{Entries as _, Worst, configuration, lower, tangent};

pub(crate) fn dynamics<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
    w: &mut Worst,
    model: &M,
    state: &Record,
    posture: &Posture<T, N>,
    v: &Tangent<T, N>,
    a: &Tangent<T, N>,
    tau: &Effort<T, N>,
) {
    w.see(
        state,
        "rnea",
        rbd_core::rnea(model, posture, v, a).entries(),
    );
    w.see(
        state,
        "nonlinear_effects",
        rbd_core::nonlinear_effects(model, posture, v).entries(),
    );
    w.see(
        state,
        "gravity",
        rbd_core::generalized_gravity(model, posture).entries(),
    );
    let mut ws = AbaWorkspace::new();
    w.see(
        state,
        "aba",
        rbd_core::aba(model, posture, v, tau, &mut ws).entries(),
    );
    let mut mass = MassMatrix::ZERO;
    rbd_core::crba(model, posture, &mut mass);
    w.see(state, "mass_matrix_lower", lower(&mass.to_dense::<V>()));
    w.see(state, "energy.kinetic", [mass.kinetic_energy(v)]);
}

pub(crate) fn motions<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
    w: &mut Worst,
    model: &M,
    frames: &[(&str, Frame<T>)],
    state: &Record,
    posture: &Posture<T, N>,
    v: &Tangent<T, N>,
    a: &Tangent<T, N>,
) {
    let mut kinematics = Kinematics::IDENTITY;
    rbd_core::forward_kinematics(model, posture, &mut kinematics);
    let (mut moving, mut bias) = (BodyMotions::ZERO, BodyMotions::ZERO);
    rbd_core::forward_accelerations(model, posture, v, a, &mut moving);
    rbd_core::bias_accelerations(model, posture, v, &mut bias);
    for (name, frame) in frames {
        let xf = kinematics.frame(frame);
        w.see(
            state,
            &format!("{name}.rotation"),
            xf.rotation.into_inner().entries(),
        );
        w.see(state, &format!("{name}.position"), xf.translation.entries());
        let velocity = moving.frame_velocity(frame);
        let spatial = moving.frame_acceleration(frame);
        let classical = moving.frame_classical_acceleration(frame);
        for (suffix, axes) in [
            ("l", Axes::Local),
            ("w", Axes::World),
            ("a", Axes::LocalWorldAligned),
        ] {
            let turned = |m: &Motion<T>| axes.motion(&xf, m).to_array();
            w.see(
                state,
                &format!("{name}.velocity_{suffix}"),
                turned(&velocity),
            );
            w.see(
                state,
                &format!("{name}.spatial_acceleration_{suffix}"),
                turned(&spatial),
            );
            if axes != Axes::World {
                w.see(
                    state,
                    &format!("{name}.classical_acceleration_{suffix}"),
                    turned(&classical),
                );
            }
            let key = format!("{name}.jacobian_{suffix}");
            if state.find(&key).is_some() {
                let mut jacobian = FrameJacobian::ZERO;
                rbd_core::frame_jacobian(model, &kinematics, frame, axes, &mut jacobian);
                w.see(state, &key, jacobian.to_dense::<V>().entries());
            }
        }
        w.see(
            state,
            &format!("{name}.bias_spatial_l"),
            bias.frame_acceleration(frame).to_array(),
        );
        let classical =
            Axes::LocalWorldAligned.motion(&xf, &bias.frame_classical_acceleration(frame));
        w.see(
            state,
            &format!("{name}.bias_classical_a"),
            classical.to_array(),
        );
    }
}

pub(crate) fn centroidal<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
    w: &mut Worst,
    model: &M,
    state: &Record,
    posture: &Posture<T, N>,
    v: &Tangent<T, N>,
    a: &Tangent<T, N>,
) {
    let mut jacobian = ComJacobian::ZERO;
    let com = rbd_core::com_jacobian(model, posture, &mut jacobian);
    w.see(state, "com.position", com.position_w.entries());
    w.see(
        state,
        "com.position",
        rbd_core::center_of_mass(model, posture)
            .position_w
            .entries(),
    );
    let rows = (0..3).flat_map(|i| {
        let base = [jacobian.base_linear, jacobian.base_angular];
        let base = base.map(|m| [m[(i, 0)], m[(i, 1)], m[(i, 2)]]).concat();
        base.into_iter().chain(jacobian.joints.map(|c| c[i]))
    });
    w.see(state, "com.jacobian", rows);
    w.see(state, "com.velocity", jacobian.mul(v).entries());

    let mut map = CentroidalMap::ZERO;
    rbd_core::centroidal_map(model, posture, &mut map);
    w.see(state, "centroidal.map", map.to_dense::<V>().entries());
    let momentum = map.momentum(v);
    w.see(state, "centroidal.momentum", momentum.to_array());
    let locked = map.locked_angular_velocity(&momentum);
    w.see(
        state,
        "centroidal.locked_angular_velocity",
        locked.entries(),
    );
    let mut inertia: SMatrix<T, 6, 6> = SMatrix::from_diagonal_element(map.mass);
    inertia
        .fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&map.locked_inertia_w.to_matrix());
    w.see(state, "centroidal.inertia", inertia.entries());

    let whole = rbd_core::centroidal_state(model, posture, v);
    w.see(state, "com.position", whole.com_w.entries());
    w.see(state, "com.velocity", whole.com_velocity_w.entries());
    w.see(state, "centroidal.momentum", whole.momentum_w.to_array());
    w.see(state, "energy.kinetic", [whole.kinetic_energy]);
    w.see(state, "energy.potential", [whole.potential_energy]);
    w.see(
        state,
        "centroidal.bias",
        rbd_core::centroidal_bias(model, posture, v).to_array(),
    );
    let com = rbd_core::com_motion(model, posture, v, a);
    w.see(state, "com.position", com.position_w.entries());
    w.see(state, "com.velocity", com.velocity_w.entries());
    w.see(state, "com.acceleration", com.acceleration_w.entries());
    let rate = rbd_core::centroidal_momentum_rate(model, posture, v, a);
    w.see(state, "centroidal.momentum_rate", rate.to_array());
    w.see(
        state,
        "com.acceleration",
        (rate.linear * (T::ONE / whole.mass)).entries(),
    );
}

pub(crate) fn manifold<T: Scalar, const N: usize>(w: &mut Worst, state: &Record) {
    let at = |key| configuration::<T, N>(state.values(key));
    let (q, q2) = (at("q"), at("q2"));
    let moved = rbd_core::integrate(&q, &tangent(state.values("step")));
    w.see_configuration(state, "integrate", &moved);
    w.see(state, "difference", rbd_core::difference(&q, &q2).entries());
    let between = rbd_core::interpolate(&q, &q2, T::of(state.scalar("fraction")));
    w.see_configuration(state, "interpolate", &between);
}
