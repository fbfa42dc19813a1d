"""dense-qp beside DAQP (pip) on the landing programs of real runs: same optimum, optimality, times, worst instruction counts.

    pip install daqp numpy
    for t in a1/lateral a1/barrel-roll …; do saltus run $t --json --programs $t.bin; done
    python tests/peers/landing_qp.py *.bin [--count]

Both solve cold. The two take turns, ROUNDS times over all programs; a program's time in a turn is the least of seven solves, and the ratio is
the median over the turns of the medians' ratio. Ours is clocked around the call, DAQP's is its own timer (set-up plus solve). With --count
every program is solved under callgrind by both, and the instructions inside the example's `cold` and inside `daqp_quadprog`, of DAQP as pip delivers
it, are compared. Exit code 1 where a ratio is above 0.6, an optimum differs by more than 1e-8 of its largest force, an optimality condition
of ours is violated by more than 1e-8 of the gradient's largest entry or of 1, or our worst count is above DAQP's.
"""

import os
import pathlib
import sys

import numpy as np

import programs

ROUNDS = 15


def medians(times):
    """Ours and DAQP's in us, and their ratio, each the median over the turns: the clock of a shared processor wanders between them."""
    of_turns = np.median(times, axis=1)
    return *(np.median(of_turns, axis=0) * 1e6), np.median(of_turns[:, 0] / of_turns[:, 1])


def main():
    count = "--count" in sys.argv
    files = [f for f in sys.argv[1:] if not f.startswith("--")]
    ours = programs.example("dense-qp", "recorded")
    # Ours and DAQP on one core: on a shared machine another may run at two thirds of its speed for seconds.
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    ok = True
    print(f"{'programs':24} {'number':>6} {'us ours':>8} {'DAQP':>8} {'ratio':>6}   {'with rows':>9} {'ours':>7} {'DAQP':>7} {'ratio':>6}"
          f" {'|x-x_DAQP|':>11} {'optimality':>10} {'iterations':>10}")
    for file in files:
        stated_all = [programs.stated(*p) for p in programs.read(file)]
        times = np.full((ROUNDS, len(stated_all), 2), np.inf)
        for turn in times:
            x, mine, steps, residual = programs.by_ours(ours, file)
            turn[:, 0] = mine[:, 0]
            off = kkt = 0.0
            for k, problem in enumerate(stated_all):
                turn[k, 1], theirs, _, good = programs.by_daqp(problem, programs.REPEAT)
                assert good, (file, k)
                off = max(off, np.abs(theirs - x[k]).max() / max(1.0, np.abs(theirs).max()))
                kkt = max(kkt, residual[k] / max(1.0, np.abs(problem[1]).max()))
        some = steps[:, 0] > 1
        med, busy = medians(times), medians(times[:, some])
        print(f"{pathlib.Path(file).stem:24} {len(stated_all):6} {med[0]:8.2f} {med[1]:8.2f} {med[2]:6.2f}   {some.sum():9}"
              f" {busy[0]:7.2f} {busy[1]:7.2f} {busy[2]:6.2f} {off:11.1e} {kkt:10.1e} {steps[:, 0].max():10}")
        ok &= med[2] <= 0.6 and off <= 1e-8 and kkt <= 1e-8
        if count:
            mine, theirs = programs.instructions_of_ours(ours, file, "cold"), programs.instructions_of_daqp(file)
            assert len(mine) == len(theirs) == len(stated_all), (len(mine), len(theirs))
            print(f"    instructions, median and worst: ours {np.median(mine):.0f} {mine.max()}, DAQP {np.median(theirs):.0f} {theirs.max()},"
                  f" ratio of the worst {mine.max() / theirs.max():.2f}")
            ok &= mine.max() <= theirs.max()
    return 0 if ok else 1


if __name__ == "__main__":
    sys.exit(main())
