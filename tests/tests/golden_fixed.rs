//! A fixed base beside Pinocchio, which leaves what is welded to the world out of centre of mass, momentum and energy.

use a1_model::A1;
use rbd_core::{BaseKind, Model, TableModel, Tree};
use saltus_tests::everything;
use saltus_tests::golden::Golden;

/// A1 with its trunk welded to the world: a third of its mass no longer counts. The values are those of
/// `tests/peers/golden.py --urdf models/a1.urdf --base fixed --name a1_fixed --states 4 --heavy 1 --frame FL_foot RR_calf`.
#[test]
fn a_welded_trunk_is_part_of_the_world() {
    let golden = Golden::load("a1_fixed");
    let of = |base: &rbd_core::BaseBody<f64>| {
        TableModel::<f64, 12>::new(BaseKind::Fixed, *base, Tree::<f64, 12>::bodies(&A1)).unwrap()
    };
    let model = of(Tree::<f64, 12>::base(&A1));
    let frame = |link: &str| Model::<f64, 12>::frame(&A1, link);
    let errors = everything::errors(&model, &golden, frame);
    assert!(errors.len() > 35, "{} quantities", errors.len());
    for (key, error) in &errors {
        assert!(*error < 1e-11, "{key}: {error:e}");
    }
    // The test would see the trunk: on a floating base it counts.
    let moving = rbd_core::center_of_mass(
        &TableModel::<f64, 12>::new(BaseKind::Floating, *model.base(), model.bodies()).unwrap(),
        &rbd_core::Posture::new(&model, &rbd_core::Configuration::NEUTRAL),
    );
    let mass = golden.robot.scalar("mass");
    assert!(moving.mass > 1.3 * mass, "{} {mass}", moving.mass);
}
