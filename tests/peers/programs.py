"""Recorded quadratic programs, solved by dense-qp (its example `recorded`) and by DAQP: what the scripts beside this one share."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

import daqp
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
REPEAT = 7  # as in the example `recorded`


def example(package, name):
    """Builds an example, and returns its path."""
    build = ["cargo", "build", "--release", "-q", "-p", package, "--features", "bench", "--example", name]
    build.append("--message-format=json")
    built = subprocess.run(build, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    paths = [json.loads(line).get("executable") for line in built.splitlines() if line.startswith("{")]
    return next(path for path in reversed(paths) if path)


def read(path):
    """The programs of a file: H, g, A, l, u and the bounds of the variables."""
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
    """As a user of DAQP states a program: bounds first, if there are any, equalities marked, rows without limits left out."""
    there = np.isfinite(lower) | np.isfinite(upper)
    a, low, up = np.ascontiguousarray(a[there]), lower[there], upper[there]
    if np.isfinite(least).any() or np.isfinite(most).any():
        low, up = np.concatenate([least, low]), np.concatenate([most, up])
    sense = np.where(low == up, 5, 0).astype(np.int32)
    return h, g, a, np.minimum(up, 1e30), np.maximum(low, -1e30), sense


def by_daqp(problem, repeat=1):
    """Least time by DAQP's own timer (set-up plus solve), minimiser, iterations and whether it is solved."""
    h, g, a, up, low, sense = problem
    least = np.inf
    for _ in range(repeat):
        x, _, flag, info = daqp.solve(h, g, a, up, low, sense.copy())
        least = min(least, info["setup_time"] + info["solve_time"])
    return least, x, info["iterations"], flag == 1


def by_ours(recorded, path):
    """Of each program the minimiser, times cold and warm, steps cold and warm, and the largest violation of an optimality condition."""
    with tempfile.NamedTemporaryFile() as out:
        subprocess.run([recorded, str(path), out.name], check=True)
        answers = np.fromfile(out.name)
    n, _, count = (int(v) for v in np.fromfile(path, count=3))
    answers = answers.reshape(count, n + 5)
    return answers[:, :n], answers[:, n : n + 2], answers[:, n + 2 : n + 4].astype(int), answers[:, n + 4]


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


def instructions_of_ours(recorded, path, way):
    """Of each program, `way` being cold or warm."""
    return callgrind([recorded, str(path), "/dev/null", way], f"recorded::{way}")


def instructions_of_daqp(path):
    """Of each program inside `daqp_quadprog` of DAQP as pip delivers it."""
    folder = str(pathlib.Path(__file__).parent)
    code = f"import sys; sys.path.insert(0, {folder!r}); import programs; programs.solve_all({str(path)!r})"
    return callgrind([sys.executable, "-c", code], "daqp_quadprog")


def solve_all(path):
    """What runs under callgrind."""
    for problem in read(path):
        by_daqp(stated(*problem))
