//! An arm that is bolted to the ground reaches for a point behind its own column: torques by a program whose rows keep the forearm
//! away from the column, with torques and joints inside their limits; the arm itself is integrated by its forward dynamics.
//!
//! `cargo run --release -p wbc-qp --example arm`

use nalgebra::Vector3;
use rbd_core::joint::Kind;
use rbd_core::{
    AbaWorkspace, BaseBody, BaseKind, Body, Configuration, Frame, JointLimits, Link, Shape,
    TableModel, Tangent, aba,
};
use wbc_qp::task::position_error;
use wbc_qp::{Extent, Gains, Horizon, Limit, Rank, Snapshot, TorqueQp};

const N: usize = 5;
/// Five joints and no contact; five torque rows, one for the distance, and its slack.
type Program = TorqueQp<f64, N, 0, 6, 6>;
const TICK: f64 = 1e-3;
/// Distance that forearm and column keep, m.
const MARGIN: f64 = 0.02;
const TORQUES: [f64; N] = [40.0, 80.0, 60.0, 15.0, 15.0];

const TOOL: Frame<f64> = Frame {
    link: Link::Joint(4),
    offset: [0.15, 0.0, 0.0],
    ..Frame::IDENTITY
};
const FOREARM: Shape<f64> = Shape {
    link: Link::Joint(4),
    from: [0.0; 3],
    to: [0.15, 0.0, 0.0],
    radius: 0.04,
    owner: 0,
};
const COLUMN: Shape<f64> = Shape {
    link: Link::Base,
    from: [0.0; 3],
    to: [0.0, 0.0, 0.35],
    radius: 0.08,
    owner: 0,
};

/// A turntable, two rods, and a wrist with two axes.
fn arm() -> Result<TableModel<f64, N>, rbd_core::TableError> {
    let rod = |kind, parent, offset, length: f64, mass: f64| Body {
        kind,
        parent,
        offset,
        mass,
        first: [0.5 * mass * length, 0.0, 0.0],
        second: [mass * length * length / 3.0, 0.001, 0.001, 0.0, 0.0, 0.0],
        ..Body::EMPTY
    };
    let base = BaseBody {
        mass: 0.0,
        first: [0.0; 3],
        second: [0.0; 6],
    };
    let bodies = [
        rod(Kind::RevoluteZ, Link::Base, [0.0, 0.0, 0.35], 0.05, 2.0),
        rod(Kind::RevoluteY, Link::Joint(0), [0.0, 0.1, 0.05], 0.4, 4.0),
        rod(Kind::RevoluteY, Link::Joint(1), [0.4, -0.1, 0.0], 0.35, 3.0),
        rod(Kind::RevoluteZ, Link::Joint(2), [0.35, 0.0, 0.0], 0.05, 0.5),
        rod(Kind::RevoluteY, Link::Joint(3), [0.05, 0.0, 0.0], 0.15, 0.5),
    ];
    TableModel::new(BaseKind::Fixed, base, &bodies)
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let model = arm()?;
    let limits = [JointLimits {
        lower: -2.8,
        upper: 2.8,
        speed: 3.0,
        ..JointLimits::NONE
    }; N];
    let horizon = Horizon {
        position: 0.1,
        velocity: 0.02,
        acceleration: 300.0,
    };
    let gains = Gains {
        stiffness: 60.0,
        damping: 16.0,
    };
    // In the column: the tool comes as near as the margin lets it.
    let target = Vector3::new(0.0, 0.0, 0.2);
    let mut q = Configuration::NEUTRAL;
    q.joints = [0.4, -0.9, 1.9, 0.1, 0.3];
    let mut v = Tangent::ZERO;
    let mut snapshot = Snapshot::ZERO;
    let mut qp = Program::new();
    let mut workspace = AbaWorkspace::new();
    let (mut least, mut named) = (f64::INFINITY, false);
    for k in 0..3000 {
        snapshot.update(&model, &q, &v);
        qp.begin(&model, &snapshot, &[], &[0.0; N])?;
        let tool = snapshot.frame_position(&model, &TOOL);
        let error = position_error(&target, &snapshot.pose(&TOOL).translation);
        let wanted = tool.acceleration([0.0; 3], [0.0; 3], error, gains);
        qp.minimise(&tool, &wanted, &[100.0; 3]);
        qp.minimise_joints(&v.joints.map(|x| -10.0 * x), &[0.1; N]);
        qp.limit_joints(&snapshot, &limits, &horizon);
        qp.limit_torques(&TORQUES.map(|most| [-most, most]))?;
        let left = snapshot.clearance(&FOREARM, &COLUMN).distance - MARGIN;
        let distance = snapshot.distance(&model, &FOREARM, &COLUMN);
        let floor = horizon.least_acceleration(left, distance.rate[0]);
        // Soft, and far heavier than the task: never impossible, and never far from kept.
        let rank = Rank::Slack(1e6);
        qp.constrain(&distance, &[floor], &[f64::INFINITY], rank)?;
        let answer = qp.solve()?;
        least = least.min(left);
        if k % 500 == 0 {
            println!(
                "{:.1} s: {:5.1} cm to go, {:4.1} cm from the column",
                f64::from(k) * TICK,
                100.0 * Vector3::from(error).norm(),
                100.0 * (left + MARGIN)
            );
            for line in qp.report(&answer, 1e-3) {
                println!("    {:?} {:?}", line.limit, line.extent);
            }
        }
        named |= qp
            .report(&answer, 1e-3)
            .any(|x| x.limit == Limit::Row(0) && matches!(x.extent, Extent::Held(_)));
        let effort = rbd_core::Effort {
            joints: answer.torques,
            ..rbd_core::Effort::ZERO
        };
        let acceleration = aba(&model, &snapshot.posture, &v, &effort, &mut workspace);
        for i in 0..N {
            v.joints[i] += TICK * acceleration.joints[i];
            q.joints[i] += TICK * v.joints[i];
        }
    }
    println!("nearest to the column: {:.2} cm", 100.0 * (least + MARGIN));
    assert!(named, "the distance was to limit the reach");
    assert!(least > -1e-3, "the margin was to be kept: {least}");
    Ok(())
}
