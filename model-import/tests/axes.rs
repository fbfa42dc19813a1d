//! Joint axes are kept to the last digit of the file.

use model_import::options::AXIS_EXACT;
use model_import::{Options, Robot, Warning};
use rbd_core::joint::Kind;
use rbd_core::{BaseKind, Configuration, Kinematics, Posture, forward_kinematics};

/// A joint about the y axis of a link that is rolled by `roll` (text) against the one above.
fn rolled(roll: &str, axis_rounding: f64) -> Robot {
    let text = format!(
        r#"<robot name="r"><link name="a"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><origin rpy="{roll} 0 0"/><axis xyz="0 1 0"/></joint>
<link name="b"><inertial><origin xyz="0 0 1"/><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#
    );
    let options = Options {
        base: BaseKind::Fixed,
        axis_rounding,
        ..Options::default()
    };
    Robot::from_urdf(&text, &options).unwrap()
}

/// Where the tip (0, 0, 1) of link `b` is, by rbd-core.
fn tip(robot: &Robot, q: f64) -> [f64; 3] {
    let model = robot.model::<f64, 1>().unwrap();
    let posture = Posture::new(
        &model,
        &Configuration {
            joints: [q],
            ..Configuration::NEUTRAL
        },
    );
    let mut poses = Kinematics::IDENTITY;
    forward_kinematics(&model, &posture, &mut poses);
    let pose = poses.frame(&robot.frame("b").unwrap());
    pose.point(&nalgebra::Vector3::z()).into()
}

/// π/2 with eleven digits is an angle like any other, with sixteen it is a right angle.
#[test]
fn digits_are_not_rounded_away() {
    for (roll, kind) in [
        ("1.57079632679", Kind::RevoluteTilted),
        ("1.5708", Kind::RevoluteTilted),
        ("1.5707963267948966", Kind::RevoluteZ),
        ("0", Kind::RevoluteY),
    ] {
        let robot = rolled(roll, AXIS_EXACT);
        assert_eq!(robot.bodies[0].kind, kind, "{roll}");
        let near = matches!(robot.warnings[..], [Warning::AxisNearlyAligned { .. }]);
        assert_eq!(near, roll == "1.57079632679");
        // Rx(r) Ry(q) e_z = (sin q, −sin r cos q, cos r cos q)
        let (r, q): (f64, f64) = (roll.parse().unwrap(), 0.7);
        let (sr, cr) = so3::math::sin_cos(r);
        let (sq, cq) = so3::math::sin_cos(q);
        for (x, y) in tip(&robot, q).into_iter().zip([sq, -sr * cq, cr * cq]) {
            assert!((x - y).abs() < 4e-16, "{roll}: {x:e} {y:e}");
        }
    }
}

#[test]
fn rounding_on_demand_aligns() {
    let robot = rolled("1.57079632679", 1e-10);
    assert_eq!(robot.bodies[0].kind, Kind::RevoluteZ);
    assert!(robot.warnings.is_empty());
    let exact = tip(&rolled("1.57079632679", AXIS_EXACT), 0.7);
    let off = (tip(&robot, 0.7)[2] - exact[2]).abs();
    assert!(off < 1e-11, "{off:e}");
}
