"""Golden values from MuJoCo, in the format of golden.py: what MJCF files of pip packages must give.

    golden_mjcf.py DIR [FILE.xml ...]     DIR/NAME.BASE.txt and DIR/index.txt; without files, those of pip gymnasium and dm_control

Springs, dampers, dry friction, actuators, contacts and fluids are switched off, gravity is (0, 0, -9.81): what is compared is
the tree. MuJoCo's free joint has its linear velocity in world axes; ours has both in base axes and a spatial acceleration,
so with v_m = T v, T = diag(R, 1), and a_m = T a + (R (w x v), 0):

    M = T' M_m T,   h = T' (M_m (R (w x v), 0) + h_m),   tau = M a + h
"""
import importlib.util
import sys
from pathlib import Path

import mujoco
import numpy as np

SEED, STATES = 20261121, 4


def line(key, value) -> str:
    x = np.asarray(value, dtype=float)
    x = x.reshape(-1, 1) if x.ndim < 2 else x
    numbers = " ".join("0" if v == 0 else repr(float(v)).removesuffix(".0") for v in x.ravel())
    return f"{key} {x.shape[0]} {x.shape[1]} {numbers}"


def mass_matrix(model, data):
    full = np.zeros((model.nv, model.nv))
    try:
        mujoco.mj_fullM(model, data, full)
    except TypeError:
        mujoco.mj_fullM(model, full, data.qM)
    return full


def quiet(path):
    spec = mujoco.MjSpec.from_file(str(path))
    model = spec.compile()
    model.opt.gravity[:] = 0, 0, -9.81
    model.opt.density = model.opt.viscosity = 0
    model.body_gravcomp[:] = 0
    model.jnt_stiffness[:] = 0
    model.dof_damping[:] = 0
    model.dof_frictionloss[:] = 0
    model.tendon_armature[:] = model.tendon_stiffness[:] = 0
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    return model


def state_lines(model, free, frames, rng, whole):
    data = mujoco.MjData(model)
    nv = model.nv
    base = 6 if free else 0
    data.qpos[:] = model.qpos0
    if free:
        quat = rng.normal(size=4)
        data.qpos[:3], data.qpos[3:7] = rng.uniform(-1, 1, 3), quat / np.linalg.norm(quat)
    joints = rng.uniform(-1.2, 1.2, nv - base)
    data.qpos[len(data.qpos) - len(joints) :] = joints
    v, a, tau = rng.uniform(-2, 2, nv), rng.uniform(-5, 5, nv), rng.uniform(-20, 20, nv)
    turn, shift = np.eye(nv), np.zeros(nv)
    q = joints
    if free:
        rot = np.zeros(9)
        mujoco.mju_quat2Mat(rot, data.qpos[3:7])
        rot = rot.reshape(3, 3)
        turn[:3, :3] = rot
        shift[:3] = rot @ np.cross(v[3:6], v[:3])
        q = np.concatenate([data.qpos[:3], data.qpos[4:7], data.qpos[3:4], joints])
    data.qvel[:] = turn @ v
    mujoco.mj_forward(model, data)
    m = mass_matrix(model, data)
    mass = turn.T @ m @ turn
    bias = turn.T @ (m @ shift + data.qfrc_bias)
    put = [line("q", q), line("v", v), line("a", a), line("tau", tau)]
    put += [line("rnea", mass @ a + bias), line("nonlinear_effects", bias)]
    put += [line("aba", np.linalg.solve(mass, tau - bias)), line("mass_condition", np.linalg.cond(mass))]
    put.append(line("mass_matrix_lower", mass[np.tril_indices(nv)]))
    put += [line("energy.kinetic", 0.5 * data.qvel @ m @ data.qvel)]
    if whole:
        put += whole_robot(model, data, turn)
    for name in frames:
        body = model.body(name).id
        put += [line(f"{name}.rotation", data.xmat[body].reshape(3, 3)), line(f"{name}.position", data.xpos[body])]
        motion = np.zeros(6)
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, motion, 0)
        put.append(line(f"{name}.velocity_a", np.concatenate([motion[3:], motion[:3]])))
    return put


def whole_robot(model, data, turn):
    """What MuJoCo says of the whole robot; it counts bodies that are welded to the world, so only without such."""
    mujoco.mj_subtreeVel(model, data)
    total = model.body_subtreemass[0]
    put = [line("com.position", data.subtree_com[0]), line("com.velocity", data.subtree_linvel[0])]
    jac = np.zeros((3, model.nv))
    mujoco.mj_jacSubtreeCom(model, data, jac, 0)
    put.append(line("com.jacobian", jac @ turn))
    put.append(line("centroidal.momentum", np.concatenate([total * data.subtree_linvel[0], data.subtree_angmom[0]])))
    return put + [line("energy.potential", data.energy[0])]


def still(model, body):
    """No joint moves it: it is welded to the world, or a mocap body."""
    while body and not model.body_dofnum[body]:
        body = model.body_parentid[body]
    return body == 0


def write(name, path, folder):
    model = quiet(path)
    kinds = [mujoco.mjtJoint(t) for t in model.jnt_type]
    free = mujoco.mjtJoint.mjJNT_FREE in kinds
    if mujoco.mjtJoint.mjJNT_BALL in kinds:
        raise ValueError("it has ball joints")
    if kinds.count(mujoco.mjtJoint.mjJNT_FREE) > 1 or (free and kinds[0] != mujoco.mjtJoint.mjJNT_FREE):
        raise ValueError("it is not one tree")
    static = [b for b in range(1, model.nbody) if still(model, b) and model.body_mass[b] > 0]
    rng = np.random.default_rng(SEED)
    named = [model.body(b).name for b in range(1, model.nbody) if not still(model, b)]
    frames = [n for n in named if n and " " not in n][-2:]
    base = "floating" if free else "fixed"
    first = 1 if free else 0
    head = [
        "# Golden values from MuJoCo; written by tests/peers/golden_mjcf.py. Do not edit.",
        f"# mujoco {mujoco.__version__}, numpy {np.__version__}, seed {SEED}",
        f"# joints: {' '.join(model.joint(j).name or '-' for j in range(first, model.njnt))}",
        line("nv", model.nv),
        line("mass", model.body_subtreemass[0]),
    ]
    head += [line(f"frame.{n}.joint", 0) for n in frames]
    for i in range(STATES):
        head += [line("state", i)] + state_lines(model, free, frames, rng, not static)
    (folder / f"{name}.{base}.txt").write_text("\n".join(head) + "\n")
    return base


def packaged():
    """The robots of pip gymnasium and dm_control, which need not be importable."""
    out = []
    for package, under in (("gymnasium", "envs/mujoco/assets"), ("dm_control", "suite"), ("dm_control", "third_party"), ("dm_control", "mujoco/testing/assets"), ("dm_control", "locomotion/walkers/assets")):
        root = Path(importlib.util.find_spec(package).origin).parent
        out += sorted((root / under).glob("**/*.xml"))
    return out


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    index = ["# name base file; base `-`: not compared, and why"]
    for path in [Path(p) for p in sys.argv[2:]] or packaged():
        parts = path.with_suffix("").parts
        start = next((i for i, p in enumerate(parts) if p in ("gymnasium", "dm_control")), len(parts) - 1)
        name = ".".join(parts[start:])
        try:
            if mujoco.MjModel.from_xml_path(str(path)).nv == 0:
                continue
            index.append(f"{name} {write(name, path, folder)} {path}")
        except Exception as reason:
            index.append(f"{name} - {path} {' '.join(str(reason).split())}")
    (folder / "index.txt").write_text("\n".join(index) + "\n")


main()
