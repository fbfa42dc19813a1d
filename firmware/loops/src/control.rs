//! The control loop at 1 kHz.

mod icub;
mod jumper;
mod pilot;

pub use icub::Humanoid;
pub use jumper::Jumper;
pub use pilot::Pilot;

use jump_control::JointCommand;
use nalgebra::{Matrix3, Rotation3, Vector3};
use rbd_core::Transform;
use saltus_probe::{Numbers, Real};

use crate::joints::Joints;

/// What a control loop hears: numbers that the flight recorder writes down and a replay reads again.
pub trait Heard<T>: Numbers + Copy {
    /// From its numbers in the order in which they were written.
    fn read(next: impl FnMut() -> T) -> Self;
}

/// The control loop of a robot with `N` joints.
pub trait Control<T: Real, const N: usize>: Sized {
    /// What it hears every millisecond.
    type Heard: Heard<T>;
    /// Its memory, which firmware keeps in a static.
    type Memory: 'static;

    /// The memory before it is used.
    fn memory() -> Self::Memory;

    /// Before the first tick; `None` if what stands in flash is refused.
    fn new(memory: &'static mut Self::Memory) -> Option<Self>;

    /// The joint loop that goes with it, before the first command.
    fn joints() -> Joints<T, N>;

    /// One tick; the command is then [`Control::command`].
    fn tick(&mut self, heard: &Self::Heard);

    /// What the joints are to do.
    fn command(&self) -> &JointCommand<T, N>;
}

/// A pose from its twelve numbers: the rotation's matrix by columns, then the place.
fn pose<T: Real>(mut next: impl FnMut() -> T) -> Transform<T> {
    let columns: [T; 9] = core::array::from_fn(|_| next());
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(&columns));
    Transform::new(rotation, Vector3::new(next(), next(), next()))
}
