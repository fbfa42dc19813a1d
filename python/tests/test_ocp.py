"""Optimal control of one's own, beside optima that are known."""

import os
import signal

import numpy as np
import pytest

import saltus

INF = np.inf
N = 20


def fastest(k: int, x: np.ndarray, u: np.ndarray) -> tuple:
    """A mass goes from rest to rest in the least time; the duration is a state."""
    place, speed, duration = x.T
    if k == N:
        return duration, None, x[:, :2]
    h, force = duration / N, u[:, 0]
    there = place + h * speed + h * h / 2 * force, speed + h * force, duration
    return 0.0 * place, np.stack(there, axis=1), np.stack([force, duration], axis=1)


def fastest_bounds(k: int) -> tuple:
    return ([1.0, 0.0], [1.0, 0.0]) if k == N else ([-1.0, 0.1], [1.0, INF])


GUESS = np.tile([0.0, 0.0, 1.0], (N + 1, 1)), np.zeros((N, 1))


def test_a_free_duration_ends_at_the_least_time() -> None:
    found = saltus.solve_ocp(fastest, *GUESS, fastest_bounds, free=[2])
    assert found.status == "Solved", found
    # Bang and bang: the whole way in 2 sqrt(distance / acceleration).
    assert found.cost == pytest.approx(2.0, abs=1e-4)
    assert np.allclose(found.u[:, 0], np.sign(np.arange(N) - N / 2 + 0.5) * -1, atol=1e-3)
    assert np.allclose(found.x[0, :2], 0)
    assert np.allclose(found.x[-1], [1.0, 0.0, 2.0], atol=1e-4)
    assert found.violation < 1e-6


@pytest.mark.parametrize(("nx", "nu"), [(2, 1), (6, 3), (12, 8)])
def test_linear_quadratic_problems_end_at_riccatis_answer(nx: int, nu: int) -> None:
    random = np.random.default_rng(nx)
    a, b = np.eye(nx) + 0.1 * random.normal(size=(nx, nx)), 0.3 * random.normal(size=(nx, nu))
    start = random.normal(size=nx)

    def evaluate(k: int, x: np.ndarray, u: np.ndarray) -> tuple:
        return (x**2).sum(1) + (u**2).sum(1), x @ a.T + u @ b.T, None

    value = np.eye(nx)
    for _ in range(N):
        gain = np.linalg.solve(np.eye(nu) + b.T @ value @ b, b.T @ value @ a)
        value = np.eye(nx) + a.T @ value @ (a - b @ gain)
    found = saltus.solve_ocp(evaluate, np.tile(start, (N + 1, 1)), np.zeros((N, nu)))
    assert found.status == "Solved"
    assert found.cost == pytest.approx(start @ value @ start, rel=1e-6)
    assert np.allclose(found.u[0], -gain @ start, atol=1e-5)


def test_what_cannot_be_met_is_a_status() -> None:
    def bounds(k: int) -> tuple:
        return ([1.0, 0.0], [1.0, 0.0]) if k == N else ([-1.0, 0.1], [1.0, 1.0])

    found = saltus.solve_ocp(fastest, *GUESS, bounds, free=[2])
    assert found.status == "LocallyInfeasible"
    assert found.violation > 1e-2


def test_what_the_user_raises_is_raised() -> None:
    def evaluate(k: int, x: np.ndarray, u: np.ndarray) -> tuple:
        if len(x) > 1:
            raise LookupError(k)
        return fastest(k, x, u)

    with pytest.raises(LookupError):
        saltus.solve_ocp(evaluate, *GUESS, fastest_bounds)

    def interrupt(iteration: int, cost: float, violation: float) -> None:
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        saltus.solve_ocp(fastest, *GUESS, fastest_bounds, progress=interrupt)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"u": np.zeros((3, 1))}, ["u:", "(20, nu)", "(3, 1)"]),
        ({"x": np.zeros(3)}, ["x:", "(N + 1, nx)"]),
        ({"free": [3]}, ["free", "3"]),
        ({"evaluate": lambda k, x, u: 1.0}, ["evaluate(0", "(cost, next, rows)"]),
        ({"evaluate": lambda k, x, u: (np.zeros(len(x)), x[:, :1], x)}, ["next of node 0"]),
        ({"bounds": lambda k: ([0.0], [1.0, 2.0])}, ["upper bounds of node 0"]),
        ({"bounds": lambda k: (np.zeros(33), np.zeros(33))}, ["32 rows", "33"]),
    ],
)
def test_shapes_that_do_not_fit_are_named(change: dict, words: list[str]) -> None:
    asked = {"evaluate": fastest, "x": GUESS[0], "u": GUESS[1], "bounds": fastest_bounds}
    with pytest.raises(saltus.BadInput) as caught:
        saltus.solve_ocp(**(asked | change))
    assert all(word in str(caught.value) for word in words), caught.value
