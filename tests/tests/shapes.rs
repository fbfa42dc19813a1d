//! A1's collision shapes are those of its URDF.

use std::fs;
use std::path::Path;

use a1_model::shapes::{HIP, HIP_RADIUS, OWNERS, SHANK, SHAPES, THIGH, TRUNK};
use a1_model::{A1, FOOT_RADIUS, a1};
use nalgebra::Vector3;
use rbd_core::{Configuration, Kinematics, Link, Model, Posture, Shape, forward_kinematics};
use roxmltree::{Document, Node};

/// The numbers of an attribute.
fn numbers(node: Node<'_, '_>, name: &str) -> Vec<f64> {
    let text = node.attribute(name).unwrap();
    text.split_whitespace()
        .map(|x| x.parse().unwrap())
        .collect()
}

/// The first collision element of a link: what solid it is, and where it is.
fn collision<'a>(document: &'a Document<'a>, link: &str) -> (Node<'a, 'a>, Vec<f64>) {
    let mut links = document.root_element().children();
    let link = links.find(|n| n.has_tag_name("link") && n.attribute("name") == Some(link));
    let collision = link
        .unwrap()
        .children()
        .find(|n| n.has_tag_name("collision"));
    let child = |name: &str| collision.unwrap().children().find(|n| n.has_tag_name(name));
    let solid = child("geometry").unwrap().children().find(Node::is_element);
    (solid.unwrap(), numbers(child("origin").unwrap(), "xyz"))
}

#[test]
fn sizes_are_those_of_the_urdf() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let text = fs::read_to_string(models.join("a1.urdf")).unwrap();
    let document = Document::parse(&text).unwrap();
    let (trunk, at) = collision(&document, "trunk");
    assert_eq!((numbers(trunk, "size"), at), (TRUNK.to_vec(), vec![0.0; 3]));
    for leg in ["FL", "FR", "RL", "RR"] {
        // Turned about y, so that its first side hangs down.
        for (link, [length, thickness]) in [("thigh", THIGH), ("calf", SHANK)] {
            let (solid, at) = collision(&document, &format!("{leg}_{link}"));
            let size = numbers(solid, "size");
            assert_eq!(size[0], length, "{leg} {link}");
            assert_eq!(f64::max(size[1], size[2]), thickness, "{leg} {link}");
            assert_eq!(at, [0.0, 0.0, -0.5 * length], "{leg} {link}");
        }
        let (hip, at) = collision(&document, &format!("{leg}_hip"));
        assert_eq!(
            (-0.5 * numbers(hip, "length")[0], at),
            (HIP[0], vec![0.0; 3])
        );
        let (motor, _) = collision(&document, &format!("{leg}_thigh_shoulder"));
        let offset = document.descendants().find(|n| {
            n.has_tag_name("joint") && n.attribute("name") == Some(&format!("{leg}_hip_fixed"))
        });
        let offset = offset
            .unwrap()
            .children()
            .find(|n| n.has_tag_name("origin"));
        let outside = numbers(offset.unwrap(), "xyz")[1].abs() + 0.5 * numbers(motor, "length")[0];
        assert!((outside - HIP[1]).abs() < 1e-12, "{outside}");
        let radius = f64::min(numbers(hip, "radius")[0], numbers(motor, "radius")[0]);
        assert_eq!(radius, HIP_RADIUS);
        let (foot, _) = collision(&document, &format!("{leg}_foot"));
        assert_eq!(numbers(foot, "radius")[0], FOOT_RADIUS);
    }
}

/// Every shape hangs on the link of its owner and, with all joints at zero, lies where that link is: left legs left, front legs in front,
/// every limb between its joint and the next.
#[test]
fn shapes_are_on_their_links() {
    let mut poses = Kinematics::IDENTITY;
    let neutral = Configuration::<f64, 12>::NEUTRAL;
    forward_kinematics(&A1, &Posture::new(&A1, &neutral), &mut poses);
    let at = |shape: &Shape<f64>, end: [f64; 3]| poses.link(shape.link).point(&Vector3::from(end));
    for shape in &SHAPES {
        let name = OWNERS[shape.owner];
        let ends = [at(shape, shape.from), at(shape, shape.to)];
        let Some((leg, part)) = name.split_once('_') else {
            assert_eq!((name, shape.link), ("trunk", Link::Base));
            for end in ends {
                let out = end.abs().add_scalar(shape.radius) - Vector3::from(TRUNK) * 0.5;
                assert!(out.max() < 1e-12, "{name}: {end}");
            }
            continue;
        };
        let Link::Joint(joint) = shape.link else {
            unreachable!("{name} hangs on the trunk")
        };
        let urdf = if part == "shank" || part == "foot" {
            "calf"
        } else {
            part
        };
        let names = Model::<f64, 12>::joint_names(&A1);
        assert_eq!(names[joint], format!("{leg}_{urdf}_joint"));
        for end in ends {
            assert_eq!(end.x > 0.0, leg.starts_with('F'), "{name}: {end}");
            assert_eq!(end.y > 0.0, leg.ends_with('L'), "{name}: {end}");
        }
        let foot = poses.frame(match leg {
            "FL" => &a1::frame::FL_FOOT,
            "FR" => &a1::frame::FR_FOOT,
            "RL" => &a1::frame::RL_FOOT,
            _ => &a1::frame::RR_FOOT,
        });
        let low = ends[1].z - shape.radius;
        let reach = match part {
            "foot" => foot.translation.z - FOOT_RADIUS,
            "shank" => foot.translation.z,
            "thigh" => foot.translation.z + SHANK[0],
            _ => -HIP_RADIUS,
        };
        assert!((low - reach).abs() < 1e-9, "{name}: {low}, not {reach}");
    }
}
