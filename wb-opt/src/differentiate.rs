//! Derivatives of one interval: cost, mixed rows, and the exact Hessian of the Lagrangian.

use crate::drive::Line;
use crate::map::{Map, turning};
use crate::midpoint::Midpoint;
use crate::problem::Problem;
use crate::robot::{BASE, TURN};
use crate::state::Units;
use crate::stretch::Stretch;
use nalgebra::Vector3;
use ocp_solver::Derivatives;
use rbd_core::second_order::{
    Contacts, EffortJacobian, Gradient, Hessian, Multipliers, PositionTerms, Sweep,
};
use so3::Scalar;

/// One interval whose nonlinear part is differentiated.
pub(crate) struct Interval<'a, 'p, T: Scalar, const N: usize, const FEET: usize> {
    pub(crate) problem: &'a Problem<'p, T, N, FEET>,
    pub(crate) k: usize,
    pub(crate) mid: &'a Midpoint<T, N, FEET>,
    pub(crate) sweep: &'a Sweep<'a, T, N>,
    pub(crate) contacts: &'a Contacts<T, FEET>,
    pub(crate) map: Map<T>,
    /// Next row to write.
    pub(crate) row: usize,
    /// Gradient of the Lagrangian so far in the angles, rates and accelerations that turn the base.
    pub(crate) turning: [Vector3<T>; 3],
    /// Where the duration of the phase is free.
    pub(crate) stretch: Option<Stretch<T, N>>,
    /// Gradient of the Lagrangian so far, if so.
    pub(crate) whole: Gradient<T, N, FEET>,
}

impl<T: Scalar, const N: usize, const FEET: usize> Interval<'_, '_, T, N, FEET> {
    /// Writes the next row, which is zero except at the coordinates `support`, and returns its multiplier in physical units.
    #[inline(always)]
    fn push<const NX: usize, const NU: usize, const NI: usize>(
        &mut self,
        unit: T,
        gradient: &Gradient<T, N, FEET>,
        support: impl Iterator<Item = usize>,
        y: &[T; NI],
        d: &mut Derivatives<T, NX, NU, NI>,
    ) -> T {
        let i = self.row;
        self.row = i.saturating_add(1);
        let scale = T::ONE / unit;
        if let (Some(x), Some(u)) = (d.rows_x.get_mut(i), d.rows_u.get_mut(i)) {
            self.map.sparse(scale, gradient, support, x, u);
            if let Some(stretch) = &self.stretch
                && let Some(slot) = x.get_mut(stretch.column)
            {
                *slot = scale * stretch.along(gradient);
            }
        }
        let multiplier = y.get(i).copied().unwrap_or(T::ZERO) * scale;
        self.count(multiplier, gradient);
        multiplier
    }

    /// Adds to the gradient of the Lagrangian.
    #[inline(always)]
    fn count(&mut self, multiplier: T, gradient: &Gradient<T, N, FEET>) {
        for (sum, part) in self.turning.iter_mut().zip(turning(gradient)) {
            *sum += part * multiplier;
        }
        if self.stretch.is_some() {
            self.whole.add(multiplier, gradient);
        }
    }

    /// Writes cost, mixed rows and the Hessian of the Lagrangian.
    pub(crate) fn differentiate<const NX: usize, const NU: usize, const NI: usize>(
        &mut self,
        y: &[T; NI],
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let units = Units::new();
        let weights = self.problem.interval_weights(self.k);
        let mut effort = [T::ZERO; N];
        self.sweep.effort(&self.mid.a, self.contacts, &mut effort);
        let mut jacobian = EffortJacobian::<T, N, FEET>::ZERO;
        self.sweep.differentiate(self.contacts, &mut jacobian);
        let bends = self.add_friction(&mut effort, &mut jacobian);

        let mut hessian = Hessian::<T, N, FEET>::ZERO;
        let mut cost = Gradient::<T, N, FEET>::ZERO;
        let mut multipliers = [T::ZERO; N];
        let mut pulls = [Vector3::zeros(); FEET];
        for (i, multiplier) in multipliers.iter_mut().enumerate().take(BASE) {
            let mut gradient = jacobian.row(i);
            self.bear(i, &effort, &mut gradient);
            *multiplier = self.push(units.effort(i), &gradient, 0..N, y, d);
        }
        self.bear_twice(&multipliers, &effort, &jacobian, &mut hessian);
        for ((point, _), pull) in self.contacts.active().zip(&mut pulls) {
            let rows = self.sweep.acceleration_gradients(point);
            for (row, pull) in rows.iter().zip(pull.iter_mut()) {
                let path = self.sweep.path(point.link);
                *pull = self.push(units.foot_acceleration, row, path, y, d);
            }
        }
        for i in BASE..N {
            let gradient = jacobian.row(i);
            let by_effort = T::TWO * weights.effort * effort[i];
            let end = self.sweep.bodies[i].subtree_end;
            let support = || self.sweep.path(i).chain(i.saturating_add(1)..end.min(N));
            multipliers[i] = self.push(units.moment, &gradient, support(), y, d) + by_effort;
            cost.add(by_effort, &gradient);
            hessian.add_outer(T::TWO * weights.effort, &gradient, support());
        }
        let explicit = self.motor_lines(&jacobian, &mut multipliers, y, d);
        for i in BASE..N {
            hessian.vv[i][i] += multipliers[i] * bends[i];
        }
        let mut positions = self.positions(y, d, &mut hessian);
        self.limits(y, d);
        self.apart(y, d, &mut hessian, &mut positions);
        self.distance(&mut cost, &mut hessian, &mut positions);
        self.count(T::ONE, &cost);

        let multipliers = Multipliers {
            effort: &multipliers,
            acceleration: &pulls,
        };
        self.sweep
            .curvature(self.contacts, &multipliers, &positions, &mut hessian);

        self.map
            .gradient(T::ONE, &cost, &mut d.cost_x, &mut d.cost_u);
        self.map.hessian(&hessian, d);
        if let Some(stretch) = &self.stretch {
            if let Some(slot) = d.cost_x.get_mut(stretch.column) {
                *slot = stretch.along(&cost);
            }
            stretch.bend((&hessian, &self.whole), &explicit, &self.map, d);
        }
    }

    /// Adds the joints' friction to the efforts and its slope to their Jacobian; its curvature in each speed.
    #[inline(always)]
    fn add_friction(
        &self,
        effort: &mut [T; N],
        jacobian: &mut EffortJacobian<T, N, FEET>,
    ) -> [T; N] {
        let mut bends = [T::ZERO; N];
        for (i, bent) in bends.iter_mut().enumerate().skip(BASE) {
            let (limit, v) = (&self.problem.robot.limits[i], self.mid.v[i]);
            let smoothing = self.problem.friction_smoothing;
            let [friction, slope, bend] = crate::drive::friction(limit, v, smoothing);
            effort[i] += friction;
            jacobian.by_v[i][i] += slope;
            *bent = bend;
        }
        bends
    }

    /// Rows of what the motors can give at the speeds at both ends of the interval; their multipliers are added to those of the efforts.
    /// Returned is what the Lagrangian gains with the duration at each joint's acceleration besides.
    #[inline(always)]
    fn motor_lines<const NX: usize, const NU: usize, const NI: usize>(
        &mut self,
        jacobian: &EffortJacobian<T, N, FEET>,
        multipliers: &mut [T; N],
        y: &[T; NI],
        d: &mut Derivatives<T, NX, NU, NI>,
    ) -> [T; N] {
        let units = Units::new();
        let mut explicit = [T::ZERO; N];
        if self.problem.groups(self.k).lines == 0 {
            return explicit;
        }
        for offset in self.problem.ends(self.k) {
            for (i, multiplier) in multipliers.iter_mut().enumerate().skip(BASE) {
                let mut gradient = jacobian.row(i);
                let slope = Line::of(self.problem.robot.motors[i].as_ref()).slope;
                gradient.v[i] += slope;
                gradient.a[i] += slope * offset;
                let end = self.sweep.bodies[i].subtree_end;
                let support = self.sweep.path(i).chain(i.saturating_add(1)..end.min(N));
                let y = self.push(units.moment, &gradient, support, y, d);
                *multiplier += y;
                // The speed at an end of the interval knows its length besides.
                if let Some(stretch) = &self.stretch {
                    let side = stretch.rate * if offset < T::ZERO { -T::HALF } else { T::HALF };
                    explicit[i] += y * slope * side;
                    let row = self.row.checked_sub(1).and_then(|i| d.rows_x.get_mut(i));
                    if let Some(slot) = row.and_then(|row| row.get_mut(stretch.column)) {
                        *slot += slope * side * self.mid.a[i] / units.moment;
                    }
                }
            }
        }
        explicit
    }

    /// Positions and speeds of the joints, as far as the length of the interval moves them.
    fn limits<const NX: usize, const NU: usize, const NI: usize>(
        &mut self,
        y: &[T; NI],
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let groups = self.problem.groups(self.k);
        if self.stretch.is_none() || groups.limited == 0 {
            return;
        }
        let speed = Units::<T>::new().speed;
        for joint in BASE..N {
            let mut gradient = Gradient::ZERO;
            gradient.q[joint] = T::ONE;
            self.push(T::ONE, &gradient, core::iter::once(joint), y, d);
        }
        for joint in BASE..N {
            let mut gradient = Gradient::ZERO;
            gradient.v[joint] = T::ONE;
            self.push(speed, &gradient, core::iter::once(joint), y, d);
        }
    }

    /// Links that keep apart.
    fn apart<const NX: usize, const NU: usize, const NI: usize>(
        &mut self,
        y: &[T; NI],
        d: &mut Derivatives<T, NX, NU, NI>,
        hessian: &mut Hessian<T, N, FEET>,
        terms: &mut PositionTerms<T, N>,
    ) {
        let groups = self.problem.groups(self.k);
        let unit = Units::<T>::new().position;
        self.row = groups.first_apart();
        for pair in self.problem.apart.iter().take(groups.apart) {
            let near = pair.near(self.sweep);
            let y = self.push(unit, &near.gradient(self.sweep), 0..N, y, d);
            near.bend(self.sweep, y, hessian, terms);
        }
    }

    /// On SO(3) the moments on the base are about its axes, m = B⁻ᵀ τ, where the chain has them about its joints:
    /// the same at zero angles, but their derivatives are not. With the angles x and z of the second and third joint
    /// m₁ = (1 + ½ (x² − z²)) τ₁ + z τ₂ − x τ₃, m₂ = (1 − ½ z²) τ₂ − z τ₁ + x z τ₃, m₃ = τ₃.
    fn bear(&self, row: usize, effort: &[T; N], gradient: &mut Gradient<T, N, FEET>) {
        if self.problem.robot.turns_freely() {
            let [x, z] = [TURN + 1, TURN + 2];
            if row == TURN {
                gradient.q[x] -= effort[TURN + 2];
                gradient.q[z] += effort[TURN + 1];
            } else if row == TURN + 1 {
                gradient.q[z] -= effort[TURN];
            }
        }
    }

    /// The second derivatives that belong to [`Self::bear`].
    fn bear_twice(
        &self,
        multipliers: &[T; N],
        effort: &[T; N],
        jacobian: &EffortJacobian<T, N, FEET>,
        hessian: &mut Hessian<T, N, FEET>,
    ) {
        if self.problem.robot.turns_freely() {
            let [x, z] = [TURN + 1, TURN + 2];
            let [first, second, third] = [TURN, TURN + 1, TURN + 2];
            let (y_1, y_2) = (multipliers[first], multipliers[second]);
            hessian.add_product(x, -y_1, &jacobian.row(third));
            hessian.add_product(z, y_1, &jacobian.row(second));
            hessian.add_product(z, -y_2, &jacobian.row(first));
            hessian.qq[x][x] += y_1 * effort[first];
            hessian.qq[z][z] -= y_1 * effort[first] + y_2 * effort[second];
            hessian.qq[x][z] += y_2 * effort[third];
            hessian.qq[z][x] += y_2 * effort[third];
        }
    }

    /// Cost of the distance from the reference.
    fn distance(
        &self,
        cost: &mut Gradient<T, N, FEET>,
        hessian: &mut Hessian<T, N, FEET>,
        terms: &mut PositionTerms<T, N>,
    ) {
        let Some(reference) = self.problem.reference.get(self.k) else {
            return;
        };
        let weight = self.problem.interval_weights(self.k).position;
        let two = T::TWO * weight;
        for (i, reference) in reference.q.iter().enumerate() {
            cost.q[i] += two * (self.mid.q[i] - *reference);
        }
        let mut straight = 0..N;
        if self.problem.robot.turns_freely() {
            // The distance of the rotation R from its reference is 3 − Σ c·r with columns c and r of the two.
            let rot_w = self.mid.rot_wc.matrix();
            let spread = reference.rot_wc.matrix() * rot_w.transpose() * -weight;
            terms.add_spread(BASE - 1, &spread);
            let pull = so3::vee(&spread) * T::TWO;
            for k in TURN..BASE {
                cost.q[k] += self.sweep.joints[k].axis.angular.dot(&pull);
            }
            (0..TURN).for_each(|i| hessian.qq[i][i] += two);
            straight.start = BASE;
        }
        straight.for_each(|i| hessian.qq[i][i] += two);
    }

    /// Rows of positions: drift and heights over the ground.
    fn positions<const NX: usize, const NU: usize, const NI: usize>(
        &mut self,
        y: &[T; NI],
        d: &mut Derivatives<T, NX, NU, NI>,
        hessian: &mut Hessian<T, N, FEET>,
    ) -> PositionTerms<T, N> {
        let units = Units::new();
        let mut terms = PositionTerms::new();
        for (point, _) in self.contacts.active() {
            for normal in [Vector3::x(), Vector3::y(), Vector3::z()] {
                let gradient = self
                    .sweep
                    .position_gradient(point.link, &point.pos, &normal);
                let path = self.sweep.path(point.link);
                let y = self.push(units.position, &gradient, path, y, d);
                terms.add(point.link, &point.pos, &(normal * y));
            }
        }
        for point in self.problem.points_over_ground(self.k) {
            let pos = self.sweep.place(point.link, &point.offset_l);
            let over = self.problem.over_ground(&pos);
            let path = || self.sweep.path(point.link);
            let gradient = self.sweep.position_gradient(point.link, &pos, &over.normal);
            let y = self.push(units.position, &gradient, path(), y, d);
            terms.add(point.link, &pos, &(over.normal * y));
            if over.curvature != T::ZERO {
                let mut axis = Vector3::zeros();
                axis[over.across] = T::ONE;
                let gradient = self.sweep.position_gradient(point.link, &pos, &axis);
                hessian.add_outer(y * over.curvature, &gradient, path());
            }
        }
        terms
    }
}
