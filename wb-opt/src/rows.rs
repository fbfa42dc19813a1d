//! Which constraint rows a node has, in which order, and their bounds.
//!
//! State rows: at the first landing node, joints at the goal and their speeds zero; at the last node, the
//! base near the goal. Control rows: per foot in contact the sides of the friction pyramid and the normal
//! force. Mixed rows, at the midpoint: effort on the base (zero), acceleration of the feet in contact
//! (zero), joint efforts, torque-speed lines at the speeds of the interval's start and end if any joint has a motor (the effort is held,
//! and light legs change their speed much over an interval), drift of the feet in contact, clearances, heights of the other feet, and, where
//! joints move, their positions and speeds, and links that keep apart ([`crate::apart`]). Rows are in the units of [`crate::state::Units`].

use crate::drive::Line;
use crate::problem::Problem;
use crate::robot::BASE;
use crate::state::Units;
use ocp_solver::Dims;
use so3::Scalar;

/// Rows a node can have at most: the least `NI` for `coordinates` coordinates, `feet` feet with friction pyramids of `sides`
/// sides ([`crate::Friction::sides`]) and a number of clearances and pairs that keep apart, with or without torque-speed lines.
#[must_use]
pub const fn row_capacity(
    coordinates: usize,
    feet: usize,
    sides: usize,
    points: usize,
    lines: bool,
) -> usize {
    let joints = coordinates.saturating_sub(BASE);
    // Contact: pyramid and normal force, acceleration, drift. The landing rows come instead of limits.
    let contacts = feet.saturating_mul(sides.saturating_add(1 + 3 + 3));
    let middle = BASE
        .saturating_add(contacts)
        .saturating_add(joints.saturating_mul(if lines { 5 } else { 3 }));
    middle.saturating_add(points)
}

/// Numbers of rows of an interval, group by group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Groups {
    /// Landing rows of the state.
    pub(crate) landing: usize,
    /// Feet in contact.
    pub(crate) feet: usize,
    /// Rows of the force of each.
    pub(crate) per_foot: usize,
    /// Joints.
    pub(crate) joints: usize,
    /// Torque-speed lines, at both ends of the interval.
    pub(crate) lines: usize,
    pub(crate) clearances: usize,
    /// Feet in the air.
    pub(crate) swing: usize,
    /// Joints that move.
    pub(crate) limited: usize,
    /// Pairs of links that keep apart.
    pub(crate) apart: usize,
}

impl Groups {
    /// First mixed row.
    pub(crate) const fn first_mixed(&self) -> usize {
        self.landing.saturating_add(self.forces())
    }

    /// First row of the joint positions; those of the speeds follow.
    pub(crate) const fn first_limit(&self) -> usize {
        self.first_mixed()
            .saturating_add(self.mixed())
            .saturating_sub(self.limits())
            .saturating_sub(self.apart)
    }

    /// First row of the links that keep apart: behind all others, so that those keep their places where a pair is added.
    pub(crate) const fn first_apart(&self) -> usize {
        self.first_limit().saturating_add(self.limits())
    }

    /// Rows of the joint positions and speeds.
    const fn limits(&self) -> usize {
        self.limited.saturating_mul(2)
    }

    /// Rows of the forces.
    pub(crate) const fn forces(&self) -> usize {
        self.feet.saturating_mul(self.per_foot)
    }

    const fn mixed(&self) -> usize {
        BASE.saturating_add(self.feet.saturating_mul(6))
            .saturating_add(self.joints)
            .saturating_add(self.lines)
            .saturating_add(self.clearances)
            .saturating_add(self.swing)
            .saturating_add(self.limits())
            .saturating_add(self.apart)
    }
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    pub(crate) fn groups(&self, k: usize) -> Groups {
        let layout = self.layout(k);
        let joints = N.saturating_sub(BASE);
        Groups {
            landing: if k == self.landing_node() {
                joints.saturating_mul(2)
            } else {
                0
            },
            feet: layout.feet,
            per_foot: self.friction.rows(),
            joints,
            lines: if self.robot.motors.iter().any(Option::is_some) {
                joints.saturating_mul(2)
            } else {
                0
            },
            clearances: self.clearances.len(),
            swing: FEET.saturating_sub(layout.feet),
            limited: layout.joints,
            apart: if layout.joints > 0 {
                self.apart.len()
            } else {
                0
            },
        }
    }

    /// Clearances and pairs that keep apart, of which each has one row at most.
    pub(crate) const fn points(&self) -> usize {
        self.clearances.len().saturating_add(self.apart.len())
    }

    pub(crate) fn row_dims(&self, k: usize) -> Dims {
        if k >= self.intervals() {
            return Dims {
                state_rows: BASE,
                ..Dims::default()
            };
        }
        let groups = self.groups(k);
        Dims {
            controls: self.layout(k).controls(),
            state_rows: groups.landing,
            control_rows: groups.forces(),
            mixed_rows: groups.mixed(),
        }
    }

    pub(crate) fn row_bounds<const NI: usize>(
        &self,
        k: usize,
        lower: &mut [T; NI],
        upper: &mut [T; NI],
    ) {
        let units = Units::new();
        let mut rows = lower.iter_mut().zip(upper.iter_mut());
        let mut push = |l: T, h: T, unit: T| {
            if let Some((lower, upper)) = rows.next() {
                (*lower, *upper) = (l / unit, h / unit);
            }
        };
        if k >= self.intervals() {
            for (goal, tolerance) in self.goal.q.iter().zip(&self.goal_tolerance) {
                push(*goal - *tolerance, *goal + *tolerance, T::ONE);
            }
            return;
        }
        let groups = self.groups(k);
        if groups.landing > 0 {
            for goal in self.goal.q.iter().skip(BASE) {
                push(*goal, *goal, T::ONE);
            }
            for _ in 0..groups.joints {
                push(T::ZERO, T::ZERO, units.speed);
            }
        }
        let standing = self.contacts(k).into_iter().enumerate();
        for (foot, _) in standing.filter(|(_, on)| *on) {
            for [_, _, mu] in self.friction.gradients().take(self.friction.sides()) {
                push(mu * self.friction.apex, T::INFINITY, units.force);
            }
            push(self.least_force, self.most_force(k, foot), units.force);
        }
        for _ in 0..BASE.saturating_add(groups.feet.saturating_mul(3)) {
            push(T::ZERO, T::ZERO, T::ONE);
        }
        let limits = || self.robot.limits.iter().skip(BASE);
        for limit in limits() {
            push(-limit.effort, limit.effort, units.moment);
        }
        let joints = || self.robot.motors.iter().skip(BASE);
        let lines = joints().chain(joints()).take(groups.lines);
        for line in lines.map(|motor| Line::of(motor.as_ref())) {
            push(-line.bound, line.bound, units.moment);
        }
        for (foot, _) in self.feet.iter().zip(self.contacts(k)).filter(|(_, on)| *on) {
            for place in &foot.pos_wf {
                push(*place - self.drift, *place + self.drift, units.position);
            }
        }
        for clearance in self.clearances {
            push(clearance.height, T::INFINITY, units.position);
        }
        let feet = self.contacts(k).into_iter().enumerate();
        for (foot, _) in feet.filter(|(_, on)| !*on) {
            push(self.least_height(k, foot), T::INFINITY, units.position);
        }
        if groups.limited > 0 {
            for limit in limits() {
                push(limit.lower, limit.upper, T::ONE);
            }
            for limit in limits() {
                push(-limit.speed, limit.speed, units.speed);
            }
        }
        for pair in self.apart.iter().take(groups.apart) {
            push(pair.distance * T::HALF, T::INFINITY, units.position);
        }
    }
}
