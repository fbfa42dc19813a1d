//! An MJCF with one of everything beside MuJoCo.

use model_import::{Options, Robot, Warning, mjcf};
use rbd_core::BaseKind;
use saltus_tests::everything;
use saltus_tests::golden::{Golden, directory};

/// The values are those of `tests/peers/golden_mjcf.py DIR tests/data/zoo.xml`.
#[test]
fn the_zoo_moves_as_in_mujoco() {
    let text = mjcf::read(&directory().join("../zoo.xml")).unwrap();
    let robot = Robot::from_mjcf(&text, &Options::default()).unwrap();
    assert_eq!(robot.base_kind, BaseKind::Floating);
    let golden = Golden::load("zoo");
    let names: Vec<&str> = robot.joints.iter().map(|j| j.name.as_str()).collect();
    assert_eq!(golden.joints, names);
    assert!((robot.mass() - golden.robot.scalar("mass")).abs() < 1e-14);
    let model = robot.model::<f64, 8>().unwrap();
    let errors = everything::errors(&model, &golden, |link| robot.frame(link));
    for key in [
        "rnea",
        "aba",
        "mass_matrix_lower",
        "com.jacobian",
        "centroidal.momentum",
        "camera.position",
    ] {
        assert!(errors.contains_key(key), "{key}");
    }
    for (key, error) in &errors {
        assert!(*error < 1e-13, "{key}: {error:e}");
    }
    // The only thing on the way that is not in the tree: nothing.
    let other = |w: &&Warning| matches!(w, Warning::NotKept { .. });
    assert_eq!(robot.warnings.iter().find(other), None);
}
