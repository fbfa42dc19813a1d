"""Golden values from Pinocchio: random states of a robot and what every algorithm of rbd-core must say about them.

    golden.py                                  writes tests/data/golden/{a1,icub23}.txt
    golden.py --others DIR                     twelve robots of pip example-robot-data, and DIR/index.txt
    golden.py --all DIR                        every URDF of pip example-robot-data on both bases, and DIR/index.txt, which says
                                               which of them Pinocchio does not read
    golden.py --urdf R.urdf [--lock j=v ...] [--base floating|fixed] [--frame f ...] --out FILE [--states N]

The file is text. `#` starts a comment; every other line is `key rows cols value ...`, row-major, SI units, shortest
decimal that reads back to the same f64. Header keys come first; each `state` line starts a new state. Quantities
marked heavy (derivatives, Jacobians, inverse mass matrix) are given for the first HEAVY states only.

Conventions are Pinocchio's: q = (base position, quaternion x y z w, joints), v = (base linear, base angular, both in the
base frame, joints), 6-vectors linear first, derivatives with respect to q on the manifold (right perturbation).
Suffixes: `_l` local axes, `_w` Pinocchio's WORLD (spatial, at the world origin), `_a` local-world-aligned.

Quantities that Pinocchio defines otherwise than we do are built here from its kinematics:
- `constrained.*`, `impulse.*`: KKT systems in long double, every foot held. The constraint is on the classical
  acceleration of the foot frame (and on its angular acceleration when `contact` is 6), world-aligned:
  M a + h = tau + J' f, J a + dJ v = 0; M (v+ - v) = J' L, J v+ = 0.
- continuous joints are one angle in q (Pinocchio keeps cosine and sine).
- `external.tau`: inverse dynamics when `external.FRAME` (wrench at the frame, world-aligned) acts on every foot.
"""
import argparse
import hashlib
from pathlib import Path

import numpy as np
import pinocchio as pin

import robots

SEED, STATES, HEAVY = 20261121, 32, 6
OUT = robots.ROOT / "tests" / "data" / "golden"
LOCAL, WORLD, ALIGNED = pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED


def line(key, value) -> str:
    x = np.asarray(value, dtype=float)
    x = x.reshape(-1, 1) if x.ndim < 2 else x
    numbers = " ".join("0" if v == 0 else repr(float(v)).removesuffix(".0") for v in x.ravel())
    return f"{key} {x.shape[0]} {x.shape[1]} {numbers}"


def solve(a, b):
    """Gaussian elimination with row pivoting in long double."""
    a, b = np.array(a, dtype=np.longdouble), np.array(b, dtype=np.longdouble)
    n = len(b)
    for k in range(n):
        p = k + int(np.argmax(np.abs(a[k:, k])))
        a[[k, p]], b[[k, p]] = a[[p, k]], b[[p, k]]
        f = a[k + 1 :, k] / a[k, k]
        a[k + 1 :] -= np.outer(f, a[k])
        b[k + 1 :] -= f * b[k]
    for k in reversed(range(n)):
        b[k] = (b[k] - a[k, k + 1 :] @ b[k + 1 :]) / a[k, k]
    return b


def kkt(mass, jac, rhs_top, rhs_bottom):
    """Solves [[M, -J'], [J, 0]] (x, f) = (top, bottom)."""
    n, c = mass.shape[0], jac.shape[0]
    z = solve(np.block([[mass, -jac.T], [jac, np.zeros((c, c))]]), np.concatenate([rhs_top, rhs_bottom]))
    return z[:n], z[n:]


def foot_rows(robot, model, data, q, v):
    """Stacked Jacobian and classical bias acceleration of every foot, world-aligned; `data` is overwritten."""
    jac, bias = [], []
    pin.computeJointJacobians(model, data, q)
    pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
    pin.updateFramePlacements(model, data)
    for name in robot.feet:
        f = model.getFrameId(name)
        jac.append(pin.getFrameJacobian(model, data, f, ALIGNED)[: robot.contact])
        bias.append(pin.getFrameClassicalAcceleration(model, data, f, ALIGNED).vector[: robot.contact])
    return np.vstack(jac), np.concatenate(bias)


def frame_names(robot):
    return robot.feet + robot.frames


def state_lines(robot, model, rng, heavy):
    q, v, a, tau = robots.random_state(model, rng)
    data = model.createData()
    put = []

    def add(key, value):
        put.append(line(key, value))

    for key, value in (("q", robots.as_angles(model, q)), ("v", v), ("a", a), ("tau", tau)):
        add(key, value)
    rnea = pin.rnea(model, data, q, v, a).copy()
    bias = pin.nonLinearEffects(model, data, q, v).copy()
    mass = pin.crba(model, data, q).copy()
    mass = np.triu(mass) + np.triu(mass, 1).T
    add("rnea", rnea)
    add("nonlinear_effects", bias)
    add("gravity", pin.computeGeneralizedGravity(model, data, q))
    forward = pin.aba(model, data, q, v, tau)
    if not np.all(np.isfinite(forward)):
        raise SystemExit("no forward dynamics: a joint moves no inertia")
    add("aba", forward)
    add("mass_matrix_lower", mass[np.tril_indices(model.nv)])
    add("mass_condition", np.linalg.cond(mass))

    # configurations
    q2, u = robots.random_q(model, rng), rng.uniform()
    if not robots.has_continuous(model):
        add("q2", q2)
        add("step", v)
        add("integrate", pin.integrate(model, q, v))
        add("difference", pin.difference(model, q, q2))
        add("fraction", u)
        add("interpolate", pin.interpolate(model, q, q2, u))

    # frames
    pin.forwardKinematics(model, data, q, v, a)
    pin.updateFramePlacements(model, data)
    for name in frame_names(robot):
        f = model.getFrameId(name)
        add(f"{name}.rotation", data.oMf[f].rotation)
        add(f"{name}.position", data.oMf[f].translation)
        for suffix, rf in (("l", LOCAL), ("w", WORLD), ("a", ALIGNED)):
            add(f"{name}.velocity_{suffix}", pin.getFrameVelocity(model, data, f, rf).vector)
            add(f"{name}.spatial_acceleration_{suffix}", pin.getFrameAcceleration(model, data, f, rf).vector)
        for suffix, rf in (("l", LOCAL), ("a", ALIGNED)):
            add(f"{name}.classical_acceleration_{suffix}", pin.getFrameClassicalAcceleration(model, data, f, rf).vector)
    zero = model.createData()
    pin.forwardKinematics(model, zero, q, v, np.zeros(model.nv))
    pin.updateFramePlacements(model, zero)
    for name in frame_names(robot):
        f = model.getFrameId(name)
        add(f"{name}.bias_spatial_l", pin.getFrameAcceleration(model, zero, f, LOCAL).vector)
        add(f"{name}.bias_classical_a", pin.getFrameClassicalAcceleration(model, zero, f, ALIGNED).vector)

    # centre of mass, centroidal quantities, energy
    pin.centerOfMass(model, data, q, v, a)
    for key, value in (("position", data.com[0]), ("velocity", data.vcom[0]), ("acceleration", data.acom[0])):
        add(f"com.{key}", value)
    add("com.jacobian", pin.jacobianCenterOfMass(model, data, q))
    pin.dccrba(model, data, q, v)
    add("centroidal.map", data.Ag)
    add("centroidal.momentum", data.hg.vector)
    add("centroidal.bias", data.dAg @ v)
    ccrba = model.createData()
    pin.ccrba(model, ccrba, q, v)
    inertia = ccrba.Ig.matrix()
    add("centroidal.inertia", inertia)
    add("centroidal.locked_angular_velocity", solve(inertia[3:, 3:], data.hg.angular))
    pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a)
    add("centroidal.momentum_rate", data.dhg.vector)
    add("energy.kinetic", pin.computeKineticEnergy(model, data, q, v))
    add("energy.potential", pin.computePotentialEnergy(model, data, q))

    # rotor inertia behind gears
    geared = model.copy()
    first = model.joints[1].nv if robot.floating else 0
    geared.armature[first:] = rng.uniform(0.001, 0.05, model.nv - first)
    geared_data = geared.createData()
    add("armature", geared.armature)
    add("armature.rnea", pin.rnea(geared, geared_data, q, v, a))
    add("armature.aba", pin.aba(geared, geared_data, q, v, tau))

    if robot.feet:
        jac, drift = foot_rows(robot, model, data, q, v)
        acceleration, force = kkt(mass, jac, tau - bias, -drift)
        add("constrained.acceleration", acceleration)
        add("constrained.force", force)
        after, impulse = kkt(mass, jac, mass @ v, np.zeros(len(drift)))
        add("impulse.velocity", after)
        add("impulse.impulse", impulse)
        sum_tau = rnea.copy()
        for name in robot.feet:
            wrench = rng.uniform(-20, 20, 6)
            add(f"external.{name}", wrench)
            sum_tau -= pin.computeFrameJacobian(model, data, q, model.getFrameId(name), ALIGNED).T @ wrench
        add("external.tau", sum_tau)

    if heavy:
        add("mass_matrix_inverse_lower", symmetric(pin.computeMinverse(model, data, q))[np.tril_indices(model.nv)])
        for name in (robot.feet or robot.frames)[:2]:
            f = model.getFrameId(name)
            for suffix, rf in (("l", LOCAL), ("w", WORLD), ("a", ALIGNED)):
                add(f"{name}.jacobian_{suffix}", pin.computeFrameJacobian(model, data, q, f, rf))
            pin.computeForwardKinematicsDerivatives(model, data, q, v, a)
            pin.updateFramePlacements(model, data)
            v_dq, a_dq, a_dv, a_da = pin.getFrameAccelerationDerivatives(model, data, f, LOCAL)
            add(f"{name}.velocity_dq_l", v_dq)
            add(f"{name}.spatial_acceleration_dq_l", a_dq)
            add(f"{name}.spatial_acceleration_dv_l", a_dv)
            frame = model.frames[f]
            _, a_dq, a_dv, _ = pin.getPointClassicAccelerationDerivatives(
                model, data, frame.parentJoint, frame.placement, ALIGNED
            )
            add(f"{name}.point_acceleration_dq_a", a_dq)
            add(f"{name}.point_acceleration_dv_a", a_dv)
        dtau_dq, dtau_dv, _ = pin.computeRNEADerivatives(model, data, q, v, a)
        add("rnea_derivatives.dq", dtau_dq)
        add("rnea_derivatives.dv", dtau_dv)
        ddq_dq, ddq_dv, _ = pin.computeABADerivatives(model, data, q, v, tau)
        add("aba_derivatives.dq", ddq_dq)
        add("aba_derivatives.dv", ddq_dv)
        dh_dq, dhd_dq, dhd_dv, _ = pin.computeCentroidalDynamicsDerivatives(model, data, q, v, a)
        add("centroidal_derivatives.momentum_dq", dh_dq)
        add("centroidal_derivatives.rate_dq", dhd_dq)
        add("centroidal_derivatives.rate_dv", dhd_dv)
    return put


def symmetric(m):
    return np.triu(m) + np.triu(m, 1).T


def check_kkt(robot, model, rng):
    """At rest, where classical and spatial accelerations agree, our KKT route must equal Pinocchio's."""
    q, _, _, tau = robots.random_state(model, rng)
    v = np.zeros(model.nv)
    data = model.createData()
    kind = pin.ContactType.CONTACT_3D if robot.contact == 3 else pin.ContactType.CONTACT_6D
    contacts = []
    for name in robot.feet:
        f = model.frames[model.getFrameId(name)]
        contacts.append(pin.RigidConstraintModel(kind, model, f.parentJoint, f.placement, LOCAL))
    datas = [c.createData() for c in contacts]
    pin.initConstraintDynamics(model, data, contacts, datas)
    theirs = pin.constraintDynamics(model, data, q, v, tau, contacts, datas, pin.ProximalSettings(1e-14, 0.0, 1)).copy()
    mass = symmetric(pin.crba(model, data, q))
    bias = pin.nonLinearEffects(model, data, q, v).copy()
    jac, drift = foot_rows(robot, model, data, q, v)
    ours, _ = kkt(mass, jac, tau - bias, -drift)
    error = np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs))
    if error > 1e-8:
        raise SystemExit(f"{robot.name}: KKT and Pinocchio's constraint dynamics differ by {error:g}")


def locked(robot) -> str:
    return " ".join(f"{k}={v:g}" for k, v in robot.lock.items())


def write(robot, out, states, heavy):
    model = robot.load()
    rng = np.random.default_rng(SEED)
    if robot.feet:
        check_kkt(robot, model, rng)
    joints = [model.names[j] for j in range(2 if robot.floating else 1, model.njoints)]
    head = [
        "# Golden values from Pinocchio; written by tests/peers/golden.py, which explains the format. Do not edit.",
        f"# pinocchio {pin.__version__}, numpy {np.__version__}, seed {SEED}",
        f"# {robot.urdf.name} sha256 {hashlib.sha256(robot.urdf.read_bytes()).hexdigest()}",
        f"# locked: {locked(robot) or 'none'}",
        f"# joints: {' '.join(joints)}",
        line("nq", len(robots.as_angles(model, pin.neutral(model)))),
        line("nv", model.nv),
        line("floating", float(robot.floating)),
        line("mass", sum(i.mass for i in list(model.inertias)[1:])),
        line("contact", robot.contact),
        "# frames: parent joint counted from 0 in the order above, base -1; placement in that joint's frame",
    ]
    for name in frame_names(robot):
        f = model.frames[model.getFrameId(name)]
        head.append(line(f"frame.{name}.joint", f.parentJoint - (2 if robot.floating else 1)))
        head.append(line(f"frame.{name}.rotation", f.placement.rotation))
        head.append(line(f"frame.{name}.position", f.placement.translation))
    for i in range(states):
        head.append(line("state", i))
        head += state_lines(robot, model, rng, i < heavy)
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text("\n".join(head) + "\n")
    print(f"{out}: nv {model.nv}, {states} states, {out.stat().st_size / 1e3:.0f} kB")


def write_mimic(robot, out):
    """Inverse dynamics and mass matrix over the independent joints, as Pinocchio has them with `mimic=True`."""
    root = (pin.JointModelFreeFlyer(),) if robot.floating else ()
    model = pin.buildModelFromUrdf(str(robot.urdf), *root, mimic=True)
    model.armature[:] = 0
    model.gravity.linear = np.array([0.0, 0.0, -9.81])
    rng = np.random.default_rng(SEED)
    lines = [line("nv", model.nv)]
    for i in range(2):
        q = pin.randomConfiguration(model, *[np.full(model.nq, x) for x in (-0.5, 0.5)])
        v, a = rng.uniform(-2, 2, model.nv), rng.uniform(-5, 5, model.nv)
        data = model.createData()
        mass = symmetric(pin.crba(model, data, q))
        lines += [line("state", i), line("q", robots.as_angles(model, q)), line("v", v), line("a", a)]
        lines.append(line("rnea", pin.rnea(model, data, q, v, a)))
        lines.append(line("mass_matrix_lower", mass[np.tril_indices(model.nv)]))
        lines.append(line("acceleration", solve(mass, a - pin.nonLinearEffects(model, data, q, v))))
    out.write_text("\n".join(lines) + "\n")


def write_all(folder):
    """Golden values of every URDF, on a floating and on a fixed base; index lines are `name base urdf` or `name - urdf reason`."""
    index = ["# name base urdf; golden values in NAME.BASE.txt; base `-`: Pinocchio does not read it, and why"]
    for name, urdf in robots.every_urdf():
        try:
            tree = pin.buildModelFromUrdf(str(urdf))
            tips = robots.tips(tree)
            for floating in (True, False) if tree.nv else (True,):
                base = "floating" if floating else "fixed"
                robot = robots.Robot(name, urdf, floating=floating, frames=tips)
                write(robot, folder / f"{name}.{base}.txt", 2, 1)
                mimic = folder / f"{name}.{base}.mimic.txt"
                mimic.unlink(missing_ok=True)
                if "<mimic" in urdf.read_text(errors="replace"):
                    try:
                        write_mimic(robot, mimic)
                    except ValueError as reason:
                        print(f"{name}: Pinocchio does not couple its joints: {reason}")
                index.append(f"{name} {base} {urdf}")
        except (Exception, SystemExit) as reason:
            index.append(f"{name} - {urdf} {' '.join(str(reason).split())}")
    (folder / "index.txt").write_text("\n".join(index) + "\n")


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("--others", type=Path, metavar="DIR")
    p.add_argument("--all", type=Path, metavar="DIR")
    p.add_argument("--urdf", type=Path)
    p.add_argument("--name")
    p.add_argument("--lock", nargs="*", default=[], metavar="JOINT=VALUE")
    p.add_argument("--base", choices=["floating", "fixed"], default="floating")
    p.add_argument("--frame", nargs="*", default=[])
    p.add_argument("--states", type=int, default=STATES)
    p.add_argument("--heavy", type=int, default=HEAVY)
    p.add_argument("--out", type=Path)
    args = p.parse_args()
    if args.others is not None:
        index = ["# name base urdf [joint=value ...]; golden values in NAME.txt"]
        for robot in robots.others():
            write(robot, args.others / f"{robot.name}.txt", 4, 1)
            base = "floating" if robot.floating else "fixed"
            index.append(f"{robot.name} {base} {robot.urdf} {locked(robot)}".rstrip())
        (args.others / "index.txt").write_text("\n".join(index) + "\n")
        return
    if args.all is not None:
        write_all(args.all)
        return
    if args.urdf is None:
        for robot in robots.ROBOTS.values():
            write(robot, OUT / f"{robot.name}.txt", args.states, args.heavy)
        return
    if args.out is None:
        p.error("--urdf needs --out")
    lock = {k: float(v) for k, v in (x.split("=") for x in args.lock)}
    robot = robots.Robot(args.name or args.urdf.stem, args.urdf, lock, args.base == "floating", frames=args.frame)
    write(robot, args.out, args.states, args.heavy)


main()
