//! Polynomials of the kernels.

/// c0 + c1 z + c2 z² + …, in pairs: half the latency of Horner's scheme.
macro_rules! polynomial {
    ($z:ident, $z2:ident; $c0:expr, $c1:expr) => { $c0 + $c1 * $z };
    ($z:ident, $z2:ident; $c0:expr, $c1:expr, $c2:expr) => { ($c0 + $c1 * $z) + $c2 * $z2 };
    ($z:ident, $z2:ident; $c0:expr, $c1:expr, $($c:expr),+) => {
        ($c0 + $c1 * $z) + $z2 * (polynomial!($z, $z2; $($c),+))
    };
}

pub(crate) use polynomial;
