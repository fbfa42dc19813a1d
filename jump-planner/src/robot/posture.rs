//! Where a quadruped's legs stand.

use super::{JOINTS, LEGS, Quadruped};
use nalgebra::{Matrix3, Matrix6, Matrix6x3, Vector3, Vector6};
use rbd_core::{
    Axes, CentroidalMap, Configuration, Force, Frame, FrameJacobian, Kinematics, Model, Posture,
    Transform, center_of_mass, centroidal_map, forward_kinematics, frame_jacobian,
    generalized_gravity,
};

/// Configuration of a quadruped.
pub type State = Configuration<f64, JOINTS>;

/// Foot below its hip in the pre-landing posture, as a share of the leg.
const LANDING_LEG: f64 = 0.725;
/// Foot outside its hip in the pre-landing posture, as a share of the leg.
const LANDING_WIDTH: f64 = 0.1;
/// Foot below its hip in folded legs, as a share of the leg: knees of A1 are 0.38 rad from their stops.
const FOLDED_LEG: f64 = 0.4;
/// How far joints may be beyond their limits in a posture, rad: round-off of solved postures.
const SLACK: f64 = 1e-9;

/// What keeps a robot standing.
pub struct Holding {
    /// Joint torques, N m.
    pub torques: [f64; JOINTS],
    /// Force of the ground on every foot, world, N.
    pub forces_w: [Vector3<f64>; LEGS],
}

impl Quadruped {
    /// Poses of all links.
    #[must_use]
    pub fn poses(&self, q: &State) -> Kinematics<f64, JOINTS> {
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(self, &Posture::new(self, q), &mut kinematics);
        kinematics
    }

    /// Centre of mass in the world, m.
    #[must_use]
    pub fn com(&self, q: &State) -> Vector3<f64> {
        center_of_mass(self, &Posture::new(self, q)).position_w
    }

    /// Rotational inertia about the centre of mass with the joints locked, world axes, kg m².
    #[must_use]
    pub fn locked_inertia(&self, q: &State) -> Matrix3<f64> {
        let mut map = CentroidalMap::ZERO;
        centroidal_map(self, &Posture::new(self, q), &mut map);
        map.locked_inertia_w.to_matrix()
    }

    /// Jacobian of a frame, world axes.
    #[must_use]
    pub fn jacobian(
        &self,
        kinematics: &Kinematics<f64, JOINTS>,
        frame: &Frame<f64>,
    ) -> FrameJacobian<f64, JOINTS> {
        let mut j = FrameJacobian::ZERO;
        frame_jacobian(self, kinematics, frame, Axes::LocalWorldAligned, &mut j);
        j
    }

    /// Where a foot's ball touches level ground, as a frame of its link.
    #[must_use]
    pub fn contact_frame(&self, kinematics: &Kinematics<f64, JOINTS>, leg: usize) -> Frame<f64> {
        let mut frame = self.feet[leg];
        let rot_wl = kinematics.link(frame.link).rotation;
        let down = rot_wl.inverse() * Vector3::new(0.0, 0.0, -self.foot_radius);
        frame.offset = (Vector3::from(frame.offset) + down).into();
        frame
    }

    /// Joints that put the balls of the feet at `targets_w`, by damped Newton steps from `q`; the base stays.
    ///
    /// # Errors
    /// Legs that cannot reach, with the distance.
    pub fn place_feet(
        &self,
        mut q: State,
        targets_w: &[Vector3<f64>; LEGS],
    ) -> Result<State, String> {
        let mut worst = f64::INFINITY;
        for _ in 0..60 {
            let kinematics = self.poses(&q);
            worst = 0.0;
            for (leg, frame) in self.feet.iter().enumerate() {
                let error = targets_w[leg] - kinematics.frame(frame).translation;
                worst = f64::max(worst, error.norm());
                let j = self.jacobian(&kinematics, frame);
                let j = Matrix3::from_fn(|row, column| j.joints[3 * leg + column].linear[row]);
                let damped = j * j.transpose() + Matrix3::identity() * 1e-6;
                let step = damped.try_inverse().ok_or("singular leg")? * error;
                let step = j.transpose() * step;
                let scale = 0.3 / f64::max(0.3, step.amax());
                for (q, d) in q.joints[3 * leg..3 * leg + 3].iter_mut().zip(step.iter()) {
                    *q += scale * d;
                }
            }
            if worst < 1e-10 {
                return Ok(q);
            }
        }
        Err(format!(
            "the legs miss their places by {:.1} mm: out of reach",
            worst * 1e3
        ))
    }

    /// The robot with its legs near a standing posture.
    #[must_use]
    pub fn near(&self, base: Transform<f64>) -> State {
        State {
            base,
            joints: self.seed,
        }
    }

    /// A standing robot with its centre of mass at `com_w` and its balls over `points_w`, base level.
    ///
    /// # Errors
    /// No such posture, or one outside the joints' limits, with the joint.
    pub fn stand(
        &self,
        com_w: &Vector3<f64>,
        points_w: &[Vector3<f64>; LEGS],
    ) -> Result<State, String> {
        let mut q = self.near(Transform::IDENTITY);
        q.base.translation = *com_w;
        let targets = points_w.map(|p| p + Vector3::new(0.0, 0.0, self.foot_radius));
        for _ in 0..40 {
            q = self.place_feet(q, &targets)?;
            let error = com_w - self.com(&q);
            if error.norm() < 1e-9 {
                return self.within_limits(q);
            }
            q.base.translation += error;
        }
        Err("no standing posture with this centre of mass".into())
    }

    /// Joints of the pre-landing posture: feet below and outside the hips.
    ///
    /// # Errors
    /// As [`Quadruped::stand`].
    pub(crate) fn landing_joints(&self, near: &State) -> Result<[f64; JOINTS], String> {
        self.joints_with(near, &self.landing_feet())
    }

    /// Joints of folded legs: the feet drawn up below where they land.
    ///
    /// # Errors
    /// As [`Quadruped::stand`].
    pub(crate) fn folded_joints(&self, near: &State) -> Result<[f64; JOINTS], String> {
        self.joints_with(near, &self.feet_below(FOLDED_LEG))
    }

    /// Joints that put the feet there, in base axes from the base's origin, m.
    fn joints_with(
        &self,
        near: &State,
        feet_b: &[Vector3<f64>; LEGS],
    ) -> Result<[f64; JOINTS], String> {
        let q = State {
            base: Transform::IDENTITY,
            joints: near.joints,
        };
        let q = self.place_feet(q, feet_b)?;
        Ok(self.within_limits(q)?.joints)
    }

    /// Feet in the pre-landing posture, in base axes from the base's origin, m.
    pub(crate) fn landing_feet(&self) -> [Vector3<f64>; LEGS] {
        self.feet_below(LANDING_LEG)
    }

    /// Feet outside the hips and below them by this share of the leg, in base axes from the base's origin, m.
    fn feet_below(&self, share: f64) -> [Vector3<f64>; LEGS] {
        let width = LANDING_WIDTH * self.leg_length;
        self.hips.map(|hip| {
            Vector3::new(
                hip.x,
                hip.y + width * hip.y.signum(),
                hip.z - share * self.leg_length,
            )
        })
    }

    fn within_limits(&self, q: State) -> Result<State, String> {
        let limits = Model::limits(self).iter().zip(&q.joints);
        let beyond = limits
            .enumerate()
            .find(|(_, (limit, x))| **x < limit.lower - SLACK || **x > limit.upper + SLACK);
        match beyond {
            None => Ok(q),
            Some((i, (limit, x))) => Err(format!(
                "joint {} would stand at {x:.3} rad, outside its limits {:.3} to {:.3}",
                Model::joint_names(self)[i],
                limit.lower,
                limit.upper
            )),
        }
    }

    /// Torques and forces of least norm that hold the robot at rest on all feet.
    ///
    /// # Errors
    /// Feet that cannot carry.
    pub fn holding(&self, q: &State) -> Result<Holding, String> {
        let kinematics = self.poses(q);
        let gravity = generalized_gravity(self, &Posture::new(self, q));
        let jacobians: [_; LEGS] = core::array::from_fn(|leg| {
            self.jacobian(&kinematics, &self.contact_frame(&kinematics, leg))
        });
        let maps = jacobians
            .each_ref()
            .map(|j| Matrix6x3::from_fn(|row, axis| j.base[row].linear[axis]));
        let mut gram = Matrix6::identity() * 1e-9;
        for map in &maps {
            gram += map * map.transpose();
        }
        let inverse = gram.try_inverse().ok_or("feet that cannot carry")?;
        let weight = inverse * Vector6::from(gravity.base.to_array());
        let forces_w = maps.map(|map| map.transpose() * weight);
        let mut torques = gravity.joints;
        for (j, f) in jacobians.iter().zip(&forces_w) {
            let pushed = j.tr_mul(&Force::new(*f, Vector3::zeros())).joints;
            for (torque, share) in torques.iter_mut().zip(pushed) {
                *torque -= share;
            }
        }
        Ok(Holding { torques, forces_w })
    }
}
