"""Checks a whole-body plan of `saltus plan TASK --solution FILE` with Pinocchio, independently of our dynamics.

usage: python wb_audit.py FILE ...      (needs numpy, pin)

Per plan: the worst residual of the equations of motion at the midpoints (rotors, joint friction and the couple of the
rolling ball feet included), the worst slip rate of a ball, the distance from the torque-speed line, and the error
of the trunk's pose at touchdown when the flight is integrated again in steps of 0.1 ms: joints follow the plan, the
base follows from linear and angular momentum at take-off.
"""
import json, sys

import numpy as np
import pinocchio as pin

from robots import A1

ROTOR, DAMPING, COULOMB, SMOOTHING, RADIUS = 0.0067, 0.01, 0.2, 0.3, 0.02
LINE = (33.5, 9.8486, 21.4357)  # torque, corner and no-load speed: a1-model/src/hardware.rs
m = A1.load()
D = m.createData()
feet = [m.getFrameId(name) for name in A1.feet]


def free_flyer(R, q, v, a):
    linear, w = R.T @ v[:3], v[3:6]
    return (np.concatenate([q[:3], pin.Quaternion(R).coeffs(), q[6:]]), np.concatenate([linear, w, v[6:]]),
            np.concatenate([R.T @ a[:3] - np.cross(w, linear), a[3:6], a[6:]]))


def audit(path):
    d = json.load(open(path))
    q, v, a, tau, F, dt, R = [np.array(d[key]) for key in ("q", "v", "a", "tau", "F", "dt", "R")]
    residual, slip, line = 0.0, 0.0, np.inf
    contacts = [p["contacts"] for p in d["phases"] for _ in range(p["intervals"])]
    for k in range(len(dt)):
        qm, vm = q[k] + dt[k] / 2 * v[k] + dt[k] ** 2 / 4 * a[k], v[k] + dt[k] / 2 * a[k]
        qp, vp, ap = free_flyer(R[k] @ pin.exp3(dt[k] / 2 * vm[3:6]), qm, vm, a[k])
        r = pin.rnea(m, D, qp, vp, ap)
        pin.computeJointJacobians(m, D, qp)
        pin.forwardKinematics(m, D, qp, vp, ap)
        pin.updateFramePlacements(m, D)
        down = np.array([0, 0, -RADIUS])
        for f, frame in enumerate(feet):
            J = pin.getFrameJacobian(m, D, frame, pin.LOCAL_WORLD_ALIGNED)
            r -= J.T @ np.concatenate([F[k, f], np.cross(down, F[k, f])])
            if contacts[k][f]:
                acc = pin.getFrameClassicalAcceleration(m, D, frame, pin.LOCAL_WORLD_ALIGNED)
                slip = max(slip, np.abs(acc.linear + np.cross(acc.angular, down)).max())
        qd = vm[6:]
        r[6:] += ROTOR * a[k, 6:] + DAMPING * qd + COULOMB * np.tanh(qd / SMOOTHING) - tau[k]
        residual = max(residual, np.abs(r).max())
        slope = LINE[0] / (LINE[2] - LINE[1])
        line = min(line, (slope * LINE[2] - np.abs(tau[k] + slope * qd)).min())
    first = len(dt) - d["phases"][-1]["intervals"]
    qq, vp, _ = free_flyer(R[first], q[first], v[first], a[first])
    pin.ccrba(m, D, qq, vp)
    momentum, spin, mass = D.hg.linear.copy(), D.hg.angular.copy(), sum(i.mass for i in m.inertias)
    for k in range(first, len(dt)):
        steps = round(dt[k] / 1e-4)
        h = dt[k] / steps
        for i in range(steps):
            s = (i + 0.5) * h
            qq[7:] = q[k, 6:] + s * v[k, 6:] + s * s / 2 * a[k, 6:]
            speed = v[k, 6:] + s * a[k, 6:]
            middle = momentum - np.array([0, 0, 9.81 * mass * h / 2])

            def twist(at):
                A = pin.computeCentroidalMap(m, D, at)
                return np.linalg.solve(A[:, :6], np.concatenate([middle, spin]) - A[:, 6:] @ speed)

            still = np.zeros(12)
            half = pin.integrate(m, qq, np.concatenate([twist(qq), still]) * (h / 2))
            qq = pin.integrate(m, qq, np.concatenate([twist(half), still]) * h)
            momentum = momentum - np.array([0, 0, 9.81 * mass * h])
    k = len(dt) - 1
    end = q[k] + dt[k] * v[k] + dt[k] ** 2 / 2 * a[k]
    landed = R[k] @ pin.exp3(dt[k] * (v[k] + dt[k] / 2 * a[k])[3:6])
    turn = np.degrees(np.linalg.norm(pin.log3(landed.T @ pin.Quaternion(qq[3:7]).matrix())))
    return dict(task=d["task"], dynamics_residual=float(residual), slip_rate=float(slip), line_margin_nm=float(line),
                flight_orientation_error_deg=float(turn), flight_position_error_m=float(np.linalg.norm(qq[:3] - end[:3])))


for path in sys.argv[1:]:
    print(json.dumps(audit(path)), flush=True)
