"""Whole-body control of foreign robots from their URDF alone, looked at with Pinocchio.

    python tests/peers/foreign.py        # the Python of `setup.sh venv`

Builds and runs `tests/examples/foreign` on talos, g1, go2, panda, tiago and ur5 of pip `example-robot-data` and checks every tick that
it writes from Pinocchio's own model of the same file: the equations of motion, where contact forces act, that contacts neither slide nor
turn, exact friction cones and centres of pressure, torque limits, joint limits, and the distance between hand and body. Exit code 1 where
one is missed by more than 1e-9 (relative for the equations of motion, torques and cones), or where a demand is not met by name as the
program's own assertions say: what is possible yields nothing, what is not is named, and something stands in the way of every reach.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pinocchio as pin

import robots

ROOT = pathlib.Path(__file__).resolve().parents[2]
BOUND = 1e-9


def files():
    data = robots.example_data()
    named = {robot.name: robot.urdf for robot in robots.others()}
    return {name: named[name] for name in ["talos", "g1", "go2", "panda", "tiago", "ur5"]}


def model_of(urdf, head, floating):
    locked = {joint: value for joint, value in head["locked"]}
    return robots.Robot(head["name"], urdf, lock=locked, floating=floating).load()


def vectors(model, line, floating):
    """q, v, a and the joints' torques in Pinocchio's order, by the joints' names."""
    order = [line["joints"][i] for i in range(len(line["joints"]))]
    q = np.array(line["base"] + line["quaternion"] + order) if floating else np.array(order)
    v = np.array((line["base_velocity"] if floating else []) + line["joint_velocities"])
    a = np.array((line["base_acceleration"] if floating else []) + line["joint_accelerations"])
    tau = np.array(([0.0] * 6 if floating else []) + line["torques"])
    return q, v, a, tau


def segment_distance(point, a, b):
    d = b - a
    t = np.clip((point - a) @ d / (d @ d), 0.0, 1.0)
    return np.linalg.norm(point - a - t * d)


def place(model, data, link, offset):
    pose = data.oMf[model.getFrameId(link)]
    return pose, pose.translation + pose.rotation @ np.array(offset)


class Worst(dict):
    def add(self, key, value):
        self[key] = max(self.get(key, -np.inf), float(value))


def contact(model, data, c, line, mu, v, worst):
    """Checks one contact; returns its generalised force."""
    pose, point = place(model, data, c["link"], c["offset"])
    normal = np.array(c["normal"])
    point = point - c["radius"] * normal
    worst.add("place", np.abs(point - c["place"]).max())
    f, n = np.array(c["force"]), np.array(c["moment"])
    jacobian = pin.getFrameJacobian(model, data, model.getFrameId(c["link"]), pin.LOCAL_WORLD_ALIGNED)
    lever = point - pose.translation
    wrench = np.concatenate([f, n + np.cross(lever, f)])
    up = pose.rotation[:, 2] if c["half"] else normal
    push = f @ up
    scale = max(1.0, push)
    worst.add("cone", (np.linalg.norm(f - push * up) - mu * push) / scale)
    if c["half"]:
        # The wrench in the sole's axes about its middle.
        moment = pose.rotation.T @ n
        x, y = c["half"]
        worst.add("pressure", (max(abs(moment[0]) - y * push, abs(moment[1]) - x * push)) / scale)
    # Acceleration of what is fixed to the ground: -k times its velocity.
    frame = model.getFrameId(c["link"])
    axes = pin.LOCAL_WORLD_ALIGNED
    vel, acc = pin.getFrameVelocity(model, data, frame, axes), pin.getFrameClassicalAcceleration(model, data, frame, axes)
    if c["half"]:
        speed = np.concatenate([vel.linear + np.cross(vel.angular, lever), vel.angular])
        rate = acc.linear + np.cross(acc.angular, lever) + np.cross(vel.angular, np.cross(vel.angular, lever))
        miss = np.concatenate([rate, acc.angular]) + line["damping"] * speed
    else:
        # A rolling ball: the centre's velocity is w x (r n).
        arm = c["radius"] * normal
        miss = acc.linear - np.cross(acc.angular, arm) + line["damping"] * (vel.linear - np.cross(vel.angular, arm))
    if line["yielded"] in ("Nothing", "Tasks"):
        worst.add("contact", np.abs(miss).max())
    return jacobian.T @ wrench


def check(urdf, path):
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    head, ticks = lines[0], lines[1:]
    floating = bool(ticks[0]["contacts"])
    model = model_of(urdf, head, floating)
    names = [name for name in list(model.names)[1:] if name != "root_joint"]
    assert names == head["joints"], "the joints have another order"
    assert all(model.joints[j].nq == 1 or j == 1 for j in range(1, model.njoints))
    data = model.createData()
    limits, mu = np.array(head["limits"]), head["friction"]
    table = {}
    for line in ticks:
        worst = table.setdefault(line["demand"], Worst())
        q, v, a, tau = vectors(model, line, floating)
        pin.computeJointJacobians(model, data, q)
        pin.forwardKinematics(model, data, q, v, a)
        pin.updateFramePlacements(model, data)
        supply = tau.copy()
        for c in line["contacts"]:
            supply += contact(model, data, c, line, mu, v, worst)
        # RNEA also runs the kinematics, with gravity as an acceleration: last, and in its own data.
        demand = pin.rnea(model, model.createData(), q, v, a)
        worst.add("motion", np.abs(demand - supply).max() / (1.0 + np.abs(demand).max()))
        joints = np.array(line["joints"])
        worst.add("torque", (np.abs(line["torques"]) - limits[:, 3]).max() / limits[:, 3].max())
        if line["demand"] != "Impossible":
            worst.add("joints", np.maximum(limits[:, 0] - joints, joints - limits[:, 1]).max())
        if line["distance"] is not None:
            _, centre = place(model, data, head["hand"], [0.0] * 3)
            _, low = place(model, data, head["body"], head["from"])
            _, high = place(model, data, head["body"], head["to"])
            away = segment_distance(centre, low, high) - head["hand_radius"] - head["thick"]
            worst.add("distance", abs(away - line["distance"]))
            worst.add("too near", head["margin"] - away)
    return model, table


def main():
    command = ["cargo", "build", "--release", "-q", "-p", "saltus-tests", "--features", "bench"]
    command += ["--example", "foreign", "--message-format=json"]
    built = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    binary = [m["executable"] for m in map(json.loads, built.splitlines()) if m.get("executable")][-1]
    bad = False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "robots.txt").write_text("".join(f"{robot} {urdf}\n" for robot, urdf in files().items()))
        subprocess.run([binary, str(folder)], check=True)
        keys = ["motion", "place", "contact", "cone", "pressure", "torque", "joints", "distance", "too near"]
        print(f"{'':17}" + "".join(f"{key:>10}" for key in keys))
        for robot, urdf in files().items():
            _, table = check(urdf, folder / f"{robot}.jsonl")
            for demand, worst in table.items():
                wrong = [key for key, value in worst.items() if not value <= BOUND]
                bad |= bool(wrong)
                cells = "".join(f"{worst[key]:10.1e}" if key in worst else f"{'':>10}" for key in keys)
                print(f"{robot:6} {demand:10}{cells}  {'WRONG: ' + ', '.join(wrong) if wrong else ''}")
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
