//! The control crates: programs, the loops of a jump, the estimator, the simulator and the planner of a rigid body.

mod jumping;
mod landing;
mod link;
mod planner;
mod plans;
mod plant;
mod programs;
mod wholebody;

use a1_model::{A1Geared, BUILD};
use icub_model::Icub23Geared;
use rbd_core::{
    Build, Configuration, Frame, JointLimits, Model, Motion, Motor, Tangent, Transform,
};

use crate::inputs::Stream;
use crate::{Real, Recorder, Subject};

/// A1 crouching: hip, thigh and calf of each leg, rad.
const CROUCH: [f64; 12] = [
    0.0, 0.9, -1.8, 0.0, 0.9, -1.8, 0.0, 0.9, -1.8, 0.0, 0.9, -1.8,
];

/// Dense programs, and everything between A1's plan and its torques, with a simulator for the robot.
pub fn a1<T: Real, R: Recorder>(recorder: &mut R)
where
    A1Geared: Model<T, 12>,
{
    let on = &mut Subject::<T, R>::new(recorder);
    on.name = "dense-qp";
    programs::run(on);
    on.name = "rbd-core";
    similarity(on);
    let robot = Robot::a1();
    on.name = "jump-control";
    jumping::run(on, &robot);
    plans::run(on, &robot);
    on.name = "landing";
    landing::run(on, &robot);
    on.name = "robot-link";
    link::run(on, &robot);
    on.name = "contact-sim";
    plant::run(on, &robot);
    #[cfg(feature = "introduce_panic")]
    crate::introduced::run(recorder);
}

/// Every quantity of a robot that is not of the reference's size.
fn similarity<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>) {
    let build = Build {
        mass: T::of(30.0),
        leg_length: T::of(0.7),
        ..BUILD.cast()
    };
    on.call("Build", &build, |b| {
        [
            b.length(0.1),
            b.area(1e-3),
            b.time(0.1),
            b.rate(20.0),
            b.rate_squared(120.0),
            b.speed(0.2),
            b.force(15.0),
            b.torque(1e4),
            b.stiffness(200.0),
            b.damping(5.0),
            b.joint_stiffness(60.0),
            b.joint_damping(2.0),
            b.per_force_squared(1.0),
            b.per_torque_squared(30.0),
        ]
    });
}

/// The whole-body programs on iCub.
pub fn icub<T: Real, R: Recorder>(recorder: &mut R)
where
    Icub23Geared: Model<T, 23>,
{
    let on = &mut Subject::<T, R>::new(recorder);
    on.name = "wbc-qp";
    wholebody::run(on);
}

/// Contact timings and trajectories of a rigid body.
pub fn planner<T: Real, R: Recorder>(recorder: &mut R) {
    let on = &mut Subject::<T, R>::new(recorder);
    on.name = "srb-opt";
    planner::run(on);
}

/// A robot with its tables and a state near standing.
struct Robot<T: Real, M, const N: usize, const F: usize> {
    model: M,
    build: Build<T>,
    feet: [Frame<T>; F],
    limits: [JointLimits<T>; N],
    motors: [Motor<T>; N],
    q: Configuration<T, N>,
    v: Tangent<T, N>,
}

impl<T: Real> Robot<T, A1Geared, 12, 4>
where
    A1Geared: Model<T, 12>,
{
    fn a1() -> Self {
        let contacts = A1Geared.contacts();
        let foot = |i: usize| contacts.get(i).map_or(Frame::IDENTITY, |c| c.frame);
        let mut stream = Stream::new(12);
        Self {
            model: A1Geared,
            build: BUILD.cast(),
            feet: core::array::from_fn(foot),
            limits: *A1Geared.limits(),
            motors: motors(&A1Geared),
            q: Configuration {
                base: Transform::new(
                    nalgebra::Rotation3::identity(),
                    nalgebra::Vector3::new(T::ZERO, T::ZERO, T::of(0.25)),
                ),
                joints: CROUCH.map(|x| T::of(x) + stream.next(0.1)),
            },
            v: moving(&mut stream),
        }
    }
}

/// The motors of a robot that has them.
#[must_use]
pub fn motors<T: Real, M: Model<T, N>, const N: usize>(model: &M) -> [Motor<T>; N] {
    let unknown = Motor {
        gear: T::ONE,
        torque: T::ONE,
        corner_speed: T::ONE,
        no_load_speed: T::TWO,
        rotor_inertia: T::ZERO,
    };
    model.motors().copied().unwrap_or([unknown; N])
}

/// A velocity of a few tenths.
fn moving<T: Real, const N: usize>(stream: &mut Stream) -> Tangent<T, N> {
    Tangent {
        base: Motion::from_array(stream.array(0.3)),
        joints: stream.array(0.5),
    }
}
