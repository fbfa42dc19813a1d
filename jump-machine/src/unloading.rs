//! Feet that leave the ground: at the take-off they let go, those that the ground does not let go are pulled up, and only then do legs swing.
//!
//! Soft ground springs back after the plan's last node, and a foot that is late drags. Joints that hold their targets then push the body with
//! what the ground gives, for as long as it takes; a body that turns by that is not on its plan any more. So does a leg that begins to swing with its
//! foot in the ground: what turns it in the air presses here, and the angular momentum that the swing would have taken from the body comes from outside.

use jump_control::JointCommand;
use nalgebra::Vector3;
use rbd_core::{Build, Limbs};
use so3::{Scalar, math};

/// How feet leave the ground. Times are since the first torques of the flight, which a machine gives [`lookahead`](crate::Settings::lookahead) before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unloading<T> {
    /// Time for which the leg of a foot that is on the ground still does not swing, s: what the drives need to let go. Much longer would leave joints that
    /// were to be braked to their stops.
    pub letting_go: T,
    /// Time over which the joints' gains come back, s.
    pub easing: T,
    /// Time during which feet are pulled up, s.
    pub lasting: T,
    /// Normal force from which on a foot is on the ground still, N.
    pub loaded: T,
    /// Force with which it is pulled up, N: the weight, nearly.
    pub pull: T,
}

impl<T: Scalar> Unloading<T> {
    /// For a robot of this size, by [dynamic similarity](rbd_core::similarity) from that of a robot of 13.741 kg with legs of 0.4 m. How long drives need
    /// is theirs.
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        Self {
            letting_go: T::of(0.0015),
            easing: build.time(0.02),
            lasting: build.time(0.05),
            loaded: build.force(8.0),
            pull: build.force(135.0),
        }
    }

    /// Changes a command of `since` seconds after the first torques of the flight. `up_b` is upwards in base axes, `foot_forces` are what the feet feel.
    pub fn apply<const N: usize, const F: usize>(
        &self,
        since: T,
        (limbs, up_b): (&Limbs<T, N, F>, &Vector3<T>),
        foot_forces: &[T; F],
        command: &mut JointCommand<T, N>,
    ) {
        if since > self.lasting {
            return;
        }
        for (end, force) in limbs.ends.iter().zip(foot_forces) {
            if *force > self.loaded {
                let swinging = end.columns().filter(|_| since < self.letting_go);
                for (j, _) in swinging {
                    if let Some(torque) = command.feed_forward.get_mut(j) {
                        *torque = T::ZERO;
                    }
                }
                end.add_tr_mul(&(up_b * self.pull), &mut command.feed_forward);
            }
        }
        if since < self.easing {
            let share = math::max(since, T::ZERO) / self.easing;
            for gains in &mut command.gains {
                gains.stiffness *= share;
                gains.damping *= share;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Unloading;
    use a1_model::{A1, BUILD, FEET};
    use jump_control::{JointCommand, JointGains};
    use nalgebra::Vector3;
    use rbd_core::{Configuration, Limbs};

    /// The plan's torque of every joint.
    const SWING: f64 = 3.0;

    /// The command, and with what force its torques pull each foot up.
    fn applied(since: f64, foot_forces: &[f64; 4]) -> (JointCommand<f64, 12>, [f64; 4]) {
        let q = Configuration {
            joints: [
                0.1, 0.9, -1.8, -0.1, 0.8, -1.6, 0.0, 0.7, -1.5, 0.2, 0.9, -1.4,
            ],
            ..Configuration::NEUTRAL
        };
        let limbs = Limbs::new(&A1, &q, &FEET.map(|foot| foot.frame));
        let mut command = JointCommand::damp(2.0);
        command.feed_forward = [SWING; 12];
        command.gains = [JointGains {
            stiffness: 60.0,
            damping: 1.5,
        }; 12];
        let law = Unloading::new(&BUILD);
        law.apply(since, (&limbs, &Vector3::z()), foot_forces, &mut command);
        // The work of the torques while every foot goes up by a metre is the force.
        let pulls = core::array::from_fn(|foot| {
            let leg = 3 * foot..3 * foot + 3;
            let mut unit = [0.0; 12];
            limbs.ends[foot].add_tr_mul(&Vector3::z(), &mut unit);
            let (mut with, mut size) = (0.0, 0.0);
            for j in leg {
                with += command.feed_forward[j] * unit[j];
                size += unit[j] * unit[j];
            }
            with / size
        });
        (command, pulls)
    }

    #[test]
    fn feet_that_feel_the_ground_are_pulled_up_at_first_instead_of_swung_and_no_others() {
        // What the swing does alone, in the same measure.
        let swing = applied(0.06, &[300.0; 4]).1;
        for (since, swings) in [(0.0, 0.0), (0.0014, 0.0), (0.0016, 1.0), (0.03, 1.0)] {
            let pulls = applied(since, &[0.0, 7.9, 8.1, 300.0]).1;
            let wanted = [
                swing[0],
                swing[1],
                135.0 + swings * swing[2],
                135.0 + swings * swing[3],
            ];
            for (pull, wanted) in pulls.iter().zip(wanted) {
                assert!((pull - wanted).abs() < 1e-9, "{since}: {pulls:?}");
            }
        }
        assert_eq!(applied(0.051, &[300.0; 4]).1, swing);
        assert_eq!(applied(0.03, &[f64::NAN; 4]).1, swing);
    }

    #[test]
    fn joint_gains_come_back() {
        for (since, share) in [(0.0, 0.0), (0.01, 0.5), (0.02, 1.0), (0.2, 1.0)] {
            let gains = applied(since, &[0.0; 4]).0.gains[4];
            assert!((gains.stiffness - 60.0 * share).abs() < 1e-9, "{since}");
            assert!((gains.damping - 1.5 * share).abs() < 1e-9, "{since}");
        }
    }
}
