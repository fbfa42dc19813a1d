//! Rows of the user, and the names under which a tick's report tells what limited it.
//!
//! A row l ≤ J x ≤ u over the robot's motion x is an equality where l = u, open on a side whose limit is infinite, and masked
//! where both are. [`Rank`] says how it gives way; [`Limited`] says afterwards what held the robot back and what gave way by how
//! much. Rows are known by their number: the first that was added since the program began is 0.

pub use dense_qp::Side;

use so3::{Scalar, math};

use crate::Error;
use crate::program::Program;

/// How a row of the user gives way where everything together is impossible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rank<T> {
    /// Strict, and among the first to yield ([`Yielded::Tasks`](crate::Yielded::Tasks)).
    Task,
    /// Strict, and yields with the joints' limits on motion ([`Yielded::MotionLimits`](crate::Yielded::MotionLimits)).
    Limit,
    /// Never strict: l ≤ J x + s ≤ u with a cost ½ w s² of this weight w > 0. Every such row takes one variable s of the program
    /// beyond those of the robot, so V is that much larger.
    Slack(T),
}

/// What can limit a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The torque of this joint.
    Torque(usize),
    /// The velocity or acceleration of this joint, by its limits of position, speed or acceleration.
    Motion(usize),
    /// The normal force of this contact, or that it is off.
    NormalForce(usize),
    /// Friction, centre of pressure or yaw moment of this contact.
    Cone(usize),
    /// That this contact stays where it is.
    Contact(usize),
    /// The row of the user with this number.
    Row(usize),
}

/// How a limit shows in an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent<T> {
    /// The answer lies on this side of it and would go further without it.
    Held(Side),
    /// It gave way: the answer is outside by this much, in the units of the row.
    Missed(T),
}

/// One line of a tick's report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limited<T> {
    /// What.
    pub limit: Limit,
    /// How.
    pub extent: Extent<T>,
}

/// What a row of a program is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The program's own.
    Own,
    /// The program's own, and the first of its contact.
    First,
    /// The user's, of this rank.
    Task,
    Limit,
    Slack,
}

/// What is known of the rows of a program beside their numbers.
#[derive(Clone, Debug)]
pub(crate) struct Rows<T, const M: usize> {
    pub(crate) kinds: [Kind; M],
    /// Limits of the user's rows as they were asked for: those of the program change as rows yield.
    pub(crate) asked: [[T; 2]; M],
    slacks: usize,
    /// Numbers of rows of [`Kind::Task`] and [`Kind::Limit`].
    tasks: usize,
    limits: usize,
}

impl<T: Scalar, const M: usize> Rows<T, M> {
    pub(crate) const fn new() -> Self {
        Self {
            kinds: [Kind::Own; M],
            asked: [[T::ZERO; 2]; M],
            slacks: 0,
            tasks: 0,
            limits: 0,
        }
    }

    pub(crate) const fn clear(&mut self) {
        self.kinds = [Kind::Own; M];
        (self.slacks, self.tasks, self.limits) = (0, 0, 0);
    }

    /// Marks the first row of a contact.
    pub(crate) fn mark_contact(&mut self, row: usize) {
        if let Some(kind) = self.kinds.get_mut(row) {
            *kind = Kind::First;
        }
    }

    /// Adds a row of the user; variables from `robot` on are for slack.
    pub(crate) fn add<const V: usize>(
        &mut self,
        program: &mut Program<T, V, M>,
        robot: usize,
        row: &mut [T; V],
        [lower, upper]: [T; 2],
        rank: Rank<T>,
    ) -> Result<(), Error> {
        let kind = match rank {
            Rank::Task => {
                self.tasks += 1;
                Kind::Task
            }
            Rank::Limit => {
                self.limits += 1;
                Kind::Limit
            }
            Rank::Slack(weight) => {
                let i = robot + self.slacks;
                let slack = row.get_mut(i).ok_or(Error::NoRoomForSlack)?;
                *slack = T::ONE;
                program.bound(i, T::NEG_INFINITY, T::INFINITY);
                program.minimise_variable(i, T::ZERO, weight);
                self.slacks += 1;
                Kind::Slack
            }
        };
        let i = program.constrain(row, lower, upper)?;
        if let (Some(to), Some(asked)) = (self.kinds.get_mut(i), self.asked.get_mut(i)) {
            (*to, *asked) = (kind, [lower, upper]);
        }
        Ok(())
    }

    pub(crate) fn kind(&self, row: usize) -> Kind {
        self.kinds.get(row).copied().unwrap_or(Kind::Own)
    }

    /// Whether there is a row of this kind.
    pub(crate) const fn has(&self, kind: Kind) -> bool {
        match kind {
            Kind::Task => self.tasks > 0,
            Kind::Limit => self.limits > 0,
            Kind::Own | Kind::First | Kind::Slack => false,
        }
    }

    /// Whether rows of this kind have to yield: whether the proof of infeasibility contains one, or where there is no proof,
    /// whether there is one.
    pub(crate) fn must_yield<const V: usize>(
        &self,
        kind: Kind,
        solution: &dense_qp::Solution<'_, T, V, M>,
    ) -> bool {
        self.has(kind)
            && (solution.status != dense_qp::Status::Infeasible
                || solution.conflict().any(
                    |(c, _)| matches!(c, dense_qp::Constraint::Row(i) if self.kind(i) == kind),
                ))
    }

    /// The contact to which force coordinate or contact row `k` belongs.
    pub(crate) fn contact_of(&self, k: usize) -> usize {
        let firsts = self.kinds.iter().take(k + 1);
        firsts
            .filter(|kind| **kind == Kind::First)
            .count()
            .saturating_sub(1)
    }

    /// The rows of the user: index in the program, number, limits asked for.
    pub(crate) fn of_the_user(&self) -> impl Iterator<Item = (usize, usize, [T; 2])> + '_ {
        let all = self.kinds.iter().zip(&self.asked).enumerate();
        all.filter(|(_, (kind, _))| !matches!(kind, Kind::Own | Kind::First))
            .enumerate()
            .map(|(number, (i, (_, asked)))| (i, number, *asked))
    }

    /// The number of the user's row with this index in the program.
    pub(crate) fn number(&self, row: usize) -> Option<usize> {
        self.of_the_user()
            .find_map(|(i, number, _)| (i == row).then_some(number))
    }
}

impl<T: Scalar, const V: usize, const M: usize> Program<T, V, M> {
    /// Ends a level of priority: costs go, those of slack from variable `robot` on stay.
    pub(crate) fn next_level(&mut self, robot: usize) {
        let mut weights = [T::ZERO; V];
        for (i, (to, row)) in weights
            .iter_mut()
            .zip(&self.hessian)
            .enumerate()
            .skip(robot)
        {
            *to = row.get(i).copied().unwrap_or(T::ZERO);
        }
        self.clear_costs();
        for (i, weight) in weights.iter().enumerate().skip(robot) {
            self.minimise_variable(i, T::ZERO, *weight);
        }
    }
}

/// How far `x` is outside of its limits; negative inside.
pub(crate) fn outside<T: Scalar>(x: T, [low, high]: [T; 2]) -> T {
    math::max(low - x, x - high)
}

/// A line of the report for something that is outside by more than `least`.
pub(crate) fn missed<T: Scalar>(limit: Limit, by: T, least: T) -> Option<Limited<T>> {
    let extent = Extent::Missed(by);
    (by > least).then_some(Limited { limit, extent })
}
