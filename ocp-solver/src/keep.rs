//! Memory against time: whether a stage keeps its derivatives between the passes of an iteration.

use crate::linearised::Linearised;
use crate::packed::Packed;
use crate::problem::{Derivatives, Dims};
use so3::Scalar;

/// What a stage does with the derivatives of its node between the three passes of an iteration (residuals,
/// factorisation, substitution): keep them ([`Derivatives`]), keep what is not zero of them ([`Packed`]), or have them written again
/// ([`Recomputed`]).
///
/// All give the same numbers, bit for bit.
pub trait Keep<T: Scalar, const NX: usize, const NU: usize, const NI: usize>:
    Copy + Send + sealed::Sealed
{
    /// The derivatives, as the passes read them.
    #[doc(hidden)]
    type Linearised: Linearised<T, NX, NU>;

    /// Makes ready for the first call of a solve.
    #[doc(hidden)]
    fn begin(&mut self);

    /// The derivatives of a node of these sizes at the iterate, written by `fill` into `scratch`; `is_new` tells that the
    /// iterate is another one than in the call before.
    #[doc(hidden)]
    fn at<'a>(
        &'a mut self,
        scratch: &'a mut Derivatives<T, NX, NU, NI>,
        dims: Dims,
        is_new: bool,
        fill: impl FnOnce(&mut Derivatives<T, NX, NU, NI>),
    ) -> &'a Self::Linearised;

    /// What is kept of the last call, if anything is.
    #[doc(hidden)]
    fn kept(&self) -> Option<&Self::Linearised>;
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Keep<T, NX, NU, NI>
    for Derivatives<T, NX, NU, NI>
{
    type Linearised = Self;

    fn begin(&mut self) {
        *self = Self::new();
    }

    #[inline(always)]
    fn at<'a>(
        &'a mut self,
        _: &'a mut Self,
        _: Dims,
        is_new: bool,
        fill: impl FnOnce(&mut Self),
    ) -> &'a Self {
        if is_new {
            fill(self);
        }
        self
    }

    #[inline(always)]
    fn kept(&self) -> Option<&Self> {
        Some(self)
    }
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Keep<T, NX, NU, NI>
    for Packed<T, NX, NU, NI>
{
    type Linearised = Self;

    /// Nothing to do: the first call writes all that is read.
    fn begin(&mut self) {}

    #[inline(always)]
    fn at<'a>(
        &'a mut self,
        scratch: &'a mut Derivatives<T, NX, NU, NI>,
        dims: Dims,
        is_new: bool,
        fill: impl FnOnce(&mut Derivatives<T, NX, NU, NI>),
    ) -> &'a Self {
        if is_new {
            fill(scratch);
            self.pack(scratch, dims);
        }
        self
    }

    #[inline(always)]
    fn kept(&self) -> Option<&Self> {
        Some(self)
    }
}

/// Keeps nothing: derivatives are evaluated three times per iteration instead of once, into one place that
/// all nodes share. This is for microcontrollers, where memory is dearer than time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Recomputed;

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Keep<T, NX, NU, NI>
    for Recomputed
{
    type Linearised = Derivatives<T, NX, NU, NI>;

    fn begin(&mut self) {}

    #[inline(always)]
    fn at<'a>(
        &'a mut self,
        scratch: &'a mut Derivatives<T, NX, NU, NI>,
        dims: Dims,
        _: bool,
        fill: impl FnOnce(&mut Derivatives<T, NX, NU, NI>),
    ) -> &'a Derivatives<T, NX, NU, NI> {
        scratch.clear(dims.rows());
        fill(scratch);
        scratch
    }

    #[inline(always)]
    fn kept(&self) -> Option<&Derivatives<T, NX, NU, NI>> {
        None
    }
}

mod sealed {
    pub trait Sealed {}
    impl<T, const NX: usize, const NU: usize, const NI: usize> Sealed
        for super::Derivatives<T, NX, NU, NI>
    {
    }
    impl<T, const NX: usize, const NU: usize, const NI: usize> Sealed for super::Packed<T, NX, NU, NI> {}
    impl Sealed for super::Recomputed {}
}
