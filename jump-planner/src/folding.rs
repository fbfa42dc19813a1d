//! Legs that fold in a flight that turns.
//!
//! The angular momentum of a flight is that of its take-off, L = I ω: folded legs make I smaller, so that the robot turns as far with less of it. The
//! push-off then has less to give, and, with the legs out again, the robot meets the ground turning more slowly: feet far from the axis of a roll
//! come down with ω times that distance on top of the fall.
//!
//! The rigid body of the first stage keeps its inertia, and pays for ω² in every node, so that a turn makes its flight long. What the push-off has to
//! give, and the ground to take, is the [energy](Folding::energy) of the turn with the legs out, ½ I (r ω)² with the share r of the inertia that
//! folded legs leave. About an axis with little inertia that is little, and a long flight, which ends with a fast fall, does not pay.
//!
//! Folded legs are a reference for the joints, which the whole-body plan follows as far as it pays.

use nalgebra::{Matrix3, Vector3};
use rbd_core::Transform;

use super::JOINTS;
use crate::robot::{Quadruped, State};
use crate::setup::POSED;

/// Least share of the inertia about the axis of the turn that folded legs have to save: those of A1 save 27 % of a roll's, 9 % of a flip's and
/// nothing of a spin's.
const WORTH: f64 = 0.2;
/// Turn from which on legs fold wholly, rad.
const WHOLLY: f64 = core::f64::consts::PI;
/// Time in which legs fold after the take-off, and in which they unfold before they rest in the landing posture, s.
const TIME: f64 = 0.12;

/// The legs' reference in flight.
#[derive(Clone, Debug)]
pub(crate) struct Folding {
    /// Joints of the landing posture, rad.
    landing: [f64; JOINTS],
    /// What folded legs differ from it by, rad.
    way: [f64; JOINTS],
    /// As [`Folding::energy`].
    energy: f64,
}

impl Folding {
    /// Of a robot that stands at `start` and turns by `angle` (rad) about the unit vector `axis`.
    ///
    /// # Errors
    /// As [`Quadruped::landing_joints`].
    pub(crate) fn new(
        (robot, start): (&Quadruped, &State),
        (axis, angle): (&Vector3<f64>, f64),
    ) -> Result<Self, String> {
        let landing = robot.landing_joints(start)?;
        let inertia = |joints: &[f64; JOINTS]| {
            let q = State {
                base: Transform::IDENTITY,
                joints: *joints,
            };
            robot.locked_inertia(&q)
        };
        let out = inertia(&landing);
        let about = |inertia: &Matrix3<f64>| axis.dot(&(inertia * axis));
        // Legs that cannot fold stay as they are.
        let folded = robot.folded_joints(start).unwrap_or(landing);
        let saved = 1.0 - about(&inertia(&folded)) / about(&out);
        let share = if saved < WORTH {
            0.0
        } else {
            (angle.abs() / WHOLLY).min(1.0)
        };
        let left = 1.0 - share * saved;
        let most = f64::max(out.m11, out.m22);
        Ok(Self {
            landing,
            way: core::array::from_fn(|i| share * (folded[i] - landing[i])),
            energy: (left * left * (about(&out) / most)).min(1.0),
        })
    }

    /// Joints of the landing posture, rad.
    pub(crate) const fn landing(&self) -> &[f64; JOINTS] {
        &self.landing
    }

    /// Energy of the turn with the legs out over that of an equally fast one that they cannot help, about the level axis with most inertia: at most 1.
    pub(crate) const fn energy(&self) -> f64 {
        self.energy
    }

    /// Joint positions at this time of a flight between two times, rad.
    pub(crate) fn joints(&self, time: f64, [takeoff, touchdown]: [f64; 2]) -> [f64; JOINTS] {
        let smooth = |time: f64| {
            let u = (time / TIME).clamp(0.0, 1.0);
            u * u * (3.0 - 2.0 * u)
        };
        let share = smooth(time - takeoff) * smooth(touchdown - POSED - time);
        core::array::from_fn(|i| self.landing[i] + share * self.way[i])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{Folding, TIME, WHOLLY};
    use crate::setup::POSED;
    use crate::task::Task;
    use nalgebra::Vector3;

    /// How far the legs of A1 are from their landing posture at most, rad, in the middle of a flight with this turn, and the turn's energy.
    fn folded(axis: Vector3<f64>, angle: f64) -> [f64; 2] {
        let task = Task::load("a1/lateral").unwrap();
        let landing = *task.landing_joints();
        let folding = Folding::new((&task.robot, &task.start), (&axis, angle)).unwrap();
        let joints = |time| folding.joints(time, [1.0, 1.5]);
        for rest in [0.0, 1.0, 1.5 - POSED, 1.5, 9.0] {
            assert_eq!(joints(rest), landing);
        }
        let [half, whole] = [1.0 + 0.5 * TIME, 1.0 + TIME].map(joints);
        for ((half, whole), landing) in half.iter().zip(&whole).zip(&landing) {
            assert!((half - 0.5 * (whole + landing)).abs() < 1e-12);
        }
        let apart = whole.iter().zip(&landing).map(|(a, b)| (a - b).abs());
        [apart.fold(0.0, f64::max), folding.energy()]
    }

    #[test]
    fn legs_fold_for_rolls_and_not_where_it_saves_little() {
        let roll = folded(Vector3::x(), 6.3);
        assert!(roll[0] > 0.7, "{roll:?}");
        assert_eq!(folded(-Vector3::x(), -3.2), roll);
        let half = folded(Vector3::x(), 0.5 * WHOLLY);
        assert!((half[0] - 0.5 * roll[0]).abs() < 1e-12);
        for (axis, angle) in [
            (Vector3::x(), 0.0),
            (Vector3::y(), 12.6),
            (Vector3::z(), 12.6),
        ] {
            assert_eq!(folded(axis, angle)[0], 0.0, "{axis}");
        }
    }

    #[test]
    fn a_roll_costs_the_energy_of_its_take_off() {
        // With a quarter of its inertia saved and 0.45 of a flip's to begin with.
        let [spread, folded_up] = [0.0, 6.3].map(|angle| folded(Vector3::x(), angle)[1]);
        assert!(spread > 0.4 && spread < 0.5, "{spread}");
        let left = so3::math::sqrt(folded_up / spread);
        assert!(left > 0.7 && left < 0.75, "{left}");
        let half = folded(Vector3::x(), 0.5 * WHOLLY)[1];
        let mean = 0.5 * (1.0 + left);
        assert!((half / spread - mean * mean).abs() < 1e-12);
        // Legs do not help the others, which pay what the task says.
        let omega = |name| Task::load(name).unwrap().problem.weights.omega;
        for name in ["a1/lateral", "a1/spin-90", "a1/double-backflip"] {
            assert_eq!(omega(name), 1e-2, "{name}");
        }
        let roll = omega("a1/double-barrel-roll");
        assert!((roll / 1e-2 - folded_up).abs() < 1e-12);
    }
}
