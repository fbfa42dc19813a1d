//! A humanoid's jump (paper B): push-off by a program of velocities or torques, a minimum-jerk flight, a landing by a torque program or
//! by servos, and standing again.

mod aerial;
mod event;
mod jump;
mod machine;
mod push_off;
mod recovery;
mod settings;
mod stance;
mod work;
mod workspace;

pub use jump::Jump;
pub use machine::Machine;
pub use settings::{Landing, PushOff, Settings};
pub use stance::{middle_of_feet, on_the_floor};
pub use work::{Solved, Work};
pub use workspace::Workspace;
