//! Whole-body dynamics, contacts and cost, paper A eq. (4), eq. (5) and eq. (6), as plain data: robot, contacts, reference, limits and weights.

use crate::apart::{Apart, Segment};
use crate::error::Error;
use crate::friction::Friction;
use crate::robot::{BASE, Point, Robot, TURN};
use crate::state::Pose;
use nalgebra::{Rotation3, Vector3};
use so3::{Scalar, math};
use srb_opt::Edge;

/// How fast [`Problem::swing_rise`] comes and goes, m/s.
const CLIMB: f64 = 0.5;

/// A foot: a point of the robot that may push against the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot<T: Scalar> {
    /// Where it is on the robot.
    pub point: Point<T>,
    /// Where it stands during its contact phases, world, m.
    pub pos_wf: Vector3<T>,
    /// Radius of the ball around the point with which it touches, and on which it rolls, m; 0 for a point.
    pub radius: T,
}

/// A point that keeps a distance from the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance<T: Scalar> {
    /// Where it is on the robot.
    pub point: Point<T>,
    /// Least height over the ground, m.
    pub height: T,
}

/// One contact phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase<T, const FEET: usize> {
    /// Feet in contact.
    pub contacts: [bool; FEET],
    /// Intervals, at least 1.
    pub intervals: usize,
    /// Length of an interval, s.
    pub dt: T,
    /// How much an interval costs, over what the weights say: 1 for a sum over all intervals, proportional to their lengths for an integral.
    pub weight: T,
}

/// Weights of the cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<T> {
    /// Of the squared distance of an interval's midpoint from its reference, rad⁻² or m⁻².
    pub position: T,
    /// Of the squared joint efforts, (N m)⁻².
    pub effort: T,
    /// Of the squared distance of the last configuration from the goal.
    pub goal: T,
}

/// Whole-body problem: joint motions, efforts and contact forces over given contact phases.
///
/// Midpoint transcription on intervals of length dt: acceleration and contact forces are constant over
/// an interval, q⁺ = q + dt q̇ + ½ dt² q̈, q̇⁺ = q̇ + dt q̈, and all nonlinear rows hold at the midpoint
/// qm = q + ½ dt q̇ + ¼ dt² q̈, vm = q̇ + ½ dt q̈. `N` coordinates, the base's six first. A base on SO(3) turns by the same
/// rule on the group: R⁺ = R Exp(dt ω_m), ω⁺ = ω + dt α, Rm = R Exp(½ dt ω_m), ω_m = ω + ½ dt α.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, T: Scalar, const N: usize, const FEET: usize> {
    /// Robot and its limits.
    pub robot: Robot<T, N>,
    /// Feet.
    pub feet: [Foot<T>; FEET],
    /// Points other than feet that stay clear of the ground.
    pub clearances: &'a [Clearance<T>],
    /// Links that keep apart.
    pub apart: &'a [Apart<T>],
    /// Least height of a foot that is not in contact, m; negative lets it graze.
    pub swing_height: T,
    /// How much more than that it keeps over the ground on its way, m: reached at 0.5 m/s from where it lifts off, left at
    /// 0.5 m/s to where it touches down.
    pub swing_rise: T,
    /// Box edge, if the ground has one.
    pub edge: Option<Edge<T>>,
    /// Contact phases in order.
    pub phases: &'a [Phase<T, FEET>],
    /// Reference configuration at the midpoint of every interval.
    pub reference: &'a [Pose<T, N>],
    /// Configuration at the start, at rest.
    pub start: Pose<T, N>,
    /// Configuration wanted at the end.
    pub goal: Pose<T, N>,
    /// How far the base may end from the goal, per coordinate, m and rad; on SO(3) per axis of the base the sine of the
    /// angle times its axis.
    pub goal_tolerance: [T; BASE],
    /// Over this many last intervals the joints rest at the goal: the pre-landing configuration.
    pub landing_intervals: usize,
    /// Speed below which the Coulomb friction of a joint fades, rad/s: τ_f = d q̇ + f tanh(q̇/this), with damping d
    /// and friction f of the robot's limits.
    pub friction_smoothing: T,
    /// Friction of the feet.
    pub friction: Friction<T>,
    /// Least normal force of a foot in contact, N: above 0, it still pushes where the true force leaves the interval's constant one.
    pub least_force: T,
    /// Fastest that the normal force of a foot falls to nothing before it leaves the ground, N/s; infinite is no limit. Motors and soft ground
    /// cannot let go at once, and what is still there when the foot should have left turns the body.
    pub release: T,
    /// Largest normal force of a foot, N; infinite is no limit but that of the joints.
    pub max_force: T,
    /// How far a foot in contact may be from its place, per axis, m.
    pub drift: T,
    /// Weights.
    pub weights: Weights<T>,
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// Number of intervals.
    #[must_use]
    pub const fn intervals(&self) -> usize {
        self.reference.len()
    }

    /// First node at which the joints rest in the landing configuration.
    #[must_use]
    pub const fn landing_node(&self) -> usize {
        self.intervals().saturating_sub(self.landing_intervals)
    }

    /// Whether the joints rest during interval `k`.
    #[must_use]
    pub const fn is_landing(&self, k: usize) -> bool {
        k >= self.landing_node()
    }

    /// Phase of interval `k`; none at the last node.
    #[must_use]
    pub fn phase_of(&self, k: usize) -> Option<&Phase<T, FEET>> {
        let mut left = k;
        for phase in self.phases {
            if left < phase.intervals {
                return Some(phase);
            }
            left = left.saturating_sub(phase.intervals);
        }
        None
    }

    /// Feet in contact during interval `k`; none at the last node.
    #[must_use]
    pub fn contacts(&self, k: usize) -> [bool; FEET] {
        self.phase_of(k)
            .map_or([false; FEET], |phase| phase.contacts)
    }

    /// Least height of a foot in the air in the middle of interval `k`, m.
    pub(crate) fn least_height(&self, k: usize, foot: usize) -> T {
        let in_air = |k: &usize| self.contacts(*k).get(foot).is_some_and(|on| !*on);
        let sum = |time: T, k: usize| time + self.dt(k);
        let half = self.dt(k) * T::HALF;
        let before = (0..k).rev().take_while(in_air).fold(half, sum);
        let after = (k.saturating_add(1)..self.intervals()).take_while(in_air);
        let nearest = math::min(before, after.fold(half, sum));
        self.swing_height + math::min(self.swing_rise, nearest * T::of(CLIMB))
    }

    /// Largest normal force of a foot in contact in the middle of interval `k`, N: [`Self::max_force`], and what falls to nothing, at
    /// [`Self::release`], until it leaves the ground.
    pub(crate) fn most_force(&self, k: usize, foot: usize) -> T {
        let on = |k: &usize| self.contacts(*k).get(foot).is_some_and(|on| *on);
        let after = k.saturating_add(1)..self.intervals();
        if after.clone().all(|k| on(&k)) {
            return self.max_force;
        }
        let half = self.dt(k) * T::HALF;
        let standing = after.take_while(on);
        let released = self.release * standing.fold(half, |time, k| time + self.dt(k));
        // From the least force it may let go at once.
        math::max(math::min(released, self.max_force), self.least_force)
    }

    /// Length of interval `k`, s; 0 at the last node.
    #[must_use]
    pub fn dt(&self, k: usize) -> T {
        self.phase_of(k).map_or(T::ZERO, |phase| phase.dt)
    }

    /// Weights of the cost of interval `k`.
    pub(crate) fn interval_weights(&self, k: usize) -> Weights<T> {
        let interval = self.phase_of(k).map_or(T::ONE, |phase| phase.weight);
        Weights {
            position: self.weights.position * interval,
            effort: self.weights.effort * interval,
            ..self.weights
        }
    }

    /// Times of the ends of interval `k` from its midpoint, s.
    #[inline(always)]
    pub(crate) fn ends(&self, k: usize) -> [T; 2] {
        let half = self.dt(k) * T::HALF;
        [-half, half]
    }

    /// Adds the joints' friction to efforts.
    #[inline(always)]
    pub(crate) fn add_friction(&self, v: &[T; N], effort: &mut [T; N]) {
        for ((effort, limit), v) in effort.iter_mut().zip(&self.robot.limits).zip(v).skip(BASE) {
            let [friction, _, _] = crate::drive::friction(limit, *v, self.friction_smoothing);
            *effort += friction;
        }
    }

    /// How far a point is over the ground.
    #[inline(always)]
    pub(crate) fn over_ground(&self, pos: &Vector3<T>) -> Height<T> {
        let mut over = Height {
            height: pos.z,
            normal: Vector3::new(T::ZERO, T::ZERO, T::ONE),
            across: 0,
            curvature: T::ZERO,
        };
        if let Some(edge) = &self.edge {
            let ground = edge.ground(pos);
            over.height -= ground.height;
            over.across = if edge.axis == 0 { 0 } else { 1 };
            over.normal[over.across] = -ground.slope;
            over.curvature = -ground.curvature;
        }
        over
    }

    /// Checks the data.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first number that is not usable and what it must be.
    pub fn check(&self) -> Result<(), Error> {
        require(
            N >= BASE,
            "N: a robot has at least the six coordinates of its base",
        )?;
        self.check_settings()?;
        self.check_poses()?;
        self.check_intervals()?;
        self.check_points()?;
        if let Some(edge) = &self.edge {
            require(edge.axis < 2, "edge.axis: must be 0 or 1")?;
            require(positive(edge.width), "edge.width: must be positive")?;
        }
        self.check_robot()
    }

    /// Numbers of their own.
    fn check_settings(&self) -> Result<(), Error> {
        let diagonals = self.friction.diagonals.unwrap_or(T::ONE);
        let w = &self.weights;
        let natural = |x: T| x >= T::ZERO && x.is_finite_number();
        for (ok, what) in [
            (
                positive(self.friction.axes) && positive(diagonals),
                "friction: must be positive",
            ),
            (
                natural(self.least_force),
                "least_force: must not be negative",
            ),
            // An infinite one is no limit.
            (self.release > T::ZERO, "release: must be positive"),
            (
                self.max_force > self.least_force,
                "max_force: must be above least_force",
            ),
            (
                natural(self.friction.apex),
                "friction.apex: must not be negative",
            ),
            (natural(self.swing_rise), "swing_rise: must not be negative"),
            (positive(self.drift), "drift: must be positive"),
            (
                positive(self.friction_smoothing),
                "friction_smoothing: must be positive",
            ),
            (positive(w.position), "weights.position: must be positive"),
            (positive(w.effort), "weights.effort: must be positive"),
            (positive(w.goal), "weights.goal: must be positive"),
        ] {
            require(ok, what)?;
        }
        Ok(())
    }

    /// Start, goal and reference.
    fn check_poses(&self) -> Result<(), Error> {
        let pose = |pose: &Pose<T, N>| {
            let defect = so3::orthogonality_defect(pose.rot_wc.matrix());
            let idle = if self.robot.turns_freely() {
                pose.q.iter().skip(TURN).take(3).all(|q| *q == T::ZERO)
            } else {
                pose.rot_wc == Rotation3::identity()
            };
            finite(&pose.q) && defect < T::of(1e-3) && idle
        };
        require(
            pose(&self.start),
            "start: must be finite, and a Pose of the robot's base coordinates",
        )?;
        require(
            pose(&self.goal),
            "goal: must be finite, and a Pose of the robot's base coordinates",
        )?;
        require(
            self.goal_tolerance.iter().all(|x| positive(*x)),
            "goal_tolerance: must be positive",
        )?;
        require(
            self.reference.iter().all(pose),
            "reference: must be finite, and Poses of the robot's base coordinates",
        )
    }

    /// Phases and how many intervals they have together.
    fn check_intervals(&self) -> Result<(), Error> {
        require(
            self.phases.iter().all(|phase| phase.intervals > 0),
            "phases.intervals: must be at least 1",
        )?;
        require(
            self.phases.iter().all(|phase| positive(phase.dt)),
            "phases.dt: must be positive",
        )?;
        require(
            self.phases.iter().all(|phase| positive(phase.weight)),
            "phases.weight: must be positive",
        )?;
        let total = self
            .phases
            .iter()
            .fold(0usize, |sum, phase| sum.saturating_add(phase.intervals));
        require(
            total == self.intervals() && total > 0,
            "reference: must have one entry per interval of the phases",
        )?;
        require(
            self.landing_intervals < total,
            "landing_intervals: must be fewer than all intervals",
        )
    }

    /// Points of the robot.
    fn check_points(&self) -> Result<(), Error> {
        let inside = |point: &Point<T>| point.link < N && finite(point.offset_l.as_slice());
        require(
            self.feet
                .iter()
                .all(|foot| foot.radius >= T::ZERO && foot.radius.is_finite_number()),
            "feet.radius: must not be negative",
        )?;
        require(
            self.feet.iter().all(|foot| inside(&foot.point)),
            "feet.point: must be on a body of the robot",
        )?;
        require(
            self.clearances.iter().all(|c| inside(&c.point)),
            "clearances.point: must be on a body of the robot",
        )?;
        let of_link = |segment: &Segment<T>| {
            let [from, to] = &segment.ends;
            inside(from) && inside(to) && from.link == to.link
        };
        let both = |pair: &Apart<T>| pair.segments.iter().all(of_link) && positive(pair.distance);
        require(
            self.apart.iter().all(both),
            "apart: ends of a segment must be on one body of the robot, distances positive",
        )
    }

    /// Motors and joint limits.
    fn check_robot(&self) -> Result<(), Error> {
        for motor in self.robot.motors.iter().flatten() {
            require(
                motor.torque > T::ZERO && motor.no_load_speed > motor.corner_speed,
                "robot.motors: torque must be positive and no_load_speed above corner_speed",
            )?;
        }
        for limit in &self.robot.limits {
            require(
                limit.lower <= limit.upper,
                "robot.limits.lower: must not be above upper",
            )?;
            require(
                limit.speed > T::ZERO && limit.effort > T::ZERO,
                "robot.limits.speed, effort: must be positive",
            )?;
        }
        Ok(())
    }
}

fn require(ok: bool, what: &'static str) -> Result<(), Error> {
    if ok {
        Ok(())
    } else {
        Err(Error::Parameter(what))
    }
}

fn positive<T: Scalar>(x: T) -> bool {
    x > T::ZERO && x.is_finite_number()
}

fn finite<T: Scalar>(values: &[T]) -> bool {
    values.iter().all(|x| x.is_finite_number())
}

/// Height of a point over the ground, with derivatives in its position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Height<T: Scalar> {
    pub(crate) height: T,
    /// Gradient.
    pub(crate) normal: Vector3<T>,
    /// World axis along which the ground is curved.
    pub(crate) across: usize,
    /// Second derivative along that axis.
    pub(crate) curvature: T,
}
