//! A quadruped from a URDF.
//!
//! Required: a floating base with exactly twelve joints, four legs of three revolute joints that hang from the base, one leg per quadrant
//! around the base (x forwards, y to the left), effort and speed limits. The foot of a leg is the frame on its last link that is farthest
//! from the knee; the radius of its ball is that of the sphere in the foot link's `<collision>`, else 1 mm. The trunk is the
//! largest box in the `<collision>` of the base, else the box between the hips.

use super::profile::{KnownBuild, LimbsTable, ProfileFile};
use super::{
    Data, JOINTS, LEGS, OWNER_COUNT, PLACES, Quadruped, RobotError, SHAPE_COUNT, State, hardware,
};
use crate::range::Range;
use model_import::{ImportError, InertiaPolicy, Options, Robot, parse_lock};
use nalgebra::Vector3;
use rbd_core::{
    BaseKind, Frame, JointLimits, Kinematics, Link, Posture, Shape, TableModel, Transform,
    forward_kinematics,
};
use roxmltree::{Document, Node};
use so3::euler::RollPitchYaw;
use std::path::Path;

/// Leg below its hip in the posture from which standing postures are searched, as a share of the leg.
const SEED_LEG: f64 = 0.65;
/// Radius of a foot without a ball, m: simulators do not feel points.
const POINT: f64 = 1e-3;
/// Shank of a leg whose foot nothing in the file tells, as a share of the thigh: its only frame stands in the knee.
const NO_SHANK: f64 = 0.1;
/// Joint positions that are tried per joint.
const SEED_STEPS: usize = 25;
/// How far the sides of a trunk without a box are inside of the hips' joints, as a share of the leg: half a hip and half a thigh.
const LEG_ROOM: f64 = 0.1;
/// Half height of a trunk without a box, as a share of the leg.
const TRUNK_HEIGHT: f64 = 0.14;

impl Quadruped {
    /// The robot of a URDF, or of a profile (`.toml`) that names one, with joints locked as `JOINT=VALUE`. See the module for what a URDF
    /// must have.
    ///
    /// # Errors
    /// [`RobotError`] names what is missing or cannot be, and where.
    pub fn load(path: &Path, locks: &[String]) -> Result<Self, RobotError> {
        if path.extension().is_none_or(|end| end != "toml") {
            return Self::from_urdf(path, locks, None);
        }
        let (profile, urdf) = ProfileFile::load(path)?;
        let locks = [profile.locks(), locks].concat();
        Self::from_urdf(&urdf, &locks, Some(&profile)).map_err(|error| match error {
            RobotError::File(error) => RobotError::Urdf { path: urdf, error },
            other => other,
        })
    }

    fn from_urdf(
        path: &Path,
        locks: &[String],
        profile: Option<&ProfileFile>,
    ) -> Result<Self, RobotError> {
        let text = crate::file::read_text(path)?;
        let locks = locks.iter().map(|lock| parse_lock(lock));
        let mut options = Options {
            base: BaseKind::Floating,
            locks: locks.collect::<Result<_, _>>()?,
            ..Options::default()
        };
        let imported = match Robot::from_urdf(&text, &options) {
            // Simplified moments of inertia are common, and a plan needs only those of the whole robot; negative ones are a mistake.
            Err(ImportError::UnphysicalInertia { moments, .. }) if moments[0] >= 0.0 => {
                options.inertia = InertiaPolicy::AsWritten;
                Robot::from_urdf(&text, &options)?
            }
            // Remedies of `saltus import` that a plan does not offer.
            Err(ImportError::UnphysicalInertia { element, moments }) => {
                return Err(RobotError::NegativeInertia { element, moments });
            }
            Err(ImportError::NotARobot { found }) => return Err(RobotError::NotAUrdf(found)),
            other => other?,
        };
        Self::of(&imported, &text, profile)
    }

    fn of(robot: &Robot, text: &str, profile: Option<&ProfileFile>) -> Result<Self, RobotError> {
        check_legs(robot)?;
        size("mass, kg", Range::Above(0.01, 1e4), robot.mass())?;
        let table: TableModel<f64, JOINTS> = robot.model()?;
        let document = Document::parse(text)?;
        let (feet, radii) = feet(robot, &document)?;
        // Where joints and feet are with all joints at zero: frames of links need not be parallel to the base's.
        let mut zero: Kinematics<f64, JOINTS> = Kinematics::IDENTITY;
        forward_kinematics(&table, &Posture::new(&table, &State::NEUTRAL), &mut zero);
        let joint = |i: usize| zero.link(Link::Joint(i)).translation;
        let foot = |leg: usize| zero.frame(&feet[leg]).translation;
        let hips = core::array::from_fn(|leg| {
            let second = joint(3 * leg + 1);
            Vector3::new(second.x, foot(leg).y, second.z)
        });
        let planar = |v: Vector3<f64>| so3::math::hypot(v.x, v.z);
        let length = |leg: usize| {
            let knee = joint(3 * leg + 2);
            planar(knee - joint(3 * leg + 1)) + planar(foot(leg) - knee)
        };
        let leg_length = (0..LEGS).map(length).fold(f64::INFINITY, f64::min);
        size("leg's length, m", Range::Above(0.01, 100.0), leg_length)?;
        let ball = Range::Above(0.0, leg_length);
        let foot_radius = one_radius(robot, &radii, ball)?;
        let limits: [JointLimits<f64>; JOINTS] = core::array::from_fn(|i| robot.joints[i].limits);
        let strongest = limits
            .iter()
            .fold(0.0, |m, limit| f64::max(m, limit.effort));
        let mut data = Data {
            name: leaked(&robot.name),
            table,
            limits,
            motors: None,
            joint_names: core::array::from_fn(|i| leaked(&robot.joints[i].name)),
            legs: quadrants(&hips)?,
            feet,
            foot_radius,
            hips,
            leg_length,
            corners: trunk(&document, robot, leg_length)?,
            shapes: [Shape::ball(Link::Base, [0.0; 3], 0.0, 0); SHAPE_COUNT],
            owners: [""; OWNER_COUNT],
            budgets: hardware::budgets(strongest),
            build: KnownBuild::default(),
            stands_by_com: false,
            limbs: LimbsTable::default(),
            seed: [0.0; JOINTS],
        };
        profile.map_or(Ok(()), |profile| profile.apply(&mut data))?;
        // After the profile, whose motors stand in for what a URDF does not say.
        let named = data.joint_names.iter().zip(&data.limits);
        named
            .into_iter()
            .try_for_each(|(name, limits)| check_limits(name, limits))?;
        size("foot's radius, m", ball, data.foot_radius)?;
        data.seed = seed(&data)?;
        data.shapes = hardware::shapes(&data);
        data.owners = hardware::owners(&Self::leak(data.clone()));
        Ok(Self::leak(data))
    }
}

/// Refuses what is nowhere near a robot: a solver would look for long for a jump of a feather or a mountain.
fn size(what: &'static str, range: Range, x: f64) -> Result<(), RobotError> {
    range
        .check(x)
        .map_err(|error| RobotError::Size { what, error })
}

/// Refuses what is no floating base with four legs of three revolute joints.
fn check_legs(robot: &Robot) -> Result<(), RobotError> {
    let names = || robot.joints.iter().map(|joint| joint.name.as_str());
    if robot.joints.len() != JOINTS {
        return Err(RobotError::Joints {
            count: robot.joints.len(),
            names: names().collect::<Vec<_>>().join(", "),
        });
    }
    if let Some(i) = robot.couplings.iter().position(Option::is_some) {
        return Err(RobotError::Follows(robot.joints[i].name.clone()));
    }
    for (i, body) in robot.bodies.iter().enumerate() {
        let parent = match i % 3 {
            0 => Link::Base,
            _ => Link::Joint(i - 1),
        };
        if body.parent != parent || !body.kind.is_revolute() {
            return Err(RobotError::NotALeg(robot.joints[i].name.clone()));
        }
    }
    Ok(())
}

/// The feet and their radii: of each leg the frame farthest from the last joint, or the ball there.
fn feet(
    robot: &Robot,
    document: &Document<'_>,
) -> Result<([Frame<f64>; LEGS], [f64; LEGS]), RobotError> {
    let mut feet = [Frame::IDENTITY; LEGS];
    let mut radii = [POINT; LEGS];
    for (leg, foot) in feet.iter_mut().enumerate() {
        let last = Link::Joint(3 * leg + 2);
        let reach = |frame: &Frame<f64>| Vector3::from(frame.offset).norm();
        let tips = robot.frames.iter().filter(|f| f.frame.link == last);
        let tip = tips
            .max_by(|a, b| reach(&a.frame).total_cmp(&reach(&b.frame)))
            .ok_or_else(|| RobotError::NotALeg(robot.joints[3 * leg + 2].name.clone()))?;
        *foot = tip.frame;
        if let Some((radius, centre)) = ball(document, &tip.name)? {
            radii[leg] = radius;
            foot.offset = tip.frame.placement().point(&centre).into();
        }
        let thigh = Vector3::from(robot.bodies[3 * leg + 2].offset).norm();
        if Vector3::from(foot.offset).norm() < NO_SHANK * thigh {
            let name = &robot.joints[3 * leg + 2].name;
            return Err(RobotError::NoFoot(name.clone()));
        }
        foot.rotation = Frame::IDENTITY.rotation;
    }
    Ok((feet, radii))
}

/// The radius of all feet, m.
fn one_radius(robot: &Robot, radii: &[f64; LEGS], ball: Range) -> Result<f64, RobotError> {
    let what = "foot's radius, m";
    radii
        .iter()
        .try_for_each(|radius| size(what, ball, *radius))?;
    let [first, ..] = *radii;
    let Some(leg) = radii.iter().position(|radius| *radius != first) else {
        return Ok(first);
    };
    Err(RobotError::Size {
        what,
        error: format!(
            "must be that of all four feet, not {first} with joint {} and {} with joint {}",
            robot.joints[2].name,
            radii[leg],
            robot.joints[3 * leg + 2].name
        ),
    })
}

/// Limits that the plan keeps to: without them, or with those of no motor, it would promise anything.
fn check_limits(joint: &str, limits: &JointLimits<f64>) -> Result<(), RobotError> {
    for (what, value) in [("effort", limits.effort), ("velocity", limits.speed)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(RobotError::Limit {
                joint: joint.to_owned(),
                what,
                value,
            });
        }
    }
    let (lower, upper) = (limits.lower, limits.upper);
    if lower < upper {
        return Ok(());
    }
    Err(RobotError::Range {
        joint: joint.to_owned(),
        lower,
        upper,
    })
}

/// Names of a robot live as long as the robot, which lives as long as the program.
pub(crate) fn leaked(name: &str) -> &'static str {
    Box::leak(name.to_owned().into_boxed_str())
}

/// The leg at each of [`PLACES`].
fn quadrants(hips: &[Vector3<f64>; LEGS]) -> Result<[usize; LEGS], RobotError> {
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let mut legs = [0; LEGS];
    for ((slot, (x, y)), place) in legs.iter_mut().zip(signs).zip(PLACES) {
        let stands = |hip: &Vector3<f64>| hip.x * x > 0.0 && hip.y * y > 0.0;
        *slot = hips
            .iter()
            .position(stands)
            .ok_or_else(|| RobotError::Quadrant {
                place,
                feet: hips
                    .map(|hip| format!("({:.3}, {:.3})", hip.x, hip.y))
                    .join(", "),
            })?;
    }
    Ok(legs)
}

/// Joints that put every foot best under its hip, knees behind where both ways are possible.
fn seed(data: &Data) -> Result<[f64; JOINTS], RobotError> {
    let grid = |limit: &JointLimits<f64>, i: usize| {
        let (low, high) = (limit.lower.max(-2.8), limit.upper.min(2.8));
        low + (high - low) * i as f64 / (SEED_STEPS - 1) as f64
    };
    let robot = Quadruped::leak(data.clone());
    let mut best = [0.0; JOINTS];
    for leg in 0..LEGS {
        let target = data.hips[leg] - Vector3::z() * (SEED_LEG * data.leg_length);
        let mut least = f64::INFINITY;
        for i in 0..SEED_STEPS * SEED_STEPS {
            let mut q = State {
                base: Transform::IDENTITY,
                joints: [0.0; JOINTS],
            };
            let first = &data.limits[3 * leg];
            q.joints[3 * leg] = 0.0_f64.clamp(first.lower, first.upper);
            q.joints[3 * leg + 1] = grid(&data.limits[3 * leg + 1], i / SEED_STEPS);
            q.joints[3 * leg + 2] = grid(&data.limits[3 * leg + 2], i % SEED_STEPS);
            let kinematics: Kinematics<f64, JOINTS> = robot.poses(&q);
            let miss = (kinematics.frame(&data.feet[leg]).translation - target).norm();
            let knee = kinematics.link(Link::Joint(3 * leg + 2)).translation;
            let ahead = (knee.x - data.hips[leg].x).max(0.0);
            let cost = miss + ahead;
            if cost < least {
                least = cost;
                best[3 * leg..3 * leg + 3].copy_from_slice(&q.joints[3 * leg..3 * leg + 3]);
            }
        }
        if least > data.leg_length {
            return Err(RobotError::Posture(robot.place(leg)));
        }
    }
    Ok(best)
}

/// Vector of an attribute such as `xyz="0 0 1"`; zero without it.
fn vector(node: Option<Node<'_, '_>>, name: &str) -> Vector3<f64> {
    let text = node.and_then(|node| node.attribute(name)).unwrap_or("");
    let numbers = text.split_whitespace().filter_map(|x| x.parse().ok());
    Vector3::from_iterator(numbers.chain([0.0; 3]).take(3))
}

/// Shapes in the collision elements of a link, with the place of each in the link's frame, m.
fn shapes<'a>(
    document: &'a Document<'a>,
    link: &'a str,
) -> impl Iterator<Item = (Node<'a, 'a>, Transform<f64>)> {
    let is_link = move |node: &Node<'_, '_>| {
        node.has_tag_name("link") && node.attribute("name") == Some(link)
    };
    let links = document.root_element().children().filter(is_link);
    let collisions = links.flat_map(|link| link.children());
    let collisions = collisions.filter(|node| node.has_tag_name("collision"));
    collisions.filter_map(|collision| {
        let child = |name: &'static str| collision.children().find(|n| n.has_tag_name(name));
        let shape = child("geometry")?.children().find(Node::is_element)?;
        let [xyz, rpy] = ["xyz", "rpy"].map(|name| vector(child("origin"), name));
        Some((shape, Transform::new(RollPitchYaw::Zyx.rotation(&rpy), xyz)))
    })
}

/// Radius and centre of the ball of a foot, in the frame of its link, m.
fn ball(document: &Document<'_>, link: &str) -> Result<Option<(f64, Vector3<f64>)>, RobotError> {
    let sphere = shapes(document, link).find(|(shape, _)| shape.has_tag_name("sphere"));
    let Some((shape, place)) = sphere else {
        return Ok(None);
    };
    let [radius] = measures(shape, link, "radius")?;
    Ok(Some((radius, place.translation)))
}

/// Measures of a collision shape, m.
fn measures<const K: usize>(
    shape: Node<'_, '_>,
    link: &str,
    what: &'static str,
) -> Result<[f64; K], RobotError> {
    let text = shape.attribute(what).unwrap_or_default();
    let numbers = text
        .split_whitespace()
        .map(|x| x.parse().unwrap_or(f64::NAN));
    let positive = |x: &f64| *x > 0.0 && x.is_finite();
    let found: Option<[f64; K]> = numbers.collect::<Vec<_>>().try_into().ok();
    found
        .filter(|all| all.iter().all(positive))
        .ok_or_else(|| RobotError::Shape {
            link: link.to_owned(),
            what,
            value: text.to_owned(),
        })
}

/// Corners of the trunk, base axes, m.
fn trunk(
    document: &Document<'_>,
    robot: &Robot,
    leg_length: f64,
) -> Result<[Vector3<f64>; 8], RobotError> {
    let offsets = robot
        .bodies
        .iter()
        .step_by(3)
        .map(|b| Vector3::from(b.offset));
    let hips = offsets.fold(Vector3::zeros(), |most: Vector3<f64>, o| most.sup(&o.abs()));
    // Narrower than the hips by the room that legs take.
    let wide = f64::max(hips.y - LEG_ROOM * leg_length, 0.5 * hips.y);
    let mut half = Vector3::new(hips.x, wide, TRUNK_HEIGHT * leg_length);
    let mut pose = Transform::IDENTITY;
    let mut largest = 0.0;
    for frame in robot.frames.iter().filter(|f| f.frame.link == Link::Base) {
        for (shape, place) in shapes(document, &frame.name) {
            if !shape.has_tag_name("box") {
                continue;
            }
            let size = Vector3::from(measures(shape, &frame.name, "size")?);
            if size.product() > largest {
                largest = size.product();
                half = size * 0.5;
                pose = frame.frame.placement().compose(&place);
            }
        }
    }
    Ok(hardware::corners(&half).map(|corner| pose.point(&corner)))
}
