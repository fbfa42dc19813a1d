"""Contact-timing + single-rigid-body trajectory optimisation, eq. (1)-(3), problem (2).
usage: python srb.py --task spin [--out sol.json] [--repeat 3] [--inertia table|composite] [--tol 1e-6] [--print]
Prints one JSON line.  The exact problem is written down in reference-problems/data/a1-jumps.json."""
import argparse, json, os, sys, time, resource
os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np, casadi as ca
import tasks as K

def hat(w): return ca.vertcat(ca.horzcat(0, -w[2], w[1]), ca.horzcat(w[2], 0, -w[0]), ca.horzcat(-w[1], w[0], 0))
def vee_skew(A): return 0.5 * ca.vertcat(A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1])
def exp4(w):
    A = hat(w); A2 = A @ A
    return ca.DM.eye(3) + A + A2 / 2 + (A2 @ A) / 6 + (A2 @ A2) / 24
def log_so3(E):
    v = vee_skew(E); c = (E[0, 0] + E[1, 1] + E[2, 2] - 1) / 2
    r = ca.sqrt(ca.dot(v, v) + K.EPS_LOG)
    return v * ca.atan2(r, c) / r
def rodrigues(ax, a):
    h = np.array([[0, -ax[2], ax[1]], [ax[2], 0, -ax[0]], [-ax[1], ax[0], 0]])
    return np.eye(3) + np.sin(a) * h + (1 - np.cos(a)) * h @ h

# variable scales (x_physical = scale * x_solver)
SC = dict(p=1.0, v=1.0, W=1.0, R=1.0, Wd=100.0, f=50.0)

def build(t, I_B):
    N, Nc = t["N"], sum(t["N"]); nph = len(N)
    ph = [i for i in range(nph) for _ in range(N[i])]
    X, lb, ub, x0, sc, g, lg, ug = [], [], [], [], [], [], [], []
    def var(name, lo, hi, init, s):
        n = len(init); z = ca.SX.sym(name, n)
        X.append(z); lb.extend(np.array(lo, float) / s); ub.extend(np.array(hi, float) / s); x0.extend(np.array(init, float) / s); sc.extend([s] * n)
        return z * s
    def con(e, lo, hi):
        e = ca.vec(e); n = e.numel(); g.append(e)
        lg.extend(np.broadcast_to(np.array(lo, float), n)); ug.extend(np.broadcast_to(np.array(hi, float), n))
    inf = np.inf; F = lambda n: ([-inf] * n, [inf] * n)
    T = var("T", *K.t_bounds(t), t["T0"], 1.0)
    # ---- initial guess
    p0 = np.array([0, 0, K.Z0]); p1 = p0 + t["goal"]; Rg = rodrigues(t["axis"], t["angle"]); ra = K.ref_angle(t)
    tk = np.concatenate([[0.0], np.cumsum([t["T0"][ph[k]] / N[ph[k]] for k in range(Nc)])])
    tl, tf = sum(t["T0"][:-1]), t["T0"][-1]                       # lift-off time, flight time
    vlo = (p1 - p0) / tf + np.array([0, 0, 0.5 * K.G * tf])       # ballistic lift-off velocity, p(lift-off) = p0
    P, V = [], []
    for s in tk:
        if s <= tl + 1e-12: P.append(p0); V.append(vlo * (s / tl))
        else: u = s - tl; P.append(p0 + vlo * u - np.array([0, 0, .5 * K.G * u * u])); V.append(vlo - np.array([0, 0, K.G * u]))
    p, v, W, R, Wd, f = [], [], [], [], [], []
    for k in range(Nc + 1):
        e0, eN = k == 0, k == Nc
        fix = lambda c, val, n: (list(val), list(val)) if c else F(n)
        p.append(var(f"p{k}", *(fix(True, p0, 3) if e0 else fix(eN, p1, 3)), P[k], SC["p"]))
        v.append(var(f"v{k}", *fix(e0, [0] * 3, 3), V[k], SC["v"]))
        rate = (ra[k + 1] - ra[k]) / (tk[k + 1] - tk[k]) if k < Nc else (ra[k] - ra[k - 1]) / (tk[k] - tk[k - 1])
        W.append(var(f"W{k}", *fix(e0, [0] * 3, 3), t["axis"] * rate, SC["W"]))
        Rk = rodrigues(t["axis"], ra[k])
        R.append(ca.reshape(var(f"R{k}", *fix(e0, np.eye(3).flatten("F"), 9), Rk.flatten("F"), SC["R"]), 3, 3))
        if k < Nc:
            st = t["phases"][ph[k]]
            Wd.append(var(f"Wd{k}", *F(3), [0] * 3, SC["Wd"]))
            lo, hi, ini = [], [], []
            for s in range(4):
                if s in st: lo += [-inf, -inf, 0]; hi += [inf, inf, K.FZ_MAX]; ini += [0, 0, K.M * K.G / len(st)]
                else: lo += [0] * 3; hi += [0] * 3; ini += [0] * 3
            f.append(ca.reshape(var(f"f{k}", lo, hi, ini, SC["f"]), 3, 4))
    J = 0; hips = K.HIP + np.outer(K.SIDE, [0, K.L1, 0])
    for k in range(Nc):
        dt = T[ph[k]] / N[ph[k]]; st = t["phases"][ph[k]]
        ft = ca.sum2(f[k]); acc = ft / K.M - ca.DM([0, 0, K.G])
        con(v[k + 1] - v[k] - dt * acc, 0, 0)
        con(p[k + 1] - p[k] - dt * v[k] - 0.5 * dt**2 * acc, 0, 0)
        mom = sum((ca.cross(f[k][:, s], p[k] - ca.DM(K.FEET0[s])) for s in st), ca.SX.zeros(3))
        con(ca.DM(I_B) @ Wd[k] + ca.cross(W[k], ca.DM(I_B) @ W[k]) - R[k].T @ mom, 0, 0)
        con(W[k + 1] - W[k] - dt * Wd[k], 0, 0)
        con(R[k + 1] - R[k] @ exp4(W[k] * dt), 0, 0)
        for s in st:
            fx, fy, fz = f[k][0, s], f[k][1, s], f[k][2, s]
            con(ca.vertcat(K.MU * fz - fx, K.MU * fz + fx, K.MU * fz - fy, K.MU * fz + fy), 0, inf)
            d = R[k].T @ (ca.DM(K.FEET0[s]) - p[k]) - ca.DM(hips[s])
            con(d, [-K.REACH_X, -K.REACH_Y, K.REACH_Z[0]], [K.REACH_X, K.REACH_Y, K.REACH_Z[1]])
        Rref = rodrigues(t["axis"], ra[k])
        eR = log_so3(ca.DM(Rref).T @ R[k])
        J += K.EPS_W * ca.dot(W[k], W[k]) + K.EPS_F * ca.dot(f[k], f[k]) + K.EPS_R * ca.dot(eR, eR)
    for k in range(1, Nc + 1):
        for c in K.CORNERS:
            x = p[k] + R[k] @ ca.DM(c)
            con(x[2] - K.ground(x, t, ca.tanh), K.CLEAR, inf)
    E = ca.DM(Rg).T @ R[Nc]
    con(vee_skew(E), 0, 0); con(ca.trace(E), 2.5, inf)
    con(ca.sum1(T), K.TTOT_LO, t["ttot"])
    return dict(nlp=dict(x=ca.vertcat(*X), f=J, g=ca.vertcat(*g)), lbx=np.array(lb), ubx=np.array(ub), x0=np.array(x0), sc=np.array(sc), lbg=np.array(lg), ubg=np.array(ug))

def unpack(t, xs):
    Nc = sum(t["N"]); nph = len(t["N"]); i = nph; o = dict(T=xs[:nph], p=[], v=[], W=[], R=[], Wd=[], f=[])
    for k in range(Nc + 1):
        for nm, n in (("p", 3), ("v", 3), ("W", 3), ("R", 9)) + ((("Wd", 3), ("f", 12)) if k < Nc else ()):
            o[nm].append(xs[i:i + n]); i += n
    return {a: np.array(b) for a, b in o.items()}

def cputime(): r = resource.getrusage(resource.RUSAGE_SELF); return r.ru_utime + r.ru_stime

def main():
    a = argparse.ArgumentParser(); a.add_argument("--task", required=True, choices=list(K.TASKS)); a.add_argument("--out"); a.add_argument("--repeat", type=int, default=1)
    a.add_argument("--inertia", default="table", choices=["table", "composite"]); a.add_argument("--tol", type=float, default=1e-6); a.add_argument("--max-iter", type=int, default=1000)
    a.add_argument("--print", action="store_true"); a.add_argument("--ipopt", default="{}", help="json dict of extra ipopt options")
    a = a.parse_args(); t = K.TASKS[a.task]
    I_B = K.I_B
    if a.inertia == "composite":
        here = os.path.dirname(os.path.abspath(__file__)); I_B = np.diag(json.load(open(os.path.join(here, "a1_model.json")))["composite_inertia_diag"])
    t0 = time.time(); b = build(t, I_B)
    opts = {"print_time": 0, "ipopt": dict(print_level=5 if a.print else 0, sb="yes", tol=a.tol, constr_viol_tol=1e-6, max_iter=a.max_iter, linear_solver="mumps", **json.loads(a.ipopt))}
    S = ca.nlpsol("S", "ipopt", b["nlp"], opts); t_build = time.time() - t0
    wall, cpu = [], []
    for _ in range(a.repeat):
        w0, c0 = time.time(), cputime()
        s = S(x0=b["x0"], lbx=b["lbx"], ubx=b["ubx"], lbg=b["lbg"], ubg=b["ubg"])
        wall.append(time.time() - w0); cpu.append(cputime() - c0)
    st = S.stats(); x = np.array(s["x"]).ravel(); g = np.array(s["g"]).ravel()
    xp = x * b["sc"]; viol = max(0, np.max(b["lbg"] - g), np.max(g - b["ubg"]), np.max((b["lbx"] - x) * b["sc"]), np.max((x - b["ubx"]) * b["sc"]))
    o = unpack(t, xp); R = o["R"].reshape(-1, 3, 3).transpose(0, 2, 1)
    dtk = np.concatenate([[o["T"][i] / n] * n for i, n in enumerate(t["N"])])
    turn = float(np.degrees(np.sum(o["W"][:-1] @ t["axis"] * dtk)))
    out = dict(task=a.task, ok=bool(st["success"]), status=st["return_status"], wall_s=round(float(np.median(wall)), 4), cpu_s=round(float(np.median(cpu)), 4), walls=[round(w, 3) for w in wall],
               build_s=round(t_build, 3), iters=st["iter_count"], cost=float(s["f"]), T=[round(float(v), 5) for v in o["T"]], max_violation=float(viol),
               peak_fz=float(o["f"].reshape(-1, 4, 3)[:, :, 2].max()), peak_W=float(np.abs(o["W"]).max()), orth_err=float(max(np.abs(r.T @ r - np.eye(3)).max() for r in R)),
               turn_deg=round(turn, 2), n_var=len(x), n_con=len(g), inertia=a.inertia)
    if a.out: json.dump(dict(**out, sol={k: v.tolist() for k, v in o.items()}, N=t["N"]), open(a.out, "w"))
    print(json.dumps(out))
if __name__ == "__main__": main()
