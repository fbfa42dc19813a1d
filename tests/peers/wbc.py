"""One controller tick of wbc-qp beside the same tick in TSID, and its program beside DAQP, in one run.

    pip install daqp numpy
    python tests/peers/wbc.py [TSID_PREFIX]

Three take turns, ROUNDS times: `wbc-qp/examples/ticks.rs` (push-offs of iCub and A1 in the contact simulator), DAQP on the programs of
these ticks (its own timer, set-up plus solve; bounds as its simple bounds) and, where TSID and `target/peers/*.model` (`setup.sh`) are
there, `tsid/bench.cpp` on the same states. A round is short, so that a change of the processor's speed meets all; the time of a program is the least of all
its times, that of a tick the least median of a round. TSID_PREFIX is the `cmeel.prefix` folder of an environment with
`pip install --only-binary :all: tsid==1.7.1 pin==3.4.0`. Exit code 1 where a ratio is above its limit: 0.5 for the tick against TSID,
0.7 for the program against DAQP.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

import daqp
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
REPEAT = 3
ROUNDS = 20
ROBOTS = ["icub23", "a1"]


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


def ticks(binary, folder):
    """One round of ours: of each robot median and worst tick, medians of its program, iterations, ticks yielded, ticks."""
    lines = subprocess.run([binary, str(folder)], check=True, capture_output=True, text=True).stdout.splitlines()
    return {robot: [float(x) for x in numbers] for robot, *numbers in map(str.split, lines)}


def main():
    prefix = sys.argv[1] if len(sys.argv) > 1 else None
    build = ["cargo", "build", "--release", "-q", "-p", "wbc-qp", "--example", "ticks", "--message-format=json"]
    built = subprocess.run(build, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    binary = re.search(r'"executable":"([^"]*ticks)"', built).group(1)
    ours, peers, times, answers = ({robot: [] for robot in ROBOTS} for _ in range(4))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for _ in range(ROUNDS):
            rounds = ticks(binary, folder)
            for robot in ROBOTS:
                ours[robot].append(rounds[robot])
                peers[robot].append(tsid(prefix, robot, folder))
                solved = [(*by_daqp(*p[:7]), *p[7:]) for p in programs(folder / f"{robot}.qps")]
                times[robot].append([[*t, td] for td, _, _, _, t in solved])
                answers[robot] = [(np.abs(x - xd).max(), good) for _, xd, good, x, _ in solved]
    bad = False
    for robot in ROBOTS:
        tick, worst, _, _, most, yielded, count = min(ours[robot])
        print(f"{robot}: {count:.0f} ticks, {yielded:.0f} yielded, at most {most:.0f} iterations")
        print(f"  tick     {tick:8.1f} us (max {worst:.1f})")
        if None in peers[robot]:
            print("  TSID     not there: see the head of this file")
        else:
            peer = min(peers[robot])
            ratio = tick / peer[0]
            bad |= ratio > 0.5
            sizes = "{:.0f} variables, {:.0f} equalities, {:.0f} inequalities".format(*peer[4:])
            print(f"  TSID     {peer[0]:8.1f} us (max {peer[1]:.1f}; QP {peer[2]:.1f}; {sizes};"
                  f" {peer[3]:.0f} solved)  ratio {ratio:.2f}")
        cold, warm, theirs = np.median(np.min(times[robot], axis=0), axis=0) * 1e6
        bad |= warm / theirs > 0.7
        off = max(off for off, good in answers[robot] if good)
        count = sum(good for _, good in answers[robot])
        print(f"  program  {warm:8.1f} us (cold {cold:.1f})")
        print(f"  DAQP     {theirs:8.1f} us ({count} solved, |x - x_DAQP| <= {off:.1e})  ratio {warm / theirs:.2f}"
              f" (cold {cold / theirs:.2f})")
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
