"""One controller tick of wbc-qp beside the same tick in TSID, and its program beside DAQP, in one run.

    pip install daqp numpy
    python tests/peers/wbc.py [TSID_PREFIX]

Three take turns, ROUNDS times: `wbc-qp/examples/ticks.rs` (push-offs of iCub and A1 in the contact simulator), `dense-qp` and DAQP on the
programs of these ticks (`programs.py`; DAQP by its own timer, set-up plus solve; bounds as its simple bounds) and, where TSID and `target/peers/*.model` (`setup.sh`) are
there, `tsid/bench.cpp` on the same states. A round is short, so that a change of the processor's speed meets all; the time of a program is the least of all
its times, that of a tick the least median of a round. TSID_PREFIX is the `cmeel.prefix` folder of an environment with
`pip install --only-binary :all: tsid==1.7.1 pin==3.4.0` and then `pip install --no-deps cmeel-urdfdom==4.0.1 cmeel-tinyxml2==10.0.0`, which these
wheels were linked with; `bench.cpp` needs clang and Eigen. Exit code 1 where a ratio is above its limit: 0.3 for the tick against TSID,
0.6 for the program against DAQP.
"""

import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import programs

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROUNDS = 20
ROBOTS = ["icub23", "a1"]


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
    """One round of ours: of each robot median and worst tick, iterations, ticks yielded, ticks."""
    lines = subprocess.run([binary, str(folder)], check=True, capture_output=True, text=True).stdout.splitlines()
    return {robot: [float(x) for x in numbers] for robot, *numbers in map(str.split, lines)}


def main():
    prefix = sys.argv[1] if len(sys.argv) > 1 else None
    binary, recorded = programs.example("wbc-qp", "ticks"), programs.example("dense-qp", "recorded")
    ours, peers, times, answers = ({robot: [] for robot in ROBOTS} for _ in range(4))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for _ in range(ROUNDS):
            rounds = ticks(binary, folder)
            for robot in ROBOTS:
                ours[robot].append(rounds[robot])
                peers[robot].append(tsid(prefix, robot, folder))
                path = folder / f"{robot}.qps"
                x, mine, _, _ = programs.by_ours(recorded, path)
                theirs = [programs.by_daqp(programs.stated(*p), programs.REPEAT) for p in programs.read(path)]
                times[robot].append(np.column_stack([mine, [t for t, *_ in theirs]]))
                answers[robot] = [(np.abs(a - b).max(), good) for a, (_, b, _, good) in zip(x, theirs)]
    bad = False
    for robot in ROBOTS:
        tick, worst, most, yielded, count = min(ours[robot])
        print(f"{robot}: {count:.0f} ticks, {yielded:.0f} yielded, at most {most:.0f} iterations")
        print(f"  tick     {tick:8.1f} us (max {worst:.1f})")
        if None in peers[robot]:
            print("  TSID     not there: see the head of this file")
        else:
            peer = min(peers[robot])
            ratio = tick / peer[0]
            bad |= ratio > 0.3
            sizes = "{:.0f} variables, {:.0f} equalities, {:.0f} inequalities".format(*peer[4:])
            print(f"  TSID     {peer[0]:8.1f} us (max {peer[1]:.1f}; QP {peer[2]:.1f}; {sizes};"
                  f" {peer[3]:.0f} solved)  ratio {ratio:.2f}")
        cold, warm, theirs = np.median(np.min(times[robot], axis=0), axis=0) * 1e6
        bad |= warm / theirs > 0.6
        off = max(off for off, good in answers[robot] if good)
        count = sum(good for _, good in answers[robot])
        print(f"  program  {warm:8.1f} us (cold {cold:.1f})")
        print(f"  DAQP     {theirs:8.1f} us ({count} solved, |x - x_DAQP| <= {off:.1e})  ratio {warm / theirs:.2f}"
              f" (cold {cold / theirs:.2f})")
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
