//! Every algorithm of rbd-core against Pinocchio's values, on const models and on models built at run time.
//!
//! Errors are relative to the largest entry of the quantity. In f64 every quantity agrees within 1e-10. In f32 the
//! bound of each quantity stands in [`single_precision_bound`].

#![allow(clippy::unwrap_used, reason = "tests")]

use std::collections::BTreeMap;

use nalgebra::{Quaternion, SMatrix, UnitQuaternion, Vector3};
use rbd_core::model::bodies_f32;
use rbd_core::{
    AbaDerivatives, AbaDerivativesWorkspace, AbaWorkspace, Axes, BaseKind, BlockMatrix,
    BodyMotions, CentroidalMap, ComJacobian, Configuration, DerivativesWorkspace, Effort, Force,
    Frame, FrameJacobian, Kinematics, MassFactors, MassMatrix, Motion, Posture, RneaDerivatives,
    TableModel, Tangent, Transform, Tree,
};
use saltus_tests::golden::{Golden, Record};
use saltus_tests::tables::{
    A1, A1_BASE, A1_BODIES, A1_FRAMES, ICUB_BASE, ICUB_BODIES, ICUB_FRAMES, Icub23,
};
use so3::Scalar;

/// Agreement demanded in f64.
const DOUBLE: f64 = 1e-10;

/// Largest relative error of a quantity in f32. Solving with the mass matrix loses more than evaluating does.
fn single_precision_bound(key: &str) -> f64 {
    if key.starts_with("aba") || key.contains("inverse") {
        2e-5
    } else {
        2e-6
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
            nalgebra::Rotation3::from_matrix_unchecked(rotation),
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
        dynamics::<T, M, N, V>(w, model, state, &posture, &v, &a, &tau);
        motions::<T, M, N, V>(w, model, frames, state, &posture, &v, &a);
        centroidal::<T, M, N, V>(w, model, state, &posture, &v, &a);
        if state.find("rnea_derivatives.dq").is_some() {
            derivatives::<T, M, N, V>(w, model, state, &posture, &v, &a, &tau);
        }
    }
    worst
}

fn dynamics<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
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

fn derivatives<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
    w: &mut Worst,
    model: &M,
    state: &Record,
    posture: &Posture<T, N>,
    v: &Tangent<T, N>,
    a: &Tangent<T, N>,
    tau: &Effort<T, N>,
) {
    let mut mass = MassMatrix::ZERO;
    rbd_core::crba(model, posture, &mut mass);
    let (mut factors, mut inverse) = (MassFactors::new(), BlockMatrix::ZERO);
    rbd_core::mass_matrix_inverse(model, &mass, &mut factors, &mut inverse);
    w.see(
        state,
        "mass_matrix_inverse_lower",
        lower(&inverse.to_dense::<V>()),
    );
    let mut ws = DerivativesWorkspace::new();
    let mut of = RneaDerivatives::ZERO;
    rbd_core::rnea_derivatives(model, posture, v, a, &mut ws, &mut of);
    w.see(
        state,
        "rnea_derivatives.dq",
        of.by_position.to_dense::<V>().entries(),
    );
    w.see(
        state,
        "rnea_derivatives.dv",
        of.by_velocity.to_dense::<V>().entries(),
    );
    w.see(
        state,
        "mass_matrix_lower",
        lower(&of.by_acceleration.to_dense::<V>()),
    );
    let mut ws = AbaDerivativesWorkspace::new();
    let mut of = AbaDerivatives::ZERO;
    rbd_core::aba_derivatives(model, posture, v, tau, &mut ws, &mut of);
    w.see(state, "aba", of.acceleration.entries());
    w.see(
        state,
        "aba_derivatives.dq",
        of.by_position.to_dense::<V>().entries(),
    );
    w.see(
        state,
        "aba_derivatives.dv",
        of.by_velocity.to_dense::<V>().entries(),
    );
    w.see(
        state,
        "mass_matrix_inverse_lower",
        lower(&of.by_effort.to_dense::<V>()),
    );
}

fn motions<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
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

fn centroidal<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
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
    let rate = rbd_core::centroidal_momentum_rate(model, posture, v, a);
    w.see(state, "centroidal.momentum_rate", rate.to_array());
    w.see(
        state,
        "com.acceleration",
        (rate.linear * (T::ONE / whole.mass)).entries(),
    );
}

#[test]
fn a1_agrees() {
    let golden = Golden::load("a1");
    let compare_f64 = compare::<f64, _, 12, 18>(&A1, &A1_FRAMES, &golden);
    compare_f64.check("a1 const f64", |_| DOUBLE);
    let model = TableModel::<f64, 12>::new(BaseKind::Floating, A1_BASE, &A1_BODIES).unwrap();
    compare::<f64, _, 12, 18>(&model, &A1_FRAMES, &golden).check("a1 run-time f64", |_| DOUBLE);
    let base = A1_BASE.to_f32();
    let model =
        TableModel::<f32, 12>::new(BaseKind::Floating, base, &bodies_f32(&A1_BODIES)).unwrap();
    let frames = A1_FRAMES.map(|(name, frame)| (name, frame.to_f32()));
    compare::<f32, _, 12, 18>(&model, &frames, &golden)
        .check("a1 run-time f32", single_precision_bound);
}

#[test]
fn icub23_agrees() {
    let golden = Golden::load("icub23");
    let compare_f64 = compare::<f64, _, 23, 29>(&Icub23, &ICUB_FRAMES, &golden);
    compare_f64.check("icub23 const f64", |_| DOUBLE);
    let model = TableModel::<f64, 23>::new(BaseKind::Floating, ICUB_BASE, &ICUB_BODIES).unwrap();
    compare::<f64, _, 23, 29>(&model, &ICUB_FRAMES, &golden)
        .check("icub23 run-time f64", |_| DOUBLE);
    let base = ICUB_BASE.to_f32();
    let model =
        TableModel::<f32, 23>::new(BaseKind::Floating, base, &bodies_f32(&ICUB_BODIES)).unwrap();
    let frames = ICUB_FRAMES.map(|(name, frame)| (name, frame.to_f32()));
    compare::<f32, _, 23, 29>(&model, &frames, &golden)
        .check("icub23 run-time f32", single_precision_bound);
}
