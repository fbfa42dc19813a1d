//! MJCF files: units, defaults and joints by hand, every refusal by name, and damaged files. The comparison with MuJoCo stands
//! in the workspace's `tests/tests/mjcf.rs` and in `cargo xtask import-check --mjcf`.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use core::f64::consts::PI;
use std::fs;
use std::path::Path;

use model_import::{ImportError, Options, Robot, Warning, mjcf};
use proptest::prelude::*;
use rbd_core::joint::Kind;
use rbd_core::{BaseKind, Configuration, Kinematics, Posture, forward_kinematics};

/// A free box with an arm of two joints; each test spoils one thing.
const ARM: &str = r#"<mujoco model="arm">
<compiler angle="degree"/>
<default><joint damping="0.5"/><default class="stiff"><joint armature="0.1" range="-90 45"/></default></default>
<worldbody><geom type="plane" size="1 1 1"/>
  <body name="trunk" pos="0 0 1"><freejoint name="root"/>
    <geom name="hull" type="box" size="0.1 0.2 0.3" density="500"/>
    <body name="upper" pos="0.1 0 0" childclass="stiff">
      <joint name="shoulder" axis="0 1 0" frictionloss="2"/>
      <joint name="reach" type="slide" axis="0 0 1" range="0 0.5" pos="0 0 0.1"/>
      <inertial pos="0 0 0" mass="2" diaginertia="0.1 0.1 0.1"/>
    </body>
  </body>
</worldbody></mujoco>"#;

fn import(text: &str) -> Result<Robot, ImportError> {
    Robot::from_mjcf(text, &Options::default())
}

fn spoilt(from: &str, to: &str) -> Result<Robot, ImportError> {
    assert!(ARM.contains(from), "`{from}` is not in the file");
    import(&ARM.replacen(from, to, 1))
}

#[test]
fn units_defaults_and_joints() {
    let robot = import(ARM).unwrap();
    assert_eq!(robot.warnings, []);
    assert_eq!(robot.base_kind, BaseKind::Floating);
    assert_eq!(robot.bodies[0].kind, Kind::RevoluteY);
    assert_eq!(robot.bodies[1].kind, Kind::PrismaticZ);
    assert!((robot.base.mass - 500.0 * 0.2 * 0.4 * 0.6).abs() < 1e-12);
    let [shoulder, reach] = [0, 1].map(|i| robot.joints[i].limits);
    assert!((shoulder.lower + PI / 2.0).abs() < 1e-15 && (shoulder.upper - PI / 4.0).abs() < 1e-15);
    assert_eq!(
        (reach.lower, reach.upper),
        (0.0, 0.5),
        "metres are no degrees"
    );
    assert_eq!(
        (shoulder.damping, shoulder.friction, shoulder.effort),
        (0.5, 2.0, f64::INFINITY)
    );
    assert_eq!(robot.bodies[0].rotor_inertia, 0.1);
    assert_eq!(robot.bodies[0].mass, 0.0, "the slide's body carries all");
    // The box: m x² / 3 with half sizes, as second moments.
    let [xx, yy, zz, ..] = robot.base.second;
    for (second, half) in [(xx, 0.1), (yy, 0.2), (zz, 0.3)] {
        assert!((second - robot.base.mass * half * half / 3.0).abs() < 1e-12);
    }
}

#[test]
fn ref_moves_the_zero_and_pos_the_axis() {
    let text = ARM.replace(
        "axis=\"0 1 0\"",
        "axis=\"0 1 0\" ref=\"30\" pos=\"0 0 0.2\"",
    );
    let robot = import(&text).unwrap();
    let model = robot.model::<f64, 2>().unwrap();
    let place = |q: f64| {
        let q = Configuration {
            joints: [q, 0.0],
            ..Configuration::NEUTRAL
        };
        let mut poses = Kinematics::IDENTITY;
        forward_kinematics(&model, &Posture::new(&model, &q), &mut poses);
        poses.frame(&robot.frame("upper").unwrap()).translation
    };
    // At the reference the body is where it is drawn; elsewhere it has turned about (0, y, 0.2).
    let drawn = place(PI / 6.0);
    assert!(
        (drawn - nalgebra::Vector3::new(0.1, 0.0, 0.0)).norm() < 1e-15,
        "{drawn}"
    );
    let turned = place(PI / 6.0 + 0.4);
    let wanted = nalgebra::Vector3::new(
        0.1 - 0.2 * so3::math::sin(0.4),
        0.0,
        0.2 - 0.2 * so3::math::cos(0.4),
    );
    assert!((turned - wanted).norm() < 1e-15, "{turned}");
}

/// What is written for what, and what the error names.
const REFUSED: &[(&str, &str, &[&str])] = &[
    (
        r#"type="slide" axis"#,
        r#"type="ball" axis"#,
        &["`reach`", "ball"],
    ),
    (
        r#"type="box" size="0.1 0.2 0.3""#,
        r#"type="mesh" mesh="hull""#,
        &["`hull`", "mesh", "inertial"],
    ),
    (
        r#"type="box" size="0.1 0.2 0.3""#,
        r#"type="box" size="0.1""#,
        &["`hull`", "sizes"],
    ),
    (
        r#"type="box""#,
        r#"type="box" shellinertia="true""#,
        &["`hull`", "shell"],
    ),
    (r#"angle="degree""#, r#"coordinate="global""#, &["global"]),
    (
        "<freejoint name=\"root\"/>",
        "<freejoint/><joint name=\"more\"/>",
        &["free joint"],
    ),
    (
        "</worldbody>",
        r#"<body name="ball"><freejoint/><geom size="1"/></body></worldbody>"#,
        &["`ball`", "second free"],
    ),
    (
        "</worldbody>",
        r#"<body name="door"><joint name="hinge"/><geom size="1"/></body></worldbody>"#,
        &["`hinge`", "one tree"],
    ),
    (
        "<inertial",
        r#"<replicate count="3"/><inertial"#,
        &["replicate"],
    ),
    (r#"mass="2""#, "", &["inertial", "upper", "mass"]),
    (r#"mass="2""#, r#"mass="-2""#, &["upper", "-2 kg"]),
    (
        r#"diaginertia="0.1 0.1 0.1""#,
        "",
        &["diaginertia or fullinertia"],
    ),
    (
        r#"diaginertia="0.1 0.1 0.1""#,
        r#"diaginertia="0.1 0.1 0.9""#,
        &["upper", "sum of the others"],
    ),
    (
        r#"diaginertia="0.1 0.1 0.1""#,
        r#"diaginertia="0.1 0.1""#,
        &["diaginertia"],
    ),
    (
        r#"axis="0 1 0""#,
        r#"axis="0 0 0""#,
        &["`shoulder`", "(0, 0, 0)"],
    ),
    (
        r#"axis="0 1 0""#,
        r#"axis="0 one 0""#,
        &["`shoulder`", "axis"],
    ),
    (r#"range="0 0.5""#, r#"range="1 0.5""#, &["`reach`", "swap"]),
    (
        r#"name="reach""#,
        r#"name="shoulder""#,
        &["`shoulder`", "taken"],
    ),
    (r#"name="upper""#, r#"name="trunk""#, &["`trunk`", "taken"]),
    (
        r#"pos="0.1 0 0""#,
        r#"pos="0.1 0 0" quat="0 0 0 0""#,
        &["`upper`", "direction"],
    ),
];

#[test]
fn what_cannot_be_kept_is_refused_by_name() {
    for (from, to, words) in REFUSED {
        let Err(error) = spoilt(from, to) else {
            panic!("{to} was taken");
        };
        let message = error.to_string();
        for word in *words {
            assert!(message.contains(word), "`{word}` is not in: {message}");
        }
    }
    let nameless = spoilt("<mujoco model=\"arm\">", "<mujoco>").unwrap();
    assert_eq!(nameless.name, "MuJoCo Model");
    assert!(matches!(
        import("<robot/>"),
        Err(ImportError::NotARobot { .. })
    ));
    assert!(matches!(import("<mujoco>"), Err(ImportError::Xml { .. })));
    let massless = import("<mujoco><worldbody/></mujoco>").unwrap();
    assert_eq!(
        (massless.joints.len(), massless.base_kind),
        (0, BaseKind::Fixed)
    );
}

#[test]
fn what_is_not_kept_is_named() {
    for (from, to, words) in [
        (r#"frictionloss="2""#, r#"stiffness="9""#, "spring"),
        (
            "</mujoco>",
            "<tendon><fixed/></tendon></mujoco>",
            "<tendon> with 1",
        ),
        (
            "</mujoco>",
            "<actuator><motor/><motor/></actuator></mujoco>",
            "<actuator> with 2",
        ),
        (
            "<default>",
            r#"<option gravity="0 0 -1.62"/><default>"#,
            "-1.62",
        ),
        ("<default>", r#"<option density="1.2"/><default>"#, "fluid"),
        (
            "<default>",
            r#"<compiler boundmass="1"/><default>"#,
            "boundmass",
        ),
        (
            r#"name="upper""#,
            r#"name="upper" gravcomp="1""#,
            "gravcomp",
        ),
        (
            "</worldbody>",
            r#"<body name="post"><geom size="1"/></body></worldbody>"#,
            "part of the world",
        ),
    ] {
        let robot = spoilt(from, to).unwrap();
        let [only @ Warning::NotKept { .. }] = &robot.warnings[..] else {
            panic!("{to}: {:?}", robot.warnings)
        };
        assert!(only.to_string().contains(words), "{only}");
    }
}

#[test]
fn a_fixed_base_welds_the_free_body_and_a_total_mass_scales() {
    let options = Options {
        base: BaseKind::Fixed,
        ..Options::default()
    };
    let robot = Robot::from_mjcf(ARM, &options).unwrap();
    assert_eq!(robot.base_kind, BaseKind::Fixed);
    assert!(robot.warnings[0].to_string().contains("`trunk`: welded"));
    let half = spoilt(r#"angle="degree""#, r#"angle="degree" settotalmass="13""#).unwrap();
    assert!((half.mass() - 13.0).abs() < 1e-12);
    assert!((half.bodies[1].mass - 2.0 * 13.0 / 26.0).abs() < 1e-12);
}

#[test]
fn includes_are_read_and_rings_end() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("includes");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let (before, rest) = ARM.split_once("<body name=\"upper\"").unwrap();
    let (inner, after) = rest.split_once("</body>").unwrap();
    let arm = format!("<mujoco><body name=\"upper\"{inner}</body></mujoco>");
    fs::write(folder.join("arm.xml"), arm).unwrap();
    let main = folder.join("main.xml");
    fs::write(&main, format!("{before}<include file=\"arm.xml\"/>{after}")).unwrap();
    let robot = import(&mjcf::read(&main).unwrap()).unwrap();
    assert_eq!(robot.bodies, import(ARM).unwrap().bodies);
    fs::write(
        folder.join("arm.xml"),
        "<mujoco><include file=\"arm.xml\"/></mujoco>",
    )
    .unwrap();
    assert!(
        mjcf::read(&main)
            .unwrap_err()
            .to_string()
            .contains("each other")
    );
    fs::remove_file(folder.join("arm.xml")).unwrap();
    assert!(
        mjcf::read(&main)
            .unwrap_err()
            .to_string()
            .contains("arm.xml")
    );
}

/// A file of a thousand bodies, each in the one before, is too many joints and no overflow.
#[test]
fn deep_trees_end() {
    let deep = |n: usize| {
        let open = r#"<body><joint axis="0 1 0"/><geom size="0.1"/>"#.repeat(n);
        format!(
            "<mujoco><worldbody>{open}{}</worldbody></mujoco>",
            "</body>".repeat(n)
        )
    };
    assert_eq!(import(&deep(100)).unwrap().joints.len(), 100);
    assert!(import(&deep(1000)).is_err());
}

proptest! {
    /// Files torn off or with bytes replaced give a robot or an error, never a panic or a hang.
    #[test]
    fn damaged_files_never_panic(cut in 0_usize..1100, at in 0_usize..1100, with in "[<>/\"=a-z0-9.-]{0,4}") {
        let _ = import(ARM.get(..cut).unwrap_or(ARM));
        if at + with.len() <= ARM.len() {
            let mut spoilt = ARM.to_owned();
            spoilt.replace_range(at..at + with.len(), &with);
            let _ = import(&spoilt);
        }
    }
}
