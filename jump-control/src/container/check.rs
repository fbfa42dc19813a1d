//! Whether what a container says can be: a checksum tells that bytes are those that were written, not that they make sense.

use super::record::is_rotation;
use super::{Container, ContainerError, Header, PlanPhase};

/// Farthest place, m, and fastest motion, m/s or rad/s, of any robot this is for.
const FAR: f32 = 100.0;
/// Times that differ by less are the same, s: sums of single-precision durations.
const SAME_TIME: f32 = 1e-3;
/// How far a force may be outside its cone, as a share of the largest: solvers stop within their tolerance.
const CONE: f32 = 5e-3;
/// Largest normal force in multiples of the one that the rigid body's plan may use: single legs of the whole body come to three.
const MOST: f32 = 10.0;

/// The bit of a number's sign.
const SIGN: u32 = 1 << 31;

type Checked = Result<(), ContainerError>;

impl<const N: usize, const F: usize> Container<'_, N, F> {
    /// Looks at every number: all are finite, times increase up to the touchdown, phases follow each other, rotations are rotations, feet on
    /// the ground push within their cone and feet in the air do not. What depends on the robot's joints is left to who knows them. One pass over
    /// the bytes where they are: most numbers are only compared.
    ///
    /// # Errors
    /// [`ContainerError::Value`] names the first number that cannot be.
    pub fn check(&self) -> Checked {
        self.check_header()?;
        let rules = Rules::of(&self.header);
        let mut before: Option<Begun> = None;
        for (i, words) in (0..self.header.nodes).zip(self.stored().words()) {
            let last = i.saturating_add(1) == self.header.nodes;
            let node = rules.node::<N, F>(Words(words), before.as_ref(), last);
            before = Some(node.map_err(|what| {
                let node = Some(i);
                ContainerError::Value { node, what }
            })?);
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

/// What of a node the next one is held against.
struct Begun {
    phase: u8,
    time: f32,
}

/// What every node is held against.
struct Rules<'h> {
    phases: &'h [PlanPhase],
    /// Time after which no node may be, s.
    latest: f32,
    friction: f64,
    /// How far a force may be outside its cone, N.
    slack: f64,
    /// Largest normal force, N.
    most: f64,
}

impl<'h> Rules<'h> {
    fn of<const N: usize>(h: &'h Header<'_, N>) -> Self {
        let count = usize::from(h.phase_count);
        Self {
            phases: h.phases.get(..count).unwrap_or_default(),
            latest: h.touchdown + SAME_TIME,
            friction: f64::from(h.margins.friction),
            slack: f64::from(CONE * h.margins.max_force),
            most: f64::from(MOST * h.margins.max_force),
        }
    }

    /// Reads a node that follows `before`; the first number that cannot be is the error. The last node holds nothing, so its forces have
    /// to be finite and no more.
    fn node<const N: usize, const F: usize>(
        &self,
        mut from: Words<'_>,
        before: Option<&Begun>,
        last: bool,
    ) -> Result<Begun, &'static str> {
        let [[phase, ..], time] = *from.numbers()?;
        let time = f32::from_le_bytes(time);
        if let Some(before) = before {
            must(time > before.time, "time")?;
            let follows = phase == before.phase || phase == before.phase.saturating_add(1);
            must(follows, "phase")?;
        }
        must(time.abs() <= FAR && time <= self.latest, "time")?;
        let now = self.phases.get(usize::from(phase)).ok_or("phase")?;
        must(within(FAR, from.numbers::<3>()?), "position of the base")?;
        let rows = from.vectors::<3>()?.each_ref().map(vector);
        must(is_rotation(&rows), "rotation of the base")?;
        must(within(FAR, from.numbers::<6>()?), "velocity of the base")?;
        must(within(FAR, from.numbers::<N>()?), "joints")?;
        must(within(FAR, from.numbers::<N>()?), "joint velocities")?;
        must(within(f32::MAX, from.numbers::<N>()?), "torques")?;
        // Before its jump begins the robot waits on all its feet, whichever stand in the first phase.
        let waits = time < 0.0;
        let forces = from.vectors::<F>()?;
        must(within(f32::MAX, forces.as_flattened()), "forces")?;
        for (foot, force) in forces.iter().enumerate() {
            let stands = waits || (u32::from(now.contacts) >> foot) & 1 == 1;
            must(last || self.pushes(vector(force), stands), "forces")?;
        }
        let mut feet = |what| must(within(FAR, from.vectors::<F>()?.as_flattened()), what);
        feet("feet")?;
        feet("velocities of the feet")?;
        Ok(Begun { phase, time })
    }

    /// Whether a force is one of the ground: within the cone and not too large under a foot that stands, none under another. By squares:
    /// those of single precision are finite in double precision.
    fn pushes(&self, force: [f32; 3], stands: bool) -> bool {
        let [x, y, z] = force.map(f64::from);
        let (reach, normal) = if stands {
            (
                self.friction * z + self.slack,
                z >= -self.slack && z <= self.most,
            )
        } else {
            (self.slack, z.abs() <= self.slack)
        };
        normal && reach >= 0.0 && x * x + y * y <= reach * reach
    }
}

/// The numbers of a node from the next one on, each as its bytes.
struct Words<'a>(&'a [[u8; 4]]);

impl<'a> Words<'a> {
    /// The next numbers. Inlined, so that loops over them have a known length.
    #[inline(always)]
    fn numbers<const K: usize>(&mut self) -> Result<&'a [[u8; 4]; K], &'static str> {
        let (numbers, rest) = self.0.split_first_chunk().ok_or("bytes")?;
        self.0 = rest;
        Ok(numbers)
    }

    /// The next vectors.
    #[inline(always)]
    fn vectors<const K: usize>(&mut self) -> Result<&'a [[[u8; 4]; 3]; K], &'static str> {
        let (vectors, _) = self.0.as_chunks();
        let vectors = vectors.first_chunk().ok_or("bytes")?;
        self.0 = self.0.get(3 * K..).unwrap_or_default();
        Ok(vectors)
    }
}

/// Whether all numbers are finite and at most `most` large: bits of positive numbers are in the order of the numbers, and those of
/// infinity and of what is no number come behind. Inlined, because most of a plan's numbers pass here: each is four instructions where their
/// number is known.
#[inline(always)]
fn within(most: f32, numbers: &[[u8; 4]]) -> bool {
    let size = |number: &[u8; 4]| u32::from_le_bytes(*number) & !SIGN;
    numbers.iter().all(|number| size(number) <= most.to_bits())
}

/// A vector from its bytes.
fn vector(bytes: &[[u8; 4]; 3]) -> [f32; 3] {
    bytes.map(f32::from_le_bytes)
}

fn must(ok: bool, what: &'static str) -> Result<(), &'static str> {
    if ok { Ok(()) } else { Err(what) }
}

#[cfg(test)]
mod tests;
