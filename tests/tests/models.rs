//! The model crates against Pinocchio and against what is known of the robots.

#![allow(clippy::unwrap_used, reason = "tests")]

use a1_model::{A1, A1Reference};
use icub_model::{Icub23, Icub23Cad};
use rbd_core::{Model, Tree};
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

#[test]
fn masses_are_those_of_the_three_sets_and_of_icub() {
    assert!((mass::<A1, 12>(&A1) - 13.741).abs() < 1e-12);
    assert!((mass::<A1Reference, 12>(&A1Reference) - 12.453).abs() < 1e-12);
    assert!((mass::<Icub23, 23>(&Icub23) - 33.0617).abs() < 1e-3);
    assert!((mass::<Icub23, 23>(&Icub23) - mass::<Icub23Cad, 23>(&Icub23Cad)).abs() < 1e-12);
}
