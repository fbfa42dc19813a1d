"""Time per iteration against the number of nodes, of peers, on work comparable to `srb-opt/examples/nodes.rs`.

usage: python srb_nodes.py --peer DIR [--task lateral] [--croco PYTHON]

fatrop: the reference problem (`tasks.py` of DIR) in its own form, one stage per node, state (p, v, W, R, T), control f, solved by
CasADi's `fatrop` plugin with exact derivatives in CasADi's virtual machine; its time is split into functions and the rest (linear
algebra, line search). Crocoddyl (binary wheels, in a Python of its own, as it brings its own Pinocchio): the backward
pass of `SolverFDDP`, which has no inequality rows, on random linear-quadratic stages of 15 states and 12 controls.
All of them run on one thread. Columns are microseconds per iteration and node.
"""
import argparse, json, os, subprocess, sys, time

os.environ.setdefault("OMP_NUM_THREADS", "1")
a = argparse.ArgumentParser()
a.add_argument("--peer")
a.add_argument("--task", default="lateral")
a.add_argument("--croco", help="Python with crocoddyl; default: this one")
a.add_argument("--only-croco", action="store_true", help=argparse.SUPPRESS)
a.add_argument("--intervals", type=int, nargs="*", default=[25, 50, 100, 200, 400])
a.add_argument("--repeat", type=int, default=5)
a = a.parse_args()


def crocoddyl_times():
    import crocoddyl, numpy as np
    rows = {}
    for n in a.intervals:
        stage = crocoddyl.ActionModelLQR.Random(15, 12)
        problem = crocoddyl.ShootingProblem(np.zeros(15), [stage] * n, stage)
        problem.nthreads = 1
        solver = crocoddyl.SolverFDDP(problem)
        xs, us = [np.ones(15) * 0.1] * (n + 1), [np.ones(12) * 0.1] * n
        solver.setCandidate(xs, us, False)
        solver.computeDirection(True)
        best = {"derivatives": float("inf"), "backward": float("inf")}
        for _ in range(10 * a.repeat):
            start = time.perf_counter()
            problem.calc(xs, us)
            problem.calcDiff(xs, us)
            middle = time.perf_counter()
            solver.backwardPass()
            end = time.perf_counter()
            best["derivatives"] = min(best["derivatives"], 1e6 * (middle - start) / n)
            best["backward"] = min(best["backward"], 1e6 * (end - middle) / n)
        rows[n] = best
    return rows


if a.only_croco:
    print(json.dumps(crocoddyl_times()))
    sys.exit()

sys.path.insert(0, a.peer)
import casadi as ca
import numpy as np
import srb
import tasks as K


def staged(task, counts):
    """The reference problem with one stage per node: what CasADi needs to see fatrop's structure."""
    phase_of = [i for i, n in enumerate(counts) for _ in range(n)]
    last, phases = len(phase_of), len(counts)
    plain = srb.build({**task, "N": counts}, K.I_B)
    guess = srb.unpack({**task, "N": counts}, plain["x0"] * plain["sc"])
    inertia, inverse = ca.DM(K.I_B), ca.DM(np.linalg.inv(K.I_B))
    hips = K.HIP + np.outer(K.SIDE, [0, K.L1, 0])
    angles = K.ref_angle({**task, "N": counts})
    start = np.array([0, 0, K.Z0])
    names = [(f"x{k}", 18 + phases) for k in range(last + 1)]
    x = [ca.SX.sym(*name) for name in names]
    stands = [task["phases"][i] for i in phase_of] + [[]]
    u = [ca.SX.sym(f"u{k}", 3 * len(s)) for k, s in enumerate(stands)]
    w, w0, g, low, high, equality, cost = [], [], [], [], [], [], 0
    inf = np.inf

    def row(value, lower, upper, is_equality=False):
        value = ca.vec(value)
        g.append(value)
        low.extend(np.broadcast_to(np.array(lower, float), value.numel()))
        high.extend(np.broadcast_to(np.array(upper, float), value.numel()))
        equality.extend([is_equality] * value.numel())

    for k in range(last + 1):
        p, v, om, t = x[k][:3], x[k][3:6], x[k][6:9], x[k][18:]
        rot = ca.reshape(x[k][9:18], 3, 3)
        f = ca.reshape(u[k], 3, len(stands[k])) * 50.0
        w += [x[k], u[k]]
        forces = guess["f"][min(k, last - 1)].reshape(4, 3)[stands[k]].ravel() / 50.0
        w0 += [guess["p"][k], guess["v"][k], guess["W"][k], guess["R"][k], guess["T"], forces]
        if k < last:
            dt = t[phase_of[k]] / counts[phase_of[k]]
            total = ca.sum2(f) if stands[k] else ca.SX.zeros(3)
            moment = sum((ca.cross(f[:, i], p - ca.DM(K.FEET0[s])) for i, s in enumerate(stands[k])), ca.SX.zeros(3))
            acc = total / K.M - ca.DM([0, 0, K.G])
            alpha = inverse @ (rot.T @ moment - ca.cross(om, inertia @ om))
            after = ca.vertcat(p + dt * v + 0.5 * dt**2 * acc, v + dt * acc, om + dt * alpha, ca.vec(rot @ srb.exp4(om * dt)), t)
            row(x[k + 1] - after, 0, 0, True)
        if k == 0:
            row(x[0][:18], np.concatenate([start, np.zeros(6), np.eye(3).ravel("F")]), np.concatenate([start, np.zeros(6), np.eye(3).ravel("F")]), True)
            row(ca.vertcat(t, ca.sum1(t)), [K.T_LO] * phases + [K.TTOT_LO], [K.T_HI] * phases + [task["ttot"]])
        for i, s in enumerate(stands[k]):
            fx, fy, fz = f[0, i], f[1, i], f[2, i]
            row(ca.vertcat(K.MU * fz - fx, K.MU * fz + fx, K.MU * fz - fy, K.MU * fz + fy), 0, inf)
            row(fz, 0, K.FZ_MAX)
            if k > 0:
                seen = rot.T @ (ca.DM(K.FEET0[s]) - p) - ca.DM(hips[s])
                row(seen, [-K.REACH_X, -K.REACH_Y, K.REACH_Z[0]], [K.REACH_X, K.REACH_Y, K.REACH_Z[1]])
        if k > 0:
            for corner in K.CORNERS:
                at = p + rot @ ca.DM(corner)
                row(at[2] - K.ground(at, task, ca.tanh), K.CLEAR, inf)
        if k == last:
            error = ca.DM(srb.rodrigues(task["axis"], task["angle"])).T @ rot
            row(p, start + task["goal"], start + task["goal"], True)
            row(srb.vee_skew(error), 0, 0, True)
            row(ca.trace(error), 2.5, inf)
        else:
            error = srb.log_so3(ca.DM(srb.rodrigues(task["axis"], angles[k])).T @ rot)
            cost += K.EPS_W * ca.dot(om, om) + K.EPS_F * ca.sumsqr(f) + K.EPS_R * ca.dot(error, error)
    nlp = dict(x=ca.vertcat(*w), f=cost, g=ca.vertcat(*g))
    sizes = dict(nx=[18 + phases] * (last + 1), nu=[v.numel() for v in u], N=last)
    return nlp, np.concatenate(w0), np.array(low), np.array(high), equality, sizes


def fatrop(task, counts):
    nlp, w0, low, high, equality, _ = staged(task, counts)
    options = dict(print_time=0, structure_detection="auto", equality=equality, record_time=True, fatrop=dict(print_level=0, tol=1e-6, max_iter=500))
    solver = ca.nlpsol("S", "fatrop", nlp, options)
    best = None
    for _ in range(a.repeat):
        begin = time.perf_counter()
        found = solver(x0=w0, lbg=low, ubg=high, lbx=-np.inf, ubx=np.inf)
        wall = time.perf_counter() - begin
        stats = solver.stats()
        functions = sum(value for key, value in stats.items() if key.startswith("t_wall_nlp"))
        if best is None or wall < best[0]:
            best = (wall, functions, stats["iter_count"], stats["success"], float(found["f"]))
    return best


python = a.croco or sys.executable
command = [python, os.path.abspath(__file__), "--only-croco", "--repeat", str(a.repeat), "--intervals", *map(str, a.intervals)]
out = subprocess.run(command, capture_output=True, text=True)
croco = json.loads(out.stdout) if out.returncode == 0 else {}
if not croco:
    print(f"no Crocoddyl in {python}: {out.stderr.strip().splitlines()[-1] if out.stderr else 'no reason given'}")
print("intervals | fatrop: ok, iterations, cost, total, functions, rest | Crocoddyl: derivatives, backward pass")
task = K.TASKS[a.task]
whole = sum(task["N"])
for n in a.intervals:
    counts = [int(i * n / whole) for i in task["N"]]
    wall, functions, iterations, ok, cost = fatrop(task, counts)
    per = 1e6 / (max(iterations, 1) * (sum(counts) + 1))
    c = croco.get(str(n), {})
    print(f"{sum(counts)} | {ok}, {iterations}, {cost:.4f}, {wall * per:.2f}, {functions * per:.2f}, {(wall - functions) * per:.2f} | "
          f"{c.get('derivatives', float('nan')):.2f}, {c.get('backward', float('nan')):.2f}", flush=True)
