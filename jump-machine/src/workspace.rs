//! What a quadruped's machine keeps from tick to tick and is lent.

use landing::Workspace as Landing;
use so3::Scalar;

use crate::regulator::Regulator;

/// Memory of the machine, which borrows it, so that it can be a static.
#[derive(Clone, Debug)]
pub struct Workspace<T: Scalar, const N: usize, const F: usize> {
    /// Of the landing's program.
    pub landing: Landing<T, N, F>,
    /// Gains of the push-off.
    pub regulator: Regulator<T>,
}

impl<T: Scalar, const N: usize, const F: usize> Workspace<T, N, F> {
    /// Nothing is remembered.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            landing: Landing::new(),
            regulator: Regulator::new(),
        }
    }
}

impl<T: Scalar, const N: usize, const F: usize> Default for Workspace<T, N, F> {
    fn default() -> Self {
        Self::new()
    }
}
