//! Memory against time: whether a stage keeps its derivatives between the passes of an iteration.

use crate::problem::Derivatives;
use so3::Scalar;

/// What a stage does with the derivatives of its node between the three passes of an iteration (residuals,
/// factorisation, substitution): keep them ([`Derivatives`]), or have them written again ([`Recomputed`]).
///
/// Both give the same numbers, bit for bit.
pub trait Keep<T, const NX: usize, const NU: usize, const NI: usize>:
    Copy + sealed::Sealed
{
    /// What one solve needs besides the stages; on the stack of the solve.
    #[doc(hidden)]
    type Scratch;

    /// Nothing kept yet.
    #[doc(hidden)]
    const EMPTY: Self;

    /// Scratch before its first use.
    #[doc(hidden)]
    const SCRATCH: Self::Scratch;

    /// The derivatives at the iterate, written by `fill`; `is_new` tells that the iterate is another one than
    /// in the call before.
    #[doc(hidden)]
    fn at<'a>(
        &'a mut self,
        scratch: &'a mut Self::Scratch,
        is_new: bool,
        fill: impl FnOnce(&mut Derivatives<T, NX, NU, NI>),
    ) -> &'a Derivatives<T, NX, NU, NI>;
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Keep<T, NX, NU, NI>
    for Derivatives<T, NX, NU, NI>
{
    type Scratch = ();
    const EMPTY: Self = Self::new();
    const SCRATCH: Self::Scratch = ();

    #[inline(always)]
    fn at<'a>(
        &'a mut self,
        (): &'a mut Self::Scratch,
        is_new: bool,
        fill: impl FnOnce(&mut Derivatives<T, NX, NU, NI>),
    ) -> &'a Derivatives<T, NX, NU, NI> {
        if is_new {
            fill(self);
        }
        self
    }
}

/// Keeps nothing: derivatives are evaluated three times per iteration instead of once, into one place that
/// all nodes share. This is for microcontrollers, where memory is dearer than time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Recomputed;

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Keep<T, NX, NU, NI>
    for Recomputed
{
    type Scratch = Derivatives<T, NX, NU, NI>;
    const EMPTY: Self = Self;
    const SCRATCH: Self::Scratch = Derivatives::new();

    #[inline(always)]
    fn at<'a>(
        &'a mut self,
        scratch: &'a mut Self::Scratch,
        _: bool,
        fill: impl FnOnce(&mut Derivatives<T, NX, NU, NI>),
    ) -> &'a Derivatives<T, NX, NU, NI> {
        // The last node's pattern may be another one.
        *scratch = Derivatives::new();
        fill(scratch);
        scratch
    }
}

mod sealed {
    pub trait Sealed {}
    impl<T, const NX: usize, const NU: usize, const NI: usize> Sealed
        for crate::problem::Derivatives<T, NX, NU, NI>
    {
    }
    impl Sealed for super::Recomputed {}
}
