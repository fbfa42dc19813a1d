//! Fixed inputs: the same numbers on every machine.

use so3::Scalar;

/// A stream of numbers spread over [−1, 1): a 64-bit linear congruential generator (Knuth's MMIX constants), of which
/// the upper 24 bits are used, so that every number is exact in `f32` too.
pub(crate) struct Stream(u64);

impl Stream {
    pub(crate) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number, in [−`half_width`, `half_width`).
    pub(crate) fn next<T: Scalar>(&mut self, half_width: f64) -> T {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let unit = (self.0 >> 40) as f64 / f64::from(1_u32 << 23) - 1.0;
        T::of(unit * half_width)
    }

    /// The next `N` numbers.
    pub(crate) fn array<T: Scalar, const N: usize>(&mut self, half_width: f64) -> [T; N] {
        core::array::from_fn(|_| self.next(half_width))
    }
}
