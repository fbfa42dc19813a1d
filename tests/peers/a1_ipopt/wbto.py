"""Whole-body trajectory optimisation, eq. (4)-(6), warm-started from an srb.py solution.
usage: python wbto.py --task spin --srb solutions/srb_spin.json [--out sol.json] [--stance acc|pos] [--guess paper|ik] [--jit] [--print]
Prints one JSON line.  The exact problem is written down in reference-problems/data/a1-jumps.json."""
import argparse, hashlib, json, os, subprocess, sys, tempfile, time, resource
os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np, casadi as ca
import tasks as K, a1dyn

DT = 0.01
EPS_Q, EPS_TAU, EPS_N = 1.0, 1e-4, 10.0
N_POSE = 5                        # last knots held at the landing joint configuration
Q_HI_LEG = np.array([46, 240, -52.5]) * np.pi / 180
Q_LO_LEG = np.array([-46, -60, -154.5]) * np.pi / 180
Q_LAND = np.array([0.0, 0.8957, -1.7914])
KNEE_CLEAR, FOOT_CLEAR = 0.02, -0.01
GOAL_P, GOAL_E = 0.02, 0.05
DRIFT = 0.01                      # stance feet stay within this of their start (only --stance acc)
S_A, S_F, S_TAU, S_V = 100.0, 50.0, 10.0, 5.0
if "--unscaled" in sys.argv: S_A = S_F = S_TAU = S_V = 1.0
inf = np.inf

def cputime(): r = resource.getrusage(resource.RUSAGE_SELF); return r.ru_utime + r.ru_stime

def euler_from_R(Rs, order):
    E = []
    for R in Rs:
        if order == "zyx": E.append([np.arctan2(R[2, 1], R[2, 2]), -np.arcsin(np.clip(R[2, 0], -1, 1)), np.arctan2(R[1, 0], R[0, 0])])
        else: E.append([np.arcsin(np.clip(R[2, 1], -1, 1)), np.arctan2(-R[2, 0], R[2, 2]), np.arctan2(-R[0, 1], R[1, 1])])
    return np.unwrap(np.array(E), axis=0)

def reference(t, d):
    """base pose reference at the whole-body knots + phase id per interval + SRB forces"""
    s = d["sol"]; N = t["N"]; T = d["T"]
    tk = [0.0]
    for n, Ti in zip(N, T): tk += list(tk[-1] + Ti / n * np.arange(1, n + 1))
    tk = np.array(tk)
    Rs = np.array(s["R"]).reshape(-1, 3, 3).transpose(0, 2, 1)
    E = euler_from_R(Rs, t["euler"]); p = np.array(s["p"]); f = np.array(s["f"])
    NW = [max(1, int(round(Ti / DT))) for Ti in T]
    tw = [0.0]; ph = []                           # reference clock is stretched phase-wise so that phases match
    for i, (n, Ti) in enumerate(zip(NW, T)): tw += list(tw[-1] + Ti / n * np.arange(1, n + 1)); ph += [i] * n
    tw = np.array(tw)
    ref = np.array([np.interp(tw, tk, c) for c in np.hstack([p, E]).T]).T
    F = np.array([f[min(np.searchsorted(tk, x + 1e-9, side="right") - 1, len(f) - 1)] for x in tw[:-1]])
    return ref, ph, NW, F

class Stage:
    """one kind of knot: SX function of scaled w -> constraints, cost; with exact derivative functions"""
    def __init__(self, t, stance, kind, stance_mode):
        order = t["euler"]; last = kind == "last"
        n = 36 if last else 36 + 18 + 12 + 3 * len(stance)
        w = ca.SX.sym("w", n); prm = ca.SX.sym("prm", 18)          # prm = q_ref
        q, v = w[:18], S_V * w[18:36]
        sc = [1.0] * 18 + [S_V] * 18
        F = ca.SX.zeros(3, 4)
        if last: a, tau = ca.SX.zeros(18), ca.SX.zeros(12)
        else:
            a, tau = S_A * w[36:54], S_TAU * w[54:66]; sc += [S_A] * 18 + [S_TAU] * 12 + [S_F] * (3 * len(stance))
            for i, s in enumerate(stance): F[:, s] = S_F * w[66 + 3 * i:69 + 3 * i]
        D = a1dyn.dynamics(q, v, a, F, order); D2 = D
        g, lo, hi, gs = [], [], [], []
        def con(e, l, h, s=1.0):
            s = 1.0 if "--unscaled" in sys.argv else s; e = ca.vec(e); g.append(e / s); m = e.numel(); lo.extend(np.broadcast_to(np.array(l, float) / s, m)); hi.extend(np.broadcast_to(np.array(h, float) / s, m)); gs.extend([s] * m)
        if not last:
            con(D["base"][:3], 0, 0, 50.0); con(D["base"][3:], 0, 0, 10.0)
            con(tau - D["tau"], 0, 0, 10.0)
            for s in stance:
                if stance_mode == "acc": con(D["foota"][:, s], 0, 0, 10.0)
                fx, fy, fz = F[0, s], F[1, s], F[2, s]
                con(ca.vertcat(K.MU * fz - fx, K.MU * fz + fx, K.MU * fz - fy, K.MU * fz + fy), 0, inf, 50.0)
        if kind != "first":
            for s in stance:
                e = D["foot"][:, s] - ca.DM(K.FEET0[s])
                con(e, 0, 0, 0.1) if stance_mode == "pos" else con(e, -DRIFT, DRIFT, 0.1)
            for c in K.CORNERS:
                x = q[:3] + D["R"] @ ca.DM(c); con(x[2] - K.ground(x, t, ca.tanh), K.CLEAR, inf, 0.1)
            for s in range(4):
                x = D["knee"][:, s]; con(x[2] - K.ground(x, t, ca.tanh), KNEE_CLEAR, inf, 0.1)
                if s not in stance: x = D["foot"][:, s]; con(x[2] - K.ground(x, t, ca.tanh), FOOT_CLEAR, inf, 0.1)
        e = q - prm
        J = (EPS_N if last else EPS_Q) * ca.dot(e, e) + EPS_TAU * ca.dot(tau, tau)
        if kind == "first": J = EPS_TAU * ca.dot(tau, tau)
        if kind == "lastm": eN = q + 0.5 * DT * v - prm; J += EPS_N * ca.dot(eN, eN)
        G = ca.vertcat(*g); self.n, self.m = n, G.numel(); self.lo, self.hi, self.gs, self.sc = map(np.array, (lo, hi, gs, sc))
        lam = ca.SX.sym("lam", self.m); sig = ca.SX.sym("sig")
        H = ca.triu(ca.hessian(sig * J + ca.dot(lam, G), w)[0])
        gj = ca.jacobian(G, w)
        h = f"{kind}_{''.join(map(str, stance))}"
        self.f = {"g": ca.Function("g_" + h, [w, prm], [G]), "J": ca.Function("J_" + h, [w, prm], [J]), "dJ": ca.Function("dJ_" + h, [w, prm], [ca.gradient(J, w)]),
                  "jac": ca.Function("jac_" + h, [w, prm], [gj]), "hes": ca.Function("hes_" + h, [w, prm, sig, lam], [H])}
        self.aux = ca.Function("aux_" + h, [w, prm], [D["foot"], D["footv"]])
    def jit(self, cache):
        for nm in list(self.f):
            fn = self.f[nm]; c = ca.CodeGenerator("x.c"); c.add(fn); src = c.dump()
            key = hashlib.sha1(src.encode()).hexdigest()[:16]; so = os.path.join(cache, f"{key}.so")
            if not os.path.exists(so):
                cf = os.path.join(cache, f"{key}.c"); open(cf, "w").write(src)
                subprocess.check_call(["gcc", "-O1", "-march=native", "-fPIC", "-shared", cf, "-o", so, "-lm"])
            self.f[nm] = ca.external(fn.name(), so)

def main():
    ap = argparse.ArgumentParser(); ap.add_argument("--task", required=True, choices=list(K.TASKS)); ap.add_argument("--srb", required=True); ap.add_argument("--out")
    ap.add_argument("--stance", default="acc", choices=["acc", "pos"]); ap.add_argument("--integ", default="euler", choices=["euler", "mid"]); ap.add_argument("--deriv", default="block", choices=["block", "casadi"]); ap.add_argument("--seed", type=int, default=-1); ap.add_argument("--noise", type=float, default=0.0); ap.add_argument("--unscaled", action="store_true")
    ap.add_argument("--guess", default="paper", choices=["paper", "ik"]); ap.add_argument("--jit", action="store_true")
    ap.add_argument("--tol", type=float, default=1e-6); ap.add_argument("--max-iter", type=int, default=1500); ap.add_argument("--max-wall", type=float, default=900.0)
    ap.add_argument("--print", action="store_true"); ap.add_argument("--ipopt", default="{}"); ap.add_argument("--repeat", type=int, default=1)
    a = ap.parse_args(); t = K.TASKS[a.task]; d = json.load(open(a.srb))
    t0 = time.time()
    ref, ph, NW, Fsrb = reference(t, d); N = len(ph)
    qref = np.hstack([ref, np.tile(Q_LAND, (N + 1, 4))]); qgoal = np.concatenate([[0, 0, K.Z0] + t["goal"], ref[-1, 3:], Q_LAND, Q_LAND, Q_LAND, Q_LAND]); qgoal[3:6] = t["axis"] * t["angle"]
    # ---- knots and kinds
    mid = a.integ == "mid"; NK = N if mid else N + 1           # number of stage blocks
    if mid: qref = 0.5 * (qref[1:] + qref[:-1])               # stage states are interval midpoints
    kinds = []
    for k in range(NK):
        st = tuple(t["phases"][ph[min(k, N - 1)]])
        kinds.append(("lastm" if k == N - 1 else "mid", st) if mid else ("first" if k == 0 else "last" if k == N else "mid", st))
    lib = {}
    for kd in kinds:
        if kd not in lib: lib[kd] = Stage(t, kd[1], kd[0], a.stance)
    nops = lib[kinds[1]].f["hes"].n_instructions(), lib[kinds[1]].f["jac"].n_instructions()
    t_jit = time.time()
    if a.jit:
        cache = os.path.join(tempfile.gettempdir(), "casadi_a1_jit"); os.makedirs(cache, exist_ok=True)
        for s in lib.values(): s.jit(cache)
    t_jit = time.time() - t_jit
    st = [lib[k] for k in kinds]; off = np.concatenate([[0], np.cumsum([s.n for s in st])]); nx = off[-1]
    x, p = ca.MX.sym("x", nx), ca.MX.sym("p", 18, NK)
    moff = np.concatenate([[0], np.cumsum([s.m for s in st])]); mg = moff[-1]
    # linear constraints (in solver units).  euler: v+ = v + dt a, q+ = q + dt v+.
    # mid: stage (qm, vm, a) stands for q_k = qm - dt/2 vm, v_k = vm - dt/2 a, and v_{k+1}, q_{k+1} with plus signs.
    rows, lbl, ubl = [], [], []                                 # rows: list of [(col, val)]
    def lin(r, lo=0.0, hi=0.0): rows.append(r); lbl.append(lo); ubl.append(hi)
    q0 = np.concatenate([[0, 0, K.Z0, 0, 0, 0], np.tile(Q_LAND, 4)]); tolg = np.array([GOAL_P] * 3 + [GOAL_E] * 3); HD = 0.5 * DT
    iq, iv, ia = (lambda k, i: (int(off[k] + i))), (lambda k, i: (int(off[k] + 18 + i))), (lambda k, i: (int(off[k] + 36 + i)))
    for k in range(NK - 1):
        for i in range(18):
            if not mid:
                lin([(iv(k + 1, i), 1.0), (iv(k, i), -1.0), (ia(k, i), -DT * S_A / S_V)])
                lin([(iq(k + 1, i), 1.0), (iq(k, i), -1.0), (iv(k + 1, i), -DT * S_V)])
            elif i < 6 or k < N - N_POSE:
                lin([(iv(k + 1, i), 1.0), (ia(k + 1, i), -HD * S_A / S_V), (iv(k, i), -1.0), (ia(k, i), -HD * S_A / S_V)])
                lin([(iq(k + 1, i), 1.0), (iv(k + 1, i), -HD * S_V), (iq(k, i), -1.0), (iv(k, i), -HD * S_V)])
    if mid:
        for i in range(18):
            lin([(iq(0, i), 1.0), (iv(0, i), -HD * S_V)], q0[i], q0[i]); lin([(iv(0, i), 1.0), (ia(0, i), -HD * S_A / S_V)])
        for i in range(6): lin([(iq(N - 1, i), 1.0), (iv(N - 1, i), HD * S_V)], qgoal[i] - tolg[i], qgoal[i] + tolg[i])
    ml = len(rows); A = ca.DM.triplet([r for r in range(ml) for _ in rows[r]], [c for r in rows for c, _ in r], ca.DM([z for r in rows for _, z in r]), ml, int(nx))
    # groups of consecutive equal knots -> map
    groups, k = [], 0
    while k < NK:
        j = k
        while j + 1 < NK and kinds[j + 1] == kinds[k]: j += 1
        groups.append((k, j + 1)); k = j + 1
    lam = ca.MX.sym("lam", int(mg + ml)); lf = ca.MX.sym("lf")
    Gs, Js, dJs, Jac, Hes = [], 0, [], [], []
    for (i, j) in groups:
        s, n = st[i], j - i
        Wm = ca.reshape(x[int(off[i]):int(off[j])], s.n, n); Pm = p[:, i:j]; Lm = ca.reshape(lam[int(moff[i]):int(moff[j])], s.m, n)
        mp = lambda f: f.map(n) if n > 1 else f
        if s.m: Gs.append(ca.vec(mp(s.f["g"])(Wm, Pm))); Jac += ca.horzsplit(mp(s.f["jac"])(Wm, Pm), s.n)
        else: Jac += [ca.DM(0, s.n)] * n
        Js = Js + ca.sum2(mp(s.f["J"])(Wm, Pm)); dJs.append(ca.vec(mp(s.f["dJ"])(Wm, Pm)))
        Hes += ca.horzsplit(mp(s.f["hes"])(Wm, Pm, ca.repmat(lf, 1, n), Lm), s.n)
    gx = ca.vertcat(*Gs, A @ x); jx = ca.vertcat(ca.diagcat(*Jac), A); hx = ca.diagcat(*Hes); pass
    pp = ca.MX.sym("pp", 18 * NK)
    F_ = lambda nm, i, o, ni, no: ca.Function(nm, i, o, ni, no)
    fx, gxs, jxs, hxs, dj = ca.graph_substitute([Js, gx, jx, hx, ca.vertcat(*dJs)], [p], [ca.reshape(pp, 18, NK)])
    opts = {"print_time": 0, "no_nlp_grad": True, "calc_lam_p": False, "calc_f": False, "calc_g": False, "ipopt": dict(print_level=5 if a.print else 0, sb="yes", tol=a.tol, constr_viol_tol=1e-6, max_iter=a.max_iter, max_wall_time=a.max_wall, linear_solver="mumps", **json.loads(a.ipopt)),
            "grad_f": F_("nlp_grad_f", [x, pp], [fx, dj], ["x", "p"], ["f", "grad_f_x"]),
            "jac_g": F_("nlp_jac_g", [x, pp], [gxs, jxs], ["x", "p"], ["g", "jac_g_x"]),
            "hess_lag": F_("nlp_hess_l", [x, pp, lf, lam], [hxs], ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"])}
    if a.deriv == "casadi":                                      # let CasADi derive everything from the MX graph
        for z in ("grad_f", "jac_g", "hess_lag"): opts.pop(z)
    S = ca.nlpsol("S", "ipopt", {"x": x, "p": pp, "f": fx, "g": gxs}, opts)
    # ---- bounds and initial guess
    sc = np.concatenate([s.sc for s in st]); lb, ub, x0 = -inf * np.ones(nx), inf * np.ones(nx), np.zeros(nx)
    qg = qref.copy()
    if a.guess == "ik":
        for k in range(NK):
            stn = kinds[k][1]; e = qg[k, 3:6]; R = np.array(a1dyn.base_rot(ca.DM(e), t["euler"]))
            for s in range(4):
                if s in stn: qg[k, 6 + 3 * s:9 + 3 * s] = leg_ik(R.T @ (K.FEET0[s] - qg[k, :3]) - K.HIP[s], K.SIDE[s])
    vg = np.zeros((NK, 18)); vg[1:] = (qg[1:] - qg[:-1]) / DT
    if a.guess == "paper": vg[:, 6:] = 0
    ag = np.zeros((N, 18)); ag[:NK - 1, :6] = ((vg[1:] - vg[:-1]) / DT)[:, :6]
    for k in range(NK):
        o = off[k]; stn = kinds[k][1]
        lo = np.concatenate([[-inf] * 6, np.tile(Q_LO_LEG, 4)]); hi = np.concatenate([[inf] * 6, np.tile(Q_HI_LEG, 4)])
        vlo = np.concatenate([[-inf] * 6, [-K.QD_MAX] * 12]); vhi = -vlo
        if k == 0 and not mid: lo = hi = q0; vlo = vhi = np.zeros(18)
        if k >= N - N_POSE: lo = lo.copy(); hi = hi.copy(); lo[6:] = hi[6:] = np.tile(Q_LAND, 4)
        if mid and k >= N - N_POSE: vlo[6:] = vhi[6:] = 0; lb[o + 42:o + 54] = ub[o + 42:o + 54] = 0
        if k == N: lo[:6] = qgoal[:6] - tolg; hi[:6] = qgoal[:6] + tolg
        lb[o:o + 18], ub[o:o + 18] = lo, hi; lb[o + 18:o + 36], ub[o + 18:o + 36] = vlo, vhi
        x0[o:o + 18], x0[o + 18:o + 36] = (q0 if k == 0 and not mid else qg[k]), vg[k]
        if k < N:
            lb[o + 54:o + 66], ub[o + 54:o + 66] = -K.TAU_MAX, K.TAU_MAX
            x0[o + 36:o + 54] = ag[k]
            for i, s in enumerate(stn): lb[o + 68 + 3 * i] = 0; x0[o + 66 + 3 * i:o + 69 + 3 * i] = Fsrb[k][3 * s:3 * s + 3]
    lb, ub, x0 = lb / sc, ub / sc, x0 / sc
    if a.noise > 0: x0 = x0 + a.noise * np.random.default_rng(a.seed).normal(size=nx)
    lg = np.concatenate([s.lo for s in st] + [np.array(lbl)]); ug = np.concatenate([s.hi for s in st] + [np.array(ubl)]); gs = np.concatenate([s.gs for s in st] + [np.ones(ml)])
    prm = qref.copy(); prm[NK - 1] = qgoal
    build = time.time() - t0; wall, cpu = [], []
    for _ in range(a.repeat):
        w0, c0 = time.time(), cputime()
        s = S(x0=x0, p=prm.ravel(), lbx=lb, ubx=ub, lbg=lg, ubg=ug); wall.append(time.time() - w0); cpu.append(cputime() - c0)
    sx = S.stats(); xs = np.array(s["x"]).ravel(); g = np.array(s["g"]).ravel()
    viol = max(0, np.max((lg - g) * gs), np.max((g - ug) * gs), np.max((lb - xs) * sc), np.max((xs - ub) * sc))
    xp = xs * sc; q = np.array([xp[off[k]:off[k] + 18] for k in range(NK)]); v = np.array([xp[off[k] + 18:off[k] + 36] for k in range(NK)]); acc = np.array([xp[off[k] + 36:off[k] + 54] for k in range(N)])
    tau = np.array([xp[off[k] + 54:off[k] + 66] for k in range(N)]); F = np.zeros((N, 4, 3)); drift = 0; vdrift = 0
    for k in range(N):
        for i, sft in enumerate(kinds[k][1]): F[k, sft] = xp[off[k] + 66 + 3 * i:off[k] + 69 + 3 * i]
        ft, fv = st[k].aux(xs[off[k]:off[k + 1]], prm[k]); ft, fv = np.array(ft), np.array(fv)
        for sft in kinds[k][1]: drift = max(drift, np.abs(ft[:, sft] - K.FEET0[sft]).max()); vdrift = max(vdrift, np.abs(fv[:, sft]).max())
    T = [n * DT for n in NW]
    out = dict(task=a.task, ok=bool(sx["success"]), status=sx["return_status"], wall_s=round(float(np.median(wall)), 3), cpu_s=round(float(np.median(cpu)), 3), walls=[round(w, 2) for w in wall], build_s=round(build, 2), jit_s=round(t_jit, 2),
               iters=sx["iter_count"], cost=float(s["f"]), T=T, knots=N, max_violation=float(viol), peak_fz=float(F[:, :, 2].max()), peak_tau=float(np.abs(tau).max()), peak_qd=float(np.abs(v[:, 6:]).max()),
               tau_sat_frac=float((np.abs(tau).max(1) > 0.99 * K.TAU_MAX).mean()), foot_drift=float(drift), foot_vel=float(vdrift), n_var=int(nx), n_con=int(mg + ml), stance=a.stance, guess=a.guess, integ=a.integ, deriv=a.deriv, jit=a.jit, hess_ops=int(nops[0]), jac_ops=int(nops[1]),
               t_fn={k[10:] if k.startswith("t_wall_nlp") else k: round(z, 2) for k, z in sx.items() if k.startswith("t_wall_nlp")}, final=[round(float(z), 4) for z in (q[-1, :6] + (HD * v[-1, :6] if mid else 0))])
    if a.out: json.dump(dict(**out, sol=dict(q=q.tolist(), v=v.tolist(), a=acc.tolist(), tau=tau.tolist(), F=F.tolist())), open(a.out, "w"))
    print(json.dumps(out))

def leg_ik(r, side):
    """hip->foot vector in body frame -> (hip, thigh, calf), clipped to the limits"""
    y, z, x = r[1], r[2], r[0]; L2 = max(y * y + z * z - K.L1**2, 1e-4); h = np.sqrt(L2)
    q1 = np.arctan2(z, y) + np.arctan2(h, side * K.L1)
    D = np.clip(np.sqrt(x * x + h * h), 0.09, 0.358); knee = -2 * np.arccos(D / 0.4)
    th = np.arctan2(-x, h) - knee / 2
    return np.clip([np.arctan2(np.sin(q1), np.cos(q1)), th, knee], Q_LO_LEG, Q_HI_LEG)
if __name__ == "__main__": main()
