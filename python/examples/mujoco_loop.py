"""A jump in MuJoCo's own Python, closed from outside: the sensors of a model of yours in, torques out.

mujoco_loop.py [TASK [ROBOT.urdf [PICTURE.png]]]
"""

import sys
from pathlib import Path

import mujoco
import numpy as np

import saltus

HOLD, SETTLE = 1.2, 2.0
A1 = Path(__file__).parents[2] / "models/a1.urdf"


def world(urdf: str, robot: saltus.Robot) -> mujoco.MjModel:
    """The URDF on a floor, with an IMU in its base; of its shapes those of the feet alone, as the planner knows them."""
    spec = mujoco.MjSpec.from_file(urdf)
    spec.option.timestep = 1e-4
    # As public models of quadrupeds have it: with MuJoCo's defaults feet creep under load, and estimate and jump go astray.
    spec.option.cone, spec.option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 100
    base = spec.worldbody.first_body()
    base.add_freejoint()
    base.add_site(name="imu")
    for shape in [*spec.geoms, *spec.meshes]:
        spec.delete(shape)
    sphere, plane = mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_PLANE
    floor = spec.worldbody.add_geom(type=plane, size=[9, 9, 1], priority=1)
    floor.friction[0] = 0.6
    for sensor in (mujoco.mjtSensor.mjSENS_ACCELEROMETER, mujoco.mjtSensor.mjSENS_GYRO):
        spec.add_sensor(type=sensor, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="imu")
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    shanks = [model.jnt_bodyid[model.joint(name).id] for name in robot.joint_names[2::3]]
    for shank, foot in zip(shanks, robot.feet([0, 0, 0, 0, 0, 0, 1, *[0] * 12])):
        place = data.xmat[shank].reshape(3, 3).T @ (foot - data.xpos[shank])
        ball = {"type": sphere, "size": [robot.foot_radius, 0, 0], "pos": place, "contype": 0}
        spec.body(model.body(shank).name).add_geom(**ball)
    return spec.compile()


def foot_forces(model: mujoco.MjModel, data: mujoco.MjData, shanks: list[int]) -> np.ndarray:
    """What the floor presses on every shank, N."""
    forces, one = np.zeros(4), np.zeros(6)
    for i, contact in enumerate(data.contact):
        body = model.geom_bodyid[contact.geom].max()
        if body in shanks:
            mujoco.mj_contactForce(model, data, i, one)
            forces[shanks.index(body)] += one[0]
    return forces


def fly(plan: saltus.Plan, model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray, str]:
    """Times, places of the base, and the phase in which the jump ends."""
    robot, data = plan.robot, mujoco.MjData(model)
    joints = [model.joint(name) for name in robot.joint_names]  # In the model's order, not ours.
    q = np.array([joint.qposadr[0] for joint in joints])
    v = np.array([joint.dofadr[0] for joint in joints])
    shanks = [model.jnt_bodyid[joint.id] for joint in joints[2::3]]
    model.dof_armature[v], model.dof_damping[v] = robot.armature, robot.damping
    model.dof_frictionloss[v] = robot.friction
    start = plan.q[0]
    data.qpos[:7], data.qpos[q] = start[[0, 1, 2, 6, 3, 4, 5]], start[7:]
    mujoco.mj_forward(model, data)
    machine, estimator = plan.machine(start=HOLD), saltus.Estimator(robot, start)
    times, places, tau = [], [], np.zeros((10, 12))
    while data.time < HOLD + plan.touchdown + SETTLE:
        imu, forces = data.sensordata, foot_forces(model, data, shanks)
        told = estimator.step(imu[:3], imu[3:], data.qpos[q], data.qvel[v], forces, tau.mean(0))
        machine.tick(data.time, told)
        for i in range(10):
            tau[i] = machine.joint_tick(data.qpos[q], data.qvel[v])
            data.qfrc_applied[v] = tau[i]
            mujoco.mj_step(model, data)
        times.append(data.time - HOLD)
        places.append(data.qpos[:7].copy())
    return np.array(times), np.array(places), machine.phase


def draw(picture: str, plan: saltus.Plan, times: np.ndarray, places: np.ndarray) -> None:
    """Place of the base in the plan and in the simulation."""
    from matplotlib import pyplot

    for axis, color in zip(range(3), "rgb"):
        pyplot.plot(times, places[:, axis], color, label="xyz"[axis])
        pyplot.plot(plan.times, plan.q[:, axis], color + "--")
    pyplot.xlabel("s")
    pyplot.ylabel("m, dashed: planned")
    pyplot.legend()
    pyplot.savefig(picture)


def main(task: str = "a1/barrel-roll", urdf: str = str(A1), picture: str = "") -> None:
    """Plans, flies and draws."""
    robot = saltus.Robot.a1() if A1.samefile(urdf) else saltus.Robot.load(urdf)
    plan = saltus.plan(task, robot)
    times, places, phase = fly(plan, world(urdf, robot))
    up = 1 - 2 * (places[-1, 4] ** 2 + places[-1, 5] ** 2)
    print(f"{task}: {phase}, base at {places[-1, :3].round(3)}, upright {up:.3f}")
    if picture:
        draw(picture, plan, times, places)
    if phase != "Stand" or up < 0.97:
        sys.exit("the robot does not stand")


if __name__ == "__main__":
    main(*sys.argv[1:])
