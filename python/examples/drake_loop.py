"""A jump in Drake, closed from outside as robots are driven: sensors in, commands with joint gains out, both 1000 times a second.

drake_loop.py [TASK]
"""

import logging
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, HalfSpace
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction, MultibodyPlant
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Diagram, DiagramBuilder

import saltus

HOLD, SETTLE, STEP, PERIOD = 1.2, 2.0, 2.5e-4, 1e-3
GRAVITY = np.array([0.0, 0.0, -9.81])
A1 = Path(__file__).parents[2] / "models/a1.urdf"


def world(robot: saltus.Robot) -> tuple[Diagram, MultibodyPlant]:
    """A1's URDF on a floor, with the rotors that it does not have; links touch the floor, and not each other."""
    builder = DiagramBuilder()
    plant, scene = AddMultibodyPlantSceneGraph(builder, STEP)
    urdf = ElementTree.parse(A1).getroot()
    for parent in [urdf, *urdf.iter("link")]:
        for child in parent.findall("visual") + parent.findall("transmission"):
            parent.remove(child)  # Meshes that are not here, and motors of which nothing is said.
    text = ElementTree.tostring(urdf, encoding="unicode")
    (model,) = Parser(plant).AddModelsFromString(text, "urdf")
    for name, inertia in zip(robot.joint_names, robot.armature):
        motor = plant.AddJointActuator(name, plant.GetJointByName(name))
        motor.set_default_rotor_inertia(inertia)
        motor.set_default_gear_ratio(1.0)
    rough, here = CoulombFriction(0.6, 0.6), RigidTransform()
    plant.RegisterCollisionGeometry(plant.world_body(), here, HalfSpace(), "floor", rough)
    plant.Finalize()
    bodies = [plant.get_body(index) for index in plant.GetBodyIndices(model)]
    shapes = [shape for body in bodies for shape in plant.GetCollisionGeometriesForBody(body)]
    ours = CollisionFilterDeclaration().ExcludeWithin(GeometrySet(shapes))
    scene.collision_filter_manager().Apply(ours)
    return builder.Build(), plant


class Body:
    """The robot in its world: what its sensors say, and what its motor boards do."""

    def __init__(self, robot: saltus.Robot, start: np.ndarray) -> None:
        """Stands at `start`."""
        diagram, self.plant = world(robot)
        self.robot, self.simulator = robot, Simulator(diagram)
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        joints = [self.plant.GetJointByName(name) for name in robot.joint_names]
        self.q = [joint.position_start() for joint in joints]
        self.v = [joint.velocity_start() for joint in joints]
        self.shanks = [joint.child_body().index() for joint in joints[2::3]]
        self.base = self.plant.GetBodyByName("base")
        for joint, angle in zip(joints, start[7:]):
            joint.set_angle(self.context, angle)
        x, y, z, w = start[3:7]
        pose = RigidTransform(Quaternion([w, x, y, z]), start[:3])
        self.plant.SetFreeBodyPose(self.context, self.base, pose)
        self.velocity = np.zeros(3)
        self.torques = np.zeros(12)

    def joints(self) -> tuple[np.ndarray, np.ndarray]:
        """What the encoders say."""
        positions = self.plant.GetPositions(self.context)
        return positions[self.q], self.plant.GetVelocities(self.context)[self.v]

    def sense(self, estimator: saltus.Estimator) -> saltus.Observation:
        """What the machine is told: an IMU, encoders, and the forces under the feet."""
        to_base = self.base.EvalPoseInWorld(self.context).rotation().inverse()
        motion = self.base.EvalSpatialVelocityInWorld(self.context)
        felt = (motion.translational() - self.velocity) / PERIOD - GRAVITY
        self.velocity = motion.translational()
        forces = self.forces()
        rate = to_base @ motion.rotational()
        return estimator.step(to_base @ felt, rate, *self.joints(), forces, self.torques)

    def forces(self) -> np.ndarray:
        """What the floor presses on every leg, N; a foot is welded to its shank."""
        forces = np.zeros(4)
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        for i in range(results.num_point_pair_contacts()):
            contact = results.point_pair_contact_info(i)
            for index in (contact.bodyA_index(), contact.bodyB_index()):
                welded = self.plant.GetBodiesWeldedTo(self.plant.get_body(index))
                for leg, shank in enumerate(self.shanks):
                    if any(body.index() == shank for body in welded):
                        forces[leg] += abs(contact.contact_force()[2])
        return forces

    def act(self, command: saltus.Command, until: float) -> None:
        """What motor boards do until this time: joint gains, the current's limit, and the friction that Drake does not have."""
        while self.context.get_time() < until - STEP / 2:
            q, v = self.joints()
            tau = command.tau + command.kp * (command.q - q) + command.kd * (command.dq - v)
            self.torques = np.clip(tau, -self.robot.max_torque, self.robot.max_torque)
            moved = self.torques - self.robot.friction * np.tanh(v / 0.1)
            self.plant.get_actuation_input_port().FixValue(self.context, moved)
            self.simulator.AdvanceTo(self.context.get_time() + STEP)


def main(task: str = "a1/lateral") -> None:
    """Plans and flies."""
    logging.getLogger("drake").setLevel(logging.ERROR)
    plan = saltus.plan(task)
    body = Body(plan.robot, plan.q[0])
    machine, estimator = plan.machine(start=HOLD), saltus.Estimator(plan.robot, plan.q[0])
    for k in range(int((HOLD + plan.touchdown + SETTLE) / PERIOD)):
        command = machine.tick(k * PERIOD, body.sense(estimator)).command
        body.act(command, (k + 1) * PERIOD)
    pose = body.base.EvalPoseInWorld(body.context)
    up = pose.rotation().matrix()[2, 2]
    place = pose.translation().round(3)
    print(f"{task}: {machine.phase}, base at {place}, upright {up:.3f}, fault {machine.fault}")
    if machine.phase != "Stand" or up < 0.97:
        sys.exit("the robot does not stand")


if __name__ == "__main__":
    main(*sys.argv[1:])
