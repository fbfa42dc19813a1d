//! Which robot a plan is for.

use rbd_core::{BaseKind, Link, Model};
use so3::Scalar;

/// A hash of everything that decides how a robot moves: bodies, limits and motors, as single precision, so that `f32` and `f64` models of
/// one robot agree. Names do not count.
///
/// FNV-1a, 64 bit: two different robots have equal hashes with a probability of 10⁻¹⁹.
#[must_use]
pub fn model_hash<T: Scalar, M: Model<T, N>, const N: usize>(model: &M) -> u64 {
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    hash.integer(N);
    hash.integer(usize::from(model.base_kind() == BaseKind::Floating));
    let base = model.base();
    hash.numbers([base.mass].iter().chain(&base.first).chain(&base.second));
    for body in model.bodies() {
        hash.integer(body.kind as usize);
        hash.integer(match body.parent {
            Link::Base => 0,
            Link::Joint(i) => i.saturating_add(1),
        });
        let own = [body.sign, body.mass, body.rotor_inertia];
        hash.numbers(own.iter().chain(&body.offset).chain(&body.first));
        hash.numbers(body.tilt.iter().flatten().chain(&body.second));
    }
    for limit in model.limits() {
        hash.numbers(&[limit.lower, limit.upper, limit.speed]);
        hash.numbers(&[limit.effort, limit.damping, limit.friction]);
    }
    for motor in model.motors().into_iter().flatten() {
        hash.numbers(&[motor.torque, motor.corner_speed, motor.no_load_speed]);
    }
    hash.0
}

/// The running hash.
struct Fnv(u64);

impl Fnv {
    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    fn integer(&mut self, x: usize) {
        self.bytes(&(x as u32).to_le_bytes());
    }

    fn numbers<'a, T: Scalar>(&mut self, numbers: impl IntoIterator<Item = &'a T>) {
        for x in numbers {
            // Minus zero is zero.
            let x = x.to_f64() as f32 + 0.0;
            self.bytes(&x.to_le_bytes());
        }
    }
}
