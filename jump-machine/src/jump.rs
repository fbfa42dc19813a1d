//! What a jump is made of, and why one is not begun.

use core::fmt;

use jump_control::Plan;
use jump_control::container::{Container, ContainerError};
use nalgebra::{Rotation3, Vector3};
use so3::Scalar;

/// One jump: a plan and where it is to end.
#[derive(Clone, Copy, Debug)]
pub struct Jump<'a, T: Scalar, const N: usize, const F: usize> {
    /// Push-off and flight. Its first node is held until the start: its torques should be those of standing still.
    pub plan: Plan<'a, T, N, F>,
    /// Orientation of the base at rest.
    pub rot_goal: Rotation3<T>,
    /// Joint positions in which the legs meet the ground, body level, rad.
    pub landing_joints: [T; N],
}

impl<'a, T: Scalar, const N: usize, const F: usize> Jump<'a, T, N, F> {
    /// The jump of a stored plan, which stays where it is: its bytes are what is flown.
    ///
    /// # Errors
    /// [`ContainerError::Value`] names the first number that cannot be.
    pub fn stored(container: &Container<'a, N, F>) -> Result<Self, ContainerError> {
        let (header, number) = (container.header(), |x: f32| T::of(f64::from(x)));
        Ok(Self {
            plan: Plan::stored(container)?,
            rot_goal: so3::exp(&Vector3::new(T::ZERO, T::ZERO, number(header.heading))),
            landing_joints: header.landing_joints.map(number),
        })
    }
}

/// Why a jump was not begun; the robot goes on standing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// The robot does not stand: it holds for another jump, is under way, or has aborted.
    NotStanding,
    /// The base is tilted further than that of a robot on its feet: it lies, or leans on something.
    Tilted,
    /// The start is not a number, or leaves less time than holding still, weighing, the push-off's gains and moving the trunk take.
    TooLate,
    /// At the start this joint was not where the plan begins.
    Posture(usize),
    /// The feet are not where the jump begins.
    Place,
    /// A number of the jump is not finite.
    NotFinite,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotStanding => f.write_str("the robot does not stand: wait until it does"),
            Self::Tilted => f.write_str("the base is tilted: set the robot on its feet"),
            Self::TooLate => {
                f.write_str("the plan came too late for its start: choose a later one")
            }
            Self::Posture(joint) => write!(
                f,
                "joint {joint} is not where the plan begins: plan from where the robot stands"
            ),
            Self::Place => f.write_str(
                "the feet are not where the jump begins: give it the place where the robot stands",
            ),
            Self::NotFinite => f.write_str("a number of the jump is not finite"),
        }
    }
}

impl core::error::Error for Refusal {}
