//! Random states of iCub.
#![allow(dead_code, unreachable_pub, reason = "each test file uses a part")]
#![allow(missing_docs, reason = "tests")]

use icub_model::{Icub23, LIMITS};
use nalgebra::Vector3;
use rbd_core::{Configuration, Motion, Tangent, Transform};
use wbc_qp::Snapshot;

pub const N: usize = 23;

/// Numbers in [−1, 1), the same on every machine.
pub struct Rng(pub u64);

impl Rng {
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        2.0 * ((self.0 >> 11) as f64 / (1u64 << 53) as f64) - 1.0
    }

    pub fn state(&mut self) -> (Configuration<f64, N>, Tangent<f64, N>) {
        let turn = Vector3::new(self.next(), self.next(), self.next());
        let mut q = Configuration {
            base: Transform::new(so3::exp(&turn), Vector3::new(self.next(), self.next(), 0.5)),
            joints: [0.0; N],
        };
        for (x, limits) in q.joints.iter_mut().zip(&LIMITS) {
            let middle = 0.5 * (limits.lower + limits.upper);
            *x = middle + 0.4 * self.next() * (limits.upper - limits.lower);
        }
        let mut v = Tangent::ZERO;
        v.base = Motion::from_array(core::array::from_fn(|_| self.next()));
        v.joints = core::array::from_fn(|_| self.next());
        (q, v)
    }
}

pub fn snapshot(q: &Configuration<f64, N>, v: &Tangent<f64, N>) -> Snapshot<f64, N> {
    let mut s = Snapshot::ZERO;
    s.update(&Icub23, q, v);
    s
}
