//! The one door to a plant.

use nalgebra::Vector3;
use rbd_core::{Configuration, Tangent};
use so3::Scalar;

/// A plant with `N` joints and `C` owners of shapes that advances one tick at a time.
pub trait Simulator<T: Scalar, const N: usize, const C: usize> {
    /// What can go wrong in a step.
    type Error;

    /// Puts the robot somewhere, at time zero and without contact history.
    fn reset(&mut self, configuration: &Configuration<T, N>, velocity: &Tangent<T, N>);

    /// Advances one tick with these joint torque commands, N m, held.
    ///
    /// # Errors
    /// Commands that are not finite, or a state that is no longer finite.
    fn step(&mut self, command: &[T; N]) -> Result<(), Self::Error>;

    /// Length of a tick, s.
    fn tick(&self) -> T;

    /// Time since the reset, s.
    fn time(&self) -> T;

    /// Where the robot is.
    fn configuration(&self) -> &Configuration<T, N>;

    /// How it moves.
    fn velocity(&self) -> &Tangent<T, N>;

    /// Torques that the motors delivered in the last step, N m.
    fn delivered(&self) -> &[T; N];

    /// Force of the ground on each owner of shapes, averaged over the last tick, world axes, N.
    fn contact_forces_w(&self) -> &[Vector3<T>; C];

    /// How hard other links of the robot press on each owner, averaged over the last tick, N: sizes of forces, added up.
    fn link_forces(&self) -> &[T; C];

    /// Torques of the joints' stops in the last step, N m.
    fn stop_torques(&self) -> &[T; N];
}
