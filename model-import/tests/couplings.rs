//! Mimic joints: the coupling beside the tree, chains and rings of followers, and what is written of it.

use crate::arm::arm;
use model_import::emit::{Provenance, module};
use model_import::{ImportError, MimicPolicy, Options, Robot, Warning};
use rbd_core::reduction::ReductionError;
use rbd_core::{BaseKind, Configuration};

/// A gripper: each finger slides; `followers` stand in the joints of the second and the third.
fn gripper(followers: [&str; 2]) -> Robot {
    let finger = |i: usize, follow: &str| {
        format!(
            r#"<link name="finger{i}"><inertial><mass value="0.1"/>
  <inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide{i}" type="prismatic"><parent link="palm"/><child link="finger{i}"/><axis xyz="0 1 0"/>
  <limit lower="0" upper="0.04" effort="5" velocity="1"/>{follow}</joint>"#
        )
    };
    let fingers = [
        finger(0, ""),
        finger(1, followers[0]),
        finger(2, followers[1]),
    ]
    .concat();
    let text = format!(r#"<robot name="gripper"><link name="palm"/>{fingers}</robot>"#);
    let options = Options {
        base: BaseKind::Fixed,
        ..Options::default()
    };
    Robot::from_urdf(&text, &options).unwrap()
}

const SECOND: &str = r#"<mimic joint="slide0" multiplier="-1" offset="0.01"/>"#;

#[test]
fn a_chain_of_followers_is_resolved() {
    let robot = gripper([
        SECOND,
        r#"<mimic joint="slide1" multiplier="0.5" offset="0.2"/>"#,
    ]);
    assert_eq!(robot.joints.len(), 3, "the tree keeps every joint");
    assert_eq!(robot.independent(), [0]);
    let reduction = robot.reduction::<f64, 8, 1>().unwrap();
    let q = Configuration {
        joints: [0.03],
        ..Configuration::NEUTRAL
    };
    let q = reduction.configuration(&q).joints;
    for (x, y) in q.iter().zip([0.03, -0.02, 0.19, 0.0]) {
        assert!((x - y).abs() < 1e-15, "{q:?}");
    }
    assert!(
        robot
            .warnings
            .iter()
            .all(|w| matches!(w, Warning::MimicFreed { .. }))
    );
    assert_eq!(robot.reduction::<f64, 8, 2>().unwrap().rows, reduction.rows);
    assert!(matches!(
        robot.reduction::<f64, 8, 0>(),
        Err(ReductionError::NoSuchCoordinate { joint: 0 })
    ));
    assert!(matches!(
        robot.reduction::<f64, 2, 1>(),
        Err(ReductionError::NoSuchCoordinate { joint: 2 })
    ));
    let text = module(&robot, "Gripper", &Provenance::new("g.urdf", "", "MIT"));
    assert!(text.contains("REDUCTION: Reduction<f64, 3, 1>"));
    assert!(text.contains("Coupling { coordinate: 0, ratio: -0.5, offset: 0.205"));
}

#[test]
fn couplings_that_cannot_hold_are_named() {
    let ring = gripper([r#"<mimic joint="slide2"/>"#, r#"<mimic joint="slide1"/>"#]);
    assert_eq!(ring.independent(), [0, 1, 2]);
    let said: Vec<String> = ring.warnings.iter().map(ToString::to_string).collect();
    assert!(
        said.len() == 2 && said.iter().all(|w| w.contains("ring")),
        "{said:?}"
    );
    let lost = gripper([r#"<mimic joint="thumb"/>"#, ""]);
    assert!(lost.warnings[0].to_string().contains("not in the file"));
    assert!(!module(&lost, "Gripper", &Provenance::new("g.urdf", "", "MIT")).contains("REDUCTION"));
}

#[test]
fn mimic_joints_are_refused_locked_or_freed() {
    let text = arm().replacen(
        r#"<axis xyz="0 0 1"/>"#,
        r#"<axis xyz="0 0 1"/><mimic joint="shoulder" multiplier="2" offset="0.25"/>"#,
        1,
    );
    let with = |mimic, locks: &[(&str, f64)]| {
        let locks = locks.iter().map(|(j, x)| ((*j).to_owned(), *x)).collect();
        Robot::from_urdf(
            &text,
            &Options {
                mimic,
                locks,
                ..Options::default()
            },
        )
    };
    let refused = with(MimicPolicy::Refuse, &[]).unwrap_err();
    assert!(
        refused.to_string().contains("--lock elbow=value"),
        "{refused}"
    );
    assert_eq!(
        with(MimicPolicy::Refuse, &[("elbow", 0.1)])
            .unwrap()
            .joints
            .len(),
        1
    );
    let free = with(MimicPolicy::Free, &[]).unwrap();
    assert_eq!(MimicPolicy::default(), MimicPolicy::Free, "as Pinocchio");
    assert_eq!(free.joints.len(), 2);
    assert!(matches!(
        &free.warnings[..],
        [Warning::MimicFreed { joint, leader }] if joint == "elbow" && leader == "shoulder"
    ));
    let lost = with(MimicPolicy::Free, &[("shoulder", 0.5)]).unwrap();
    assert!(matches!(&lost.warnings[..], [Warning::MimicLost { .. }]));
    assert!(lost.warnings[0].to_string().contains("is locked"));
    assert_eq!(
        with(MimicPolicy::Lock, &[]).unwrap().locked,
        [("elbow".to_owned(), 0.25)]
    );
    let both = with(MimicPolicy::Lock, &[("shoulder", 0.5)])
        .unwrap()
        .locked;
    assert_eq!(
        both,
        [("shoulder".to_owned(), 0.5), ("elbow".to_owned(), 1.25)]
    );
    let text = text.replace(r#"mimic joint="shoulder""#, r#"mimic joint="hip""#);
    let options = Options {
        mimic: MimicPolicy::Lock,
        ..Options::default()
    };
    assert!(matches!(
        Robot::from_urdf(&text, &options).unwrap_err(),
        ImportError::UnknownLeader { .. }
    ));
}
