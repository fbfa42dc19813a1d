"""Reads a golden file of Pinocchio's values, whose format `tests/peers/golden.py` explains."""

from collections.abc import Iterator

import numpy as np
from conftest import ROOT

State = dict[str, np.ndarray]


def states(robot: str) -> Iterator[State]:
    state: State | None = None
    for line in (ROOT / f"tests/data/golden/{robot}.txt").read_text().splitlines():
        if line.startswith("#"):
            continue
        key, rows, columns, *numbers = line.split()
        if key == "state":
            if state is not None:
                yield state
            state = {}
        elif state is not None:
            matrix = np.array(numbers, dtype=float).reshape(int(rows), int(columns))
            state[key] = matrix[:, 0] if columns == "1" else matrix
    if state is not None:
        yield state


def symmetric(lower: np.ndarray, size: int) -> np.ndarray:
    """The matrix whose lower triangle, row by row, this is."""
    matrix = np.zeros((size, size))
    matrix[np.tril_indices(size)] = lower
    return matrix + np.tril(matrix, -1).T
