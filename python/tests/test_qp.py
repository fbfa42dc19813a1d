"""Quadratic programs, judged by their conditions of optimality."""

import numpy as np
import pytest

import saltus


@pytest.mark.parametrize(
    ("n", "m"), [(1, 0), (3, 5), (8, 16), (9, 3), (20, 40), (40, 90), (64, 128)]
)
def test_solutions_meet_the_conditions(n: int, m: int) -> None:
    random = np.random.default_rng(n)
    for _ in range(5):
        root = random.normal(size=(n, n))
        hessian, gradient = root @ root.T + 0.1 * np.eye(n), random.normal(size=n)
        rows, inside = random.normal(size=(m, n)), random.normal(size=n)
        low = rows @ inside - random.uniform(0, 1, m)
        high = rows @ inside + random.uniform(0, 1, m)
        low[: m // 8] = high[: m // 8] = rows[: m // 8] @ inside
        bound = np.abs(inside) + random.uniform(0, 0.5, n)
        found = saltus.solve_qp(hessian, gradient, rows, low, high, -bound, bound)
        assert found.status == "Solved"
        x, y, z = found.x, found.row_multipliers, found.bound_multipliers
        assert (x.shape, y.shape, z.shape) == ((n,), (m,), (n,))
        assert np.abs(hessian @ x + gradient + rows.T @ y + z).max() < 1e-7
        assert (rows @ x >= low - 1e-7).all()
        assert (rows @ x <= high + 1e-7).all()
        assert (np.abs(x) <= bound + 1e-7).all()
        slack = np.where(y > 0, high - rows @ x, rows @ x - low)
        assert np.abs(y * slack).max(initial=0) < 1e-5
        assert np.abs(z * np.where(z > 0, bound - x, x + bound)).max() < 1e-5
        assert found.cost == pytest.approx(x @ hessian @ x / 2 + gradient @ x)


def test_there_is_a_status_for_what_has_no_minimum() -> None:
    apart = saltus.solve_qp(np.eye(1), [0.0], [[1.0], [1.0]], [1.0, -np.inf], [np.inf, 0.0])
    assert apart.status == "Infeasible"
    assert apart.row_multipliers[0] < 0 < apart.row_multipliers[1]
    assert apart.ray is None
    down = saltus.solve_qp(np.zeros((1, 1)), [1.0])
    assert down.status == "Unbounded"
    assert down.ray[0] < 0


@pytest.mark.parametrize(
    ("program", "words"),
    [
        ((np.eye(2), [0.0]), ["hessian", "(1, 1)", "(2, 2)"]),
        ((np.eye(1), [0.0], [[1.0, 2.0]]), ["rows", "(1, 1)"]),
        (([[np.nan]], [0.0]), ["hessian row 0"]),
        (([[-1.0]], [0.0]), ["not convex"]),
        ((np.eye(1), [0.0], [[1.0]], [2.0], [1.0]), ["row_lower[0]"]),
        ((np.eye(65), np.zeros(65)), ["64 variables"]),
        ((np.zeros((0, 0)), []), ["gradient"]),
    ],
)
def test_bad_numbers_are_named(program: tuple, words: list[str]) -> None:
    with pytest.raises(saltus.BadInput) as caught:
        saltus.solve_qp(*program)
    assert all(word in str(caught.value) for word in words), caught.value
