"""One controller tick of wbc-qp beside the same tick in TSID, and its program beside DAQP, in one run.

    pip install daqp numpy
    python tests/peers/wbc.py [TSID_PREFIX]

Runs `wbc-qp/examples/ticks.rs` (push-offs of iCub and A1 in the contact simulator: times are the least of 7 calls per tick),
solves the same programs with DAQP (its own timer, set-up plus solve, least of 7; bounds as its simple bounds) and, where TSID and
`target/peers/*.model` (`setup.sh`) are there, runs `tsid/bench.cpp` on the same states. TSID_PREFIX is the `cmeel.prefix` folder of an
environment with `pip install --only-binary :all: tsid==1.7.1 pin==3.4.0`. Exit code 1 where a ratio is above its limit: 0.5 for the
tick against TSID, 0.7 for the program against DAQP.
"""

import pathlib
import subprocess
import sys
import tempfile

import daqp
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
REPEAT = 7


def programs(path):
    data = np.fromfile(path)
    n, m, count = (int(v) for v in data[:3])
    at = 3
    for _ in range(count):
        out = []
        for shape in [(n, n), (n,), (m, n), (m,), (m,), (n,), (n,), (n,), (2,)]:
            size = int(np.prod(shape))
            out.append(np.ascontiguousarray(data[at : at + size].reshape(shape)))
            at += size
        yield out


def by_daqp(h, g, a, lower, upper, lb, ub):
    """Simple bounds come first; rows without limits are left out, as a user of DAQP would."""
    there = np.isfinite(lower) | np.isfinite(upper)
    a, lower, upper = np.ascontiguousarray(a[there]), lower[there], upper[there]
    low = np.maximum(np.concatenate([lb, lower]), -1e30)
    up = np.minimum(np.concatenate([ub, upper]), 1e30)
    sense = np.where(low == up, 5, 0).astype(np.int32)
    best = np.inf
    for _ in range(REPEAT):
        x, _, flag, info = daqp.solve(h, g, a, up, low, sense.copy())
        best = min(best, info["setup_time"] + info["solve_time"])
    return best, x, flag == 1


def tsid(prefix, robot, folder):
    """Medians and maximum in microseconds, ticks solved, sizes; None where TSID is not there."""
    model = ROOT / f"target/peers/{robot}.model"
    if prefix is None or not model.exists():
        return None
    binary = ROOT / "target/peers/tsid"
    source = ROOT / "tests/peers/tsid/bench.cpp"
    if not binary.exists() or binary.stat().st_mtime < source.stat().st_mtime:
        limits = ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30"]
        include = ["-isystem", f"{prefix}/include", "-isystem", "/usr/include/eigen3"]
        link = [f"-L{prefix}/lib", "-ltsid", "-leiquadprog", "-lpinocchio_default"]
        paths = [f"-Wl,-rpath,{prefix}/lib", f"-Wl,-rpath-link,{prefix}/lib"]
        flags = ["-std=c++17", "-DNDEBUG", "-w", "-O2", *limits, *include]
        subprocess.run(["clang++", *flags, str(source), *link, *paths, "-o", str(binary)], check=True)
    run = [str(binary), str(model), str(folder / f"{robot}.ticks")]
    return [float(x) for x in subprocess.run(run, check=True, capture_output=True, text=True).stdout.split()]


def main():
    prefix = sys.argv[1] if len(sys.argv) > 1 else None
    bad = False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        command = ["cargo", "run", "--release", "-q", "-p", "wbc-qp", "--example", "ticks", "--", name]
        lines = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
        for line in lines.splitlines():
            robot, *numbers = line.split()
            tick, worst, cold, warm, most, yielded, count = (float(x) for x in numbers)
            times, off, solved = [], 0.0, 0
            for h, g, a, lower, upper, lb, ub, x, t in programs(folder / f"{robot}.qps"):
                td, xd, good = by_daqp(h, g, a, lower, upper, lb, ub)
                solved += good
                off = max(off, np.abs(x - xd).max()) if good else off
                times.append([*t, td])
            ours, hot, theirs = np.median(times, axis=0) * 1e6
            print(f"{robot}: {count:.0f} ticks, {yielded:.0f} yielded, at most {most:.0f} iterations")
            print(f"  tick     {tick:8.1f} us (max {worst:.1f})")
            peer = tsid(prefix, robot, folder)
            if peer is None:
                print("  TSID     not there: see the head of this file")
            else:
                ratio = tick / peer[0]
                bad |= ratio > 0.5
                sizes = "{:.0f} variables, {:.0f} equalities, {:.0f} inequalities".format(*peer[4:])
                print(f"  TSID     {peer[0]:8.1f} us (max {peer[1]:.1f}; QP {peer[2]:.1f}; {sizes};"
                      f" {peer[3]:.0f} solved)  ratio {ratio:.2f}")
            ratio = hot / theirs
            bad |= ratio > 0.7
            print(f"  program  {hot:8.1f} us (cold {ours:.1f})")
            print(f"  DAQP     {theirs:8.1f} us ({solved} solved, |x - x_DAQP| <= {off:.1e})  ratio {ratio:.2f}"
                  f" (cold {ours / theirs:.2f})")
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
