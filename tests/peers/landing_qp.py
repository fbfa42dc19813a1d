"""dense-qp beside DAQP (pip) on the landing programs of real runs: same optimum, optimality, times, worst instruction counts.

    pip install daqp numpy
    for t in a1/lateral a1/barrel-roll …; do saltus run $t --json --programs $t.bin; done
    python tests/peers/landing_qp.py *.bin [--count]

Both solve cold. The two take turns, ROUNDS times over all programs; a program's time in a turn is the least of REPEAT solves, and the ratio is
the median over the turns of the medians' ratio. Ours is clocked around the call, DAQP's is its own timer (set-up plus solve). With --count
every program is solved under callgrind by both, and the instructions inside `measured` and inside `daqp_quadprog`, of DAQP as pip delivers
it, are compared. Exit code 1 where a ratio is above 0.6, an optimum differs by more than 1e-8 of its largest force, an optimality condition
of ours is violated by more than 1e-8 of the gradient's largest entry or of 1, or our worst count is above DAQP's.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

import daqp
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROUNDS = 15
REPEAT = 5  # as in the example `recorded`


def programs(path):
    data = np.fromfile(path)
    n, m, count = (int(v) for v in data[:3])
    at = 3
    for _ in range(count):
        parts = []
        for shape in [(n, n), (n,), (m, n), (m,), (m,), (n,), (n,)]:
            size = int(np.prod(shape))
            parts.append(np.ascontiguousarray(data[at : at + size].reshape(shape)))
            at += size
        yield parts


def stated(h, g, a, lower, upper, least, most):
    """As DAQP wants it: bounds first, equalities marked."""
    low = np.maximum(np.concatenate([least, lower]), -1e30)
    up = np.minimum(np.concatenate([most, upper]), 1e30)
    sense = np.where(low == up, 5, 0).astype(np.int32)
    return h, g, a, up, low, sense


def by_daqp(problem):
    h, g, a, up, low, sense = problem
    x, _, flag, info = daqp.solve(h, g, a, up, low, sense.copy())
    return x, flag, info["setup_time"] + info["solve_time"]


def callgrind(command, inside):
    """Instructions inside a function, of each of its calls."""
    with tempfile.TemporaryDirectory() as folder:
        tool = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out"]
        marks = [f"--toggle-collect={inside}", f"--dump-after={inside}", "--combine-dumps=no"]
        subprocess.run([*tool, *marks, *command], capture_output=True, check=True)
        counts = {}
        for part in pathlib.Path(folder).glob("out.*"):
            text = part.read_text()
            if "--dump-after" in text:
                counts[int(part.suffix[1:])] = int(re.search(r"^(?:totals|summary): (\d+)", text, re.M).group(1))
        return np.array([counts[k] for k in sorted(counts)])


def solve_all(file):
    """What runs under callgrind."""
    for p in programs(file):
        by_daqp(stated(*p))


def medians(times):
    """Ours and DAQP's in us, and their ratio, each the median over the turns: the clock of a shared processor wanders between them."""
    of_turns = np.median(times, axis=1)
    return *(np.median(of_turns, axis=0) * 1e6), np.median(of_turns[:, 0] / of_turns[:, 1])


def main():
    count = "--count" in sys.argv
    files = [f for f in sys.argv[1:] if not f.startswith("--")]
    build = ["cargo", "build", "--release", "-q", "-p", "dense-qp", "--example", "recorded", "--message-format=json"]
    built = subprocess.run(build, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    ours = re.search(r'"executable":"([^"]*recorded)"', built).group(1)
    # Ours and DAQP on one core: on a shared machine another may run at two thirds of its speed for seconds.
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    ok = True
    print(f"{'programs':24} {'number':>6} {'us ours':>8} {'DAQP':>8} {'ratio':>6}   {'with rows':>9} {'ours':>7} {'DAQP':>7} {'ratio':>6}"
          f" {'|x-x_DAQP|':>11} {'optimality':>10} {'iterations':>10}")
    for file in files:
        stated_all = [stated(*p) for p in programs(file)]
        times = np.full((ROUNDS, len(stated_all), 2), np.inf)
        answers = None
        for turn in times:
            with tempfile.NamedTemporaryFile() as out:
                subprocess.run([ours, file, out.name], check=True)
                answers = np.fromfile(out.name).reshape(len(stated_all), -1)
            turn[:, 0] = answers[:, 13]
            off = kkt = 0.0
            for k, problem in enumerate(stated_all):
                for _ in range(REPEAT):
                    x, flag, t = by_daqp(problem)
                    assert flag == 1, (file, k, flag)
                    turn[k, 1] = min(turn[k, 1], t)
                off = max(off, np.abs(x - answers[k, :12]).max() / max(1.0, np.abs(x).max()))
                kkt = max(kkt, answers[k, 14] / max(1.0, np.abs(problem[1]).max()))
        some = answers[:, 12] > 1
        med, busy = medians(times), medians(times[:, some])
        print(f"{pathlib.Path(file).stem:24} {len(stated_all):6} {med[0]:8.2f} {med[1]:8.2f} {med[2]:6.2f}   {some.sum():9}"
              f" {busy[0]:7.2f} {busy[1]:7.2f} {busy[2]:6.2f} {off:11.1e} {kkt:10.1e} {int(answers[:, 12].max()):10}")
        ok &= med[2] <= 0.6 and off <= 1e-8 and kkt <= 1e-8
        if count:
            mine = callgrind([ours, file, "/dev/null", "once"], "recorded::measured")
            code = f"import sys; sys.path.insert(0, {str(pathlib.Path(__file__).parent)!r}); import landing_qp; landing_qp.solve_all({file!r})"
            theirs = callgrind([sys.executable, "-c", code], "daqp_quadprog")
            assert len(mine) == len(theirs) == len(stated_all), (len(mine), len(theirs))
            print(f"    instructions, median and worst: ours {np.median(mine):.0f} {mine.max()}, DAQP {np.median(theirs):.0f} {theirs.max()},"
                  f" ratio of the worst {mine.max() / theirs.max():.2f}")
            ok &= mine.max() <= theirs.max()
    return 0 if ok else 1


if __name__ == "__main__":
    sys.exit(main())
