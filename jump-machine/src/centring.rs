//! The plan's jump by the robot's own centre of mass: while it still holds, the robot moves its trunk until its centre of mass is where the plan's is.
//!
//! A payload or a battery that lies 2 cm aside gives the planned forces another arm: 500 N for 0.1 s on 2 cm are 1 N m s, which turn A1 by
//! some rad/s. Other forces would make up for it, but the plan's are what friction and motors allow. A trunk that is farther back by as
//! much as the centre of mass is too far forward ([`Balance`](crate::balance::Balance)) has it where the plan has it: the feet stand, seen
//! from the centre of mass, as planned, and all planned forces are right. So every foot is, in base axes, δ farther than planned: from the
//! hold on, in flight, and in the landing posture.

use nalgebra::Vector3;
use rbd_core::{Build, LimbEnd, Tree};
use so3::{Scalar, math};

use landing::solve_damped;

use crate::Machine;

/// How the centre of mass is found and the trunk moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Centring<T> {
    /// Time for which the trunk moves before the start, s.
    pub moving: T,
    /// Time for which it then rests, s.
    pub rest: T,
    /// Farthest that the centre of mass may seem from the model's, m; zero leaves the trunk where the plan has it.
    pub most: T,
    /// Farthest that joints and foot sensors may contradict each other, m.
    pub agreement: T,
    /// Largest share by which joints or sensors may feel another weight than the model's.
    pub heavier: T,
    /// Largest load that it may carry, over the model's mass; zero is none.
    pub most_load: T,
    /// Height of a load over the origin of the base, m.
    pub load_height: T,
    /// Tikhonov term on the way of a foot, m²: keeps stretched legs from large motions.
    pub damping: T,
}

impl<T: Scalar> Centring<T> {
    /// For a robot of this size, by [dynamic similarity](rbd_core::similarity) from those of a robot of 13.741 kg with legs of 0.4 m: the
    /// lab's battery and payload are 2.7 cm aside at most, and its joints and sensors 5 mm apart (standard deviation).
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        Self {
            moving: build.time(0.2),
            rest: build.time(0.05),
            most: build.length(0.04),
            agreement: build.length(0.02),
            heavier: T::of(0.35),
            most_load: T::of(0.25),
            load_height: build.length(0.04),
            damping: build.area(1e-4),
        }
    }

    /// Time before the start at which the centre of mass must be known, s.
    #[must_use]
    pub fn before(&self) -> T {
        self.moving + self.rest
    }

    /// Share of the way at time `t` of the plan: least jerk, from 0 to 1.
    fn share(&self, t: T) -> T {
        let x = math::clamp((t + self.before()) / self.moving, T::ZERO, T::ONE);
        x * x * x * (T::of(10.0) - x * (T::of(15.0) - x * T::of(6.0)))
    }
}

/// Joint displacements that move a foot by `way_b`, to first order, rad; those of other legs stay.
fn move_foot<T: Scalar, const N: usize>(
    end: &LimbEnd<T, N>,
    damping: T,
    way_b: &Vector3<T>,
    joints: &mut [T; N],
) {
    let force = solve_damped(end, damping, way_b);
    for (j, column) in end.columns() {
        if let Some(q) = joints.get_mut(j) {
            *q = column.dot(&force);
        }
    }
}

/// What is known of the centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Centred<T: Scalar, const N: usize> {
    /// How far it is from the model's, base axes, m; none before it is known, zero where that is not believed.
    pub(crate) offset_b: Option<Vector3<T>>,
    /// What it carries, over the model's mass.
    pub(crate) load: T,
    /// Joint displacements, rad.
    pub(crate) joints: [T; N],
    /// The foot for which they are computed next.
    next: usize,
}

impl<T: Scalar, const N: usize> Centred<T, N> {
    /// Nothing is known.
    pub(crate) const fn new() -> Self {
        Self {
            offset_b: None,
            load: T::ZERO,
            joints: [T::ZERO; N],
            next: 0,
        }
    }
}

impl<T: Scalar, M: Tree<T, N>, const N: usize, const F: usize> Machine<'_, T, M, N, F> {
    /// Moves the joints of a reference at time `t` of the plan, whose legs are the wanted ones; the way of the feet, base axes, m. Nothing
    /// is moved where the centre of mass is the model's, and where `levelled` joints follow the body already.
    ///
    /// One leg is computed in a tick, in turn: a displacement of 0.1 rad changes by a thousandth of a radian until it is its turn again.
    pub(crate) fn centre(
        &mut self,
        t: T,
        levelled: bool,
        joints: &mut [T; N],
    ) -> Option<Vector3<T>> {
        let found = self.centred.offset_b.filter(|_| !levelled);
        let offset_b = found.filter(|offset_b| *offset_b != Vector3::zeros())?;
        let centring = &self.settings.centring;
        let way_b = offset_b * centring.share(t);
        let Centred {
            joints: moved,
            next,
            ..
        } = &mut self.centred;
        if let Some(end) = self.wanted.ends.get(*next) {
            move_foot(end, centring.damping, &way_b, moved);
        }
        *next = if *next + 1 < F { *next + 1 } else { 0 };
        for (q, moved) in joints.iter_mut().zip(moved) {
            *q += *moved;
        }
        Some(way_b)
    }
}

#[cfg(test)]
mod tests {
    use super::{Centring, move_foot};
    use a1_model::{A1Geared, BUILD, FEET};
    use nalgebra::Vector3;
    use rbd_core::{Configuration, Limbs};

    #[test]
    fn the_trunk_moves_once_and_then_rests() {
        let centring = Centring::<f64>::new(&BUILD);
        let begin = -centring.before();
        for (t, share) in [
            (begin - 1.0, 0.0),
            (begin, 0.0),
            (begin + 0.5 * centring.moving, 0.5),
            (-centring.rest, 1.0),
            (2.0, 1.0),
        ] {
            assert!((centring.share(t) - share).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn every_foot_moves_as_far_as_it_is_told() {
        let centring = Centring::new(&BUILD);
        let legs = |joints| {
            let q = Configuration {
                joints,
                ..Configuration::NEUTRAL
            };
            Limbs::<f64, 12, 4>::new(&A1Geared, &q, &FEET.map(|foot| foot.frame))
        };
        let crouch: [f64; 12] = core::array::from_fn(|i| [0.1, 0.8, -1.6][i % 3]);
        let (before, way_b) = (legs(crouch), Vector3::new(0.02, -0.01, 0.002));
        let mut moved = [f64::NAN; 12];
        for end in &before.ends {
            move_foot(end, centring.damping, &way_b, &mut moved);
        }
        let after = legs(core::array::from_fn(|i| crouch[i] + moved[i]));
        for (after, before) in after.ends.iter().zip(&before.ends) {
            let way = after.position - before.position;
            // Of second order in 2 cm on legs of 0.28 m.
            assert!((way - way_b).norm() < 1.5e-3, "{way}");
        }
    }
}
