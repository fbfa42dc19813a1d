//! A1 dropped on its feet: the landing controller in closed loop with any simulator.

use a1_model::{A1Geared, BUILD, FEET, FOOT_RADIUS, MOTORS, a1};
use contact_sim::{Error, NativeSimulator, Shape, Simulator, Terrain};
use jump_control::{JointCommand, JointGains};
use landing::{
    Detector, DetectorState, Landing, Outcome, PreLanding, Settings, Status, Target, Workspace,
};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{
    Configuration, Kinematics, Link, Motion, Posture, Tangent, forward_kinematics, joint_friction,
};

/// Contacts: four feet, then the trunk.
pub const CONTACTS: usize = 12;
/// A plant for drops.
pub type Plant = Box<dyn Simulator<f64, 12, CONTACTS, Error = Error>>;

/// Mass of the robot, kg; gravity, m/s².
const MASS: f64 = 13.741;
const GRAVITY: f64 = 9.81;
/// Thigh and shank, m.
const LINK: f64 = 0.2;

/// Legs under and 4 cm outside the hips, 0.29 m long.
pub const POSTURE: [f64; 12] = [
    0.14, 0.77, -1.54, -0.14, 0.77, -1.54, 0.14, 0.77, -1.54, -0.14, 0.77, -1.54,
];

/// What is wrong with a foot sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// Always zero.
    Dead,
    /// Always loaded.
    Stuck,
    /// Loaded or not at random, each millisecond.
    Chattering,
}

/// One drop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drop {
    /// Height of the lowest foot over the floor at the start, m.
    pub height: f64,
    /// Roll at the start, rad.
    pub roll: f64,
    /// Pitch at the start, rad.
    pub pitch: f64,
    /// Speed to the left at the start, m/s.
    pub sideways: f64,
    /// A foot with a bad sensor.
    pub fault: Option<(usize, Wrong)>,
}

/// What a drop ended in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Tilt below 10° after three seconds.
    pub upright: bool,
    /// The trunk touched the ground at any time.
    pub trunk_touched: bool,
    /// Slower than 5 cm/s after three seconds.
    pub at_rest: bool,
    /// Ticks at which the force program had no answer.
    pub failures: u32,
    /// Ticks at which it was stopped at its cap of factorisations.
    pub capped: u32,
    /// Sensors that the detector did not believe at some time.
    pub faulty: [bool; 4],
}

impl End {
    /// Upright, at rest, trunk untouched.
    #[must_use]
    pub const fn good(&self) -> bool {
        self.upright && !self.trunk_touched && self.at_rest
    }
}

/// The native simulator: feet and trunk corners as balls.
#[must_use]
pub fn native() -> Plant {
    let spheres: [Shape<f64>; CONTACTS] = core::array::from_fn(|i| match FEET.get(i) {
        Some(foot) => Shape::ball(foot.frame.link, foot.frame.offset, FOOT_RADIUS, i),
        None => {
            let side = |bit: usize| if (i >> bit) & 1 == 0 { 1.0 } else { -1.0 };
            let corner = [0.1235 * side(0), 0.087 * side(1), 0.047 * side(2)];
            Shape::ball(Link::Base, corner, 0.01, i)
        }
    });
    let settings = contact_sim::Settings::new(&a1::LIMITS, &MOTORS);
    Box::new(NativeSimulator::new(
        A1Geared,
        spheres,
        Terrain::FLAT,
        settings,
    ))
}

/// MuJoCo: feet as balls, the trunk as the published box.
///
/// # Errors
/// What MuJoCo says of the model.
#[cfg(feature = "mujoco")]
pub fn mujoco() -> Result<Plant, contact_sim::ModelRefused> {
    use contact_sim::{Geom, MujocoSimulator};
    let mut geoms: Vec<Geom> = FEET
        .iter()
        .enumerate()
        .map(|(i, foot)| Geom::of(foot, i))
        .collect();
    geoms.push(Geom::Box {
        frame: rbd_core::Frame::IDENTITY,
        half: [0.1335, 0.097, 0.057],
        owner: 4,
    });
    let mut settings = contact_sim::Settings::new(&a1::LIMITS, &MOTORS);
    settings.substeps = 1;
    let sim = MujocoSimulator::new(&A1Geared, (&geoms, &[]), &Terrain::FLAT, settings)?;
    Ok(Box::new(sim))
}

/// Numbers for a chattering sensor.
fn coin(seed: &mut u64) -> bool {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    *seed >> 63 == 1
}

/// Numbers in [0, 1) from a seed (SplitMix64).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Drop number `index` of a study, all sensors right: a height between two, tilted by up to 20° about any horizontal axis,
/// at up to 0.5 m/s sideways.
#[must_use]
pub fn drawn(seed: u64, index: u64, [low, high]: [f64; 2]) -> Drop {
    let mut state = seed ^ index.wrapping_mul(0xd134_2543_de82_ef95);
    let mut between = |a: f64, b: f64| a + (b - a) * uniform(&mut state);
    let tilt = between(0.0, 20.0).to_radians();
    let about = between(0.0, core::f64::consts::TAU);
    Drop {
        height: between(low, high),
        roll: tilt * so3::math::cos(about),
        pitch: tilt * so3::math::sin(about),
        sideways: between(-0.5, 0.5),
        fault: None,
    }
}

/// A drop with one sensor wrong: kinds and feet in turn.
#[must_use]
pub fn with_fault(drop: &Drop, index: u64) -> Drop {
    let kinds = [Wrong::Dead, Wrong::Stuck, Wrong::Chattering];
    let foot = (index / 3 % 4) as usize;
    Drop {
        fault: Some((foot, kinds[(index % 3) as usize])),
        ..*drop
    }
}

/// Height from which the knees alone can take up a level fall, m: at full torque from the landing posture to their stops,
/// feet under the hips. Beyond it a landing lives on what impacts and friction take.
///
/// 4 τ (q_stop − q) = m g (h + ΔL), with legs of length L = 2 l cos(q/2).
#[must_use]
pub fn energy_bound() -> f64 {
    let (start, stop) = (-POSTURE[2], -a1::LIMITS[2].lower);
    let work = 4.0 * MOTORS[2].torque * (stop - start);
    let leg = |knee: f64| 2.0 * LINK * so3::math::cos(0.5 * knee);
    work / (MASS * GRAVITY) - (leg(start) - leg(stop))
}

fn place(plant: &mut Plant, drop: &Drop) {
    let mut q = Configuration {
        joints: POSTURE,
        ..Configuration::NEUTRAL
    };
    q.base.rotation = Rotation3::from_euler_angles(drop.roll, drop.pitch, 0.0);
    let mut kinematics = Kinematics::IDENTITY;
    forward_kinematics(&A1Geared, &Posture::new(&A1Geared, &q), &mut kinematics);
    let low = FEET
        .iter()
        .map(|foot| kinematics.frame(&foot.frame).translation.z)
        .fold(f64::INFINITY, f64::min);
    q.base.translation.z = drop.height + FOOT_RADIUS - low;
    let along = q.base.rotation.inverse() * Vector3::new(0.0, drop.sideways, 0.0);
    let start = Tangent {
        base: Motion::new(along, Vector3::zeros()),
        joints: [0.0; 12],
    };
    plant.reset(&q, &start);
}

/// Drops the robot and lets it settle for three seconds. Contact counts from 60 ms after the release, as it counts from the
/// pre-landing posture on in a jump.
///
/// # Errors
/// What the simulator says.
pub fn run(plant: &mut Plant, drop: &Drop) -> Result<End, Error> {
    place(plant, drop);
    let feet = FEET.map(|foot| foot.frame);
    let landing = Landing::<f64, 12, 4>::new(feet, Settings::new(&BUILD), [33.5; 12]);
    let mut workspace = Workspace::new();
    let detector = Detector::new(&BUILD, feet);
    let posture = PreLanding::new(&BUILD, feet, POSTURE);
    let mut contact = DetectorState::<f64, 12, 4>::new();
    let target = Target {
        height: 0.25,
        ..Target::LEVEL
    };
    let mut end = End {
        upright: false,
        trunk_touched: false,
        at_rest: false,
        failures: 0,
        capped: 0,
        faulty: [false; 4],
    };
    // Another chattering for every drop.
    let mut seed = drop.height.to_bits() ^ 7;
    let mut felt = [0.0; 12];
    for k in 0..3000 {
        let (q, v) = (*plant.configuration(), *plant.velocity());
        let mut forces: [f64; 4] = core::array::from_fn(|i| plant.contact_forces_w()[i].norm());
        if let Some((foot, wrong)) = drop.fault {
            forces[foot] = match wrong {
                Wrong::Dead => 0.0,
                Wrong::Stuck => 100.0,
                Wrong::Chattering if coin(&mut seed) => 100.0,
                Wrong::Chattering => 0.0,
            };
        }
        detector.update(&A1Geared, &mut contact, &q, &v, &felt, &forces, 1e-3);
        for (ever, now) in end.faulty.iter_mut().zip(contact.faulty) {
            *ever |= now;
        }
        let contacts = if k < 60 { [false; 4] } else { contact.contacts };
        let up_b = q.base.rotation.inverse() * Vector3::z();
        let waiting = posture.joints(&A1Geared, &up_b, &v.base.linear);
        let c = landing.step(
            &A1Geared,
            &q,
            &v,
            &contacts,
            &target,
            &waiting,
            &mut workspace,
        );
        match c.outcome {
            Outcome::Solved(_) | Outcome::Airborne => {}
            Outcome::Failed(Status::Limit) => end.capped += 1,
            Outcome::Failed(_) | Outcome::BadData => end.failures += 1,
        }
        let command = JointCommand {
            position: c.position,
            velocity: [0.0; 12],
            feed_forward: c.feed_forward,
            gains: core::array::from_fn(|i| JointGains {
                stiffness: c.stiffness[i],
                damping: c.damping[i],
            }),
        };
        felt = [0.0; 12];
        for _ in 0..10 {
            let (q, v) = (plant.configuration().joints, plant.velocity().joints);
            plant.step(&command.torques(&q, &v, &MOTORS))?;
            let friction = joint_friction(&a1::LIMITS, &v, 0.1);
            for ((felt, tau), loss) in felt.iter_mut().zip(plant.delivered()).zip(friction) {
                *felt += 0.1 * (tau + loss);
            }
            end.trunk_touched |= plant.contact_forces_w()[4..].iter().any(|f| f.norm() > 0.0);
        }
    }
    let up = plant.configuration().base.rotation * Vector3::z();
    end.upright = up.z > so3::math::cos(10_f64.to_radians());
    end.at_rest = plant.velocity().base.linear.norm() < 0.05;
    Ok(end)
}

/// The eighteen drops of one height: roll or pitch by 0, ±10 and ±20 degrees, at rest or at 0.5 m/s sideways.
pub fn eighteen(height: f64) -> impl Iterator<Item = Drop> {
    let tilts = [
        (0.0, 0.0),
        (10.0, 0.0),
        (-10.0, 0.0),
        (20.0, 0.0),
        (-20.0, 0.0),
        (0.0, 10.0),
        (0.0, -10.0),
        (0.0, 20.0),
        (0.0, -20.0),
    ];
    tilts
        .into_iter()
        .flat_map(move |(roll, pitch): (f64, f64)| {
            [0.0, 0.5].map(|sideways| Drop {
                height,
                roll: roll.to_radians(),
                pitch: pitch.to_radians(),
                sideways,
                fault: None,
            })
        })
}
