//! Whether what a container says can be: a checksum tells that bytes are those that were written, not that they make sense.

use so3::math;

use super::{Container, ContainerError, Header, PlanNode};

/// Farthest place, m, and fastest motion, m/s or rad/s, of any robot this is for.
const FAR: f32 = 100.0;
/// Times that differ by less are the same, s: sums of single-precision durations.
const SAME_TIME: f32 = 1e-3;
/// How far a force may be outside its cone, as a share of the largest: solvers stop within their tolerance.
const CONE: f32 = 5e-3;
/// Largest normal force in multiples of the one that the rigid body's plan may use: single legs of the whole body come to three.
const MOST: f32 = 10.0;

type Checked = Result<(), ContainerError>;

impl<const N: usize, const F: usize> Container<'_, N, F> {
    /// Looks at every number: all are finite, times increase up to the touchdown, phases follow each other, rotations are rotations, feet on
    /// the ground push within their cone and feet in the air do not. What depends on the robot's joints is left to who knows them. Takes as
    /// long as reading the container once more.
    ///
    /// # Errors
    /// [`ContainerError::Value`] names the first number that cannot be.
    pub fn check(&self) -> Checked {
        self.check_header()?;
        let mut before: Option<PlanNode<N, F>> = None;
        for i in 0..self.header.nodes {
            let wrong = |what| {
                Err(ContainerError::Value {
                    node: Some(i),
                    what,
                })
            };
            let Some(node) = self.node(usize::from(i)) else {
                return wrong("bytes");
            };
            if let Some(what) = before.and_then(|before| order(&before, &node)) {
                return wrong(what);
            }
            let last = i.saturating_add(1) == self.header.nodes;
            if let Some(what) = fault(&self.header, &node, last) {
                return wrong(what);
            }
            before = Some(node);
        }
        let end = before.map_or(f32::NAN, |node| node.time);
        header(near(end, self.header.touchdown), "time of the last node")
    }

    fn check_header(&self) -> Checked {
        let h = &self.header;
        let count = usize::from(h.phase_count);
        let phases = h.phases.get(..count).unwrap_or_default();
        header(!phases.is_empty(), "number of phases")?;
        let feet =
            |contacts: u8| u32::from(contacts) < 1_u32.checked_shl(F as u32).unwrap_or(u32::MAX);
        header(phases.iter().all(|p| feet(p.contacts)), "feet of a phase")?;
        let lasts = |x: f32| (0.0..=FAR).contains(&x);
        header(
            phases.iter().all(|p| lasts(p.duration)),
            "duration of a phase",
        )?;
        let total: f32 = phases.iter().map(|p| p.duration).sum();
        header(near(total, h.touchdown), "touchdown")?;
        header(lasts(h.takeoff) && h.takeoff <= h.touchdown, "takeoff")?;
        header(h.posing.abs() <= FAR && h.posing <= h.touchdown, "posing")?;
        let m = &h.margins;
        let positive = |x: f32| x > 0.0 && x < f32::MAX;
        let share = |x: f32| x > 0.0 && x <= 1.0;
        header(
            positive(m.friction) && positive(m.max_force) && positive(m.weight),
            "margins",
        )?;
        header(
            share(m.friction_share) && share(m.torque_share) && share(m.speed_share),
            "shares",
        )?;
        let step = h.ground.is_none_or(|step| {
            step.axis < 2
                && matches!(step.side, 1 | -1)
                && step.drop.abs() <= FAR
                && step.distance.abs() <= FAR
        });
        header(step, "ground")?;
        let all = |xs: &[f32]| xs.iter().all(|x| x.abs() <= FAR);
        header(all(&h.goal_w) && all(&[h.heading]), "goal")?;
        header(all(&h.landing_joints), "landing posture")
    }
}

/// Fails where the header, or the nodes as a whole, cannot be.
fn header(ok: bool, what: &'static str) -> Checked {
    if ok {
        Ok(())
    } else {
        Err(ContainerError::Value { node: None, what })
    }
}

fn near(a: f32, b: f32) -> bool {
    (a - b).abs() <= SAME_TIME
}

/// What is wrong with the order of two nodes.
fn order<const N: usize, const F: usize>(
    before: &PlanNode<N, F>,
    node: &PlanNode<N, F>,
) -> Option<&'static str> {
    let rises = node.time > before.time;
    let follows = node.phase == before.phase || node.phase == before.phase.saturating_add(1);
    [(rises, "time"), (follows, "phase")]
        .into_iter()
        .find_map(unless)
}

/// What is wrong with a node. The last one holds nothing, so its forces are not looked at.
fn fault<const N: usize, const F: usize>(
    h: &Header<'_, N>,
    node: &PlanNode<N, F>,
    last: bool,
) -> Option<&'static str> {
    let all = |xs: &[f32]| xs.iter().all(|x| x.abs() <= FAR);
    let finite = |xs: &[f32]| xs.iter().all(|x| x.is_finite());
    let forces = node.forces_w.as_flattened();
    let phase = h
        .phases
        .get(..usize::from(h.phase_count))
        .unwrap_or_default();
    let phase = phase.get(usize::from(node.phase));
    let push = |(foot, f): (usize, &[f32; 3])| {
        let stands = phase.is_some_and(|p| (u32::from(p.contacts) >> foot) & 1 == 1);
        pushes(h, f, stands)
    };
    let checks = [
        (
            node.time.abs() <= FAR && node.time <= h.touchdown + SAME_TIME,
            "time",
        ),
        (phase.is_some(), "phase"),
        (all(&node.position_w), "position of the base"),
        (node.has_rotation(), "rotation of the base"),
        (all(&node.velocity_b), "velocity of the base"),
        (all(&node.joints), "joints"),
        (all(&node.joint_velocities), "joint velocities"),
        (finite(&node.torques), "torques"),
        (finite(forces), "forces"),
        (last || node.forces_w.iter().enumerate().all(push), "forces"),
        (all(node.feet_b.as_flattened()), "feet"),
        (
            all(node.foot_velocities_b.as_flattened()),
            "velocities of the feet",
        ),
    ];
    checks.into_iter().find_map(unless)
}

fn unless((ok, what): (bool, &'static str)) -> Option<&'static str> {
    (!ok).then_some(what)
}

/// Whether a force is one of the ground: within the cone and not too large under a foot that stands, none under another.
fn pushes<const N: usize>(h: &Header<'_, N>, f: &[f32; 3], stands: bool) -> bool {
    let [x, y, z] = f.map(f64::from);
    let slack = f64::from(CONE * h.margins.max_force);
    let most = f64::from(MOST * h.margins.max_force);
    let side = math::hypot(x, y);
    if stands {
        z >= -slack && z <= most && side <= f64::from(h.margins.friction) * z + slack
    } else {
        side <= slack && z.abs() <= slack
    }
}
