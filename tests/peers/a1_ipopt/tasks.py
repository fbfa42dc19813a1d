"""Problem data shared by srb.py and wbto.py.  reference-problems/data/a1-jumps.json is the same as JSON."""
import numpy as np

# ---- robot, Table I -------------------------------------------------------
M = 12.0                                  # kg, total
I_B = np.diag([0.017, 0.056, 0.065])      # kg m^2, Table I (trunk inertia, used literally)
G = 9.81
TRUNK = np.array([0.361, 0.194, 0.114])   # l, w, h
TAU_MAX, QD_MAX = 33.5, 21.0
L1, L2, L3 = 0.0838, 0.2, 0.2
HIP = np.array([[0.1805, 0.047, 0.0], [0.1805, -0.047, 0.0],
                [-0.1805, 0.047, 0.0], [-0.1805, -0.047, 0.0]])      # FL FR RL RR, body frame
SIDE = np.array([1.0, -1.0, 1.0, -1.0])
FOOT_Y = 0.047 + L1                       # 0.1308
FEET0 = np.array([[0.1805, s * FOOT_Y, 0.0] for s in (1, -1)] + [[-0.1805, s * FOOT_Y, 0.0] for s in (1, -1)])
CORNERS = np.array([[sx * TRUNK[0] / 2, sy * TRUNK[1] / 2, sz * TRUNK[2] / 2]
                    for sx in (1, -1) for sy in (1, -1) for sz in (1, -1)])

# ---- common settings ------------------------------------------------------
Z0 = 0.25          # initial and final COM height above the local ground
MU = 0.6
FZ_MAX = 160.0     # N per foot
REACH_X, REACH_Y, REACH_Z = 0.12, 0.10, (-0.33, -0.10)   # foot minus (hip + SIDE*L1*ey), body frame
T_LO, T_HI = 0.10, 1.00   # bounds of each T_i
TTOT_LO = 0.50                            # sum of phases; upper end is per task (Table II total, rounded up to 0.05 s)
CLEAR = 0.03       # trunk corner above ground / obstacle profile
EPS_W, EPS_F, EPS_R = 1e-2, 1e-5, 1.0
EPS_LOG = 1e-6
EDGE_W = 0.03      # width of the tanh that smooths a box edge

FL, FR, RL, RR = 0, 1, 2, 3
ALL, REAR, RIGHT, AIR = [FL, FR, RL, RR], [RL, RR], [FR, RR], []

def task(phases, N, T0, goal, axis, angle, bp, box=0.0, edge=None, euler="zyx", ttot=0.9):
    """phases: stance legs; N: intervals; T0: initial guess [s]; goal: COM displacement [m];
    axis,angle: total rotation R_goal = Exp(axis*angle); bp: reference angle at the end of each phase
    (None = linear over the whole horizon); box: drop height [m];
    edge: (axis index, sign, distance): box occupies sign*coord < distance; euler: order used by wbto."""
    return dict(phases=phases, N=N, T0=T0, goal=np.array(goal, float), axis=np.array(axis, float), angle=angle,
                bp=bp, box=box, edge=edge, euler=euler, ttot=ttot)

d = np.pi / 180
A2 = lambda: ([ALL, AIR], [50, 30], [0.5, 0.3])
A3 = lambda legs: ([ALL, legs, AIR], [50, 30, 40], [0.5, 0.3, 0.4])
TASKS = {
    "lateral":      task(*A2(), [0, 0.3, 0], [0, 0, 1], 0.0, None, ttot=0.8),
    "lateral_down": task(*A2(), [0, 0.5, -0.3], [0, 0, 1], 0.0, None, box=0.3, edge=(1, 1, 0.18)),
    "spin":         task(*A2(), [0, 0, 0], [0, 0, 1], 90 * d, None),
    "diagonal":     task(*A3(REAR), [0.4, -0.3, 0], [0, 0, 1], 45 * d, None, ttot=1.2),
    "barrel":       task(*A3(RIGHT), [0, -0.3, 0], [1, 0, 0], 360 * d, [0, 60 * d, 360 * d], ttot=1.2),
    "double_barrel": task(*A3(RIGHT), [0, -0.5, -0.8], [1, 0, 0], 720 * d, [0, 60 * d, 720 * d], box=0.8, edge=(1, -1, 0.18), ttot=1.35),
    "double_backflip": task(*A3(REAR), [-0.7, 0, -2.0], [0, -1, 0], 720 * d, [0, 60 * d, 720 * d], box=2.0, edge=(0, -1, 0.23), euler="zxy", ttot=1.55),
    "forward":      task(*A3(REAR), [0.6, 0, 0], [0, 0, 1], 0.0, None, ttot=1.2),
    "barrel_box":   task(*A3(RIGHT), [0, -0.5, -0.4], [1, 0, 0], 360 * d, [0, 60 * d, 360 * d], box=0.4, edge=(1, -1, 0.18), ttot=1.2),
}
PAPER_T = {"lateral": [50, 28], "lateral_down": [52, 35], "spin": [56, 31], "diagonal": [54, 30, 33],
           "barrel": [51, 32, 35], "double_barrel": [52, 34, 45], "double_backflip": [50, 33, 69]}
PAPER_SRB_S = {"lateral": 4.14, "lateral_down": 5.02, "spin": 5.7, "diagonal": 5.98, "barrel": 6.61,
               "double_barrel": 11.7, "double_backflip": 7.23}
PAPER_WB_S = {"lateral": 31, "lateral_down": 32, "spin": 39, "diagonal": 226, "barrel": 35,
              "double_barrel": 46, "double_backflip": 89}

def t_bounds(t):
    return [T_LO] * len(t["N"]), [T_HI] * len(t["N"])

def ground(xyz, t, tanh):
    """smoothed terrain height below a point (start ground = 0, landing ground = -box)."""
    if t["box"] == 0.0: return 0.0
    i, s, e = t["edge"]
    return -t["box"] * 0.5 * (1 + tanh((s * xyz[i] - e) / EDGE_W))

def ref_angle(t):
    """reference rotation angle at nodes 0..Nc"""
    N = t["N"]; Nc = sum(N)
    if t["bp"] is None: return np.linspace(0, t["angle"], Nc + 1)
    a = [0.0]; prev = 0.0
    for n, b in zip(N, t["bp"]):
        a += list(prev + (b - prev) * np.arange(1, n + 1) / n); prev = b
    return np.array(a)

def spec():
    """machine-readable copy of everything above"""
    c = {k: v for k, v in globals().items() if k.isupper() and k not in ("TASKS",) and not k.startswith("PAPER")}
    j = lambda v: v.tolist() if isinstance(v, np.ndarray) else v
    return {"constants": {k: j(v) for k, v in c.items() if not callable(v)}, "tasks": {n: {k: j(v) for k, v in t.items()} for n, t in TASKS.items()}}
if __name__ == "__main__":
    import json, os
    json.dump(spec(), open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "spec.json"), "w"), indent=1)
