//! What a robot touches the ground with and what drives its joints.

use so3::{Scalar, math};

use crate::model::{Body, Frame};

/// The shape of a foot or sole, in its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactShape<T> {
    /// A ball around the frame's origin: touches the ground in one point, which rolls.
    Sphere {
        /// Radius, m.
        radius: T,
    },
    /// A flat rectangle in the frame's xy plane, facing −z.
    Rectangle {
        /// Lowest and highest x, m.
        x: [T; 2],
        /// Lowest and highest y, m.
        y: [T; 2],
    },
}

/// Something that may touch the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T> {
    /// Name of its frame.
    pub name: &'static str,
    /// Where it is.
    pub frame: Frame<T>,
    /// Its shape.
    pub shape: ContactShape<T>,
}

impl Contact<f64> {
    /// The same contact in single precision.
    #[must_use]
    pub const fn to_f32(&self) -> Contact<f32> {
        Contact {
            name: self.name,
            frame: self.frame.to_f32(),
            shape: match self.shape {
                ContactShape::Sphere { radius } => ContactShape::Sphere {
                    radius: radius as f32,
                },
                ContactShape::Rectangle { x, y } => ContactShape::Rectangle {
                    x: [x[0] as f32, x[1] as f32],
                    y: [y[0] as f32, y[1] as f32],
                },
            },
        }
    }
}

/// A joint's motor and gear, seen from the joint.
///
/// The largest driving torque is constant up to a speed and then falls on a line to zero, as the supply
/// voltage runs out:
///
/// ```text
/// torque ├────────┐
///        │         \
///      0 └────────┴──┴── speed
///            corner   no load
/// ```
///
/// Against the motion the full torque is there at any speed: the back-EMF helps to brake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor<T> {
    /// Turns of the motor per turn of the joint.
    pub gear: T,
    /// Largest torque, N m.
    pub torque: T,
    /// Speed up to which that torque can drive, rad/s.
    pub corner_speed: T,
    /// Speed at which nothing is left to drive, rad/s.
    pub no_load_speed: T,
    /// Inertia of the rotor as the joint feels it: gear² × rotor inertia, kg m².
    pub rotor_inertia: T,
}

impl<T: Scalar> Motor<T> {
    /// Lowest and highest torque at a joint speed, N m. A NaN speed gives [0, 0].
    #[must_use]
    pub fn torque_range(&self, speed: T) -> [T; 2] {
        let driving = self.driving_torque(math::abs(speed));
        if speed > T::ZERO {
            [-self.torque, driving]
        } else if speed <= T::ZERO {
            [-driving, self.torque]
        } else {
            [T::ZERO; 2]
        }
    }

    /// Largest torque in the direction of motion at a speed ≥ 0.
    fn driving_torque(&self, speed: T) -> T {
        if speed <= self.corner_speed {
            self.torque
        } else if speed < self.no_load_speed {
            let slope = self.torque / (self.no_load_speed - self.corner_speed);
            slope * (self.no_load_speed - speed)
        } else {
            T::ZERO
        }
    }
}

impl Motor<f64> {
    /// The same motor in single precision.
    #[must_use]
    pub const fn to_f32(&self) -> Motor<f32> {
        Motor {
            gear: self.gear as f32,
            torque: self.torque as f32,
            corner_speed: self.corner_speed as f32,
            no_load_speed: self.no_load_speed as f32,
            rotor_inertia: self.rotor_inertia as f32,
        }
    }
}

/// What a robot's hardware may be asked for in one jump, each figure with its source where it is set.
///
/// A limit that is exceeded does not mean that the robot breaks at once; it means that nobody would put this jump on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budgets {
    /// Longest time in which a motor gives all it has, s: in the push-off, in flight, in the landing.
    pub saturation: [f64; 3],
    /// Longest time in which a joint presses on its stop, s.
    pub stop_time: f64,
    /// Largest torque of a joint's stop, N m.
    pub stop_torque: f64,
    /// Longest time in which a joint is faster than its limit, s.
    pub overspeed: f64,
    /// Largest mean over 10 ms of the ground's force on the whole robot, in its weights.
    pub ground_force: f64,
    /// Heat that a motor's winding takes up before it is too hot, J.
    pub winding_heat: f64,
    /// Torque constant of the motors at the motor's shaft, N m/A.
    pub torque_constant: f64,
    /// Resistance of a motor's winding, Ω.
    pub resistance: f64,
    /// Largest mean over 10 ms of the power that the supply gives, W; infinite where nobody knows.
    pub supply_power: f64,
}

/// Bodies whose joints feel the rotors of these motors, for `static` items of model crates.
#[must_use]
pub const fn with_rotors<const N: usize>(
    bodies: &[Body<f64>; N],
    motors: &[Motor<f64>; N],
) -> [Body<f64>; N] {
    let mut out = *bodies;
    let mut i = 0;
    while i < N {
        out[i].rotor_inertia = motors[i].rotor_inertia;
        i += 1;
    }
    out
}

/// Motors in single precision, for `static` items of model crates.
#[must_use]
pub const fn motors_f32<const N: usize>(motors: &[Motor<f64>; N]) -> [Motor<f32>; N] {
    let mut out = [Motor {
        gear: 0.0,
        torque: 0.0,
        corner_speed: 0.0,
        no_load_speed: 0.0,
        rotor_inertia: 0.0,
    }; N];
    let mut i = 0;
    while i < N {
        out[i] = motors[i].to_f32();
        i += 1;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::Motor;

    const MOTOR: Motor<f64> = Motor {
        gear: 9.0,
        torque: 30.0,
        corner_speed: 10.0,
        no_load_speed: 20.0,
        rotor_inertia: 0.01,
    };

    #[test]
    fn torque_falls_on_a_line_in_the_direction_of_motion_only() {
        for (speed, drive) in [
            (0.0, 30.0),
            (10.0, 30.0),
            (15.0, 15.0),
            (20.0, 0.0),
            (40.0, 0.0),
        ] {
            assert_eq!(MOTOR.torque_range(speed)[1], drive, "at {speed}");
            assert_eq!(MOTOR.torque_range(-speed)[0], -drive, "at -{speed}");
            if speed > 0.0 {
                assert_eq!(MOTOR.torque_range(speed)[0], -30.0);
                assert_eq!(MOTOR.torque_range(-speed)[1], 30.0);
            }
        }
        assert_eq!(MOTOR.torque_range(f64::NAN), [0.0; 2]);
    }
}
