"""A jump over topics, as Gazebo and ROS have them: a world of its own process, and a controller that knows nothing else of it.

topics_loop.py [TASK]

Every millisecond the world publishes /imu, /joint_states, /contacts, and /clock as the last, and waits for /joint_command, which its
motor boards follow for the next one. In the place of pipes there may be any middleware; in the place of MuJoCo any world.
"""

import sys
from multiprocessing import Pipe, Process
from multiprocessing.connection import Connection

import mujoco
import numpy as np
from mujoco_loop import A1, HOLD, SETTLE, foot_forces, world

import saltus

STEPS = 10
COMMAND = ("q", "dq", "kp", "kd", "tau")


def robot_in_its_world(end: Connection, robot: dict, start: np.ndarray) -> None:
    """Sensors out, commands in, until the process is ended; what the robot is comes as numbers."""
    model = world(str(A1), saltus.Robot.a1())
    data = mujoco.MjData(model)
    joints = [model.joint(name) for name in robot["names"]]
    q = np.array([joint.qposadr[0] for joint in joints])
    v = np.array([joint.dofadr[0] for joint in joints])
    shanks = [model.jnt_bodyid[joint.id] for joint in joints[2::3]]
    model.dof_armature[v], model.dof_frictionloss[v] = robot["armature"], robot["friction"]
    model.dof_damping[v] = robot["damping"]
    data.qpos[:7], data.qpos[q] = start[[0, 1, 2, 6, 3, 4, 5]], start[7:]
    mujoco.mj_forward(model, data)
    effort = np.zeros(12)
    while True:
        imu = data.sensordata
        end.send(("/imu", {"acceleration": imu[:3].tolist(), "rate": imu[3:].tolist()}))
        states = {"position": data.qpos[q], "velocity": data.qvel[v], "effort": effort}
        end.send(("/joint_states", {name: x.tolist() for name, x in states.items()}))
        end.send(("/contacts", foot_forces(model, data, shanks).tolist()))
        end.send(("/truth", data.qpos[:7].tolist()))  # For the judge alone.
        end.send(("/clock", data.time))
        _, command = end.recv()
        q_d, dq_d, kp, kd, tau = (np.array(command[name]) for name in COMMAND)
        efforts = np.zeros((STEPS, 12))
        for i in range(STEPS):
            asked = tau + kp * (q_d - data.qpos[q]) + kd * (dq_d - data.qvel[v])
            efforts[i] = np.clip(asked, -robot["limits"], robot["limits"])
            data.qfrc_applied[v] = efforts[i]
            mujoco.mj_step(model, data)
        effort = efforts.mean(0)


def control(end: Connection, plan: saltus.Plan) -> tuple[saltus.Machine, list[float]]:
    """Flies a plan over topics; the machine in the end, and where the base truly is."""
    machine, estimator = plan.machine(start=HOLD), saltus.Estimator(plan.robot, plan.q[0])
    latest: dict = {}
    while latest.get("/clock", 0.0) < HOLD + plan.touchdown + SETTLE:
        topic, message = end.recv()
        latest[topic] = message
        if topic != "/clock":
            continue
        imu, joints = latest["/imu"], latest["/joint_states"]
        told = estimator.step(
            imu["acceleration"],
            imu["rate"],
            joints["position"],
            joints["velocity"],
            latest["/contacts"],
            joints["effort"],
        )
        command = machine.tick(message, told).command
        numbers = {name: getattr(command, name).tolist() for name in COMMAND}
        end.send(("/joint_command", numbers))
    return machine, latest["/truth"]


def main(task: str = "a1/lateral") -> None:
    """Plans, begins the world, and flies in it."""
    plan = saltus.plan(task)
    body = plan.robot
    numbers = {"names": body.joint_names, "limits": body.max_torque, "armature": body.armature}
    numbers |= {"friction": body.friction, "damping": body.damping}
    ours, theirs = Pipe()
    other = Process(target=robot_in_its_world, args=(theirs, numbers, plan.q[0]), daemon=True)
    other.start()
    machine, truth = control(ours, plan)
    other.terminate()
    up = 1 - 2 * (truth[4] ** 2 + truth[5] ** 2)
    place = np.round(truth[:3], 3)
    print(f"{task}: {machine.phase}, base at {place}, upright {up:.3f}, fault {machine.fault}")
    if machine.phase != "Stand" or up < 0.97:
        sys.exit("the robot does not stand")


if __name__ == "__main__":
    main(*sys.argv[1:])
