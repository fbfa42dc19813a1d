//! What the legs say of the velocity: with it, a foot that stands does stand.

use a1_model::FEET;
use nalgebra::Vector3;
use proptest::prelude::*;
use rbd_core::{Contact, ContactShape};
use state_est::Foot;

use crate::common::{config, rotation, vector, world};

proptest! {
    #![proptest_config(config(128, 11))]

    /// Moved on with the estimated velocity, the lowest point of a ball's material rests, however the leg moves and the ball rolls.
    #[test]
    fn the_lowest_point_of_a_ball_rests(world in world(), leg in 0..4_usize, radius in 0.0..0.2_f64) {
        let foot = Foot { radius, ..Foot::of(&FEET[leg]) };
        let estimate = world.by_foot(foot);
        prop_assert!((estimate.velocity.angular - world.omega_b).amax() < 1e-12);
        let h = 1e-5;
        let [before, after] = [-h, h].map(|dt| {
            world.after(&estimate.velocity.linear, dt).pose_of(&foot.frame)
        });
        let centre = (after.translation - before.translation) / (2.0 * h);
        let turning = so3::log(&(after.rotation * before.rotation.inverse())) / (2.0 * h);
        let rest = centre - turning.cross(&(Vector3::z() * radius));
        prop_assert!(rest.amax() < 1e-6, "{rest}");
    }

    /// The middle of a sole is the mean of its corners, wherever the sole sits on its link; that of a ball is its frame's origin.
    #[test]
    fn a_sole_is_used_by_its_middle(
        world in world(), leg in 0..4_usize, turn in rotation(), at in vector(0.2), x in [-0.2..0.2_f64, -0.2..0.2], y in [-0.2..0.2_f64, -0.2..0.2],
    ) {
        let mut frame = FEET[leg].frame;
        frame.offset = at.into();
        frame.rotation = core::array::from_fn(|i| core::array::from_fn(|j| turn[(i, j)]));
        let shape = ContactShape::Rectangle { x, y };
        let foot = Foot::of(&Contact { name: "sole", frame, shape });
        let pose = world.pose_of(&frame);
        let corners = [(0, 0), (0, 1), (1, 0), (1, 1)];
        let sum: Vector3<f64> = corners.iter().map(|&(i, j)| pose.point(&Vector3::new(x[i], y[j], 0.0))).sum();
        prop_assert!((world.pose_of(&foot.frame).translation - sum / 4.0).amax() < 1e-12);
        prop_assert_eq!(foot.radius, 0.0);
    }
}
