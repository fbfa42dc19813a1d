"""Instructions per iteration and node of the single rigid body's solve, by part, from 25 to 400 intervals.

usage: python node_instructions.py --saltus target/release/saltus --problem reference-problems/data/a1-jumps.json [--task lateral]

Needs valgrind. Counts do not depend on what else the machine does, unlike the times of `srb-opt/examples/nodes.rs`.
"""
import argparse, json, os, re, subprocess, tempfile

a = argparse.ArgumentParser()
a.add_argument("--saltus", required=True)
a.add_argument("--problem", required=True)
a.add_argument("--task", default="lateral")
a.add_argument("--intervals", type=int, nargs="*", default=[25, 50, 100, 200, 400])
a = a.parse_args()
# Function (its part of the solver's time, callees included), as callgrind names it.
PARTS = {"factorisation": "riccati::factorise", "substitution": "riccati::substitute", "line search": "iterate::try_step"}

print("intervals | iterations | instructions per iteration and node: whole solve | factorisation | substitution | line search | derivatives and the rest")
for n in a.intervals:
    file = json.load(open(a.problem))
    task = file["tasks"][a.task]
    whole = sum(task["N"])
    task["N"] = [int(i * n / whole) for i in task["N"]]
    with tempfile.TemporaryDirectory() as folder:
        path, out = os.path.join(folder, "problem.json"), os.path.join(folder, "callgrind")
        json.dump(file, open(path, "w"))
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", a.saltus, "plan", "--problem", path, "--reference", a.task, "--json"]
        found = subprocess.run(command, capture_output=True, text=True)
        report = json.loads(found.stdout)
        listed = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", out], capture_output=True, text=True).stdout
    counts = {}
    for line in listed.splitlines():
        match = re.match(r"\s*([\d,]+) \(", line)
        if match:
            count = int(match.group(1).replace(",", ""))
            for name, function in {**PARTS, "solve": "Solver<T>::solve"}.items():
                if re.search(re.escape(function) + r"(\s|$|')", line):
                    counts[name] = max(counts.get(name, 0), count)
    per = 1.0 / (report["srb"]["iterations"] * (sum(task["N"]) + 1))
    parts = [counts.get(name, 0) * per for name in PARTS]
    total = counts["solve"] * per
    print(f"{sum(task['N'])} | {report['srb']['iterations']} | {total:.0f} | " + " | ".join(f"{part:.0f}" for part in [*parts, total - sum(parts)]), flush=True)
