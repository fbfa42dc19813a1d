//! Every quantity of a golden file on a model of any base and size: what `agree` does for the basic algorithms.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use rbd_core::{
    AbaDerivatives, AbaDerivativesWorkspace, AbaWorkspace, Axes, BaseKind, BlockMatrix,
    BodyMotions, CentroidalDerivatives, CentroidalMap, ComJacobian, Configuration,
    CoupledWorkspace, DerivativesWorkspace, Effort, Force, Frame, FrameJacobian, Kinematics,
    MassFactors, MassMatrix, Motion, Posture, Reduction, RneaDerivatives, Tangent, Transform, Tree,
};

use crate::golden::{Golden, Record};

/// Largest error of each quantity relative to the largest number that it should give, over all states.
pub type Errors = BTreeMap<String, f64>;

/// How much rounding a solution with the mass matrix may show: that of 1e-11 in the best of cases, and the condition number
/// of the matrix otherwise.
#[must_use]
pub fn bound(golden: &Golden, key: &str) -> f64 {
    let solved = key.starts_with("aba") || key == "mass_matrix_inverse_lower";
    let conditions = golden.states.iter().map(|s| s.scalar("mass_condition"));
    let worst = conditions.fold(0.0, f64::max);
    if solved {
        f64::max(1e-11, 8.0 * f64::EPSILON * worst)
    } else {
        1e-11
    }
}

/// A state of the file on a model, and the coordinates that both have: `start..end` of 6 + N.
struct At<'a, M, const N: usize> {
    model: &'a M,
    state: &'a Record,
    posture: Posture<f64, N>,
    v: Tangent<f64, N>,
    a: Tangent<f64, N>,
    tau: Effort<f64, N>,
    start: usize,
    end: usize,
    errors: &'a mut Errors,
}

/// Compares `model` with the golden file; `frame` finds a link's frame by name. `N` may exceed the joints of
/// a run-time model.
///
/// # Panics
/// If the file is of a robot with another base or number of joints, or names a frame that is not found.
pub fn errors<M: Tree<f64, N>, const N: usize>(
    model: &M,
    golden: &Golden,
    frame: impl Fn(&str) -> Option<Frame<f64>>,
) -> Errors {
    let start = match model.base_kind() {
        BaseKind::Floating => 0,
        BaseKind::Fixed => 6,
    };
    let end = 6 + model.joint_count();
    assert_eq!(golden.nv(), end - start, "size");
    let mut errors = Errors::new();
    for state in &golden.states {
        let tangent = |key| tangent::<N>(state.values(key), start);
        let tau = tangent("tau");
        let mut at = At {
            model,
            state,
            posture: Posture::new(model, &configuration(state.values("q"), start == 0)),
            v: tangent("v"),
            a: tangent("a"),
            tau: Effort {
                base: Force::new(tau.base.linear, tau.base.angular),
                joints: tau.joints,
            },
            start,
            end,
            errors: &mut errors,
        };
        at.dynamics();
        at.whole_robot();
        for name in golden.frames() {
            let found = frame(&name);
            assert!(found.is_some(), "the model has no frame `{name}`");
            at.frame(&name, &found.unwrap_or(Frame::IDENTITY));
        }
        if state.find("mass_matrix_inverse_lower").is_some() {
            at.derivatives();
            at.centroidal_derivatives();
        }
    }
    errors
}

/// Compares a robot with coupled joints with the golden file of its independent ones (`golden.py --all`): inverse dynamics,
/// mass matrix, and forward dynamics with `a` as effort. `R` may exceed the independent joints.
#[must_use]
pub fn coupled_errors<M: Tree<f64, N>, const N: usize, const R: usize>(
    model: &M,
    reduction: &Reduction<f64, N, R>,
    golden: &Golden,
) -> Errors {
    let start = match model.base_kind() {
        BaseKind::Floating => 0,
        BaseKind::Fixed => 6,
    };
    let range = start..start + golden.nv();
    let mut errors = Errors::new();
    for state in &golden.states {
        let q = reduction.configuration(&configuration(state.values("q"), start == 0));
        let posture = Posture::new(model, &q);
        let [v, a] = ["v", "a"].map(|key| tangent::<R>(state.values(key), start));
        let (full_v, full_a) = (reduction.tangent(&v), reduction.tangent(&a));
        let tau = reduction.effort(&rbd_core::rnea(model, &posture, &full_v, &full_a));
        let list: Vec<f64> = range.clone().map(|i| tau.coordinate(i)).collect();
        see(&mut errors, state, "rnea", &list);
        let effort = Effort {
            base: Force::new(a.base.linear, a.base.angular),
            joints: a.joints,
        };
        let mut ws = Box::new(CoupledWorkspace::new());
        let back = rbd_core::coupled_dynamics(model, reduction, &posture, &v, &effort, &mut ws);
        let list: Vec<f64> = range.clone().map(|i| back.coordinate(i)).collect();
        see(&mut errors, state, "acceleration", &list);
        let columns: Vec<_> = (0..range.end)
            .map(|j| ws.reduced.mul(&Tangent::unit(j)))
            .collect();
        let rows = range.clone();
        let list: Vec<f64> = rows
            .flat_map(|i| (start..=i).map(move |j| (i, j)))
            .map(|(i, j)| columns[j].coordinate(i))
            .collect();
        see(&mut errors, state, "mass_matrix_lower", &list);
    }
    errors
}

fn see(errors: &mut Errors, state: &Record, key: &str, ours: &[f64]) {
    // MuJoCo does not say everything that Pinocchio says.
    let Some(theirs) = state.find(key).map(|m| m.values.as_slice()) else {
        return;
    };
    assert_eq!(ours.len(), theirs.len(), "{key}: number of entries");
    let scale = theirs.iter().fold(1e-3_f64, |m, x| m.max(x.abs()));
    let worst = errors.entry(key.to_owned()).or_default();
    for (x, y) in ours.iter().zip(theirs) {
        let error = (x - y).abs() / scale;
        if error > *worst || error.is_nan() {
            *worst = error;
        }
    }
}

impl<M: Tree<f64, N>, const N: usize> At<'_, M, N> {
    fn see(&mut self, key: &str, ours: &[f64]) {
        see(self.errors, self.state, key, ours);
    }

    /// The coordinates that the file has.
    fn list(&self, coordinate: impl Fn(usize) -> f64) -> Vec<f64> {
        (self.start..self.end).map(coordinate).collect()
    }

    /// A matrix by its columns, as the file has it: row by row.
    fn rows<const K: usize>(&self, column: impl Fn(usize) -> [f64; K]) -> Vec<f64> {
        let columns: Vec<[f64; K]> = (self.start..self.end).map(column).collect();
        (0..K)
            .flat_map(|i| columns.iter().map(move |c| c[i]))
            .collect()
    }

    fn lower(&self, entry: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let rows = self.start..self.end;
        rows.flat_map(|i| (self.start..=i).map(move |j| (i, j)))
            .map(|(i, j)| entry(i, j))
            .collect()
    }

    fn see_effort(&mut self, key: &str, x: &Effort<f64, N>) {
        let list = self.list(|i| x.coordinate(i));
        self.see(key, &list);
    }

    fn see_matrix(&mut self, key: &str, m: &BlockMatrix<f64, N>) {
        let rows = (self.start..self.end).flat_map(|i| (self.start..self.end).map(move |j| (i, j)));
        let list: Vec<f64> = rows.map(|(i, j)| entry(m, i, j)).collect();
        self.see(key, &list);
    }

    fn dynamics(&mut self) {
        let (model, posture, v) = (self.model, self.posture, self.v);
        self.see_effort("rnea", &rbd_core::rnea(model, &posture, &v, &self.a));
        self.see_effort(
            "nonlinear_effects",
            &rbd_core::nonlinear_effects(model, &posture, &v),
        );
        self.see_effort("gravity", &rbd_core::generalized_gravity(model, &posture));
        let mut ws = Box::new(AbaWorkspace::new());
        let a = rbd_core::aba(model, &posture, &v, &self.tau, &mut ws);
        let list = self.list(|i| a.coordinate(i));
        self.see("aba", &list);
        let mut mass = Box::new(MassMatrix::ZERO);
        rbd_core::crba(model, &posture, &mut mass);
        let columns: Vec<_> = (0..self.end).map(|j| mass.mul(&Tangent::unit(j))).collect();
        let list = self.lower(|i, j| columns[j].coordinate(i));
        self.see("mass_matrix_lower", &list);
        if self.state.find("mass_matrix_inverse_lower").is_some() {
            let mut factors = Box::new(MassFactors::new());
            let mut inverse = Box::new(BlockMatrix::ZERO);
            rbd_core::mass_matrix_inverse(model, &mass, &mut factors, &mut inverse);
            let list = self.lower(|i, j| entry(&inverse, i, j));
            self.see("mass_matrix_inverse_lower", &list);
        }
    }

    fn whole_robot(&mut self) {
        let (model, posture, v, a) = (self.model, self.posture, self.v, self.a);
        let mut jacobian = Box::new(ComJacobian::ZERO);
        let com = rbd_core::com_jacobian(model, &posture, &mut jacobian);
        self.see("com.position", com.position_w.as_slice());
        let list = self.rows(|j| jacobian.mul(&Tangent::unit(j)).into());
        self.see("com.jacobian", &list);
        let com = rbd_core::com_motion(model, &posture, &v, &a);
        self.see("com.velocity", com.velocity_w.as_slice());
        self.see("com.acceleration", com.acceleration_w.as_slice());
        let mut map = Box::new(CentroidalMap::ZERO);
        rbd_core::centroidal_map(model, &posture, &mut map);
        let list = self.rows(|j| map.momentum(&Tangent::unit(j)).to_array());
        self.see("centroidal.map", &list);
        let locked = map.locked_angular_velocity(&map.momentum(&v));
        self.see("centroidal.locked_angular_velocity", locked.as_slice());
        let inertia = map.locked_inertia_w.to_matrix();
        let entry = |i: usize, j: usize| match (i < 3, j < 3) {
            (true, true) if i == j => map.mass,
            (false, false) => inertia[(i - 3, j - 3)],
            _ => 0.0,
        };
        let list: Vec<f64> = (0..36).map(|k| entry(k / 6, k % 6)).collect();
        self.see("centroidal.inertia", &list);
        let now = rbd_core::centroidal_state(model, &posture, &v);
        self.see("com.position", now.com_w.as_slice());
        self.see("centroidal.momentum", &now.momentum_w.to_array());
        self.see("energy.kinetic", &[now.kinetic_energy]);
        self.see("energy.potential", &[now.potential_energy]);
        let bias = rbd_core::centroidal_bias(model, &posture, &v);
        self.see("centroidal.bias", &bias.to_array());
        let rate = rbd_core::centroidal_momentum_rate(model, &posture, &v, &a);
        self.see("centroidal.momentum_rate", &rate.to_array());
    }

    fn frame(&mut self, name: &str, frame: &Frame<f64>) {
        let (model, posture) = (self.model, self.posture);
        let mut poses = Box::new(Kinematics::IDENTITY);
        rbd_core::forward_kinematics(model, &posture, &mut poses);
        let mut motions = Box::new(BodyMotions::ZERO);
        rbd_core::forward_accelerations(model, &posture, &self.v, &self.a, &mut motions);
        let xf = poses.frame(frame);
        let key = |tail: &str| format!("{name}.{tail}");
        let rotation: Vec<f64> = xf.rotation.matrix().transpose().iter().copied().collect();
        self.see(&key("rotation"), &rotation);
        self.see(&key("position"), xf.translation.as_slice());
        let aligned = |m: Motion<f64>| Axes::LocalWorldAligned.motion(&xf, &m).to_array();
        self.see(&key("velocity_a"), &aligned(motions.frame_velocity(frame)));
        let spatial = motions.frame_acceleration(frame);
        self.see(&key("spatial_acceleration_l"), &spatial.to_array());
        let classical = motions.frame_classical_acceleration(frame);
        self.see(&key("classical_acceleration_a"), &aligned(classical));
        let jacobian_key = key("jacobian_a");
        if self.state.find(&jacobian_key).is_some() {
            let mut jacobian = Box::new(FrameJacobian::ZERO);
            let axes = Axes::LocalWorldAligned;
            rbd_core::frame_jacobian(model, &poses, frame, axes, &mut jacobian);
            let list = self.rows(|j| jacobian.mul(&Tangent::unit(j)).to_array());
            self.see(&jacobian_key, &list);
        }
    }

    fn derivatives(&mut self) {
        let (model, posture, v) = (self.model, self.posture, self.v);
        let mut ws = Box::new(DerivativesWorkspace::new());
        let mut of = Box::new(RneaDerivatives::ZERO);
        rbd_core::rnea_derivatives(model, &posture, &v, &self.a, &mut ws, &mut of);
        self.see_matrix("rnea_derivatives.dq", &of.by_position);
        self.see_matrix("rnea_derivatives.dv", &of.by_velocity);
        let mut ws = Box::new(AbaDerivativesWorkspace::new());
        let mut of = Box::new(AbaDerivatives::ZERO);
        rbd_core::aba_derivatives(model, &posture, &v, &self.tau, &mut ws, &mut of);
        self.see_matrix("aba_derivatives.dq", &of.by_position);
        self.see_matrix("aba_derivatives.dv", &of.by_velocity);
    }

    fn centroidal_derivatives(&mut self) {
        let (model, posture, v) = (self.model, self.posture, self.v);
        let mut ws = Box::new(DerivativesWorkspace::new());
        let mut of = Box::new(CentroidalDerivatives::ZERO);
        rbd_core::centroidal_derivatives(model, &posture, &v, &self.a, &mut ws, &mut of);
        for (key, columns) in [
            ("momentum_dq", &of.momentum_by_position),
            ("rate_dq", &of.rate_by_position),
            ("rate_dv", &of.rate_by_velocity),
        ] {
            let list = self.rows(|j| columns.mul(&Tangent::unit(j)).to_array());
            self.see(&format!("centroidal_derivatives.{key}"), &list);
        }
    }
}

/// Entry (i, j), base first.
fn entry<const N: usize>(m: &BlockMatrix<f64, N>, i: usize, j: usize) -> f64 {
    match (i < 6, j < 6) {
        (true, true) => m.base[i][j],
        (true, false) => m.base_joints[i][j - 6],
        (false, true) => m.joints_base[i - 6][j],
        (false, false) => m.joints[i - 6][j - 6],
    }
}

/// Position, quaternion x y z w if the base moves, joints.
fn configuration<const N: usize>(q: &[f64], floating: bool) -> Configuration<f64, N> {
    let mut out = Configuration::NEUTRAL;
    let joints = if floating {
        let quat = UnitQuaternion::new_normalize(Quaternion::new(q[6], q[3], q[4], q[5]));
        let rotation: Matrix3<f64> = quat.to_rotation_matrix().into_inner();
        out.base = Transform::new(
            Rotation3::from_matrix_unchecked(rotation),
            Vector3::new(q[0], q[1], q[2]),
        );
        &q[7..]
    } else {
        q
    };
    out.joints[..joints.len()].copy_from_slice(joints);
    out
}

fn tangent<const N: usize>(x: &[f64], start: usize) -> Tangent<f64, N> {
    let mut out = Tangent::ZERO;
    if start == 0 {
        let base: [f64; 6] = core::array::from_fn(|i| x[i]);
        out.base = Motion::from_array(base);
    }
    let joints = &x[6 - start..];
    out.joints[..joints.len()].copy_from_slice(joints);
    out
}
