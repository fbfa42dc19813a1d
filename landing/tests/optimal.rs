//! The forces of a tick are the optimum of its program, by the judgement of a general solver.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, BUILD, FEET};
use dense_qp::Status;
use landing::{Command, Landing, Outcome, Program, Settings, Target, Workspace};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, Frame, Motion, Tangent, Transform, Tree};
use so3::Scalar;

/// Numbers in (−1, 1): a linear congruence is random enough.
struct Stream(u64);

impl Stream {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn array<const K: usize>(&mut self, half: f64) -> [f64; K] {
        core::array::from_fn(|_| half * self.next())
    }
}

/// A state of any subset of feet, from nearly standing (`wild` = 0.1) to far from any jump (1).
struct Case {
    q: Configuration<f64, 12>,
    v: Tangent<f64, 12>,
    on: [bool; 4],
}

fn cases(wild: f64) -> impl Iterator<Item = Case> {
    let mut stream = Stream(2026);
    (0..2000_u32).map(move |k| {
        let turn = Vector3::from(stream.array::<3>(1.5 * wild));
        let mut joints = stream.array::<12>(wild);
        for (i, q) in joints.iter_mut().enumerate() {
            *q += [0.0, 0.8, -1.6][i % 3];
        }
        let base = Transform::new(so3::exp(&turn), Vector3::from(stream.array::<3>(0.3)));
        let velocity = Motion::from_array(stream.array(6.0 * wild));
        Case {
            q: Configuration { base, joints },
            v: Tangent {
                base: velocity,
                joints: stream.array(20.0 * wild),
            },
            on: core::array::from_fn(|i| (k >> i) & 1 == 0),
        }
    })
}

struct Controller<T: Scalar> {
    landing: Landing<T, 12, 4>,
    workspace: Workspace<T, 12, 4>,
}

impl<T: Scalar> Controller<T>
where
    A1Geared: Tree<T, 12>,
{
    fn new() -> Self {
        let feet = FEET.map(|foot| Frame {
            link: foot.frame.link,
            offset: foot.frame.offset.map(T::of),
            ..Frame::IDENTITY
        });
        Self {
            landing: Landing::new(feet, Settings::new(&BUILD.cast()), [T::of(33.5); 12]),
            workspace: Workspace::new(),
        }
    }

    fn step(&mut self, case: &Case) -> Command<T, 12, 4> {
        let of = |v: &Vector3<f64>| v.map(T::of);
        let base = Transform::new(
            Rotation3::from_matrix_unchecked(case.q.base.rotation.matrix().map(T::of)),
            of(&case.q.base.translation),
        );
        let (q, v) = (case.q.joints.map(T::of), case.v.joints.map(T::of));
        let velocity = Motion::new(of(&case.v.base.linear), of(&case.v.base.angular));
        let q = Configuration { base, joints: q };
        let v = Tangent {
            base: velocity,
            joints: v,
        };
        let target = Target {
            height: T::of(0.25),
            ..Target::LEVEL
        };
        let (landing, workspace) = (&self.landing, &mut self.workspace);
        landing.step(&A1Geared, &q, &v, &case.on, &target, &q.joints, workspace)
    }
}

/// Also where the rows of a tick before are those of an altogether different state.
#[test]
fn forces_are_the_optimum_of_the_stated_program() {
    let (mut solved, mut capped) = (0, 0);
    for wild in [0.1, 0.4, 1.0] {
        let mut controller = Controller::<f64>::new();
        for (k, case) in cases(wild).enumerate() {
            if k % 3 == 0 {
                controller.workspace = Workspace::new();
            }
            let command = controller.step(&case);
            match command.outcome {
                Outcome::Airborne => continue,
                Outcome::Solved(_) => solved += 1,
                other => {
                    assert_eq!(other, Outcome::Failed(Status::Limit), "{k}");
                    capped += 1;
                    continue;
                }
            }
            let program = Program::<f64, 12, 28>::of(&controller.workspace);
            let mut memory = dense_qp::Workspace::new();
            let answer =
                dense_qp::solve(&program.problem(), &Default::default(), &mut memory).unwrap();
            assert_eq!(answer.status, Status::Solved);
            for (force, x) in command.forces_w.iter().zip(answer.x.chunks(3)) {
                let off = (force - Vector3::from_column_slice(x)).amax();
                assert!(off <= 2e-8, "{k}: {off:e} N");
            }
        }
    }
    // Measured: 5 529 and 96; the states are far apart.
    assert!(solved > 5_400, "{solved} solved, {capped} capped");
}

/// Median and largest distance in newtons between the forces of both precisions, of some hundred newtons each. A foot or two cannot make
/// every wrench; how the rest is shared is then decided by w_e = 1e-4 alone, which is what single precision loses first.
#[test]
fn single_precision_follows() {
    for (wild, capped, median, most) in [(0.1, 2, 0.06, 2.0), (1.0, 90, 0.3, 20.0)] {
        let (mut single, mut double) = (Controller::<f32>::new(), Controller::<f64>::new());
        let mut early = 0;
        let mut offs = Vec::new();
        for case in cases(wild) {
            let (s, d) = (single.step(&case), double.step(&case));
            match (s.outcome, d.outcome) {
                (Outcome::Airborne, _) => {}
                (Outcome::Solved(_), Outcome::Solved(_)) => {
                    let feet = s.forces_w.iter().zip(&d.forces_w);
                    let off = feet.map(|(s, d)| (s.map(f64::from) - d).amax());
                    offs.push(off.fold(0.0, f64::max));
                }
                (Outcome::Solved(_) | Outcome::Failed(_), _) => early += 1,
                (Outcome::BadData, _) => unreachable!("{wild}: finite numbers went in"),
            }
        }
        offs.sort_by(f64::total_cmp);
        let (middle, worst) = (offs[offs.len() / 2], *offs.last().unwrap());
        assert!(early <= capped, "{early} ticks ended early");
        assert!(middle <= median && worst <= most, "{middle} {worst}");
    }
}
