//! Every way in which a URDF can be no robot gives the error that names the element; what robots in use get wrong
//! gives a warning; nothing panics.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use crate::arm::{BOX, arm};
use model_import::{ImportError, InertiaPolicy, Options, Robot, Warning, parse_lock};
use proptest::prelude::*;
use rbd_core::BaseKind;

fn import(text: &str) -> Result<Robot, ImportError> {
    Robot::from_urdf(text, &Options::default())
}

/// The error after replacing the first `from` by `to`; the message must contain each of `words`.
fn error(from: &str, to: &str, words: &[&str]) -> ImportError {
    let good = arm();
    assert!(good.contains(from), "`{from}` is not in the file");
    let error = import(&good.replacen(from, to, 1)).unwrap_err();
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
    error
}

macro_rules! fails {
    ($from:expr, $to:expr, $words:expr, $pattern:pat) => {
        let error = error($from, $to, &$words);
        assert!(matches!(error, $pattern), "{error:?}");
    };
}

#[test]
fn the_unspoilt_arm_is_good() {
    let robot = import(&arm()).unwrap();
    assert_eq!(robot.warnings, []);
    assert_eq!(robot.joints.len(), 2);
    assert_eq!(robot.joints[1].limits.lower, f64::NEG_INFINITY);
    assert_eq!(robot.joints[0].limits.upper, 1.0);
}

#[test]
fn text_that_is_no_urdf() {
    fails!(
        "</robot>",
        "",
        ["not XML", "complete"],
        ImportError::Xml { .. }
    );
    let torn = &arm()[..300];
    assert!(matches!(import(torn).unwrap_err(), ImportError::Xml { .. }));
    assert!(matches!(import("").unwrap_err(), ImportError::Xml { .. }));
    assert!(
        matches!(import("<sdf/>").unwrap_err(), ImportError::NotARobot { found } if found == "sdf")
    );
    assert_eq!(
        import("<robot name='x'/>").unwrap_err(),
        ImportError::NoLinks
    );
}

#[test]
fn numbers_that_are_none() {
    for bad in ["NaN", "inf", "one", ""] {
        let value = format!(r#"<mass value="{bad}"/>"#);
        fails!(
            r#"<mass value="1"/>"#,
            &value,
            ["link `trunk`", "line 3", "mass"],
            ImportError::BadNumber { .. }
        );
    }
    fails!(
        r#"iyy="0.1""#,
        r#"iyy="nan""#,
        ["link `trunk`", "iyy"],
        ImportError::BadNumber { .. }
    );
    fails!(
        r#"xyz="0 0 0.1""#,
        r#"xyz="0 0""#,
        ["joint `shoulder`", "three numbers"],
        ImportError::BadNumber { .. }
    );
    fails!(
        r#"rpy="0 0 0""#,
        r#"rpy="0 0 x""#,
        ["joint `shoulder`", "rpy"],
        ImportError::BadNumber { .. }
    );
    fails!(
        r#"upper="1""#,
        r#"upper="NaN""#,
        ["joint `shoulder`", "upper limit"],
        ImportError::BadNumber { .. }
    );
    fails!(
        r#"effort="5""#,
        r#"effort="1e999""#,
        ["joint `shoulder`", "effort"],
        ImportError::BadNumber { .. }
    );
}

#[test]
fn missing_parts() {
    for (from, to, words) in [
        (r#"<mass value="1"/>"#, "", ["link `trunk`", "<mass>"]),
        (r#"izz="0.1""#, "", ["link `trunk`", "izz"]),
        (
            r#"<link name="upper">"#,
            "<link>",
            ["link in line 11", "name"],
        ),
        (
            r#"<parent link="trunk"/>"#,
            "",
            ["joint `shoulder`", "parent"],
        ),
        (r#"type="revolute""#, "", ["joint `shoulder`", "type"]),
        (
            r#"<axis xyz="0 1 0"/>"#,
            "<axis/>",
            ["joint `shoulder`", "axis"],
        ),
    ] {
        fails!(from, to, words, ImportError::Missing { .. });
    }
}

/// A motor of less than nothing, and losses that drive.
#[test]
fn joints_of_less_than_nothing() {
    for (from, to, what) in [
        (r#"effort="5""#, r#"effort="-5""#, "effort is `-5`"),
        (r#"velocity="2""#, r#"velocity="-2""#, "speed is `-2`"),
        (
            r#"<limit lower="-1""#,
            r#"<dynamics damping="-0.1"/><limit lower="-1""#,
            "damping is `-0.1`",
        ),
        (
            r#"<limit lower="-1""#,
            r#"<dynamics friction="-0.1"/><limit lower="-1""#,
            "friction is `-0.1`",
        ),
    ] {
        fails!(
            from,
            to,
            ["joint `", what, "at least 0"],
            ImportError::BadNumber { .. }
        );
    }
}

#[test]
fn bodies_that_cannot_be() {
    fails!(
        r#"<mass value="1"/>"#,
        r#"<mass value="-1"/>"#,
        ["link `trunk`", "-1 kg"],
        ImportError::NegativeMass { .. }
    );
    fails!(
        r#"ixx="0.1""#,
        r#"ixx="0.3""#,
        ["link `trunk`", "sum of the others", "as-written"],
        ImportError::UnphysicalInertia { .. }
    );
    fails!(
        r#"ixx="0.1""#,
        r#"ixx="-0.1""#,
        ["link `trunk`"],
        ImportError::UnphysicalInertia { .. }
    );
    let text = arm().replacen(r#"ixx="0.1""#, r#"ixx="0.3""#, 1);
    let options = Options {
        inertia: InertiaPolicy::AsWritten,
        ..Options::default()
    };
    let robot = Robot::from_urdf(&text, &options).unwrap();
    assert!(
        matches!(&robot.warnings[..], [Warning::UnphysicalLink { element, .. }] if element.contains("trunk"))
    );
    assert!(robot.model::<f64, 2>().is_ok() && robot.model::<f64, 1>().is_err());
}

/// A moved link without inertia at the end of the arm is an error, in the middle it is not.
#[test]
fn missing_inertia_matters_where_nothing_else_resists() {
    let last = arm().rfind(BOX).unwrap();
    let mut text = arm();
    text.replace_range(last..last + BOX.len(), "");
    let error = import(&text).unwrap_err();
    assert!(
        matches!(&error, ImportError::MissingInertia { joint, link, .. } if joint == "elbow" && link == "fore")
    );
    assert!(error.to_string().contains("--lock elbow=0"));
    let locked = Options {
        locks: vec![("elbow".to_owned(), 0.0)],
        ..Options::default()
    };
    assert_eq!(Robot::from_urdf(&text, &locked).unwrap().joints.len(), 1);
    let middle = format!(r#"<link name="upper">{BOX}</link>"#);
    let robot = import(&arm().replacen(&middle, r#"<link name="upper"/>"#, 1)).unwrap();
    assert_eq!(robot.bodies[0].mass, 0.0);
    // A point mass on its own axis resists nothing.
    let point = r#"ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0""#;
    let mut text = arm();
    let tensor = r#"ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0""#;
    let last = text.rfind(tensor).unwrap();
    text.replace_range(last..last + tensor.len(), point);
    assert!(matches!(
        import(&text).unwrap_err(),
        ImportError::MissingInertia { .. }
    ));
    let weightless = arm()
        .replace(BOX, "")
        .replace(r#"type="revolute""#, r#"type="fixed""#)
        .replace("continuous", "fixed");
    assert_eq!(import(&weightless).unwrap_err(), ImportError::NoMass);
}

#[test]
fn links_that_form_no_tree() {
    fails!(
        r#"<child link="fore"/>"#,
        r#"<child link="hand"/>"#,
        ["joint `elbow`", "`hand`"],
        ImportError::UnknownLink { .. }
    );
    fails!(
        r#"<parent link="trunk"/>"#,
        r#"<parent link="body"/>"#,
        ["joint `shoulder`", "`body`"],
        ImportError::UnknownLink { .. }
    );
    fails!(
        r#"<child link="fore"/>"#,
        r#"<child link="upper"/>"#,
        ["`upper`", "`shoulder`", "`elbow`"],
        ImportError::TwoParents { .. }
    );
    fails!(
        "</robot>",
        r#"<link name="hat"/></robot>"#,
        ["`trunk`", "`hat`", "no parent"],
        ImportError::SeveralRoots { .. }
    );
    fails!(
        r#"<child link="fore"/>"#,
        r#"<child link="trunk"/>"#,
        ["cut the loop"],
        ImportError::Loop { .. }
    );
    // The link that hangs on a ring is not the one to blame.
    let hanging = r#"<link name="z"/><link name="a"/><link name="b"/>
        <joint name="az" type="fixed"><parent link="a"/><child link="z"/></joint>
        <joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>
        <joint name="ba" type="fixed"><parent link="b"/><child link="a"/></joint></robot>"#;
    let blamed = error("</robot>", hanging, &["cut the loop"]);
    assert!(matches!(blamed, ImportError::Loop { link } if link == "a" || link == "b"));
    fails!(
        r#"<link name="fore">"#,
        r#"<link name="upper">"#,
        ["link `upper`", "taken"],
        ImportError::DuplicateName { .. }
    );
    fails!(
        r#"<joint name="elbow""#,
        r#"<joint name="shoulder""#,
        ["joint `shoulder`", "taken"],
        ImportError::DuplicateName { .. }
    );
    // A ring with nothing above it, alone and beside a good tree.
    let ring = r#"<joint name="back" type="fixed"><parent link="fore"/><child link="trunk"/></joint></robot>"#;
    fails!(
        "</robot>",
        ring,
        ["`trunk`", "cut the loop"],
        ImportError::Loop { .. }
    );
    let beside = r#"<link name="a"/><link name="b"/>
        <joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>
        <joint name="ba" type="fixed"><parent link="b"/><child link="a"/></joint></robot>"#;
    fails!(
        "</robot>",
        beside,
        ["cut the loop"],
        ImportError::Loop { .. }
    );
    let own = r#"<link name="a"/><joint name="aa" type="fixed"><parent link="a"/><child link="a"/></joint></robot>"#;
    fails!("</robot>", own, ["`a`"], ImportError::Loop { .. });
}

#[test]
fn joints_that_cannot_be() {
    fails!(
        r#"xyz="0 1 0""#,
        r#"xyz="0 0 0""#,
        ["joint `shoulder`", "axis"],
        ImportError::ZeroAxis { .. }
    );
    fails!(
        r#"xyz="0 1 0""#,
        r#"xyz="0 2 0""#,
        ["joint `shoulder`", "length 2"],
        ImportError::NonUnitAxis { .. }
    );
    fails!(
        "continuous",
        "planar",
        ["joint `elbow`", "planar"],
        ImportError::UnsupportedJoint { .. }
    );
    fails!(
        "continuous",
        "floating",
        ["joint `elbow`", "floating"],
        ImportError::UnsupportedJoint { .. }
    );
    fails!(
        r#"lower="-1""#,
        r#"lower="3""#,
        ["joint `shoulder`", "swap"],
        ImportError::InvertedLimits { .. }
    );
}

#[test]
fn locks_that_cannot_be() {
    let lock = |locks: &[(&str, f64)]| {
        let locks = locks.iter().map(|(j, x)| ((*j).to_owned(), *x)).collect();
        Robot::from_urdf(
            &arm(),
            &Options {
                locks,
                ..Options::default()
            },
        )
    };
    let unknown = lock(&[("knee", 0.0)]).unwrap_err();
    assert!(matches!(unknown, ImportError::UnknownLock { .. }));
    assert!(unknown.to_string().contains("shoulder, elbow"), "{unknown}");
    assert!(matches!(
        lock(&[("elbow", f64::NAN)]).unwrap_err(),
        ImportError::BadLock { .. }
    ));
    assert!(matches!(
        lock(&[("elbow", 0.0), ("elbow", 1.0)]).unwrap_err(),
        ImportError::LockedTwice { .. }
    ));
    let outside = lock(&[("shoulder", 1.5)]).unwrap();
    assert!(matches!(
        &outside.warnings[..],
        [Warning::LockOutsideRange { .. }]
    ));
    for text in ["elbow", "elbow=", "elbow=x", "elbow=inf", "=1"] {
        assert!(
            matches!(parse_lock(text), Err(ImportError::BadLock { .. })),
            "{text}"
        );
    }
    assert_eq!(
        parse_lock("elbow=-0.5").unwrap(),
        ("elbow".to_owned(), -0.5)
    );
}

#[test]
fn what_robots_in_use_get_wrong_is_a_warning() {
    let warning = |from: &str, to: &str| {
        let robot = import(&arm().replacen(from, to, 1)).unwrap();
        assert_eq!(robot.warnings.len(), 1, "{:?}", robot.warnings);
        robot.warnings[0].clone()
    };
    let scaled = warning(r#"xyz="0 1 0""#, r#"xyz="0.7071 0.7071 0""#);
    assert!(matches!(scaled, Warning::AxisScaled { .. }));
    let unlimited = warning(
        r#"<limit lower="-1" upper="1" effort="5" velocity="2"/>"#,
        "",
    );
    assert!(matches!(unlimited, Warning::NoLimit { .. }));
    let placeholder = warning(r#"velocity="2""#, r#"velocity="0""#);
    assert!(matches!(
        placeholder,
        Warning::PlaceholderLimit { what: "speed", .. }
    ));
    // An unphysical camera on a heavy trunk.
    let camera = r#"<link name="eye"><inertial><mass value="0.01"/>
        <inertia ixx="0" iyy="0" izz="3e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="mount" type="fixed"><parent link="trunk"/><child link="eye"/></joint></robot>"#;
    assert!(matches!(
        warning("</robot>", camera),
        Warning::UnphysicalLink { .. }
    ));
    let massless = r#"<link name="eye"><inertial><mass value="0"/>
        <inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="mount" type="fixed"><parent link="trunk"/><child link="eye"/></joint></robot>"#;
    assert!(matches!(
        warning("</robot>", massless),
        Warning::InertiaWithoutMass { .. }
    ));
}

#[test]
fn a_fixed_base_needs_no_mass() {
    let text = arm().replacen(
        &format!(r#"<link name="trunk">{BOX}</link>"#),
        r#"<link name="trunk"/>"#,
        1,
    );
    let options = Options {
        base: BaseKind::Fixed,
        ..Options::default()
    };
    assert_eq!(Robot::from_urdf(&text, &options).unwrap().base.mass, 0.0);
}

proptest! {
    /// Files torn off or with bytes replaced give a robot or an error, never a panic or a hang.
    #[test]
    fn damaged_files_never_panic(cut in 0_usize..900, at in 0_usize..900, with in "[<>/\"=a-z0-9.-]{0,4}") {
        let good = arm();
        let torn = good.get(..cut).unwrap_or(&good);
        let _ = import(torn);
        if good.is_char_boundary(at) && good.is_char_boundary(at + with.len()) && at + with.len() <= good.len() {
            let mut spoilt = good.clone();
            spoilt.replace_range(at..at + with.len(), &with);
            let _ = import(&spoilt);
        }
    }
}

/// A file that writes the floating base down, as a joint from a link that stands for the world, is the robot without both.
#[test]
fn a_floating_joint_at_the_root_is_the_floating_base() {
    let world = r#"<link name="world"/><joint name="free" type="floating">
        <parent link="world"/><child link="trunk"/></joint></robot>"#;
    let [plain, written] =
        [arm(), arm().replace("</robot>", world)].map(|text| import(&text).unwrap());
    assert_eq!(format!("{written:?}"), format!("{plain:?}"));
    for (from, to, words) in [
        (
            r#"<link name="world"/>"#,
            format!(r#"<link name="world">{BOX}</link>"#),
            "floating",
        ),
        (
            r#"<parent link="world"/>"#,
            r#"<parent link="fore"/>"#.to_owned(),
            "floating",
        ),
        (
            r#"<parent link="world"/>"#,
            r#"<parent link="word"/>"#.to_owned(),
            "`word`",
        ),
        (r#"<child link="trunk"/>"#, String::new(), "child"),
    ] {
        let text = arm().replace("</robot>", &world.replace(from, &to));
        let message = import(&text).unwrap_err().to_string();
        assert!(
            message.contains("`free`") && message.contains(words),
            "{message}"
        );
    }
}
