"""Times `saltus plan --stage srb` against CasADi + IPOPT on the same problems, in one run.

usage: python srb_ratio.py --saltus target/release/saltus --peer tests/peers/a1_ipopt [--problem FILE ...] [--repeat 20]

DIR holds the peer (`srb.py`, `tasks.py`); needs casadi and numpy. Per task: the median cold solve of both in
one process each (ours counts the whole portfolio), their costs, and the ratio. Ours is also solved from
20 noisy guesses with --noise. Wall times of both come from their own clocks; cpu times from the kernel.
"""
import argparse, json, os, resource, subprocess, sys, time

a = argparse.ArgumentParser()
a.add_argument("--saltus", required=True)
a.add_argument("--peer", required=True)
a.add_argument("--problem", nargs="*", default=[], help="JSON files like the shipped one; default: the shipped nine")
a.add_argument("--task", nargs="*", help="only these tasks")
a.add_argument("--repeat", type=int, default=20)
a.add_argument("--peer-repeat", type=int, default=3)
a.add_argument("--noise", type=float, default=0.0, help="also solve from 20 guesses with this noise")
a = a.parse_args()
sys.path.insert(0, a.peer)
os.environ.setdefault("OMP_NUM_THREADS", "1")
import casadi as ca
import numpy as np
import srb
import tasks as K


def cpu(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def saltus(*arguments):
    start = cpu(resource.RUSAGE_CHILDREN)
    out = subprocess.run([a.saltus, "plan", "--stage", "srb", "--json", *arguments], capture_output=True, text=True)
    report = json.loads(out.stdout)
    return report, cpu(resource.RUSAGE_CHILDREN) - start


def ours(where):
    """Median wall ms inside the process, and cpu ms per solve as the slope over the repetitions."""
    _, once = saltus(*where)
    report, many = saltus(*where, "--repeat", str(a.repeat + 1))
    return report, report["srb"]["wall_ms"], 1e3 * (many - once) / a.repeat


def peer(task):
    b = srb.build(task, K.I_B)
    options = dict(print_level=0, sb="yes", tol=1e-6, constr_viol_tol=1e-6, max_iter=1000, linear_solver="mumps")
    solver = ca.nlpsol("S", "ipopt", b["nlp"], dict(print_time=0, ipopt=options))
    walls, cpus = [], []
    for _ in range(a.peer_repeat):
        wall, used = time.time(), cpu(resource.RUSAGE_SELF)
        s = solver(x0=b["x0"], lbx=b["lbx"], ubx=b["ubx"], lbg=b["lbg"], ubg=b["ubg"])
        walls.append(time.time() - wall)
        cpus.append(cpu(resource.RUSAGE_SELF) - used)
    stats = solver.stats()
    return stats["success"], float(s["f"]), stats["iter_count"], 1e3 * np.median(walls), 1e3 * np.median(cpus)


def problems():
    if not a.problem:
        for name, task in K.TASKS.items():
            yield name, task, ["--reference", name]
    for path in a.problem:
        file = json.load(open(path))
        for key, value in file["constants"].items():
            array = isinstance(getattr(K, key, None), np.ndarray)
            setattr(K, key, np.array(value) if array else value)
        for name, task in file["tasks"].items():
            task = {**task, "goal": np.array(task["goal"], float), "axis": np.array(task["axis"], float)}
            yield name, task, ["--problem", path, "--reference", name]


ratios, cpu_ratios = [], []
print("task | IPOPT iterations, cost, ms wall (cpu) | ours status, iterations, cost / IPOPT's, violation, ms wall (cpu) | ratio wall (cpu) | noisy")
for name, task, where in problems():
    if a.task and name not in a.task:
        continue
    ok, cost, iterations, wall, used = peer(task)
    report, our_wall, our_cpu = ours(where)
    q = report["srb"]
    noisy = ""
    if a.noise > 0:
        runs = [saltus(*where, "--guess-noise", str(a.noise), "--seed", str(seed))[0] for seed in range(1, 21)]
        good = sum(r["status"] == "Solved" and r["srb"]["cost"] <= 1.001 * cost and r["srb"]["max_violation"] <= 1e-6 for r in runs)
        noisy = f"{good}/20"
    ratios.append(wall / our_wall)
    cpu_ratios.append(used / our_cpu)
    print(f"{name} | {'ok' if ok else 'FAILED'} {iterations}, {cost:.4f}, {wall:.0f} ({used:.0f}) | {report['status']} {q['iterations']}, "
          f"{q['cost'] / cost:.5f}, {q['max_violation']:.0e}, {our_wall:.2f} ({our_cpu:.2f}) | {ratios[-1]:.0f} ({cpu_ratios[-1]:.0f}) | {noisy}", flush=True)
print(f"median ratio {np.median(ratios):.0f} wall, {np.median(cpu_ratios):.0f} cpu; least {min(ratios):.0f} wall, {min(cpu_ratios):.0f} cpu")
