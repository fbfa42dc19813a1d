//! Kinematics of A1: poses, and leg velocities under a moving body.

use super::{FOOT_COUNT, JOINTS, ROBOT, State, Velocity, feet};
use a1_model::FOOT_RADIUS;
use nalgebra::{Matrix3, Vector3};
use rbd_core::{
    Axes, CentroidalMap, Force, Frame, FrameJacobian, Kinematics, Motion, Posture, center_of_mass,
    centroidal_map, centroidal_state, forward_kinematics, frame_jacobian,
};

/// Poses of all links.
pub(crate) fn poses(q: &State) -> Kinematics<f64, JOINTS> {
    let mut kinematics = Kinematics::IDENTITY;
    forward_kinematics(&ROBOT, &Posture::new(&ROBOT, q), &mut kinematics);
    kinematics
}

/// Centre of mass in the world.
pub(crate) fn com(q: &State) -> Vector3<f64> {
    center_of_mass(&ROBOT, &Posture::new(&ROBOT, q)).position_w
}

/// Jacobian of a frame, linear part in world axes.
pub(crate) fn jacobian(
    kinematics: &Kinematics<f64, JOINTS>,
    frame: &Frame<f64>,
) -> FrameJacobian<f64, JOINTS> {
    let mut j = FrameJacobian::ZERO;
    frame_jacobian(&ROBOT, kinematics, frame, Axes::LocalWorldAligned, &mut j);
    j
}

/// The three columns of a leg.
fn leg_columns(j: &FrameJacobian<f64, JOINTS>, leg: usize) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| j.joints[3 * leg + column].linear[row])
}

/// Where a foot's ball touches level ground, as a frame of its link.
pub(crate) fn contact_frame(kinematics: &Kinematics<f64, JOINTS>, leg: usize) -> Frame<f64> {
    let mut frame = feet()[leg];
    let rot_wl = kinematics.link(frame.link).rotation;
    let down = rot_wl.inverse() * Vector3::new(0.0, 0.0, -FOOT_RADIUS);
    frame.offset = (Vector3::from(frame.offset) + down).into();
    frame
}

/// Angular velocity, base axes, of a robot that has this angular momentum about its centre of mass, world axes, and turns as one body.
pub(crate) fn locked(q: &State, momentum_w: &Vector3<f64>) -> Vector3<f64> {
    let mut map = CentroidalMap::ZERO;
    centroidal_map(&ROBOT, &Posture::new(&ROBOT, q), &mut map);
    let momentum = Force::new(Vector3::zeros(), *momentum_w);
    q.base.rotation.inverse() * map.locked_angular_velocity(&momentum)
}

/// The velocity of the whole robot whose centre of mass moves with `com_velocity_w` and which has this angular momentum, while the
/// balls of the feet in `stance` roll without slip and the other joints move with `swing`.
///
/// Found by fixed-point steps on the base's velocity: the legs are lighter than the rest.
pub(crate) fn rolling_velocity(
    q: &State,
    stance: &[bool; FOOT_COUNT],
    com_velocity_w: &Vector3<f64>,
    momentum_w: &Vector3<f64>,
    swing: &[f64; JOINTS],
) -> Result<Velocity, String> {
    let kinematics = poses(q);
    let posture = Posture::new(&ROBOT, q);
    let to_base = q.base.rotation.inverse();
    let legs: Vec<_> = (0..FOOT_COUNT)
        .map(|leg| {
            let j = jacobian(&kinematics, &contact_frame(&kinematics, leg));
            (j, leg_columns(&j, leg).try_inverse())
        })
        .collect();
    let mut map = CentroidalMap::ZERO;
    centroidal_map(&ROBOT, &posture, &mut map);
    let mut velocity = Velocity {
        base: Motion::new(to_base * com_velocity_w, Vector3::zeros()),
        joints: *swing,
    };
    for _ in 0..200 {
        for (leg, (j, inverse)) in legs.iter().enumerate().filter(|(leg, _)| stance[*leg]) {
            let base_only = Velocity {
                base: velocity.base,
                joints: [0.0; JOINTS],
            };
            let inverse = inverse.ok_or("a stance leg is stretched out")?;
            let qd = -(inverse * j.mul(&base_only).linear);
            velocity.joints[3 * leg..3 * leg + 3].copy_from_slice(qd.as_slice());
        }
        let now = centroidal_state(&ROBOT, &posture, &velocity);
        let missing = Force::new(Vector3::zeros(), momentum_w - now.momentum_w.angular);
        let faster = to_base * map.locked_angular_velocity(&missing);
        let shift = to_base * (com_velocity_w - now.com_velocity_w);
        if shift.norm() < 1e-9 && faster.norm() < 1e-9 {
            return Ok(velocity);
        }
        velocity.base.linear += shift;
        velocity.base.angular += faster;
    }
    Err("no whole-body velocity for this motion of the centre of mass".into())
}
