//! From a plan to torques: sampler, Cartesian PD, joint PD, slew, phases, watch, estimate, profiles.

use jump_control::{
    CartesianPd, ComProfile, Curve, Event, JointCommand, Measurement, MinimumJerk, Node,
    PayloadEstimate, Phase, Plan, Reference, Slew, Torques, Watch, next_phase, sample,
    takeoff_speed,
};
use rbd_core::Tree;

use super::Robot;
use crate::inputs::Stream;
use crate::{Numbers, Real, Recorder, Subject};

const NODES: usize = 6;

impl<T: Real, const N: usize> Numbers for JointCommand<T, N> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        (self.position, self.velocity, self.feed_forward).visit(take);
        let gains = self.gains.iter();
        gains.for_each(|g| (g.stiffness, g.damping).visit(take));
    }
}

impl<T: Real, const N: usize> Numbers for Reference<T, N> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        (self.joints, self.joint_velocities, self.torques).visit(take);
        take(self.node as f64);
    }
}

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, 12>>(
    on: &mut Subject<'_, T, R>,
    robot: &Robot<T, M, 12, 4>,
) {
    let stream = &mut Stream::new(3);
    let nodes: [Node<T, 12, 4>; NODES] = core::array::from_fn(|i| Node {
        time: T::of(0.02 * i as f64),
        joints: stream.array(1.0),
        joint_velocities: stream.array(5.0),
        torques: stream.array(20.0),
        ..Node::ZERO
    });
    let times = [0.05, 0.08, 0.1].map(T::of);
    let plan = on.call("Plan::new", (&nodes, times), |(nodes, [a, b, c])| {
        Checked(Plan::new(nodes, a, b, c, Torques::Hold).ok())
    });
    let Checked(Some(plan)) = plan else { return };
    let mut reference = Reference::ZERO;
    for (time, hint) in [(-1.0, 0), (0.031, 0), (0.075, 1), (0.09, 9), (1.0, 3)] {
        reference = on.call("sample", (&plan, T::of(time), hint), |(p, t, hint)| {
            sample(p, t, hint)
        });
    }
    let measured = Measurement {
        base: robot.q.base,
        base_velocity: robot.v.base,
        joints: robot.q.joints,
        joint_velocities: robot.v.joints,
        foot_forces: stream.array(30.0),
        age: T::of(0.001),
    };
    let watch = Watch {
        max_age: T::of(0.005),
    };
    on.call("Watch::fault", (&watch, &measured), |(w, m)| {
        w.fault(m).is_some()
    });
    let pd = CartesianPd::new(&robot.build, robot.feet);
    let input = (&pd, &robot.model, &measured, &reference);
    let command = on.call("CartesianPd::command", input, |(pd, m, x, r)| {
        pd.command(m, x, r)
    });
    let input = (&command, &robot.q.joints, &robot.v.joints, &robot.motors);
    let torques = on.call("JointCommand::torques", input, |(c, q, v, m)| {
        c.torques(q, v, m)
    });
    let mut slew = Slew::new(T::of(1e4));
    on.call("Slew::limit", (&mut slew, torques), |(s, tau)| {
        s.limit(&tau, T::of(1e-4))
    });
    on.call("Slew::limit_together", (&mut slew, torques), |(s, tau)| {
        s.limit_together(&tau, T::of(1e-5))
    });
    for phase in Phase::ALL {
        on.call("next_phase", phase, |phase| {
            next_phase(phase, Event::Touchdown) == phase
        });
    }
    let mut estimate = PayloadEstimate::new();
    let input = (&mut estimate, measured.joints);
    on.call("PayloadEstimate", input, |(s, f)| {
        s.add(&f, &f);
        s.factor(T::of(0.35))
    });
    let speed = on.call("takeoff_speed", T::of(0.04), |h| {
        takeoff_speed(h, T::of(9.81))
    });
    on.call("ComProfile", (speed, T::of(0.2)), |(v, t)| {
        ComProfile::by_displacement(Curve::rising(), v, T::of(0.11), T::of(9.81)).map(|profile| {
            let point = profile.at(t);
            (point.rise, point.speed, point.acceleration)
        })
    });
    let motion = MinimumJerk {
        from: robot.q.joints,
        velocity: robot.v.joints,
        to: command.position,
        duration: T::of(0.12),
    };
    on.call("MinimumJerk::at", (&motion, T::of(0.05)), |(m, t)| m.at(t));
}

/// A plan that was accepted, listed by its times.
struct Checked<'a, T: Real>(Option<Plan<'a, T, 12, 4>>);

impl<T: Real> Numbers for Checked<'_, T> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        let times = self.0.as_ref().map(|p| (p.takeoff, p.posing, p.touchdown));
        times.visit(take);
    }
}
