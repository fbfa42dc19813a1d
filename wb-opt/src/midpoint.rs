//! The midpoint of an interval, where dynamics and contacts hold (paper A eq. (5)):
//!
//! ```text
//! qm = q + ½ dt q̇ + ¼ dt² q̈,   vm = q̇ + ½ dt q̈
//! ```
//!
//! A base on SO(3) turns by the same rule on the group ([`crate::rotation`]).

use crate::problem::Problem;
use crate::robot::{BASE, TURN};
use crate::rotation::{Turn, angular_acceleration, joint_acceleration, set_triple, triple};
use crate::state::{Layout, State, Units};
use nalgebra::{Rotation3, Vector3};
use rbd_core::second_order::{Contacts, Sweep};
use so3::Scalar;

/// Motion at the middle of an interval, in the coordinates of the chain: on SO(3) the angles of the base turn from
/// [`Self::rot_wc`] and are zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Midpoint<T: Scalar, const N: usize, const FEET: usize> {
    pub(crate) q: [T; N],
    pub(crate) v: [T; N],
    pub(crate) a: [T; N],
    /// Forces on the feet in contact, world axes, N.
    pub(crate) forces: [Vector3<T>; FEET],
    pub(crate) rot_wc: Rotation3<T>,
    pub(crate) layout: Layout,
}

impl<T: Scalar, const N: usize, const FEET: usize> Midpoint<T, N, FEET> {
    /// Sets the robot in this motion: the last joint of the base that does not turn carries the rotation that its angles count from.
    #[inline(always)]
    pub(crate) fn set(&self, sweep: &mut Sweep<'_, T, N>) {
        let chart = Some((TURN - 1, &self.rot_wc));
        sweep.set([&self.q, &self.v, &self.a], chart);
    }
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    pub(crate) fn layout(&self, k: usize) -> Layout {
        let feet = self.contacts(k).iter().filter(|on| **on).count();
        let joints = if self.is_landing(k) {
            0
        } else {
            N.saturating_sub(BASE)
        };
        Layout { feet, joints }
    }

    /// Physical accelerations and forces of interval `k`, and the motion at its middle.
    #[inline(always)]
    pub(crate) fn midpoint<const NU: usize>(
        &self,
        k: usize,
        state: &State<T, N>,
        control: &[T; NU],
    ) -> Midpoint<T, N, FEET> {
        let units = Units::new();
        let layout = self.layout(k);
        let half = self.dt(k) * T::HALF;
        let mut mid = Midpoint {
            q: state.q,
            v: state.v,
            a: [T::ZERO; N],
            forces: [Vector3::zeros(); FEET],
            rot_wc: state.rot_wc,
            layout,
        };
        for (i, a) in mid.a.iter_mut().enumerate() {
            if let Some(u) = layout.acceleration(i).and_then(|u| control.get(u)) {
                *a = *u * units.acceleration;
            }
        }
        let moving = mid.q.iter_mut().zip(&mut mid.v).zip(&mid.a);
        for ((q, v), a) in moving {
            *q += half * (*v + half * *a);
            *v += half * *a;
        }
        if self.robot.turns_freely() {
            // What moved the angles turns the rotation instead.
            mid.rot_wc = state.rot_wc * so3::exp(&triple(&mid.q, TURN));
            set_triple(&mut mid.q, TURN, &Vector3::zeros());
            let joints = joint_acceleration(&triple(&mid.v, TURN), &triple(&mid.a, TURN));
            set_triple(&mut mid.a, TURN, &joints);
        }
        let (_, forces) = control.split_at(BASE.min(NU));
        let (triples, _) = forces.as_chunks::<3>();
        for (force, u) in mid.forces.iter_mut().zip(triples).take(layout.feet) {
            *force = Vector3::from(*u) * units.force;
        }
        mid
    }

    /// The middle of interval `k` as far as its base turns on SO(3).
    pub(crate) fn turn(&self, k: usize, mid: &Midpoint<T, N, FEET>) -> Option<Turn<T>> {
        let half = self.dt(k) * T::HALF;
        let (omega, joints) = (triple(&mid.v, TURN), triple(&mid.a, TURN));
        let turns = self.robot.turns_freely();
        turns.then(|| Turn::new(half, &omega, &joints))
    }

    /// Where interval `k` leads, seen from the next node, in m, rad and their rates.
    #[inline(always)]
    pub(crate) fn gap(
        &self,
        k: usize,
        state: &State<T, N>,
        mid: &Midpoint<T, N, FEET>,
        next: &State<T, N>,
    ) -> [[T; N]; 2] {
        let dt = self.dt(k);
        let mut gap = [[T::ZERO; N]; 2];
        let [of_q, of_v] = &mut gap;
        let moving = state.q.iter().zip(&mid.v).zip(&next.q);
        for (slot, ((q, v), to)) in of_q.iter_mut().zip(moving) {
            *slot = *q + dt * *v - *to;
        }
        let speeding = state.v.iter().zip(&mid.a).zip(&next.v);
        for (slot, ((v, a), to)) in of_v.iter_mut().zip(speeding) {
            *slot = *v + dt * *a - *to;
        }
        if self.robot.turns_freely() {
            let omega = triple(&mid.v, TURN);
            let reached = state.rot_wc * so3::exp(&(omega * dt));
            let turned = so3::log(&(next.rot_wc.inverse() * reached));
            set_triple(of_q, TURN, &turned);
            let alpha = angular_acceleration(&omega, &triple(&mid.a, TURN));
            let speed = triple(&state.v, TURN) + alpha * dt - triple(&next.v, TURN);
            set_triple(of_v, TURN, &speed);
        }
        gap
    }

    /// Motions of the feet in contact during interval `k`, in order, and the forces on them.
    #[inline(always)]
    pub(crate) fn contact_motions(
        &self,
        k: usize,
        sweep: &Sweep<'_, T, N>,
        mid: &Midpoint<T, N, FEET>,
    ) -> Contacts<T, FEET> {
        let mut contacts = Contacts {
            forces: mid.forces,
            count: mid.layout.feet,
            ..Contacts::NONE
        };
        let on = self.contacts(k);
        let standing = self.feet.iter().zip(&on).filter(|(_, on)| **on);
        for (slot, (foot, _)) in contacts.points.iter_mut().zip(standing) {
            *slot = sweep.point(foot.point.link, &foot.point.offset_l);
            slot.arm.z = -foot.radius;
        }
        contacts
    }
}
