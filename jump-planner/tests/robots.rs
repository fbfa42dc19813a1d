//! Robots of others: what a file lacks is named with its remedy, and a profile gives it.

use jump_planner::planned::Planner;
use jump_planner::robot::{JOINTS, Quadruped};
use jump_planner::stored::open_for;
use jump_planner::task::Task;
use jump_planner::task::file::TaskFile;
use nalgebra::Vector3;
use rbd_core::Model;
use std::path::{Path, PathBuf};

/// A1's URDF.
fn a1() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/a1.urdf");
    std::fs::read_to_string(path).unwrap()
}

/// The text without what stands from each `begin` to the next `end`.
fn without(text: &str, begin: &str, end: &str) -> String {
    let mut parts = text.split(begin);
    let mut out = parts.next().unwrap().to_owned();
    for part in parts {
        out += part.split_once(end).unwrap().1;
    }
    out
}

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("robots-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn load(&self, name: &str, text: &str, locks: &[&str]) -> Result<Quadruped, String> {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        let locks: Vec<_> = locks.iter().map(|lock| (*lock).to_owned()).collect();
        Quadruped::load(&path, &locks).map_err(|error| error.to_string())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).unwrap();
    }
}

/// Limits of effort, N m, and speed, rad/s, of all joints.
fn efforts_and_speeds(robot: &Quadruped) -> [(f64, f64); JOINTS] {
    let limits: &[_; JOINTS] = Model::limits(robot);
    limits.each_ref().map(|limit| (limit.effort, limit.speed))
}

/// A URDF without any `<limit>`, as of a mini cheetah, is refused alone and good with the motors of a profile.
#[test]
fn motors_of_a_profile_stand_in_for_limits_that_a_urdf_lacks() {
    let folder = Folder::new("limits");
    let bare = without(&a1(), "<limit ", "/>");
    let bare = bare.replace("type=\"revolute\"", "type=\"continuous\"");
    let alone = folder
        .load("bare.urdf", &bare, &[])
        .map(|_| ())
        .unwrap_err();
    for word in ["FL_hip_joint", "effort", "<limit>", "profile"] {
        assert!(alone.contains(word), "{word}: {alone}");
    }
    let profile = "urdf = \"bare.urdf\"\n[motors.all]\ntorque_nm = 20\ncorner_speed_rad_s = 15\nno_load_speed_rad_s = 30\n";
    let robot = folder.load("bare.toml", profile, &[]).unwrap();
    assert_eq!(efforts_and_speeds(&robot), [(20.0, 30.0); JOINTS]);
    // So they do where a limit is a placeholder.
    let fast = a1().replace("velocity=\"21\"", "velocity=\"1000\"");
    folder.load("bare.urdf", &fast, &[]).unwrap();
    let robot = folder.load("bare.toml", profile, &[]).unwrap();
    assert_eq!(efforts_and_speeds(&robot), [(20.0, 30.0); JOINTS]);
    assert!(robot.placeholders().is_empty());
    // The speed limit of the URDF stays where there is one.
    folder.load("bare.urdf", &a1(), &[]).unwrap();
    let robot = folder.load("bare.toml", profile, &[]).unwrap();
    assert_eq!(efforts_and_speeds(&robot), [(20.0, 21.0); JOINTS]);
}

/// What is refused names the culprit and a remedy that a plan has.
#[test]
fn files_that_are_no_quadruped_are_told_what_they_lack() {
    let folder = Folder::new("refused");
    let mut footless = a1();
    for leg in ["FR", "FL", "RR", "RL"] {
        let begin = format!("<joint name=\"{leg}_foot_fixed\"");
        footless = without(&footless, &begin, "</joint>");
        footless = without(&footless, &format!("<link name=\"{leg}_foot\">"), "</link>");
    }
    let negative = a1().replacen("ixx=\"0.0158533\"", "ixx=\"-1\"", 1);
    let uneven = a1().replacen("<sphere radius=\"0.02\"/>", "<sphere radius=\"0.05\"/>", 1);
    let follows = r#"<joint name="FL_calf_joint" type="revolute">"#;
    let mimic = a1().replacen(
        follows,
        &format!("{follows}<mimic joint=\"FR_calf_joint\"/>"),
        1,
    );
    for changed in [&negative, &uneven, &mimic] {
        assert_ne!(*changed, a1());
    }
    // Its root stands 0.3 m before its legs.
    let aside = r#"<link name="dummy"/><joint name="aside" type="fixed"><parent link="dummy"/><child link="base"/>
        <origin xyz="-0.3 0 0.5"/></joint></robot>"#;
    let aside = a1().replace("</robot>", aside);
    for (text, locks, words, never) in [
        (
            aside,
            &[][..],
            &["no leg stands at FL", "(-0.119, 0.131)", "frame between"][..],
            "--lock",
        ),
        (
            footless,
            &[][..],
            &["calf_joint", "where the foot is", "sphere"][..],
            "out of reach",
        ),
        (negative, &[], &["trunk", "negative"], "--inertia"),
        (
            uneven,
            &[],
            &["foot's radius", "0.05", "0.02", "calf_joint"],
            "node",
        ),
        (
            mimic,
            &[],
            &["FL_calf_joint", "<mimic>", "motor of its own"],
            "--lock",
        ),
        (
            "<mujoco/>".to_owned(),
            &[],
            &["<mujoco>", "MJCF", "saltus import", "URDF"],
            "or <mujoco>",
        ),
        (
            "<sdf/>".to_owned(),
            &[],
            &["<sdf>", "<robot>", "xacro"],
            "MJCF",
        ),
        (
            a1(),
            &["FL_hip_joint=0"],
            &["12", "11", "three revolute joints"],
            "--lock",
        ),
    ] {
        let error = folder
            .load("robot.urdf", &text, locks)
            .map(|_| ())
            .unwrap_err();
        for word in words {
            assert!(error.contains(word), "{word}: {error}");
        }
        assert!(!error.contains(never), "{never}: {error}");
    }
}

/// A trunk's box stands as its file turns it: on its side it is as high as it was wide.
#[test]
fn the_box_of_a_trunk_may_be_turned() {
    let folder = Folder::new("turned");
    let size = "<box size=\"0.267 0.194 0.114\"/>";
    let level =
        "<collision>\n      <origin rpy=\"0 0 0\" xyz=\"0 0 0\"/>\n      <geometry>\n        "
            .to_owned()
            + size;
    let turned = a1().replacen(
        &level,
        &level.replace("rpy=\"0", "rpy=\"1.5707963267948966"),
        1,
    );
    assert_ne!(turned, a1());
    let most = |text: &str| -> Vector3<f64> {
        let robot = folder.load("robot.urdf", text, &[]).unwrap();
        let corners = robot.corners.iter().map(Vector3::abs);
        corners.fold(Vector3::zeros(), |most: Vector3<f64>, corner| {
            most.sup(&corner)
        })
    };
    let half: Vector3<f64> = Vector3::new(0.267, 0.194, 0.114) * 0.5;
    assert!((most(&a1()) - half).norm() < 1e-12);
    assert!((most(&turned) - half.xzy()).norm() < 1e-12);
}

/// A name that is neither built in nor a file.
#[test]
fn a_robot_that_is_not_built_in_is_told_what_is() {
    let text = "robot = \"spot\"\ngoal_m = [0, 0, 0]\n[[phase]]\nfeet = []\nguess_s = 0.3\n";
    let file = TaskFile::parse(Path::new("t.toml"), text).unwrap();
    let error = file
        .own_robot("t.toml", Path::new(""))
        .map(|_| ())
        .unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("spot") && error.contains("\"a1\""),
        "{error}"
    );
}

/// A plan opened for another robot tells which it is for.
#[test]
fn a_plan_for_another_robot_names_both() {
    let folder = Folder::new("plan");
    let task = Task::load("a1/lateral").unwrap();
    let srb = task.solve().unwrap();
    let bytes = Planner::Kinematics.plan(&task, &srb).unwrap().bytes;
    assert!(open_for(&bytes, &task.robot).is_ok());
    let text = a1().replacen("name=\"a1\"", "name=\"wolf\"", 1);
    let other = folder.load("wolf.urdf", &text, &[]).unwrap();
    let error = open_for(&bytes, &other).map(|_| ()).unwrap_err();
    for word in ["another robot, a1 ", "not for wolf ", "--robot"] {
        assert!(error.contains(word), "{word}: {error}");
    }
}
