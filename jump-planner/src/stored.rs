//! A whole-body plan as a container, and back.

use super::planned::{Origin, node, peaks};
use super::reference::{Reference, standing};
use super::task::Task;
use super::whole_body::{POSED, WholeBodyPlan};
use super::{FOOT_COUNT, JOINTS, Node};
use crate::robot::Quadruped;
use jump_control::Torques;
use jump_control::container::{
    Container, ContainerError, GroundStep, Header, LONGEST_TASK, MOST_PHASES, Margins, PlanNode,
    PlanPhase, model_hash, write,
};
use rbd_core::{Configuration, Model, Tangent};
use std::path::Path;
use wb_opt::Phase;

/// A plan's container, for a quadruped.
pub type Stored<'a> = Container<'a, JOINTS, FOOT_COUNT>;

/// Joint angles that differ by less are the same posture: what single precision leaves, and more, rad.
const SAME_POSTURE: f64 = 1e-4;

/// What a planner says of a jump, beyond what its task says.
pub(crate) struct Content<'a> {
    /// Nodes with their contact phase; they begin with the posture in which the robot waits.
    pub(crate) nodes: &'a [(usize, Node)],
    /// Which feet stand in each phase, and how long it is, s.
    pub(crate) phases: &'a [([bool; FOOT_COUNT], f64)],
    /// When the landing posture stands, s.
    pub(crate) posing: f64,
    /// Share of the motors' torque that was planned with.
    pub(crate) torque_share: f64,
}

/// The container of a whole-body plan.
///
/// # Errors
/// More nodes or a longer name than a container takes, or a robot that cannot stand or land.
pub fn store(task: &Task, plan: &WholeBodyPlan) -> Result<Vec<u8>, String> {
    let mut nodes = vec![(0, standing(task)?)];
    let contacts = plan.phases.iter().enumerate();
    let phase_of = contacts.flat_map(|(i, phase)| core::iter::repeat_n(i, phase.intervals));
    for (interval, phase) in plan.intervals.iter().zip(phase_of) {
        let at = node(interval.start, &interval.state, Some(interval));
        nodes.push((phase, at));
    }
    let span = |phase: &Phase<f64, FOOT_COUNT>| phase.dt * phase.intervals as f64;
    let phases: Vec<_> = plan.phases.iter().map(|p| (p.contacts, span(p))).collect();
    let touchdown: f64 = phases.iter().map(|(_, duration)| duration).sum();
    let last = phases.len().saturating_sub(1);
    nodes.push((last, node(touchdown, &plan.end, None)));
    let content = Content {
        nodes: &nodes,
        phases: &phases,
        posing: touchdown - POSED,
        torque_share: plan.torque_share,
    };
    content.write(task)
}

impl Content<'_> {
    /// The container.
    pub(crate) fn write(&self, task: &Task) -> Result<Vec<u8>, String> {
        let robot = &task.robot;
        let records = self.nodes.iter();
        let nodes: Vec<_> = records
            .map(|(phase, node)| record(robot, *phase as u8, node))
            .collect();
        let mut out = vec![0; Stored::size(nodes.len())];
        let header = self.header(task)?;
        write(&mut out, hash(robot), &header, &nodes).map_err(|error| error.to_string())?;
        Ok(out)
    }

    fn header<'t>(&self, task: &'t Task) -> Result<Header<'t, JOINTS>, String> {
        let robot = &task.robot;
        let standing = |(contacts, _): &&([bool; FOOT_COUNT], f64)| contacts.contains(&true);
        let pushing = self.phases.iter().take_while(standing);
        let takeoff: f64 = pushing.map(|(_, duration)| duration).sum();
        let touchdown: f64 = self.phases.iter().map(|(_, duration)| duration).sum();
        let mut phases = [PlanPhase::default(); MOST_PHASES];
        for (slot, (contacts, duration)) in phases.iter_mut().zip(self.phases) {
            let bits = contacts.iter().enumerate();
            *slot = PlanPhase {
                contacts: bits.fold(0, |bits, (i, on)| bits | (u8::from(*on) << i)),
                duration: *duration as f32,
            };
        }
        Ok(Header {
            task: short(&task.name),
            robot: robot.name,
            torques: Torques::Hold,
            takeoff: takeoff as f32,
            posing: self.posing as f32,
            touchdown: touchdown as f32,
            phase_count: self.phases.len() as u8,
            phases,
            ground: ground(task),
            margins: margins(task, self.torque_share as f32),
            goal_w: goal(task).0,
            heading: goal(task).1,
            landing_joints: task.landing_joints().map(|x| x as f32),
            // What is written counts them.
            nodes: 0,
        })
    }
}

/// A task's name as far as there is room: where the path of its file is too long, the file's own name, for which `--task` makes up.
fn short(name: &str) -> &str {
    if name.len() <= LONGEST_TASK {
        return name;
    }
    let file = Path::new(name).file_name().and_then(|file| file.to_str());
    file.unwrap_or(name)
}

/// Wanted displacement of the base, m, and heading, rad, as they are stored.
fn goal(task: &Task) -> ([f32; 3], f32) {
    let goal: [f64; 3] = task.goal.into();
    (goal.map(|x| x as f32), task.heading as f32)
}

fn ground(task: &Task) -> Option<GroundStep> {
    task.edge.map(|edge| GroundStep {
        drop: edge.drop as f32,
        axis: edge.axis as u8,
        side: edge.sign as i8,
        distance: edge.distance as f32,
    })
}

/// Whether a plan's header says what its task does.
///
/// # Errors
/// A sentence: of another box, to another goal, within other margins, or into another landing posture.
pub fn agree(header: &Header<'_, JOINTS>, task: &Task) -> Result<(), String> {
    let other = |what: &str| Err(format!("{what} than task {}: plan again", task.name));
    if header.ground != ground(task) {
        return other("the plan is for another box");
    }
    if (header.goal_w, header.heading) != goal(task) {
        return other("the plan has another goal");
    }
    let shares = task.limits.torque_shares.map(|share| share as f32);
    let known = shares
        .into_iter()
        .any(|share| header.margins == margins(task, share));
    if !known {
        return other("the plan keeps to other margins");
    }
    let pairs = header.landing_joints.iter().zip(task.landing_joints());
    let gap = pairs.fold(0.0, |m: f64, (a, b)| m.max((f64::from(*a) - b).abs()));
    if gap > SAME_POSTURE {
        return other("the plan lands in another posture");
    }
    Ok(())
}

/// What a plan of this task keeps to, with this share of the torque.
fn margins(task: &Task, torque_share: f32) -> Margins {
    Margins {
        friction: task.limits.friction as f32,
        friction_share: task.limits.friction_share as f32,
        max_force: task.problem.max_force as f32,
        torque_share,
        speed_share: task.limits.speed_share as f32,
        weight: (task.problem.mass * task.problem.gravity) as f32,
    }
}

/// A stored plan as the controller follows it, with the task that it is judged by.
///
/// # Errors
/// What [`agree`] says, or a plan from another posture.
pub fn reference(plan: &Stored<'_>, task: &Task) -> Result<Reference, String> {
    let header = plan.header();
    agree(header, task)?;
    let nodes: Vec<Node> = plan.nodes().map(|node| node.node()).collect();
    let gap = |node: &Node| {
        let pairs = node.joints.iter().zip(&task.start.joints);
        pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
    };
    // Not `>`: what is not a number is no start either.
    if !nodes.first().is_some_and(|node| gap(node) <= SAME_POSTURE) {
        return Err(format!(
            "the plan begins in another posture than task {}: plan again",
            task.name
        ));
    }
    let takeoff = f64::from(header.takeoff);
    let [peak_torque, peak_friction] = peaks(&nodes, takeoff);
    let phases = header.phases.iter().take(header.phase_count.into());
    Ok(Reference {
        bytes: plan.bytes().to_vec(),
        takeoff,
        posing: f64::from(header.posing),
        touchdown: f64::from(header.touchdown),
        landing_joints: header.landing_joints.map(f64::from),
        durations: phases.map(|phase| f64::from(phase.duration)).collect(),
        peak_torque,
        peak_friction,
        base_residual: f64::NAN,
        origin: Origin::Stored,
        nodes,
    })
}

impl Reference {
    /// Writes the torques of [`Reference::nodes`] into the bytes, for a study that changed them.
    ///
    /// # Errors
    /// Bytes that are no plan.
    pub fn store_torques(&mut self) -> Result<(), String> {
        let show = |error: ContainerError| error.to_string();
        let stored = Stored::read(&self.bytes).map_err(show)?;
        let mut nodes: Vec<_> = stored.nodes().collect();
        for (stored, node) in nodes.iter_mut().zip(&self.nodes) {
            stored.torques = node.torques.map(|x| x as f32);
        }
        let mut bytes = vec![0; self.bytes.len()];
        write(&mut bytes, stored.robot(), stored.header(), &nodes).map_err(show)?;
        self.bytes = bytes;
        Ok(())
    }
}

/// Opens a container for a robot.
///
/// # Errors
/// [`ContainerError`] says why the bytes are no plan for this robot.
pub fn open<'a>(bytes: &'a [u8], robot: &Quadruped) -> Result<Stored<'a>, ContainerError> {
    Container::open(bytes, hash(robot))
}

/// As [`open`], of a whole file and for people: of a plan for another robot it tells which, and what to do. Bytes behind the plan, which a page
/// of flash has, are refused: a file that has them was not written so.
///
/// # Errors
/// A sentence.
pub fn open_for<'a>(bytes: &'a [u8], robot: &Quadruped) -> Result<Stored<'a>, String> {
    let plan = open(bytes, robot).map_err(|error| match (error, Stored::read(bytes)) {
        (ContainerError::Robot { planned, given }, Ok(plan)) => format!(
            "a plan for another robot, {} (model {planned:016x}), and not for {} (model {given:016x}): \
             give the URDF or profile that it was planned for, with --robot",
            plan.header().robot,
            robot.name
        ),
        (error, _) => error.to_string(),
    })?;
    match bytes.len() - plan.bytes().len() {
        0 => Ok(plan),
        behind => Err(format!(
            "{behind} bytes stand behind the plan's own {}, which no planner wrote: copy the plan again",
            plan.bytes().len()
        )),
    }
}

fn hash(robot: &Quadruped) -> u64 {
    model_hash::<f64, _, JOINTS>(robot)
}

fn record(robot: &Quadruped, phase: u8, node: &Node) -> PlanNode<JOINTS, FOOT_COUNT> {
    let single = |x: [f64; 3]| x.map(|x| x as f32);
    let q = Configuration {
        base: node.base,
        joints: node.joints,
    };
    let legs_only = Tangent {
        joints: node.joint_velocities,
        ..Tangent::ZERO
    };
    let kinematics = robot.poses(&q);
    let to_base = node.base.rotation.inverse();
    let mut feet_b = [[0.0; 3]; FOOT_COUNT];
    let mut foot_velocities_b = feet_b;
    for (leg, frame) in robot.feet.iter().enumerate() {
        let foot_w = kinematics.frame(frame).translation - node.base.translation;
        feet_b[leg] = single((to_base * foot_w - robot.hips[leg]).into());
        let velocity_w = robot.jacobian(&kinematics, frame).mul(&legs_only).linear;
        foot_velocities_b[leg] = single((to_base * velocity_w).into());
    }
    let rotation = node.base.rotation.matrix();
    let rows: [[f64; 3]; 3] = core::array::from_fn(|i| core::array::from_fn(|k| rotation[(i, k)]));
    PlanNode {
        phase,
        time: node.time as f32,
        position_w: single(node.base.translation.into()),
        rotation_wb: rows.map(single),
        velocity_b: node.base_velocity.to_array().map(|x| x as f32),
        joints: node.joints.map(|x| x as f32),
        joint_velocities: node.joint_velocities.map(|x| x as f32),
        torques: node.torques.map(|x| x as f32),
        forces_w: node.forces_w.map(|f| single(f.into())),
        feet_b,
        foot_velocities_b,
    }
}

/// Name of a robot's joint, without the word every joint has.
#[must_use]
pub fn joint_name(robot: &Quadruped, i: usize) -> String {
    Model::joint_names(robot)[i].replace("_joint", "")
}
