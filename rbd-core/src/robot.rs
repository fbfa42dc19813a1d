//! A robot as a controller or planner knows it: dynamics, and names, limits, frames, contacts, motors.

use so3::Scalar;

use crate::hardware::{Contact, Motor};
use crate::model::{Frame, JointLimits};
use crate::tree::Tree;

/// What a controller or planner asks of a robot beyond its dynamics.
///
/// Model crates implement it for f32 and f64 from the same tables, with [`model!`](crate::model!).
pub trait Model<T: Scalar, const N: usize>: Tree<T, N> {
    /// Name of the robot.
    fn name(&self) -> &'static str;

    /// Names of the joints, in the order of the joint coordinates.
    fn joint_names(&self) -> &'static [&'static str; N];

    /// Limits and losses of the joints.
    fn limits(&self) -> &'static [JointLimits<T>; N];

    /// Names of the frames: the links of the URDF, depth first.
    fn frame_names(&self) -> &'static [&'static str];

    /// The frames, in the order of their names.
    fn frames(&self) -> &'static [Frame<T>];

    /// What may touch the ground; empty if nobody has said.
    fn contacts(&self) -> &'static [Contact<T>] {
        &[]
    }

    /// The motors of the joints, if they are known.
    fn motors(&self) -> Option<&'static [Motor<T>; N]> {
        None
    }

    /// Index of a joint, by name.
    #[must_use]
    fn joint_index(&self, name: &str) -> Option<usize> {
        self.joint_names().iter().position(|n| *n == name)
    }

    /// A frame, by the name of its link.
    #[must_use]
    fn frame(&self, name: &str) -> Option<Frame<T>> {
        let i = self.frame_names().iter().position(|n| *n == name)?;
        self.frames().get(i).copied()
    }
}

/// Implements [`Model`](crate::Model) from tables: name, joint names, limits, frame names, frames; then, if
/// there are any, contacts; then motors.
#[macro_export]
macro_rules! model {
    (impl Model<$T:ty, $N:literal> for $Robot:ty {
        $name:path, $joint_names:path, $limits:path, $frame_names:path, $frames:path
        $(, $contacts:path $(, $motors:path)?)?
    }) => {
        impl $crate::robot::Model<$T, $N> for $Robot {
            #[inline]
            fn name(&self) -> &'static str {
                $name
            }
            #[inline]
            fn joint_names(&self) -> &'static [&'static str; $N] {
                &$joint_names
            }
            #[inline]
            fn limits(&self) -> &'static [$crate::model::JointLimits<$T>; $N] {
                &$limits
            }
            #[inline]
            fn frame_names(&self) -> &'static [&'static str] {
                &$frame_names
            }
            #[inline]
            fn frames(&self) -> &'static [$crate::model::Frame<$T>] {
                &$frames
            }
            $(
                #[inline]
                fn contacts(&self) -> &'static [$crate::hardware::Contact<$T>] {
                    &$contacts
                }
                $(
                    #[inline]
                    fn motors(&self) -> Option<&'static [$crate::hardware::Motor<$T>; $N]> {
                        Some(&$motors)
                    }
                )?
            )?
        }
    };
}
