//! Descriptions that are larger than any robot are refused by name and at once, whatever they are full of.

use core::time::Duration;
use std::fs;
use std::path::Path;
use std::time::Instant;

use model_import::{ImportError, Options, Robot, mjcf};

const BODY: &str = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";

/// A URDF of so many links, each on the one that `above` says.
fn urdf(links: usize, kind: &str, above: impl Fn(usize) -> usize) -> String {
    let mut out = "<robot name='r'>\n".to_owned();
    for i in 0..links {
        out += &format!("<link name='l{i}'>{BODY}</link>\n");
    }
    for i in 1..links {
        let parent = above(i);
        out += &format!(
            "<joint name='j{i}' type='{kind}'><parent link='l{parent}'/><child link='l{i}'/><axis xyz='1 0 0'/></joint>\n"
        );
    }
    out + "</robot>"
}

fn refused(text: &str) -> ImportError {
    let clock = Instant::now();
    let read = match text.starts_with("<robot") {
        true => Robot::from_urdf(text, &Options::default()),
        false => Robot::from_mjcf(text, &Options::default()),
    };
    assert!(clock.elapsed() < Duration::from_secs(30));
    read.unwrap_err()
}

#[test]
fn chains_and_stars_of_thousands_are_refused() {
    for text in [
        urdf(20_000, "revolute", |i| i - 1),
        urdf(20_000, "continuous", |_| 0),
        urdf(20_000, "fixed", |i| i - 1),
    ] {
        let error = refused(&text);
        assert!(
            matches!(error, ImportError::TooLarge { most: 8192, .. }),
            "{error}"
        );
    }
    // What is a few thousand links, and no joints that move, is still read.
    let some = urdf(1000, "fixed", |i| i - 1);
    assert!(Robot::from_urdf(&some, &Options::default()).is_ok());
}

#[test]
fn bodies_in_bodies_end_before_the_stack_does() {
    let nested = |tag: &str, deep: usize| {
        let (open, close) = (
            format!("<{tag}>").repeat(deep),
            format!("</{tag}>").repeat(deep),
        );
        format!("<mujoco><worldbody>{open}{close}</worldbody></mujoco>")
    };
    for tag in ["body", "frame", "custom"] {
        let error = refused(&nested(tag, 5000));
        let words = error.to_string();
        assert!(words.contains("around one another"), "{tag}: {words}");
    }
}

#[test]
fn numbers_that_no_robot_has_are_refused_with_their_element() {
    let good = urdf(2, "revolute", |_| 0);
    for (from, to, what) in [
        ("mass value='1'", "mass value='1e308'", "mass"),
        ("ixx='1'", "ixx='-1e200'", "ixx"),
        ("<axis", "<origin xyz='0 1e100 0'/><axis", "origin xyz"),
        ("<axis", "<origin rpy='0 1e100 0'/><axis", "origin rpy"),
    ] {
        let words = refused(&good.replacen(from, to, 1)).to_string();
        assert!(
            words.contains(what) && words.contains("at most 1e9") && words.contains("(line "),
            "{words}"
        );
    }
}

#[test]
fn includes_that_grow_by_powers_end() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("powers");
    fs::create_dir_all(&folder).unwrap();
    for i in 0..12 {
        let next = format!("<include file='{}.xml'/>", i + 1).repeat(10);
        fs::write(
            folder.join(format!("{i}.xml")),
            format!("<mujoco>{next}</mujoco>"),
        )
        .unwrap();
    }
    fs::write(folder.join("12.xml"), "<mujoco/>").unwrap();
    let error = mjcf::read(&folder.join("0.xml")).unwrap_err();
    assert!(error.to_string().contains("1024 files"), "{error}");
}
