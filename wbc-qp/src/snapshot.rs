//! What tasks and contacts are computed from: the state of the robot, evaluated once per tick.

use nalgebra::Vector3;
use rbd_core::{
    BodyMotions, CentroidalMap, Configuration, Force, Frame, Kinematics, Posture, Tangent,
    Transform, Tree, bias_accelerations, centroidal_bias, centroidal_map, forward_kinematics,
};
use so3::Scalar;

/// A robot's state with everything that several tasks share: poses, motions, centroidal map.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<T: Scalar, const N: usize> {
    /// Configuration.
    pub configuration: Configuration<T, N>,
    /// Generalised velocity ν.
    pub velocity: Tangent<T, N>,
    /// Sines and cosines of the joints.
    pub posture: Posture<T, N>,
    /// Poses of the bodies.
    pub kinematics: Kinematics<T, N>,
    /// Velocities and bias accelerations of the bodies.
    pub motions: BodyMotions<T, N>,
    /// Centroidal map A_G, mass, centre of mass, locked inertia.
    pub centroidal: CentroidalMap<T, N>,
    /// A_G ν: linear momentum, and angular momentum about the centre of mass, world axes.
    pub momentum_w: Force<T>,
    /// Ȧ_G ν.
    pub momentum_bias_w: Force<T>,
}

impl<T: Scalar, const N: usize> Snapshot<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = Self {
        configuration: Configuration::NEUTRAL,
        velocity: Tangent::ZERO,
        posture: Posture::ZERO,
        kinematics: Kinematics::IDENTITY,
        motions: BodyMotions::ZERO,
        centroidal: CentroidalMap::ZERO,
        momentum_w: Force::ZERO,
        momentum_bias_w: Force::ZERO,
    };

    /// Evaluates a state.
    pub fn update<M: Tree<T, N>>(
        &mut self,
        model: &M,
        configuration: &Configuration<T, N>,
        velocity: &Tangent<T, N>,
    ) {
        self.configuration = *configuration;
        self.velocity = *velocity;
        self.posture = Posture::new(model, configuration);
        forward_kinematics(model, &self.posture, &mut self.kinematics);
        bias_accelerations(model, &self.posture, velocity, &mut self.motions);
        centroidal_map(model, &self.posture, &mut self.centroidal);
        self.momentum_w = self.centroidal.momentum(velocity);
        self.momentum_bias_w = centroidal_bias(model, &self.posture, velocity);
    }

    /// Centre of mass in the world, m.
    #[must_use]
    pub const fn com_w(&self) -> Vector3<T> {
        self.centroidal.com_w
    }

    /// Velocity of the centre of mass in the world, m/s.
    #[must_use]
    pub fn com_velocity_w(&self) -> Vector3<T> {
        self.momentum_w.linear / self.centroidal.mass
    }

    /// Angular velocity that the robot would have if its joints locked at once, world axes, rad/s
    /// (paper B, II-C).
    #[must_use]
    pub fn locked_angular_velocity_w(&self) -> Vector3<T> {
        self.centroidal.locked_angular_velocity(&self.momentum_w)
    }

    /// Pose of a frame in the world.
    #[must_use]
    pub fn pose(&self, frame: &Frame<T>) -> Transform<T> {
        self.kinematics.frame(frame)
    }
}

impl<T: Scalar, const N: usize> Default for Snapshot<T, N> {
    fn default() -> Self {
        Self::ZERO
    }
}
