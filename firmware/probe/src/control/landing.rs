//! Touchdown detection, posture before landing, the landing program, and the estimator of the base.

use landing::{
    Command, Detector, DetectorState, Landing, Outcome, PreLanding, Retraction, Settings,
    Shortening, Target, Workspace,
};
use nalgebra::Vector3;
use rbd_core::{Limbs, Transform, Tree};
use state_est::{Estimate, Estimator, Foot, Sample, State, Status};

use super::Robot;
use crate::inputs::Stream;
use crate::{Numbers, Real, Recorder, Subject};

fn vector<T: Real>(stream: &mut Stream, half_width: f64) -> Vector3<T> {
    stream.array::<T, 3>(half_width).into()
}

impl<T: Real> Numbers for Command<T, 12, 4> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        (self.feed_forward, self.position).visit(take);
        (self.stiffness, self.damping, self.forces_w).visit(take);
        take(match self.outcome {
            Outcome::Airborne => -1.0,
            Outcome::Solved(iterations) => f64::from(iterations),
            Outcome::Failed(_) => -2.0,
            Outcome::BadData => -3.0,
        });
    }
}

impl<T: Real> Numbers for Estimate<T, 4> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        (self.base, self.velocity, self.confidence).visit(take);
        (self.status == Status::Good).visit(take);
    }
}

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, 12>>(
    on: &mut Subject<'_, T, R>,
    robot: &Robot<T, M, 12, 4>,
) {
    let stream = &mut Stream::new(5);
    let Robot { model, q, v, .. } = robot;
    let detector = Detector::new(&robot.build, robot.feet);
    let mut contact = DetectorState::new();
    for force in [0.0, 40.0, 40.0, 3.0] {
        let torques: [T; 12] = stream.array(10.0);
        let input = (&mut contact, &torques, [T::of(force); 4]);
        on.call("Detector::update", input, |(state, torques, forces)| {
            detector.update(model, state, q, v, torques, &forces, T::of(1e-3));
            (state.contacts, state.faulty)
        });
    }
    let posture = PreLanding::new(&robot.build, robot.feet, q.joints);
    let up: Vector3<T> = vector(stream, 1.0);
    on.call("PreLanding::joints", (&posture, up), |(p, up)| {
        p.joints(model, &up, &v.base.linear)
    });
    let legs = Limbs::new(model, q, &robot.feet);
    let shortening = Shortening::new(&robot.build);
    on.call("Shortening::raise", (&shortening, &legs), |(s, legs)| {
        let fastest = s.fastest(&legs.ends, &v.base);
        s.raise(T::ZERO, fastest, T::ONE, T::of(1e-3))
    });
    let retraction = Retraction::new(&robot.build);
    on.call("Retraction::speed", (&retraction, T::ONE), |(r, fall)| {
        r.speed(T::ZERO, T::ZERO, (fall, fall))
    });

    let limits = robot.motors.map(|motor| motor.torque);
    let landing = Landing::<T, 12, 4>::new(robot.feet, Settings::new(&robot.build), limits);
    let target = Target {
        height: T::of(0.25),
        ..Target::LEVEL
    };
    let mut ws = Workspace::new();
    for contacts in [[true; 4], [true, false, false, true], [false; 4]] {
        let input = (&landing, contacts, &target, &mut ws);
        on.call("Landing::step", input, |(landing, on, target, ws)| {
            landing.step(model, q, v, &on, target, &q.joints, ws)
        });
    }
    let forces: [Vector3<T>; 4] = core::array::from_fn(|_| vector(stream, 30.0));
    on.call("reaction_torques", (&landing, &forces), |(landing, f)| {
        landing.reaction_torques(model, q, f)
    });

    let estimator = Estimator::<T, 12, 4, 6> {
        feet: robot.feet.map(|frame| Foot {
            frame,
            radius: T::of(0.02),
        }),
        imu: Transform::IDENTITY,
        settings: state_est::Settings::new(),
    };
    let mut state = State::new(&estimator, model, q);
    for evidence in [T::ONE, T::HALF, T::NAN] {
        let sample = Sample {
            specific_force_i: vector(stream, 10.0),
            angular_velocity_i: vector(stream, 2.0),
            joints: q.joints,
            joint_velocities: v.joints,
            evidence: [evidence; 4],
        };
        let input = (&estimator, &mut state, Some(&sample));
        on.call("Estimator::step", input, |(estimator, state, sample)| {
            estimator.step(model, state, sample, T::of(1e-3))
        });
    }
    let input = (&estimator, &mut state);
    on.call("Estimator::step missing", input, |(estimator, state)| {
        estimator.step(model, state, None, T::of(1e-3))
    });
    // It stands still, so that every foot is an anchor.
    let calm = Sample {
        specific_force_i: Vector3::z() * T::of(9.81),
        angular_velocity_i: Vector3::zeros(),
        joints: q.joints,
        joint_velocities: [T::ZERO; 12],
        evidence: [T::ONE; 4],
    };
    let mut state = State::new(&estimator, model, q);
    let _ = estimator.step(model, &mut state, Some(&calm), T::of(1e-3));
    on.call("State::feet", &mut state, |state| state.feet());
    let place = (&mut state, Vector3::repeat(T::HALF));
    on.call("State::stand_at", place, |(state, middle_w)| {
        state.stand_at(&middle_w, T::HALF)
    });
}
