//! Problem (2) of paper A as plain data: robot, contacts, goal, limits and weights.

use crate::error::Error;
use crate::exponential::Exponential;
use nalgebra::{Matrix3, Vector3};
use so3::Scalar;

/// A foot and where it may be seen from the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot<T: Scalar> {
    /// Fixed contact point in the world, m.
    pub pos_wf: Vector3<T>,
    /// Centre of the leg's workspace in the body frame, m.
    pub nominal_b: Vector3<T>,
}

/// One contact phase: which feet push, on how many intervals, and how long it may last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase<T, const FEET: usize> {
    /// Feet in contact.
    pub contacts: [bool; FEET],
    /// Intervals `N_i`, at least 1.
    pub intervals: usize,
    /// Duration of the guess, s.
    pub duration_guess: T,
    /// Shortest duration, s.
    pub min_duration: T,
    /// Longest duration, s.
    pub max_duration: T,
    /// Reference turn angle at the end of the phase, rad; see [`Reference`].
    pub reference_angle: T,
}

/// The turn angle the body should follow about [`Problem::axis`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// From zero to the goal angle, linearly in the node index over the whole horizon.
    Linear,
    /// Piecewise linear in the node index through [`Phase::reference_angle`]. Needed for full turns,
    /// where start and goal rotation are equal and only the reference tells the number of turns.
    PerPhase,
}

/// A box edge: the ground height is `−drop/2 (1 + tanh((sign · x_axis − distance)/width))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge<T> {
    /// Height of the start above the landing ground, m; negative jumps up.
    pub drop: T,
    /// World axis across the edge: 0 is x, 1 is y.
    pub axis: usize,
    /// Direction of the landing side along the axis, ±1.
    pub sign: T,
    /// Distance of the edge from the origin along that direction, m.
    pub distance: T,
    /// Smoothing width, m.
    pub width: T,
}

impl<T: Scalar> Edge<T> {
    /// The smoothed ground under a point of the world.
    #[inline(always)]
    #[must_use]
    pub fn ground(&self, pos_w: &Vector3<T>) -> Ground<T> {
        let across = if self.axis == 0 { pos_w.x } else { pos_w.y };
        let t = so3::math::tanh((self.sign * across - self.distance) / self.width);
        let half = self.drop * T::HALF;
        let steep = half * (T::ONE - t * t) / self.width;
        Ground {
            height: -half * (T::ONE + t),
            slope: -steep * self.sign,
            curvature: T::TWO * t * steep / self.width,
        }
    }
}

/// The ground under a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground<T> {
    /// Height, m.
    pub height: T,
    /// First derivative of the height along the axis across the edge.
    pub slope: T,
    /// Second derivative of the height along that axis, 1/m.
    pub curvature: T,
}

/// Weights of the cost, per node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<T> {
    /// Of the squared angular velocity, (rad/s)⁻².
    pub omega: T,
    /// Of the squared forces, N⁻².
    pub force: T,
    /// Of the squared rotation error, rad⁻².
    pub rotation: T,
}

/// Problem (2): plan a jump of a single rigid body together with its contact timings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem<T: Scalar, const FEET: usize, const PHASES: usize> {
    /// Mass, kg.
    pub mass: T,
    /// Rotational inertia about the centre of mass in the body frame, kg m².
    pub inertia_b: Matrix3<T>,
    /// Gravity magnitude, m/s².
    pub gravity: T,
    /// Feet.
    pub feet: [Foot<T>; FEET],
    /// Lower corner of a leg's workspace about its nominal point, body frame, m.
    pub reach_lower: Vector3<T>,
    /// Upper corner of a leg's workspace about its nominal point, body frame, m.
    pub reach_upper: Vector3<T>,
    /// Coulomb coefficient of the friction pyramid.
    pub friction: T,
    /// Largest normal force per foot, N.
    pub max_force: T,
    /// Corners of the trunk, body frame, m.
    pub corners: [Vector3<T>; 8],
    /// Least height of the corners over the ground, m.
    pub clearance: T,
    /// Box edge, if the ground has one.
    pub edge: Option<Edge<T>>,
    /// Contact phases; the first `phase_count` are used.
    pub phases: [Phase<T, FEET>; PHASES],
    /// Number of phases.
    pub phase_count: usize,
    /// Shortest total duration, s.
    pub min_total: T,
    /// Longest total duration, s.
    pub max_total: T,
    /// Centre of mass at the start, m; velocities are zero and the rotation is the identity there.
    pub start_w: Vector3<T>,
    /// Centre of mass at the end, m; velocities are free there.
    pub goal_w: Vector3<T>,
    /// Unit axis of the turn.
    pub axis: Vector3<T>,
    /// Total turn about the axis, rad; may exceed 2π.
    pub angle: T,
    /// Least trace of the final rotation error; 3 is exact, 2.5 excludes the half turn.
    pub min_final_trace: T,
    /// Reference rotation.
    pub reference: Reference,
    /// Weights.
    pub weights: Weights<T>,
    /// Steps of the rotation; the reference problems have Taylor's.
    pub exponential: Exponential,
    /// Smoothing ε of the rotation error, see the module documentation.
    pub log_epsilon: T,
}

impl<T: Scalar, const FEET: usize, const PHASES: usize> Problem<T, FEET, PHASES> {
    /// Total number of intervals.
    #[must_use]
    pub fn intervals(&self) -> usize {
        self.used_phases()
            .iter()
            .fold(0usize, |sum, phase| sum.saturating_add(phase.intervals))
    }

    /// The phases in use.
    #[must_use]
    pub fn used_phases(&self) -> &[Phase<T, FEET>] {
        self.phases.get(..self.phase_count).unwrap_or(&self.phases)
    }

    /// Phase of interval `k`, with its index; the last phase for the last node.
    #[must_use]
    pub fn phase_of(&self, k: usize) -> Option<(usize, &Phase<T, FEET>)> {
        let mut left = k;
        let mut found = None;
        for (i, phase) in self.used_phases().iter().enumerate() {
            found = Some((i, phase));
            if left < phase.intervals {
                break;
            }
            left = left.saturating_sub(phase.intervals);
        }
        found
    }

    /// Reference turn angle at node `k`, rad.
    #[must_use]
    pub fn reference_angle(&self, k: usize) -> T {
        let ratio = |a: usize, b: usize| T::of(a as f64) / T::of(b.max(1) as f64);
        match self.reference {
            Reference::Linear => self.angle * ratio(k, self.intervals()),
            Reference::PerPhase => {
                let (mut left, mut before) = (k, T::ZERO);
                for phase in self.used_phases() {
                    if left <= phase.intervals {
                        return before
                            + (phase.reference_angle - before) * ratio(left, phase.intervals);
                    }
                    left = left.saturating_sub(phase.intervals);
                    before = phase.reference_angle;
                }
                before
            }
        }
    }

    /// Smoothed ground height under a point.
    #[inline(always)]
    pub(crate) fn ground(&self, point: &Vector3<T>) -> T {
        self.edge.map_or(T::ZERO, |edge| edge.ground(point).height)
    }

    /// Checks the data.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first number that is not usable.
    pub fn check(&self) -> Result<(), Error> {
        let all = |v: &Vector3<T>| v.iter().all(|x| x.is_finite_number());
        positive(self.mass, "mass: must be positive")?;
        positive(self.gravity, "gravity: must be positive")?;
        require(
            nalgebra::Cholesky::new(self.inertia_b).is_some(),
            "inertia_b: must be positive definite",
        )?;
        positive(self.friction, "friction: must be positive")?;
        positive(self.max_force, "max_force: must be positive")?;
        require(
            self.clearance.is_finite_number(),
            "clearance: must be finite",
        )?;
        require(all(&self.start_w), "start_w: must be finite")?;
        require(all(&self.goal_w), "goal_w: must be finite")?;
        require(self.angle.is_finite_number(), "angle: must be finite")?;
        let unit = (self.axis.norm_squared() - T::ONE).to_f64().abs() < 1e-6;
        require(unit, "axis: must be a unit vector")?;
        for foot in &self.feet {
            require(
                all(&foot.pos_wf) && all(&foot.nominal_b),
                "feet: must be finite",
            )?;
        }
        require(self.corners.iter().all(all), "corners: must be finite")?;
        for i in 0..3 {
            require(
                self.reach_lower[i] < self.reach_upper[i],
                "reach_lower: must be below reach_upper",
            )?;
        }
        if let Some(edge) = &self.edge {
            require(edge.axis < 2, "edge.axis: must be 0 or 1")?;
            positive(edge.width, "edge.width: must be positive")?;
            require(edge.drop.is_finite_number(), "edge.drop: must be finite")?;
            require(
                edge.distance.is_finite_number(),
                "edge.distance: must be finite",
            )?;
        }
        self.check_phases()?;
        for (value, name) in [
            (self.weights.omega, "weights.omega: must be positive"),
            (self.weights.force, "weights.force: must be positive"),
            (self.weights.rotation, "weights.rotation: must be positive"),
            (self.log_epsilon, "log_epsilon: must be positive"),
        ] {
            positive(value, name)?;
        }
        Ok(())
    }

    /// Phases, their durations and how long they may take together.
    fn check_phases(&self) -> Result<(), Error> {
        let counted = self.phase_count > 0 && self.phase_count <= PHASES;
        require(counted, "phase_count: must be between 1 and PHASES")?;
        for phase in self.used_phases() {
            require(phase.intervals > 0, "phases.intervals: must be at least 1")?;
            positive(phase.min_duration, "phases.min_duration: must be positive")?;
            require(
                phase.min_duration <= phase.max_duration,
                "phases.max_duration: below min_duration",
            )?;
            positive(
                phase.duration_guess,
                "phases.duration_guess: must be positive",
            )?;
        }
        require(
            self.min_total <= self.max_total,
            "max_total: must not be below min_total",
        )
    }
}

/// Refuses the number of this name.
fn require(ok: bool, name: &'static str) -> Result<(), Error> {
    if ok {
        Ok(())
    } else {
        Err(Error::Parameter(name))
    }
}

fn positive<T: Scalar>(value: T, name: &'static str) -> Result<(), Error> {
    require(value > T::ZERO && value.is_finite_number(), name)
}
