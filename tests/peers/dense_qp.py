"""dense-qp beside DAQP (pip) on six families of programs, in one run.

    pip install daqp clarabel scipy numpy
    python tests/peers/dense_qp.py [--count] [--rounds N] [FAMILY ...]

`dense-qp/examples/peers.rs` makes up landing forces, whole-body control of a humanoid, a pendulum that sways and one that walks
(LIPM); `wbc-qp/examples/ticks.rs` records the programs of iCub's velocity and torque controllers on a push-off. Ours (the example
`recorded`, clocked around the call) and DAQP (its own timer, set-up plus solve) solve the same numbers ROUNDS times in turns on one
core, a program's time being the least of seven solves. Prints medians and maxima over each family in us; every figure is the median of the
turns', the ratios as well. `warm` starts from the last program's active set. Clarabel solves every eighth of the made-up programs once, and
its cost is compared. With --count both solve every program under callgrind, and instructions are compared instead of times.

Exit code 1 where a median is above 0.6 of DAQP's, a worst case above DAQP's, a warm start takes more than one step more than a cold one,
or all warm starts of a family more than all cold ones.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

import clarabel
import numpy as np
from scipy import sparse

import programs

FAMILIES = ["landing20", "landing32", "icub23-velocity", "icub23", "humanoid", "pendulum", "lipm"]


def by_clarabel(h, g, a, lower, upper):
    eq = lower == upper
    up, low = ~eq & np.isfinite(upper), ~eq & np.isfinite(lower)
    rows = sparse.csc_matrix(np.vstack([a[eq], a[up], -a[low]]))
    rhs = np.concatenate([upper[eq], upper[up], -lower[low]])
    cones = [clarabel.NonnegativeConeT(int(up.sum() + low.sum()))]
    if eq.any():
        cones.insert(0, clarabel.ZeroConeT(int(eq.sum())))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
    quad = sparse.csc_matrix(np.triu(h))
    return np.array(clarabel.DefaultSolver(quad, g, rows, rhs, cones, settings).solve().x)


def above_clarabel(recorded, path):
    """By how much a cost of ours is above Clarabel's, relative; programs without bounds only."""
    x, *_ = programs.by_ours(recorded, path)
    worst = -np.inf
    for (h, g, a, lower, upper, least, most), ours in list(zip(programs.read(path), x))[::8]:
        if np.isfinite(least).any() or np.isfinite(most).any():
            return np.nan
        cost = lambda v: 0.5 * v @ h @ v + g @ v
        theirs = cost(by_clarabel(h, g, a, lower, upper))
        worst = max(worst, (cost(ours) - theirs) / (1.0 + abs(theirs)))
    return worst


def turns(recorded, path, rounds):
    """Times (round, program, [cold, warm, DAQP]) in us, steps cold and warm, DAQP's iterations, and the largest distance of the optima."""
    stated = [programs.stated(*p) for p in programs.read(path)]
    times, off = [], 0.0
    for _ in range(rounds):
        x, ours, steps, _ = programs.by_ours(recorded, path)
        theirs = [programs.by_daqp(problem, programs.REPEAT) for problem in stated]
        assert all(good for *_, good in theirs), path
        off = max(off, max(np.abs(a - b[1]).max() for a, b in zip(x, theirs)))
        times.append(np.column_stack([ours, [t for t, *_ in theirs]]))
    return np.array(times) * 1e6, steps, np.array([k for _, _, k, _ in theirs]), off


def counts(recorded, path):
    """Instructions of every program: cold, warm, DAQP."""
    ours = [programs.instructions_of_ours(recorded, path, way) for way in ["cold", "warm"]]
    return np.column_stack([*ours, programs.instructions_of_daqp(path)])[None]


def row(name, figures):
    """Prints a row of (turn, program, [cold, warm, DAQP]); returns the two ratios."""
    med, top = np.median(figures, axis=1), figures.max(axis=1)
    cells = " ".join(f"{m:9.2f} ({p:8.1f})" for m, p in zip(np.median(med, axis=0), np.median(top, axis=0)))
    ratio, of_top = (np.median(x[:, 0] / x[:, 2]) for x in [med, top])
    print(f"{name:16} {cells} {ratio:6.2f} {of_top:6.2f}", end="", flush=True)
    return ratio, of_top


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--count", action="store_true")
    arguments.add_argument("--rounds", type=int, default=7)
    arguments.add_argument("families", nargs="*")
    arguments = arguments.parse_args()
    recorded = programs.example("dense-qp", "recorded")
    # Ours and DAQP on one core: on a shared machine another may run at two thirds of its speed for seconds.
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    bad = False
    what = "instructions" if arguments.count else "us"
    print(f"{what + ', median (max)':16} {'cold':>20} {'warm':>20} {'DAQP':>20} {'/DAQP':>6} {'worst':>6}"
          f" {'steps':>6} {'warm':>6} {'DAQP':>6} {'|x-x_DAQP|':>11} {'f-f_Clarabel':>12}")
    with tempfile.TemporaryDirectory() as folder:
        for package, name in [("dense-qp", "peers"), ("wbc-qp", "ticks")]:
            subprocess.run([programs.example(package, name), folder], check=True, stdout=subprocess.DEVNULL)
        for name in arguments.families or FAMILIES:
            path = pathlib.Path(folder) / f"{name}.qps"
            if arguments.count:
                ratios = row(name, counts(recorded, path))
                print()
            else:
                times, steps, theirs, off = turns(recorded, path, arguments.rounds)
                ratios = row(name, times)
                cold, warm = steps.T
                print(f" {cold.mean():6.2f} {warm.mean():6.2f} {theirs.mean():6.2f} {off:11.1e} {above_clarabel(recorded, path):12.1e}"
                      f"  warm - cold at most {(warm - cold).max()}")
                bad |= warm.sum() > cold.sum() or (warm - cold).max() > 1
            bad |= ratios[0] > 0.6 or ratios[1] > 1.0
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
