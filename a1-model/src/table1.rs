//! Table I of the jumping paper (paper A): a single rigid body of 12 kg and the legs' geometry, literally.
//!
//! These numbers are another robot than [`crate::A1`]: the inertia is a trunk's, the mass the whole robot's,
//! and "total leg mass" (4.71 kg) is what the published URDF's *trunk* weighs. Do not mix them.

/// Mass of the robot, kg.
pub const MASS: f64 = 12.0;

/// Inertia of the single rigid body about its centre of mass, about x, y, z, kg m² ("trunk inertia").
pub const INERTIA: [f64; 3] = [0.017, 0.056, 0.065];

/// "Total leg mass", kg.
pub const LEG_MASS: f64 = 4.71;

/// Length, width and height of the trunk, m. The length is the distance between front and rear hips.
pub const TRUNK: [f64; 3] = [0.361, 0.194, 0.114];

/// Hip link length l1, m. (The URDF and the reference problems have 0.0838.)
pub const HIP_LINK: f64 = 0.083;

/// Thigh and calf lengths l2 and l3, m.
pub const LEG_LINKS: [f64; 2] = [0.2, 0.2];

/// Gear ratio of every joint.
pub const GEAR: f64 = 9.0;

/// Largest joint torque, N m.
pub const TORQUE: f64 = 33.5;

/// Largest joint speed, rad/s.
pub const SPEED: f64 = 21.0;

/// Ranges of hip, thigh and knee, degrees (section II).
pub const RANGES_DEG: [[f64; 2]; 3] = [[-46.0, 46.0], [-60.0, 240.0], [-154.5, -52.5]];
