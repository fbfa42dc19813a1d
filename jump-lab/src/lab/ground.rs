//! A simulator whose landing ground is not as high as known, where a robot starts and lands on the same floor.
//!
//! The floor is moved while nobody touches it: at the top of the flight. A simulator's floor stays where it is; the robot is put that much
//! lower instead, and whoever looks at it is told the difference again, so that the floor seems to have moved.

use contact_sim::{Error, Simulator};
use nalgebra::Vector3;
use rbd_core::{Configuration, Tangent};

/// A simulator of `N` joints and `C` contacts.
pub type Plant<const N: usize, const C: usize> = Box<dyn Simulator<f64, N, C, Error = Error>>;

/// The plant with its ground.
pub struct Ground<const N: usize, const C: usize> {
    plant: Plant<N, C>,
    /// By how much the floor is to be moved, m; zero once it was.
    waiting: f64,
    /// By how much it has been.
    moved: f64,
}

impl<const N: usize, const C: usize> Ground<N, C> {
    /// A plant whose floor is to be `higher` after the flight, m.
    #[must_use]
    pub const fn new(plant: Plant<N, C>, higher: f64) -> Self {
        Self {
            plant,
            waiting: higher,
            moved: 0.0,
        }
    }

    /// The simulator; its robot is where its own floor is.
    #[must_use]
    pub fn plant(&self) -> &dyn Simulator<f64, N, C, Error = Error> {
        self.plant.as_ref()
    }

    /// Where the robot is, in the world in which the floor moves.
    #[must_use]
    pub fn configuration(&self) -> Configuration<f64, N> {
        let mut q = *self.plant.configuration();
        q.base.translation.z += self.moved;
        q
    }

    /// By how much the floor has moved upwards, m.
    #[must_use]
    pub const fn moved(&self) -> f64 {
        self.moved
    }

    /// How it moves.
    #[must_use]
    pub fn velocity(&self) -> &Tangent<f64, N> {
        self.plant.velocity()
    }

    /// One tick of the simulator. The floor moves where the robot flies and no longer rises.
    ///
    /// # Errors
    /// What the simulator says.
    pub fn step(&mut self, torques: &[f64; N], flies: bool) -> Result<(), String> {
        let q = *self.plant.configuration();
        let v = *self.plant.velocity();
        let falls = (q.base.rotation * v.base.linear).z <= 0.0;
        let touches = self
            .plant
            .contact_forces_w()
            .iter()
            .any(|f| *f != Vector3::zeros());
        if self.waiting != 0.0 && flies && falls && !touches {
            let mut lower = q;
            lower.base.translation.z -= self.waiting;
            self.plant.reset(&lower, &v);
            self.moved = core::mem::take(&mut self.waiting);
        }
        self.plant.step(torques).map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::Ground;
    use a1_model::{A1Geared, FEET, MOTORS, a1};
    use contact_sim::{NativeSimulator, Settings, Shape, Simulator, Terrain};
    use rbd_core::{Configuration, Tangent};

    /// A robot that is dropped sees no jump in its own height, and meets the floor where it was moved to.
    #[test]
    fn the_floor_moves_and_the_robot_does_not() {
        let feet = core::array::from_fn(|i| Shape::of(&FEET[i], i).unwrap());
        let settings = Settings::new(&a1::LIMITS, &MOTORS);
        let mut plant =
            NativeSimulator::<f64, _, 12, 4, 4>::new(A1Geared, feet, Terrain::FLAT, settings);
        let mut start = Configuration::<f64, 12>::NEUTRAL;
        start.base.translation.z = 0.6;
        start.joints = core::array::from_fn(|i| [0.0, 0.9, -1.8][i % 3]);
        plant.reset(&start, &Tangent::ZERO);
        let mut ground = Ground::new(Box::new(plant), 0.05);
        let lowest = |ground: &Ground<12, 4>| ground.configuration().base.translation.z;
        let mut before = lowest(&ground);
        let mut touched = None;
        for _ in 0..4000 {
            ground.step(&[0.0; 12], true).unwrap();
            let now = lowest(&ground);
            assert!((now - before).abs() < 1e-3, "the robot was moved");
            before = now;
            if ground.plant().contact_forces_w().iter().any(|f| f.z > 0.0) {
                touched = touched.or(Some(now));
            }
        }
        assert_eq!(ground.moved(), 0.05);
        // Legs hang down 0.2486 m below the base in this posture, with a ball of 0.02 m at their ends.
        let leg = 2.0 * 0.2 * so3::math::cos(0.9_f64) + 0.02;
        assert!((touched.unwrap() - leg - 0.05).abs() < 5e-3, "{touched:?}");
    }
}
