//! The robot that is planned for: A1 with its rotors, or a quadruped from a URDF and what is written down beside it.

mod error;
mod hardware;
mod posture;
mod profile;
mod rolling;
mod urdf;

use a1_model::{A1Geared, BUDGETS, BUILD, FEET, FOOT_RADIUS, MOTORS, OWNERS, SHAPES, a1};
use core::ops::Deref;
use nalgebra::Vector3;
use rbd_core::tree::Fold;
use rbd_core::{
    BaseBody, BaseKind, Body, Budgets, Frame, GRAVITY, Inertia, JointLimits, MassMatrix, Model,
    Motor, Posture, Shape, TableModel, Tree, crba,
};

pub use error::RobotError;
pub use posture::State;

/// Joints: four legs of three.
pub const JOINTS: usize = 12;
/// Legs, one foot each.
pub const LEGS: usize = 4;

/// A torque that no leg reaches, N m.
const UNLIMITED: f64 = 1e3;

/// Places of the legs, in the order of [`Data::legs`] and of task files.
pub const PLACES: [&str; LEGS] = ["FL", "FR", "RL", "RR"];

/// A quadruped. Copies share one description, which lives as long as the program: a session plans for few robots.
#[derive(Clone, Copy, Debug)]
pub struct Quadruped(&'static Data);

/// What is known about a quadruped. Leg i has joints 3 i to 3 i + 2, from the trunk down.
#[derive(Clone, Debug)]
pub struct Data {
    /// Its name in plans and results.
    pub name: &'static str,
    table: TableModel<f64, JOINTS>,
    limits: [JointLimits<f64>; JOINTS],
    motors: Option<[Motor<f64>; JOINTS]>,
    joint_names: [&'static str; JOINTS],
    /// Leg at each of [`PLACES`].
    pub legs: [usize; LEGS],
    /// Centres of the balls of the feet.
    pub feet: [Frame<f64>; LEGS],
    /// Radius of the balls, m.
    pub foot_radius: f64,
    /// Middle of each foot's workspace at the height of its hip: where the foot hangs with the hip's first joint at zero,
    /// base axes, m.
    pub hips: [Vector3<f64>; LEGS],
    /// From the second joint of a leg to its foot when stretched, m.
    pub leg_length: f64,
    /// Corners of the trunk, base axes, m.
    pub corners: [Vector3<f64>; 8],
    /// Collision shapes of all links: feet in the order of the legs first.
    pub shapes: Shapes,
    /// What the forces on the shapes count for: feet, shanks, thighs and hips by leg, and the trunk.
    pub owners: [&'static str; OWNER_COUNT],
    /// What the hardware may be asked for.
    pub budgets: Budgets,
    /// What its gains follow from, as far as it was measured or written down; the rest is derived.
    build: profile::KnownBuild,
    /// Whether the centre of mass stands at a task's height, as in paper A, or the hips do.
    stands_by_com: bool,
    /// Thickness of its limbs, where it is written down.
    limbs: profile::LimbsTable,
    /// Joints near a standing posture.
    seed: [f64; JOINTS],
}

/// Shapes of a robot: a ball per foot, a capsule per shank, thigh and hip, and ten capsules around the trunk.
pub const SHAPE_COUNT: usize = SHAPES.len();
/// What they belong to.
pub const OWNER_COUNT: usize = OWNERS.len();

/// Collision shapes of a robot.
pub type Shapes = [Shape<f64>; SHAPE_COUNT];

impl Quadruped {
    /// A1 as published, with rotors: what `saltus run` simulates.
    ///
    /// # Errors
    /// Tables that are no model: never of the published robot.
    pub fn a1() -> Result<Self, RobotError> {
        let model = A1Geared;
        let table = TableModel::with_any_inertia(
            BaseKind::Floating,
            *Tree::<f64, JOINTS>::base(&model),
            Tree::<f64, JOINTS>::bodies(&model),
        )?;
        // Paper A, Table I: hips, their offset to the leg's plane, and half the trunk.
        let side = |leg: usize| if leg.is_multiple_of(2) { 1.0 } else { -1.0 };
        let end = |leg: usize| if leg < 2 { 1.0 } else { -1.0 };
        Ok(Self::leak(Data {
            name: "a1",
            table,
            limits: a1::LIMITS,
            motors: Some(MOTORS),
            joint_names: a1::JOINT_NAMES,
            legs: [0, 1, 2, 3],
            feet: FEET.map(|foot| foot.frame),
            foot_radius: FOOT_RADIUS,
            hips: core::array::from_fn(|i| Vector3::new(0.1805 * end(i), 0.1308 * side(i), 0.0)),
            leg_length: 0.4,
            corners: hardware::corners(&Vector3::new(0.1805, 0.097, 0.057)),
            shapes: SHAPES,
            owners: OWNERS,
            budgets: BUDGETS,
            build: profile::KnownBuild::all(&BUILD),
            stands_by_com: true,
            limbs: profile::LimbsTable::default(),
            seed: core::array::from_fn(|i| [0.0, 0.8, -1.6][i % 3]),
        }))
    }

    /// The same robot with all its mass in the trunk: the single rigid body with its legs where they are at the `start`, on legs that weigh
    /// nothing and whose torques have no limit. The joints' rotors stay: they load their own motors alone, and without them nothing holds
    /// the legs' accelerations.
    ///
    /// # Errors
    /// Tables that are no model.
    pub fn on_massless_legs(&self, start: &State) -> Result<Self, RobotError> {
        let mut mass = MassMatrix::ZERO;
        crba(self, &Posture::new(self, start), &mut mass);
        let Inertia {
            mass,
            first,
            second: i,
        } = mass.base;
        let base = BaseBody {
            mass,
            first: first.into(),
            second: [i.xx, i.yy, i.zz, i.xy, i.xz, i.yz],
        };
        let bodies = self.table.bodies().map(|body| Body {
            mass: 0.0,
            first: [0.0; 3],
            second: [0.0; 6],
            ..body
        });
        Ok(Self::leak(Data {
            table: TableModel::with_any_inertia(BaseKind::Floating, base, &bodies)?,
            limits: self.limits.map(|limit| JointLimits {
                effort: UNLIMITED,
                damping: 0.0,
                friction: 0.0,
                ..limit
            }),
            motors: None,
            ..self.0.clone()
        }))
    }

    /// Keeps a description for the rest of the program.
    fn leak(data: Data) -> Self {
        Self(Box::leak(Box::new(data)))
    }

    /// The leg at a place, by its name in task files.
    #[must_use]
    pub fn leg(&self, place: &str) -> Option<usize> {
        let at = PLACES.iter().position(|name| *name == place)?;
        self.legs.get(at).copied()
    }

    /// Name of the place of a leg.
    #[must_use]
    pub fn place(&self, leg: usize) -> &'static str {
        let at = self.legs.iter().position(|l| *l == leg);
        at.and_then(|at| PLACES.get(at)).copied().unwrap_or("?")
    }

    /// Mass, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        let bodies = self.table.bodies().iter().map(|body| body.mass);
        self.table.base().mass + bodies.sum::<f64>()
    }

    /// Weight, N.
    #[must_use]
    pub fn weight(&self) -> f64 {
        -self.mass() * GRAVITY[2]
    }

    /// Whether a task's standing height is that of the centre of mass, as in paper A, and not that of the hips.
    #[must_use]
    pub fn stands_by_com(&self) -> bool {
        self.stands_by_com
    }
}

impl Deref for Quadruped {
    type Target = Data;
    fn deref(&self) -> &Data {
        self.0
    }
}

impl Tree<f64, JOINTS> for Quadruped {
    fn base_kind(&self) -> BaseKind {
        BaseKind::Floating
    }
    fn base(&self) -> &BaseBody<f64> {
        self.0.table.base()
    }
    fn bodies(&self) -> &[Body<f64>; JOINTS] {
        self.0.table.bodies()
    }
    fn fold<F: Fold<f64>>(&self, fold: &mut F, base: &F::Down) -> F::Up {
        self.0.table.fold(fold, base)
    }
}

impl Model<f64, JOINTS> for Quadruped {
    fn name(&self) -> &'static str {
        self.0.name
    }
    fn joint_names(&self) -> &'static [&'static str; JOINTS] {
        &self.0.joint_names
    }
    fn limits(&self) -> &'static [JointLimits<f64>; JOINTS] {
        &self.0.limits
    }
    fn frame_names(&self) -> &'static [&'static str] {
        &PLACES
    }
    fn frames(&self) -> &'static [Frame<f64>] {
        &self.0.feet
    }
    fn motors(&self) -> Option<&'static [Motor<f64>; JOINTS]> {
        self.0.motors.as_ref()
    }
}
