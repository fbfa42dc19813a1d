//! Feedback gains of efforts and contact forces from those of the solver's controls.

use crate::map::{Map, add_scaled};
use crate::midpoint::Midpoint;
use crate::problem::Problem;
use crate::robot::BASE;
use crate::state::{Layout, State, Units};
use rbd_core::second_order::{EffortJacobian, Sweep};
use so3::Scalar;

/// Changes that the optimum asks for per deviation of the state at the start of an interval, by rows. On SO(3) the
/// base deviates by `R Exp(θ)` and by its angular velocity, both in base axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains<T, const N: usize, const FEET: usize> {
    /// Effort of coordinate i per m or rad of each coordinate, N m/rad for joints; the base's rows are zero.
    pub effort_by_q: [[T; N]; N],
    /// Effort of coordinate i per rate of each coordinate, N m s/rad for joints; the base's rows are zero.
    pub effort_by_v: [[T; N]; N],
    /// Contact force, world axes, per m or rad of each coordinate; zero for feet in the air.
    pub force_by_q: [[[T; N]; 3]; FEET],
    /// Contact force per rate of each coordinate.
    pub force_by_v: [[[T; N]; 3]; FEET],
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// Gains of interval `k`, from the gain of its controls ([`ocp_solver::Stage::gain`]).
    ///
    /// Efforts change with the state directly and with the controls that respond to it:
    /// dτ = (∂τ/∂x + ∂τ/∂u K) dx. The barrier of the last iteration is in K, so the gains soften toward
    /// active limits.
    #[must_use]
    pub fn gains<const NX: usize, const NU: usize>(
        &self,
        k: usize,
        state: &State<T, N>,
        control: &[T; NU],
        gain: &[[T; NX]; NU],
    ) -> Gains<T, N, FEET> {
        let units = Units::<T>::new();
        let mid: Midpoint<T, N, FEET> = self.midpoint(k, state, control);
        let mut sweep = Sweep::zero(&self.robot.bodies);
        mid.set(&mut sweep);
        let contacts = self.contact_motions(k, &sweep, &mid);
        let mut jacobian = EffortJacobian::<T, N, FEET>::ZERO;
        sweep.differentiate(&contacts, &mut jacobian);
        let map = Map::new(self.dt(k), mid.layout, self.turn(k, &mid));
        let mut out = Gains {
            effort_by_q: [[T::ZERO; N]; N],
            effort_by_v: [[T::ZERO; N]; N],
            force_by_q: [[[T::ZERO; N]; 3]; FEET],
            force_by_v: [[[T::ZERO; N]; 3]; FEET],
        };
        let split = |row: &[T; NX], factor: T, by_q: &mut [T; N], by_v: &mut [T; N]| {
            let (of_q, of_v) = row.split_at(N.min(NX));
            for (slot, x) in by_q.iter_mut().zip(of_q) {
                *slot = factor * *x;
            }
            for (slot, x) in by_v.iter_mut().zip(of_v) {
                *slot = factor * *x / units.speed;
            }
        };
        for i in BASE..N {
            let [_, slope, _] =
                crate::drive::friction(&self.robot.limits[i], mid.v[i], self.friction_smoothing);
            jacobian.by_v[i][i] += slope;
            let (mut x, mut u) = ([T::ZERO; NX], [T::ZERO; NU]);
            map.gradient(T::ONE, &jacobian.row(i), &mut x, &mut u);
            for (weight, row) in u.iter().zip(gain).take(mid.layout.controls()) {
                add_scaled(&mut x, *weight, row);
            }
            split(&x, T::ONE, &mut out.effort_by_q[i], &mut out.effort_by_v[i]);
        }
        let on = self.contacts(k);
        let feet = out.force_by_q.iter_mut().zip(&mut out.force_by_v).zip(on);
        for (f, ((by_q, by_v), _)) in feet.filter(|(_, on)| *on).enumerate() {
            let rows = gain.iter().skip(Layout::force(f));
            for ((by_q, by_v), row) in by_q.iter_mut().zip(by_v).zip(rows) {
                split(row, units.force, by_q, by_v);
            }
        }
        out
    }
}
