//! What the caller decides about an import.

use rbd_core::BaseKind;

use crate::error::ImportError;

/// What becomes of joints that follow another one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MimicPolicy {
    /// They are joints of their own in the tree, as Pinocchio reads them by default (`mimic=False`), and the coupling is
    /// kept beside it: [`Robot::reduction`](crate::Robot::reduction) is Pinocchio's `mimic=True`.
    #[default]
    Free,
    /// They are locked where their leader stands: at its lock value, or at zero if it moves.
    Lock,
    /// They are an error unless locked by name.
    Refuse,
}

/// What becomes of moved bodies with moments of inertia that no body has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InertiaPolicy {
    /// They are an error. Links that are unphysical by themselves but not with what is fixed to them are not.
    #[default]
    Physical,
    /// They are kept, as Pinocchio keeps them, as long as the mass matrix can be inverted.
    AsWritten,
}

/// What the caller decides about an import.
#[derive(Clone, Debug)]
pub struct Options {
    /// Whether the base moves.
    pub base: BaseKind,
    /// Joints to lock, with the positions to lock them at, rad or m.
    pub locks: Vec<(String, f64)>,
    /// What becomes of mimic joints.
    pub mimic: MimicPolicy,
    /// What becomes of moments of inertia that no body has.
    pub inertia: InertiaPolicy,
    /// Largest deviation of an entry of a joint axis from ± a coordinate axis that is taken for rounding: the joint becomes an
    /// aligned one, which is cheaper than a tilted one. By default [`AXIS_EXACT`], so that no digit of the file is lost. Files
    /// that write π/2 with eleven digits need 1e-10 for aligned joints, and their dynamics change by about as much.
    pub axis_rounding: f64,
}

/// A deviation of a joint axis that only rounding in f64 explains.
pub const AXIS_EXACT: f64 = 1e-14;

impl Default for Options {
    fn default() -> Self {
        Self {
            base: BaseKind::Floating,
            locks: Vec::new(),
            mimic: MimicPolicy::default(),
            inertia: InertiaPolicy::Physical,
            axis_rounding: AXIS_EXACT,
        }
    }
}

/// Reads `joint=value`.
///
/// # Errors
/// [`ImportError::BadLock`] if it is not that, with a finite value.
pub fn parse_lock(text: &str) -> Result<(String, f64), ImportError> {
    let bad = || ImportError::BadLock {
        text: text.to_owned(),
    };
    let (joint, value) = text.split_once('=').ok_or_else(bad)?;
    let value: f64 = value.trim().parse().map_err(|_| bad())?;
    if joint.trim().is_empty() || !value.is_finite() {
        return Err(bad());
    }
    Ok((joint.trim().to_owned(), value))
}
