//! How far a model is from Pinocchio: the basic algorithms on every state of a golden file.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use rbd_core::algo::crba::{MassMatrix, crba};
use rbd_core::state::{Configuration, Effort, Posture, Tangent};
use rbd_core::{
    AbaWorkspace, BaseKind, Force, Frame, Kinematics, Motion, Transform, Tree, aba,
    forward_kinematics, rnea,
};

use crate::golden::{Golden, Record};

/// Largest error of each algorithm relative to the largest number it should give, over all states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Inverse dynamics.
    pub rnea: f64,
    /// Forward dynamics.
    pub aba: f64,
    /// Mass matrix.
    pub crba: f64,
    /// Positions (m) and rotations of the file's frames.
    pub frames: f64,
}

impl Errors {
    /// The worst of them; NaN if any is.
    #[must_use]
    pub fn worst(&self) -> f64 {
        let all = [self.rnea, self.aba, self.crba, self.frames];
        all.into_iter()
            .fold(0.0, |w, x| if x > w || x.is_nan() { x } else { w })
    }
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
    let base = if model.base_kind() == BaseKind::Floating {
        6
    } else {
        0
    };
    assert_eq!(golden.nv(), base + model.joint_count(), "size");
    let frames: Vec<(String, Frame<f64>)> = golden
        .frames()
        .map(|name| match frame(&name) {
            Some(frame) => (name, frame),
            #[allow(clippy::panic, reason = "a missing frame must fail the test")]
            None => panic!("the model has no frame `{name}`"),
        })
        .collect();
    let mut errors = Errors::default();
    for state in &golden.states {
        one_state(model, state, base, &frames, &mut errors);
    }
    errors
}

fn one_state<M: Tree<f64, N>, const N: usize>(
    model: &M,
    state: &Record,
    base: usize,
    frames: &[(String, Frame<f64>)],
    errors: &mut Errors,
) {
    let n = model.joint_count();
    let posture = Posture::new(model, &configuration(state.values("q"), base));
    let [v, a] = ["v", "a"].map(|key| tangent::<N>(state.values(key), base));
    let want = state.values("rnea");
    worse(
        &mut errors.rnea,
        &flat_effort(&rnea(model, &posture, &v, &a), base, n),
        want,
    );
    let tau = tangent::<N>(state.values("tau"), base);
    let effort = Effort {
        base: Force {
            linear: tau.base.linear,
            angular: tau.base.angular,
        },
        joints: tau.joints,
    };
    let mut ws = Box::new(AbaWorkspace::new());
    let got = aba(model, &posture, &v, &effort, &mut ws);
    worse(
        &mut errors.aba,
        &flat_tangent(&got, base, n),
        state.values("aba"),
    );
    let mut mass = Box::new(MassMatrix::ZERO);
    crba(model, &posture, &mut mass);
    worse(
        &mut errors.crba,
        &lower(&mass, base, n),
        state.values("mass_matrix_lower"),
    );
    let mut poses = Box::new(Kinematics::IDENTITY);
    forward_kinematics(model, &posture, &mut poses);
    for (name, frame) in frames {
        let pose = poses.frame(frame);
        let rotation: Vec<f64> = pose.rotation.matrix().transpose().iter().copied().collect();
        worse(
            &mut errors.frames,
            &rotation,
            state.values(&format!("{name}.rotation")),
        );
        let position = state.values(&format!("{name}.position"));
        worse(&mut errors.frames, pose.translation.as_slice(), position);
    }
}

fn worse(worst: &mut f64, got: &[f64], want: &[f64]) {
    assert_eq!(got.len(), want.len(), "sizes");
    let scale = want.iter().fold(1e-3_f64, |m, x| m.max(x.abs()));
    for (x, y) in got.iter().zip(want) {
        let error = (x - y).abs() / scale;
        if error > *worst || error.is_nan() {
            *worst = error;
        }
    }
}

/// Position, quaternion x y z w, joints; `base` is 6 or 0.
fn configuration<const N: usize>(q: &[f64], base: usize) -> Configuration<f64, N> {
    let mut out = Configuration::NEUTRAL;
    let joints = if base == 0 {
        q
    } else {
        let quat = UnitQuaternion::new_normalize(Quaternion::new(q[6], q[3], q[4], q[5]));
        let rotation: Matrix3<f64> = quat.to_rotation_matrix().into_inner();
        out.base = Transform::new(
            Rotation3::from_matrix_unchecked(rotation),
            Vector3::new(q[0], q[1], q[2]),
        );
        &q[7..]
    };
    out.joints[..joints.len()].copy_from_slice(joints);
    out
}

fn tangent<const N: usize>(x: &[f64], base: usize) -> Tangent<f64, N> {
    let mut out = Tangent::ZERO;
    if let [a, b, c, d, e, f] = x[..base] {
        out.base = Motion {
            linear: Vector3::new(a, b, c),
            angular: Vector3::new(d, e, f),
        };
    }
    out.joints[..x.len() - base].copy_from_slice(&x[base..]);
    out
}

fn flat_effort<const N: usize>(x: &Effort<f64, N>, base: usize, n: usize) -> Vec<f64> {
    (6 - base..6 + n).map(|i| x.coordinate(i)).collect()
}

fn flat_tangent<const N: usize>(x: &Tangent<f64, N>, base: usize, n: usize) -> Vec<f64> {
    (6 - base..6 + n).map(|i| x.coordinate(i)).collect()
}

/// The lower triangle of the mass matrix, by rows, from its products with unit motions.
fn lower<const N: usize>(mass: &MassMatrix<f64, N>, base: usize, n: usize) -> Vec<f64> {
    let columns: Vec<Vec<f64>> = (6 - base..6 + n)
        .map(|j| flat_effort(&mass.mul(&Tangent::unit(j)), base, n))
        .collect();
    (0..base + n)
        .flat_map(|i| (0..=i).map(move |j| (i, j)))
        .map(|(i, j)| columns[j][i])
        .collect()
}
