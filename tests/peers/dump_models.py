"""Write the models and 256 random states as plain text, for the C++ benches and for ours: one input for everybody.

No URDF parser or Pinocchio library is then needed at link time, so -march=native cannot clash with the alignment
the prebuilt libraries were compiled with. usage: dump_models.py OUT_DIR
"""
import sys
from pathlib import Path

import numpy as np

import robots

SEED, STATES = 20240607, 256
KINDS = {
    "JointModelFreeFlyer": "FF",
    "JointModelRX": "RX",
    "JointModelRY": "RY",
    "JointModelRZ": "RZ",
    "JointModelRevoluteUnaligned": "RU",
}


def text(values) -> str:
    return " ".join(repr(float(x)) for x in np.asarray(values).ravel())


out = Path(sys.argv[1])
out.mkdir(parents=True, exist_ok=True)
for robot in robots.ROBOTS.values():
    m = robot.load()
    lines = [f"{m.njoints - 1}"]
    for j in range(1, m.njoints):
        kind = KINDS[m.joints[j].shortname()]
        axis = np.zeros(3) if kind == "FF" else robots.axis_of(m, j)
        place, inertia = m.jointPlacements[j], m.inertias[j]
        numbers = [*axis, *place.rotation.ravel(), *place.translation, inertia.mass, *inertia.lever, *inertia.inertia.ravel()]
        lines.append(f"{m.names[j]} {m.parents[j]} {kind} {text(numbers)}")
    lines.append(f"{len(robot.feet)} {robot.contact}")
    for name in robot.feet:
        f = m.frames[m.getFrameId(name)]
        lines.append(f"{name} {f.parentJoint} {text([*f.placement.rotation.ravel(), *f.placement.translation])}")
    (out / f"{robot.name}.model").write_text("\n".join(lines) + "\n")
    rng = np.random.default_rng(SEED)
    states = [text(np.concatenate(robots.random_state(m, rng))) for _ in range(STATES)]
    (out / f"{robot.name}.states").write_text(f"{STATES} {m.nq} {m.nv}\n" + "\n".join(states) + "\n")
    print(f"{robot.name}: nq {m.nq}, nv {m.nv}, mass {sum(i.mass for i in m.inertias):.4f} kg")
