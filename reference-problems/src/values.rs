//! What the numbers of a problem file may be: nothing is computed, and no memory asked for, before each was looked at and named.

use crate::file::{Constants, FEET, Task};
use jump_planner::range::Range::{self, Above, From};
use nalgebra::{Cholesky, Matrix3, Vector3};

/// Most contact phases of a task.
const MOST_PHASES: usize = 12;
/// Most intervals of a task.
const MOST_INTERVALS: usize = 2000;
/// Lengths and displacements, m.
const LENGTH: Range = From(-100.0, 100.0);
/// Ten turns, rad.
const TURN: Range = From(-63.0, 63.0);
/// Durations, s.
pub(crate) const DURATION: Range = From(1e-6, 10.0);
/// What must be more than nothing.
const POSITIVE: Range = Above(0.0, 1e6);
/// Weights of costs.
const WEIGHT: Range = From(1e-15, 1e12);

/// Names the key of a value that is out of its range.
fn within<'a>(
    key: &str,
    range: Range,
    values: impl IntoIterator<Item = &'a f64>,
) -> Result<(), String> {
    range
        .check_all(values)
        .map_err(|what| format!("{key}: {what}"))
}

impl Constants {
    pub(crate) fn check(&self) -> Result<(), String> {
        for (key, value) in [
            ("M", self.m),
            ("G", self.g),
            ("Z0", self.z0),
            ("MU", self.mu),
            ("FZ_MAX", self.fz_max),
            ("REACH_X", self.reach_x),
            ("REACH_Y", self.reach_y),
            ("EDGE_W", self.edge_w),
            ("TAU_MAX", self.tau_max),
            ("QD_MAX", self.qd_max),
        ] {
            within(key, POSITIVE, [&value])?;
        }
        for (key, value) in [
            ("EPS_W", self.eps_w),
            ("EPS_F", self.eps_f),
            ("EPS_R", self.eps_r),
            ("EPS_LOG", self.eps_log),
        ] {
            within(key, WEIGHT, [&value])?;
        }
        for (key, value) in [
            ("T_LO", self.t_lo),
            ("T_HI", self.t_hi),
            ("TTOT_LO", self.ttot_lo),
        ] {
            within(key, DURATION, [&value])?;
        }
        within("L1", LENGTH, [&self.l1])?;
        within("CLEAR", LENGTH, [&self.clear])?;
        within("HIP", LENGTH, self.hip.as_flattened())?;
        within("FEET0", LENGTH, self.feet0.as_flattened())?;
        within("CORNERS", LENGTH, self.corners.as_flattened())?;
        within("REACH_Z", LENGTH, &self.reach_z)?;
        if self.side.iter().any(|side| side.abs() != 1.0) {
            return Err(format!("SIDE: each must be 1 or -1, not {:?}", self.side));
        }
        ordered("REACH_Z", self.reach_z)?;
        ordered("T_LO and T_HI", [self.t_lo, self.t_hi])?;
        self.check_inertia()
    }

    fn check_inertia(&self) -> Result<(), String> {
        within("I_B", From(-1e6, 1e6), self.i_b.as_flattened())?;
        let inertia_b = Matrix3::from_fn(|i, j| self.i_b[i][j]);
        let slip = (inertia_b - inertia_b.transpose()).amax();
        if slip > 1e-9 * inertia_b.amax() {
            return Err(format!("I_B: must be symmetric, not {:?}", self.i_b));
        }
        if Cholesky::new(inertia_b).is_none() {
            return Err(format!(
                "I_B: must be positive definite, not {:?}",
                self.i_b
            ));
        }
        Ok(())
    }
}

fn ordered(key: &str, [low, high]: [f64; 2]) -> Result<(), String> {
    if low > high {
        return Err(format!("{key}: {low} must not be above {high}"));
    }
    Ok(())
}

impl Task {
    pub(crate) fn check(&self, constants: &Constants) -> Result<(), String> {
        let count = self.n.len();
        if !(1..=MOST_PHASES).contains(&count) {
            return Err(format!("N: 1 to {MOST_PHASES} phases, not {count}"));
        }
        if self.phases.len() != count || self.t0.len() != count {
            let given = [self.phases.len(), count, self.t0.len()];
            return Err(format!(
                "phases, N and T0 must have equal lengths, not {given:?}"
            ));
        }
        if self.bp.as_ref().is_some_and(|bp| bp.len() != count) {
            return Err(format!("bp: one angle per phase is needed, {count}"));
        }
        let total = self
            .n
            .iter()
            .fold(0, |sum: usize, n| sum.saturating_add(*n));
        if self.n.contains(&0) || total > MOST_INTERVALS {
            return Err(format!(
                "N: each at least 1 and all together at most {MOST_INTERVALS} intervals, not {:?}",
                self.n
            ));
        }
        self.phases.iter().try_for_each(|feet| check_feet(feet))?;
        within("T0", DURATION, &self.t0)?;
        within("ttot", DURATION, [&self.ttot])?;
        ordered("TTOT_LO and ttot", [constants.ttot_lo, self.ttot])?;
        within("goal", LENGTH, &self.goal)?;
        within("angle", TURN, [&self.angle])?;
        within("bp", TURN, self.bp.iter().flatten())?;
        within("box", LENGTH, [&self.r#box])?;
        let length = Vector3::from(self.axis).norm();
        let unit = (length - 1.0).abs() < 1e-6;
        if !unit {
            return Err(format!(
                "axis: must be a unit vector, its length is {length:?}"
            ));
        }
        self.order()?;
        self.check_edge()
    }

    fn check_edge(&self) -> Result<(), String> {
        let Some((axis, sign, distance)) = self.edge else {
            return match self.r#box {
                0.0 => Ok(()),
                _ => Err("edge: a box needs one: [axis, sign, distance]".to_owned()),
            };
        };
        if axis > 1 {
            return Err(format!("edge: its axis must be 0 or 1, not {axis}"));
        }
        if sign.abs() != 1.0 {
            return Err(format!("edge: its sign must be 1 or -1, not {sign:?}"));
        }
        within("edge", LENGTH, [&distance])
    }
}

/// Feet on the ground, each once.
fn check_feet(feet: &[usize]) -> Result<(), String> {
    for (i, foot) in feet.iter().enumerate() {
        if *foot >= FEET {
            return Err(format!(
                "phases: there is no foot {foot}, only 0 to {}",
                FEET - 1
            ));
        }
        if feet.iter().take(i).any(|before| before == foot) {
            return Err(format!("phases: foot {foot} is named twice in one phase"));
        }
    }
    Ok(())
}
