//! Names of a model lead where its tables have them.

use rbd_core::{BaseBody, Body, Frame, JointLimits, Link, Model};

struct Biped;

static BASE: BaseBody<f64> = BaseBody::<f64>::EMPTY;
static BODIES: [Body<f64>; 4] = [Body::<f64>::EMPTY; 4];
static JOINTS: [&str; 4] = ["left hip", "left knee", "right hip", "right knee"];
static LIMITS: [JointLimits<f64>; 4] = [JointLimits::NONE; 4];
static FRAME_NAMES: [&str; 3] = ["trunk", "left foot", "right foot"];
static FRAMES: [Frame<f64>; 3] = [
    Frame::IDENTITY,
    Frame {
        link: Link::Joint(1),
        ..Frame::IDENTITY
    },
    Frame {
        link: Link::Joint(3),
        ..Frame::IDENTITY
    },
];
const NAME: &str = "biped";

rbd_core::tree! {
    impl Tree<f64, 4> for Biped { floating, BASE, BODIES, 2 * [RevoluteX, RevoluteY] }
}

rbd_core::model! {
    impl Model<f64, 4> for Biped { NAME, JOINTS, LIMITS, FRAME_NAMES, FRAMES }
}

/// Every name is found at its own place, and no other is found at all.
#[test]
fn names_lead_to_their_places() {
    for (i, name) in JOINTS.iter().enumerate() {
        assert_eq!(Biped.joint_index(name), Some(i));
    }
    for (name, frame) in FRAME_NAMES.iter().zip(FRAMES) {
        assert_eq!(Biped.frame(name), Some(frame));
    }
    assert_eq!(Biped.joint_index("trunk"), None);
    assert_eq!(Biped.frame("left hip"), None);
}
