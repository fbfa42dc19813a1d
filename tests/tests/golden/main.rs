//! Every algorithm of rbd-core against Pinocchio's values, on const models and on models built at run time.
//!
//! Errors are relative to the largest entry of the quantity. In f64 every quantity agrees within 1e-10. In f32 the
//! bound of each quantity stands in [`single_precision_bound`].

#![allow(clippy::unwrap_used, reason = "tests")]

mod algorithms;
mod contacts;
mod derivatives;

use std::collections::BTreeMap;

use a1_model::A1;
use icub_model::gazebo::AsPublished as Icub23;
use nalgebra::{Quaternion, Rotation3, SMatrix, UnitQuaternion, Vector3};
use rbd_core::{
    AbaWorkspace, Configuration, Effort, Force, Frame, Model, Motion, Posture, TableModel, Tangent,
    Transform, Tree,
};
use saltus_tests::golden::{Golden, Record};
use so3::Scalar;

/// Agreement demanded in f64.
const DOUBLE: f64 = 1e-10;

/// Largest relative error of a quantity in f32: evaluating costs a few roundings, solving with the mass matrix
/// multiplies them by its condition number, and solving for contact forces does so twice.
fn single_precision_bound(key: &str) -> f64 {
    match key {
        "aba" | "aba_derivatives.dq" | "aba_derivatives.dv" | "mass_matrix_inverse_lower" => 2e-5,
        _ if key.starts_with("constrained") || key.starts_with("impulse") => 2e-4,
        _ => 2e-6,
    }
}

/// The worst relative error of each quantity so far.
#[derive(Default)]
struct Worst(BTreeMap<String, f64>);

impl Worst {
    /// Compares numbers with those of `key`, both row by row.
    fn see<T: Scalar>(&mut self, state: &Record, key: &str, ours: impl IntoIterator<Item = T>) {
        let theirs = state.values(key);
        let ours: Vec<f64> = ours.into_iter().map(Scalar::to_f64).collect();
        assert_eq!(ours.len(), theirs.len(), "{key}: number of entries");
        let scale = theirs.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let error = ours.iter().zip(theirs).fold(0.0_f64, |m, (a, b)| {
            if (a - b).abs() <= m { m } else { (a - b).abs() }
        });
        let error = if scale > 0.0 { error / scale } else { error };
        let worst = self.0.entry(key.to_owned()).or_default();
        *worst = if error <= *worst { *worst } else { error };
    }

    /// Compares a configuration with (position, quaternion, joints), its rotation as a matrix.
    fn see_configuration<T: Scalar, const N: usize>(
        &mut self,
        state: &Record,
        key: &str,
        ours: &Configuration<T, N>,
    ) {
        let theirs: Configuration<f64, N> = configuration(state.values(key));
        let numbers = |r: Vec<f64>, p: Vec<f64>, joints: Vec<f64>| [r, p, joints].concat();
        let ours = numbers(
            ours.base
                .rotation
                .into_inner()
                .entries()
                .into_iter()
                .map(Scalar::to_f64)
                .collect(),
            ours.base
                .translation
                .entries()
                .into_iter()
                .map(Scalar::to_f64)
                .collect(),
            ours.joints.iter().map(|x| x.to_f64()).collect(),
        );
        let theirs = numbers(
            theirs.base.rotation.into_inner().entries(),
            theirs.base.translation.entries(),
            theirs.joints.to_vec(),
        );
        let error = ours.iter().zip(&theirs).fold(0.0_f64, |m, (a, b)| {
            if (a - b).abs() <= m { m } else { (a - b).abs() }
        });
        let worst = self.0.entry(key.to_owned()).or_default();
        *worst = if error <= *worst { *worst } else { error };
    }

    fn check(&self, what: &str, bound: impl Fn(&str) -> f64) {
        for (key, error) in &self.0 {
            println!("{what} {key}: {error:.1e}");
        }
        for (key, error) in &self.0 {
            assert!(
                *error <= bound(key),
                "{what} {key}: relative error {error:e}"
            );
        }
    }
}

fn motion<T: Scalar>(x: &[f64]) -> Motion<T> {
    Motion::from_array(core::array::from_fn(|i| T::of(x[i])))
}

fn tangent<T: Scalar, const N: usize>(x: &[f64]) -> Tangent<T, N> {
    Tangent {
        base: motion(x),
        joints: core::array::from_fn(|i| T::of(x[6 + i])),
    }
}

fn effort<T: Scalar, const N: usize>(x: &[f64]) -> Effort<T, N> {
    Effort {
        base: Force::from_array(motion(x).to_array()),
        joints: core::array::from_fn(|i| T::of(x[6 + i])),
    }
}

fn configuration<T: Scalar, const N: usize>(x: &[f64]) -> Configuration<T, N> {
    // Turned into a matrix in f64: an f32 quaternion would add its own error.
    let quat = UnitQuaternion::new_unchecked(Quaternion::new(x[6], x[3], x[4], x[5]));
    let rotation = quat.to_rotation_matrix().into_inner().map(T::of);
    Configuration {
        base: Transform::new(
            Rotation3::from_matrix_unchecked(rotation),
            Vector3::new(T::of(x[0]), T::of(x[1]), T::of(x[2])),
        ),
        joints: core::array::from_fn(|i| T::of(x[7 + i])),
    }
}

trait Entries<T> {
    fn entries(self) -> Vec<T>;
}

impl<T: Scalar, const N: usize> Entries<T> for Effort<T, N> {
    fn entries(self) -> Vec<T> {
        self.base
            .to_array()
            .into_iter()
            .chain(self.joints)
            .collect()
    }
}

impl<T: Scalar, const N: usize> Entries<T> for Tangent<T, N> {
    fn entries(self) -> Vec<T> {
        self.base
            .to_array()
            .into_iter()
            .chain(self.joints)
            .collect()
    }
}

impl<T: Scalar, const R: usize, const C: usize> Entries<T> for SMatrix<T, R, C> {
    fn entries(self) -> Vec<T> {
        self.row_iter()
            .flat_map(|row| row.iter().copied().collect::<Vec<_>>())
            .collect()
    }
}

fn lower<T: Scalar, const V: usize>(m: &SMatrix<T, V, V>) -> Vec<T> {
    (0..V)
        .flat_map(|i| (0..=i).map(move |j| (i, j)))
        .map(|ij| m[ij])
        .collect()
}

/// Runs every algorithm on every state of the golden file.
fn compare<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
    model: &M,
    frames: &[(&str, Frame<T>)],
    golden: &Golden,
) -> Worst {
    let mut worst = Worst::default();
    let w = &mut worst;
    for state in &golden.states {
        let posture = Posture::new(model, &configuration::<T, N>(state.values("q")));
        let v: Tangent<T, N> = tangent(state.values("v"));
        let a: Tangent<T, N> = tangent(state.values("a"));
        let tau: Effort<T, N> = effort(state.values("tau"));
        algorithms::dynamics::<T, M, N, V>(w, model, state, &posture, &v, &a, &tau);
        algorithms::motions::<T, M, N, V>(w, model, frames, state, &posture, &v, &a);
        algorithms::centroidal::<T, M, N, V>(w, model, state, &posture, &v, &a);
        if state.find("rnea_derivatives.dq").is_some() {
            derivatives::derivatives::<T, M, N, V>(w, model, state, &posture, &v, &a, &tau);
            derivatives::centroidal_derivatives::<T, M, N, V>(w, model, state, &posture, &v, &a);
            derivatives::frame_derivatives::<T, M, N, V>(w, model, frames, state, &posture, &v, &a);
        }
        let feet = 12 / golden.robot.scalar("contact") as usize;
        contacts::contacts(w, model, &frames[..feet], state, &posture, &v, &a, &tau);
        algorithms::manifold::<T, N>(w, state);
    }
    worst
}

const A1_FRAMES: [&str; 6] = [
    "FL_foot", "FR_foot", "RL_foot", "RR_foot", "FL_calf", "imu_link",
];
const ICUB_FRAMES: [&str; 4] = ["l_sole", "r_sole", "chest", "l_hand"];

fn frames<T: Scalar, M: Model<T, N>, const N: usize>(
    model: &M,
    names: &[&'static str],
) -> Vec<(&'static str, Frame<T>)> {
    names
        .iter()
        .map(|name| (*name, model.frame(name).unwrap()))
        .collect()
}

/// The same robot, its joint kinds known only at run time.
fn table<T: Scalar, M: Tree<T, N>, const N: usize>(model: &M) -> TableModel<T, N> {
    TableModel::new(model.base_kind(), *model.base(), model.bodies()).unwrap()
}

#[test]
fn a1_agrees() {
    let golden = Golden::load("a1");
    assert_eq!(golden.joints, Model::<f64, 12>::joint_names(&A1));
    let (double, single) = (frames(&A1, &A1_FRAMES), frames(&A1, &A1_FRAMES));
    compare::<f64, _, 12, 18>(&A1, &double, &golden).check("a1 const f64", |_| DOUBLE);
    compare::<f64, _, 12, 18>(&table(&A1), &double, &golden).check("a1 run-time f64", |_| DOUBLE);
    compare::<f32, _, 12, 18>(&A1, &single, &golden).check("a1 const f32", single_precision_bound);
}

#[test]
fn icub23_agrees() {
    let golden = Golden::load("icub23");
    assert_eq!(golden.joints, Model::<f64, 23>::joint_names(&Icub23));
    let (double, single) = (frames(&Icub23, &ICUB_FRAMES), frames(&Icub23, &ICUB_FRAMES));
    compare::<f64, _, 23, 29>(&Icub23, &double, &golden).check("icub23 const f64", |_| DOUBLE);
    compare::<f64, _, 23, 29>(&table(&Icub23), &double, &golden)
        .check("icub23 run-time f64", |_| DOUBLE);
    compare::<f32, _, 23, 29>(&Icub23, &single, &golden)
        .check("icub23 const f32", single_precision_bound);
}

/// Rotors behind gears add to the diagonal of the mass matrix.
fn rotors<M: Tree<f64, N>, const N: usize>(model: &M, golden: &Golden) {
    let mut worst = Worst::default();
    for state in &golden.states {
        let mut bodies = *model.bodies();
        for (body, inertia) in bodies.iter_mut().zip(&state.values("armature")[6..]) {
            body.rotor_inertia = *inertia;
        }
        let geared = TableModel::<f64, N>::new(model.base_kind(), *model.base(), &bodies).unwrap();
        let posture = Posture::new(&geared, &configuration::<f64, N>(state.values("q")));
        let (v, a) = (tangent(state.values("v")), tangent(state.values("a")));
        worst.see(
            state,
            "armature.rnea",
            rbd_core::rnea(&geared, &posture, &v, &a).entries(),
        );
        let tau = effort(state.values("tau"));
        let acceleration = rbd_core::aba(&geared, &posture, &v, &tau, &mut AbaWorkspace::new());
        worst.see(state, "armature.aba", acceleration.entries());
    }
    worst.check("rotors", |_| DOUBLE);
}

#[test]
fn rotors_agree() {
    rotors::<_, 12>(&A1, &Golden::load("a1"));
    rotors::<_, 23>(&Icub23, &Golden::load("icub23"));
}
