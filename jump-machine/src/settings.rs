//! Everything about the machine that is neither the robot's tables nor the jump.

use jump_control::{CartesianPd, Plan};
use landing::{Detector, InertiaShaping, PreLanding, Retraction, Shortening};
use rbd_core::{Build, Frame, Motor};
use so3::{Scalar, math};

use crate::regulator::{Regulator, Weights};
use crate::{Centring, Unloading};

/// Periods, limits and gains of a robot with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T: Scalar, const N: usize, const F: usize> {
    /// Period of [`Machine::tick`](crate::Machine::tick), s.
    pub period: T,
    /// Oldest measurement to act on, s: links are late by a few milliseconds, and a few packets in a row get lost.
    pub max_age: T,
    /// Longest silence of either loop, s.
    pub max_silence: T,
    /// How far ahead of now the plan's torques are sampled, s: what holding over a tick and the slew limit delay them by.
    pub lookahead: T,
    /// Time in which a robot that was given a jump moves from where it stands to where the plan begins, s.
    pub gathering: T,
    /// Time for which it then comes to rest on the plan's torques, s: one that still sways seems to lean on other feet.
    pub calming: T,
    /// Time during which the robot weighs itself and finds its centre of mass, before its trunk moves, s.
    pub weighing: T,
    /// Largest share by which the robot may hold harder, or less hard, than planned: 15 % of payload over motors that are 10 % weak, and some.
    pub max_payload: T,
    /// The centre of mass.
    pub centring: Centring<T>,
    /// Farthest that a joint may be from the plan's first node at the start, rad.
    pub start_tolerance: T,
    /// Time before the touchdown from which the landing posture follows the capture point, s.
    pub levelling: T,
    /// Time after the planned touchdown at which the robot gives up waiting for the ground, s.
    pub patience: T,
    /// Base speeds below which the robot is at rest, m/s and rad/s.
    pub rest: (T, T),
    /// Largest tilt of the base of a robot that stands, rad.
    pub most_tilt: T,
    /// Time at rest after which it stands, s.
    pub settling: T,
    /// Height of the centre of mass over the feet's centres when standing, m.
    pub stand_height: T,
    /// Damping of the safe command, N m s/rad.
    pub safe_damping: T,
    /// Largest rate of a joint's torque, N m/s.
    pub slew: T,
    /// Push-off and flight.
    pub pd: CartesianPd<T, N, F>,
    /// The body in the push-off.
    pub regulator: Weights<T>,
    /// Feet at the take-off.
    pub unloading: Unloading<T>,
    /// Legs in flight.
    pub inertia_shaping: InertiaShaping<T>,
    /// Touchdown.
    pub detector: Detector<T, N, F>,
    /// Legs before touchdown; its joints are those of legs without ground while no jump is armed.
    pub posture: PreLanding<T, N, F>,
    /// Feet that go along with the ground.
    pub retraction: Retraction<T>,
    /// Legs that wait shorter for a fast ground.
    pub shortening: Shortening<T>,
    /// Stance after touchdown.
    pub landing: landing::Settings<T>,
    /// The motors.
    pub motors: [Motor<T>; N],
}

impl<T: Scalar, const F: usize, const N: usize> Settings<T, N, F> {
    /// Least time for which a robot holds before the start of a plan, s: it gathers its legs, comes to rest, weighs itself and computes the push-off's gains, then it moves its trunk.
    #[must_use]
    pub fn least_hold(&self, plan: &Plan<'_, T, N, F>) -> T {
        let ticks = u32::try_from(Regulator::ticks(plan) + 1).unwrap_or(u32::MAX);
        let gains = T::of(f64::from(ticks)) * self.period;
        let weighed = self.gathering + self.calming + self.weighing;
        math::max(weighed, gains) + self.centring.before()
    }

    /// Settings for a robot of this size, by [dynamic similarity](rbd_core::similarity) from those of a robot of 13.741 kg with legs of
    /// 0.4 m, with which `saltus run` executes; `saltus verdicts` measures them.
    ///
    /// Period, age, silence and lookahead are the computers' and links', the same for all robots: 1 kHz, 10 ms, 5 ms, 1 ms. So is the
    /// time for which a leg lets go, the drives'. Their 10 kN m/s build up a torque in a time that is theirs as well, so the rate scales as a torque. All other times are the
    /// body's.
    ///
    /// `standing` are joint positions for legs without ground while no jump is armed.
    #[must_use]
    pub fn new(
        build: &Build<T>,
        feet: [Frame<T>; F],
        motors: [Motor<T>; N],
        standing: [T; N],
    ) -> Self {
        let of = T::of;
        Self {
            period: of(1e-3),
            max_age: of(0.010),
            max_silence: of(0.005),
            lookahead: of(0.001),
            gathering: build.time(0.3),
            calming: build.time(0.4),
            weighing: build.time(0.15),
            max_payload: of(0.35),
            centring: Centring::new(build),
            start_tolerance: of(0.15),
            levelling: build.time(0.12),
            patience: build.time(0.5),
            rest: (build.speed(0.05), build.rate(0.2)),
            most_tilt: of(0.4),
            settling: build.time(0.2),
            stand_height: build.length(0.25),
            safe_damping: build.joint_damping(2.0),
            slew: build.torque(1e4),
            pd: CartesianPd::new(build, feet),
            regulator: Weights::new(build),
            unloading: Unloading::new(build),
            inertia_shaping: InertiaShaping::new(build),
            detector: Detector::new(build, feet),
            posture: PreLanding::new(build, feet, standing),
            retraction: Retraction::new(build),
            shortening: Shortening::new(build),
            landing: landing::Settings::new(build),
            motors,
        }
    }
}
