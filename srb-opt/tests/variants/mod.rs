//! Jumps of the reference problem's form that nobody tuned for: other goals, heights, turns, payloads, contacts.
#![allow(
    dead_code,
    clippy::disallowed_methods,
    reason = "every program that includes this uses its own part, and draws numbers with std"
)]

use nalgebra::Vector3;
use srb_opt::onboard::{FEET, Jump, PHASES, example};
use srb_opt::{Edge, Phase, Reference};

/// SplitMix64.
pub(crate) struct Draw(pub(crate) u64);

impl Draw {
    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2f64.powi(64)
    }

    /// Uniform in an interval.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number below `n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n - 1)
    }

    /// Standard normal.
    pub(crate) fn normal(&mut self) -> f64 {
        let (a, b) = (1.0 - self.unit(), self.unit());
        (-2.0 * a.ln()).sqrt() * (core::f64::consts::TAU * b).cos()
    }
}

/// Turns: none, a part of one about z, or one or two about x or y.
fn turn(draw: &mut Draw) -> (Vector3<f64>, f64) {
    match draw.below(4) {
        0 => (Vector3::z(), 0.0),
        1 => (Vector3::z(), draw.between(-0.35, 0.35)),
        _ => {
            let axis = if draw.below(2) == 0 {
                Vector3::x()
            } else {
                Vector3::y()
            };
            let turns = (1 + draw.below(2)) as f64;
            (axis, if draw.below(2) == 0 { turns } else { -turns })
        }
    }
}

/// Whether the jump goes along y, and its sign: a roll carries the body to its side, a flip to its front or back.
fn heading(draw: &mut Draw, axis: Vector3<f64>, turns: f64) -> (bool, f64) {
    if turns.abs() >= 1.0 {
        let along_y = axis.x == 1.0;
        let sign = turns.signum();
        return (along_y, if along_y { -sign } else { sign });
    }
    let along_y = draw.below(2) == 0;
    (along_y, if draw.below(2) == 0 { 1.0 } else { -1.0 })
}

/// How much lower than the start the goal is, how far away, and how far beside.
fn landing(draw: &mut Draw, turns: f64) -> (f64, f64, f64) {
    let drop: f64 = match draw.below(3) {
        0 => 0.0,
        1 => draw.between(-0.5, 0.0),
        _ => draw.between(0.0, 2.0),
    };
    let drop = if turns.abs() == 2.0 {
        drop.max(0.6)
    } else {
        drop
    };
    if drop == 0.0 {
        (drop, draw.between(0.0, 0.6), draw.between(-0.1, 0.1))
    } else {
        (drop, draw.between(0.5, 0.8), 0.0)
    }
}

/// All feet, then those that still push if some leave early, then none.
fn write_phases(jump: &mut Jump<f64>, pushing: Option<[bool; FEET]>, flight: f64) {
    let phase = |contacts, intervals, duration_guess| Phase {
        contacts,
        intervals,
        duration_guess,
        min_duration: 0.1,
        max_duration: 1.0,
        reference_angle: 0.0,
    };
    if let Some(pushing) = pushing {
        jump.phases = [
            phase([true; FEET], 50, 0.5),
            phase(pushing, 30, 0.3),
            phase([false; FEET], 40, flight.max(0.4)),
        ];
        jump.phase_count = PHASES;
        jump.max_total = 0.8 + flight;
    } else {
        jump.phases[0] = phase([true; FEET], 50, 0.5);
        jump.phases[1] = phase([false; FEET], 30, flight);
        jump.phase_count = 2;
        jump.max_total = 0.5 + flight;
    }
}

/// A jump drawn at random, and what it is.
pub(crate) fn variant(seed: u64) -> (Jump<f64>, String) {
    let mut draw = Draw(seed);
    let mut jump = example::<f64>();
    let payload = draw.between(0.8, 1.2);
    jump.mass *= payload;
    jump.inertia_b *= draw.between(0.8, 1.2);
    let (axis, turns) = turn(&mut draw);
    let acrobatic = turns.abs() >= 1.0;
    let (along_y, way) = heading(&mut draw, axis, turns);
    let (drop, distance, across) = landing(&mut draw, turns);
    let (x, y) = if along_y {
        (across, way * distance)
    } else {
        (way * distance, across)
    };
    jump.goal_w = jump.start_w + Vector3::new(x, y, -drop);
    if drop != 0.0 {
        jump.edge = Some(Edge {
            drop,
            axis: usize::from(along_y),
            sign: way,
            distance: if along_y { 0.18 } else { 0.23 },
            width: 0.03,
        });
    }
    (jump.axis, jump.angle) = (axis, turns * core::f64::consts::TAU);
    // Legs of the push-off's second half: those the body leaves over.
    let two_legs = acrobatic || draw.below(2) == 0;
    let stays = |i: usize| {
        let (front, left) = (i < 2, i.is_multiple_of(2));
        if along_y {
            left == (way > 0.0)
        } else {
            front == (way > 0.0)
        }
    };
    let fall = (2.0 * drop.max(0.0) / jump.gravity).sqrt();
    let flight = 0.3 + 0.12 * turns.abs() + 0.6 * fall;
    let pushing = two_legs.then(|| core::array::from_fn(stays));
    write_phases(&mut jump, pushing, flight);
    if acrobatic {
        jump.reference = Reference::PerPhase;
        jump.phases[1].reference_angle = core::f64::consts::FRAC_PI_3 * turns.signum();
        jump.phases[2].reference_angle = jump.angle;
    }
    let text = format!(
        "turns {turns:+.2} about {}, drop {drop:+.2}, goal ({x:+.2}, {y:+.2}), payload {payload:.2}, {} legs",
        if axis.x == 1.0 {
            "x"
        } else if axis.y == 1.0 {
            "y"
        } else {
            "z"
        },
        if two_legs { "4 then 2" } else { "4" },
    );
    (jump, text)
}
