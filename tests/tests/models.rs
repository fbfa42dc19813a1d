//! The model crates against Pinocchio and against what is known of the robots.

use a1_model::{A1, A1Geared, A1Reference, a1, a1_reference, geared};
use icub_model::{Icub23, Icub23Cad, Icub23GazeboGeared, Icub23Geared, cad, gazebo, robots};
use model_import::limbs::{expression, structure};
use rbd_core::hardware::ContactShape;
use rbd_core::{
    BaseKind, Body, Configuration, Kinematics, Link, Model, Posture, TableModel, Tangent, Tree,
    forward_kinematics, rnea,
};
use saltus_tests::agree::errors;
use saltus_tests::golden::Golden;

fn mass<M: Tree<f64, N>, const N: usize>(model: &M) -> f64 {
    model.base().mass + model.bodies().iter().map(|b| b.mass).sum::<f64>()
}

#[test]
fn a1_agrees_with_pinocchio() {
    let golden = Golden::load("a1");
    assert_eq!(golden.joints, Model::<f64, 12>::joint_names(&A1));
    let errors = errors::<A1, 12>(&A1, &golden, |name| A1.frame(name));
    assert!(errors.worst() < 1e-12, "{errors:?}");
}

#[test]
fn icub_agrees_with_pinocchio() {
    let golden = Golden::load("icub23");
    assert_eq!(golden.joints, Model::<f64, 23>::joint_names(&Icub23));
    let errors = errors::<Icub23, 23>(&Icub23, &golden, |name| Icub23.frame(name));
    assert!(errors.worst() < 1e-11, "{errors:?}");
}

/// The written order of limbs and kinds is that of the tables: the walk of the const model and the walk over
/// its own tables at run time see the same robot.
fn walks_its_tables<M: Tree<f64, N>, const N: usize>(model: &M) {
    let table =
        TableModel::<f64, N>::new(BaseKind::Floating, *model.base(), model.bodies()).unwrap();
    let mut configuration = Configuration::NEUTRAL;
    let mut velocity = Tangent::ZERO;
    for i in 0..N {
        configuration.joints[i] = 0.1 + 0.05 * i as f64;
        velocity.joints[i] = 1.0 - 0.3 * i as f64;
    }
    let posture = Posture::new(model, &configuration);
    let a = rnea(model, &posture, &velocity, &velocity);
    let b = rnea(&table, &posture, &velocity, &velocity);
    for i in 0..6 + N {
        assert!((a.coordinate(i) - b.coordinate(i)).abs() < 1e-10, "{i}");
    }
}

#[test]
fn const_models_walk_their_own_tables() {
    walks_its_tables::<A1, 12>(&A1);
    walks_its_tables::<A1Geared, 12>(&A1Geared);
    walks_its_tables::<A1Reference, 12>(&A1Reference);
    walks_its_tables::<Icub23, 23>(&Icub23);
    walks_its_tables::<Icub23Cad, 23>(&Icub23Cad);
    walks_its_tables::<Icub23Geared, 23>(&Icub23Geared);
    walks_its_tables::<Icub23GazeboGeared, 23>(&Icub23GazeboGeared);
    assert_eq!(
        expression(&structure(&a1::BODIES)),
        "4 * [RevoluteX, RevoluteY, RevoluteY]"
    );
}

#[test]
fn masses_are_those_of_the_three_sets_and_of_icub() {
    assert!((mass::<A1, 12>(&A1) - 13.741).abs() < 1e-12);
    assert!((mass::<A1Reference, 12>(&A1Reference) - 12.453).abs() < 1e-12);
    assert!((mass::<Icub23, 23>(&Icub23) - 33.0617).abs() < 1e-4);
    assert!((mass::<Icub23, 23>(&Icub23) - mass::<Icub23Cad, 23>(&Icub23Cad)).abs() < 1e-12);
}

#[test]
fn reference_set_is_the_published_legs_under_another_trunk() {
    for (body, other) in a1::BODIES.iter().zip(&a1_reference::BODIES) {
        assert_eq!(
            (body.kind, body.parent, body.offset),
            (other.kind, other.parent, other.offset)
        );
        assert!((body.mass - other.mass).abs() < 1e-12);
        for (x, y) in body.second.iter().zip(&other.second) {
            assert!((x - y).abs() < 1e-12);
        }
    }
    let base = a1_reference::BASE;
    assert_eq!(base.mass, 4.713);
    let inertia = base.inertia().rotational_com();
    for (x, y) in [inertia.xx, inertia.yy, inertia.zz]
        .iter()
        .zip(&a1_model::table1::INERTIA)
    {
        assert!((x - y).abs() < 1e-12);
    }
}

#[test]
fn feet_are_balls_at_the_end_of_the_calves() {
    let feet = Model::<f64, 12>::contacts(&A1Geared);
    let names: Vec<_> = feet.iter().map(|c| c.name).collect();
    assert_eq!(names, ["FL_foot", "FR_foot", "RL_foot", "RR_foot"]);
    for (leg, foot) in feet.iter().enumerate() {
        assert_eq!(foot.frame.link, Link::Joint(3 * leg + 2));
        assert_eq!(foot.frame.offset, [0.0, 0.0, -0.2]);
        assert_eq!(foot.shape, ContactShape::Sphere { radius: 0.02 });
        assert_eq!(foot.frame, A1.frame(foot.name).unwrap());
    }
}

#[test]
fn a1_motor_leaves_a_little_torque_at_the_published_top_speed() {
    let motor = a1_model::hardware::MOTOR;
    assert_eq!(motor.torque_range(0.0), [-33.5, 33.5]);
    assert!((motor.corner_speed - 9.85).abs() < 0.01);
    assert!((motor.no_load_speed - 21.44).abs() < 0.01);
    let left = motor.torque_range(21.0)[1];
    assert!(left > 1.0 && left < 1.5, "{left}");
    for (body, plain) in geared::BODIES.iter().zip(&a1::BODIES) {
        assert_eq!(body.rotor_inertia, 0.0067);
        assert_eq!((body.mass, body.second), (plain.mass, plain.second));
    }
}

/// `root_link` looks backwards: at zero the soles' x axes point to −x of the base, the left one has y < 0.
#[test]
fn icub_base_looks_backwards() {
    let posture = Posture::new(&Icub23, &Configuration::<f64, 23>::NEUTRAL);
    let mut poses = Kinematics::IDENTITY;
    forward_kinematics(&Icub23, &posture, &mut poses);
    for (sole, y) in icub_model::SOLES.iter().zip([-0.070, 0.070]) {
        let pose = poses.frame(&sole.frame);
        let m = pose.rotation.matrix();
        assert!((m[(0, 0)] + 1.0).abs() < 1e-12 && (m[(1, 1)] + 1.0).abs() < 1e-12);
        assert!((m[(2, 2)] - 1.0).abs() < 1e-12);
        assert!(
            (pose.translation.y - y).abs() < 5e-3,
            "{}",
            pose.translation.y
        );
        assert!((pose.translation.z + 0.62).abs() < 0.01);
    }
}

#[test]
fn icub_soles_are_mirror_images_on_the_frames_of_both_models() {
    let [left, right] = &icub_model::SOLES;
    assert_eq!(
        (left.frame, right.frame),
        (gazebo::frame::L_SOLE, gazebo::frame::R_SOLE)
    );
    assert_eq!(
        (left.frame, right.frame),
        (cad::frame::L_SOLE, cad::frame::R_SOLE)
    );
    let (ContactShape::Rectangle { x: xl, y: yl }, ContactShape::Rectangle { x: xr, y: yr }) =
        (left.shape, right.shape)
    else {
        unreachable!()
    };
    assert_eq!((xl, yl), (xr, [-yr[1], -yr[0]]));
    assert!((xl[1] - xl[0] - 0.160).abs() < 1e-12 && (yl[1] - yl[0] - 0.072).abs() < 1e-12);
}

#[test]
fn icub_limits_are_the_file_s_but_for_placeholders_and_ankles() {
    use gazebo::joint::{L_ANKLE_PITCH, L_KNEE, R_ANKLE_PITCH, TORSO_PITCH};
    let limits = icub_model::LIMITS;
    for (i, (ours, file)) in limits.iter().zip(&gazebo::LIMITS).enumerate() {
        assert!(ours.effort < 100.0 && ours.speed < 10.0, "joint {i}");
        let ankle = i == L_ANKLE_PITCH || i == R_ANKLE_PITCH;
        let shift = if ankle { 15_f64.to_radians() } else { 0.0 };
        assert!((file.lower - ours.lower - shift).abs() < 1e-12, "joint {i}");
        assert!((file.upper - ours.upper - shift).abs() < 1e-12, "joint {i}");
        assert_eq!(file.effort < 1000.0, i < TORSO_PITCH, "joint {i}");
        if i < TORSO_PITCH {
            assert_eq!((ours.effort, ours.speed), (file.effort, file.speed));
        }
    }
    // The start squat of the jump: possible only with shifted ankles.
    assert!(limits[L_ANKLE_PITCH].lower < -0.817 && gazebo::LIMITS[L_ANKLE_PITCH].lower > -0.817);
    assert!(limits[L_KNEE].lower < -2.013);
    assert_eq!(gazebo::LIMITS[0].damping, 1.0);
    assert_eq!(cad::LIMITS[0].damping, 0.223);
}

#[test]
fn icub_variants_differ_in_moments_of_inertia_only() {
    for (i, (a, b)) in gazebo::BODIES.iter().zip(&cad::BODIES).enumerate() {
        assert_eq!(
            (a.kind, a.parent, a.offset, a.tilt),
            (b.kind, b.parent, b.offset, b.tilt)
        );
        assert!((a.mass - b.mass).abs() < 1e-12, "body {i}");
        for (x, y) in a.first.iter().zip(&b.first) {
            assert!((x - y).abs() < 1e-12, "body {i}");
        }
    }
    assert!(gazebo::BODIES[15].second != cad::BODIES[15].second);
    let rotor = |i: usize| robots::GEARED[i].rotor_inertia;
    assert!((rotor(0) - 0.3076).abs() < 1e-3, "hip pitch, geared 1:150");
    assert!((rotor(1) - 0.1367).abs() < 1e-4 && (rotor(15) - 0.0795).abs() < 1e-4);
}

#[test]
fn single_precision_tables_are_the_rounded_ones() {
    let rounded = |a: &Body<f64>, b: &Body<f32>| {
        assert_eq!(a.to_f32(), *b);
        assert_eq!(a.second[0] as f32, b.second[0]);
    };
    for (a, b) in a1::BODIES.iter().zip(&a1::BODIES_F32) {
        rounded(a, b);
    }
    for (a, b) in cad::BODIES.iter().zip(&cad::BODIES_F32) {
        rounded(a, b);
    }
    let names = Model::<f32, 23>::joint_names(&Icub23);
    assert_eq!(names, Model::<f64, 23>::joint_names(&Icub23));
}
