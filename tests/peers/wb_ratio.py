"""Times `saltus plan --stage whole-body` against CasADi + IPOPT on the same problems, in one run.

usage: python wb_ratio.py --saltus target/release/saltus --peer tests/peers/a1_ipopt --srb reference-problems/data/srb [--task NAME ...] [--repeat 20]

--peer holds `wbto.py`, `verify.py`, `tasks.py` (needs casadi, numpy, pin); --srb the SRB solutions `NAME.json`. Per
task: the median cold solve of both in one process each (ours counts every attempt), costs, violations, the worst
residual of the equations of motion that Pinocchio finds in our solution, and the ratio of wall and of cpu time.
"""
import argparse, json, os, resource, statistics, subprocess, sys, tempfile

a = argparse.ArgumentParser()
a.add_argument("--saltus", required=True)
a.add_argument("--peer", required=True)
a.add_argument("--srb", required=True)
a.add_argument("--problem", help="JSON file like the shipped one, for ours; the peer's tasks.py must hold the same task")
a.add_argument("--task", nargs="*")
a.add_argument("--repeat", type=int, default=20)
a.add_argument("--peer-repeat", type=int, default=3)
a.add_argument("--verify", action="store_true", help="check our solutions with the peer's verify.py")
a = a.parse_args()
os.environ.setdefault("OMP_NUM_THREADS", "1")
NAMES = ["lateral", "lateral_down", "spin", "diagonal", "barrel", "double_barrel", "double_backflip", "forward", "barrel_box"]


def run(*command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    out = subprocess.run(command, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    lines = [line for line in out.stdout.splitlines() if line.startswith("{")]
    if not lines:
        sys.exit(f"{' '.join(command)}: {out.stderr}")
    return json.loads(lines[-1]), cpu


def ours(task, srb, path):
    where = [a.saltus, "plan", "--stage", "whole-body", "--json", "--reference", task, "--srb", srb, "--solution", path]
    where += ["--problem", a.problem] if a.problem else []
    _, once = run(*where)
    report, many = run(*where, "--repeat", str(a.repeat + 1))
    return report["status"], report["whole_body"], 1e3 * (many - once) / a.repeat


ratios, cpu_ratios = [], []
print("task | IPOPT iterations, cost, ms wall (cpu) | ours status, iterations, cost / IPOPT's, violation, ms wall (cpu) | ratio wall (cpu) | verify")
for task in a.task or NAMES:
    srb = os.path.join(a.srb, f"{task}.json")
    peer, _ = run(sys.executable, os.path.join(a.peer, "wbto.py"), "--task", task, "--srb", srb, "--integ", "mid", "--deriv", "block", "--repeat", str(a.peer_repeat))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "sol.json")
        status, q, cpu = ours(task, srb, path)
        checked = ""
        if a.verify:
            found, _ = run(sys.executable, os.path.join(a.peer, "verify.py"), "--task", task, "--sol", path)
            checked = f"{found['dyn_residual']:.0e}, flight {found['rot_err_reintegrated_deg']:.1f} deg"
    ratios.append(1e3 * peer["wall_s"] / q["wall_ms"])
    cpu_ratios.append(1e3 * peer["cpu_s"] / cpu)
    print(f"{task} | {'ok' if peer['ok'] else 'FAILED'} {peer['iters']}, {peer['cost']:.4f}, {1e3 * peer['wall_s']:.0f} ({1e3 * peer['cpu_s']:.0f}) | "
          f"{status} {q['iterations']}, {q['cost'] / peer['cost']:.5f}, {q['max_violation']:.0e}, {q['wall_ms']:.1f} ({cpu:.1f}) | "
          f"{ratios[-1]:.1f} ({cpu_ratios[-1]:.1f}) | {checked}", flush=True)
print(f"median ratio {statistics.median(ratios):.1f} wall, {statistics.median(cpu_ratios):.1f} cpu; least {min(ratios):.1f} wall, {min(cpu_ratios):.1f} cpu")
