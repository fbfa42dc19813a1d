//! What the URDFs of the robots do not say.

/// What a URDF does not say.
pub(crate) struct Spec {
    /// Links that stand on the ground.
    pub(crate) feet: &'static [&'static str],
    /// Middle of each foot in its link, and half sides of a sole; without these it is a ball of the third number.
    pub(crate) sole: ([f64; 3], Option<[f64; 2]>),
    /// Joints whose names end so start here; the others at zero, or as near as their limits let them.
    pub(crate) start: &'static [(&'static str, f64)],
    /// Joints with these in their names are locked.
    pub(crate) locked: &'static str,
    /// What reaches, and its radius.
    pub(crate) hand: (&'static str, f64),
    /// What is in the way: a capsule's link, ends in it, and radius.
    pub(crate) body: (&'static str, [f64; 3], [f64; 3], f64),
}

pub(crate) fn spec(name: &str) -> Spec {
    let found = legged(name).or_else(|| arm(name));
    found.unwrap_or_else(|| panic!("no robot of this name: {name}"))
}

/// Robots on feet.
fn legged(name: &str) -> Option<Spec> {
    Some(match name {
        "talos" => Spec {
            feet: &["left_sole_link", "right_sole_link"],
            sole: ([0.0; 3], Some([0.1, 0.06])),
            start: &[
                ("leg_left_3_joint", -0.41),
                ("leg_right_3_joint", -0.41),
                ("leg_left_4_joint", 0.86),
                ("leg_right_4_joint", 0.86),
                ("leg_left_5_joint", -0.45),
                ("leg_right_5_joint", -0.45),
                ("arm_left_1_joint", 0.25),
                ("arm_right_1_joint", -0.25),
                ("arm_left_2_joint", 0.3),
                ("arm_right_2_joint", -0.3),
                ("arm_left_4_joint", -0.9),
                ("arm_right_4_joint", -0.9),
            ],
            locked: "-",
            hand: ("gripper_left_base_link", 0.06),
            body: ("torso_2_link", [0.0, 0.0, -0.2], [0.0, 0.0, 0.3], 0.16),
        },
        "g1" => Spec {
            feet: &["left_ankle_roll_link", "right_ankle_roll_link"],
            sole: ([0.035, 0.0, -0.037], Some([0.085, 0.025])),
            start: &[
                ("hip_pitch_joint", -0.4),
                ("knee_joint", 0.8),
                ("ankle_pitch_joint", -0.4),
                ("left_shoulder_roll_joint", 0.4),
                ("right_shoulder_roll_joint", -0.4),
                ("elbow_joint", 0.3),
            ],
            locked: "_hand_",
            hand: ("left_wrist_yaw_link", 0.05),
            body: ("torso_link", [0.0, 0.0, 0.0], [0.0, 0.0, 0.35], 0.1),
        },
        "go2" => Spec {
            feet: &["FL_foot", "FR_foot", "RL_foot", "RR_foot"],
            sole: ([0.0, 0.0, 0.022], None),
            start: &[("thigh_joint", 0.8), ("calf_joint", -1.6)],
            locked: "-",
            hand: ("", 0.0),
            body: ("", [0.0; 3], [0.0; 3], 0.0),
        },
        _ => return None,
    })
}

/// Arms on a base that is fixed.
fn arm(name: &str) -> Option<Spec> {
    Some(match name {
        "panda" => Spec {
            feet: &[],
            sole: ([0.0; 3], None),
            start: &[
                ("joint2", -0.785),
                ("joint4", -2.356),
                ("joint6", 1.571),
                ("panda_joint7", 0.785),
            ],
            locked: "finger",
            hand: ("panda_hand", 0.08),
            body: ("panda_link0", [0.0, 0.0, 0.0], [0.0, 0.0, 0.33], 0.1),
        },
        "tiago" => Spec {
            feet: &[],
            sole: ([0.0; 3], None),
            start: &[
                ("torso_lift_joint", 0.15),
                ("arm_1_joint", 1.0),
                ("arm_2_joint", -0.3),
                ("arm_3_joint", -1.0),
                ("arm_4_joint", 1.2),
            ],
            locked: "wheel",
            hand: ("arm_7_link", 0.08),
            body: (
                "torso_lift_link",
                [-0.05, 0.0, -0.6],
                [-0.05, 0.0, -0.1],
                0.15,
            ),
        },
        "ur5" => Spec {
            feet: &[],
            sole: ([0.0; 3], None),
            start: &[("shoulder_lift_joint", -1.2), ("elbow_joint", 1.6)],
            locked: "-",
            hand: ("tool0", 0.05),
            body: ("base_link", [0.0, 0.0, 0.0], [0.0, 0.0, 0.25], 0.1),
        },
        _ => return None,
    })
}
