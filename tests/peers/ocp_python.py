"""A pendulum is swung up in Python, by saltus.solve_ocp and by Crocoddyl (pip crocoddyl 3.2.1), both with a model written in Python.

    ocp_python.py

Fixed time, which both can state: status, cost, iterations and time of each, least of fifteen in turns. Then the duration is free and the torque
bounded, which Crocoddyl's shooting problems have no place for: ten lines here.
"""
import time

import crocoddyl
import numpy as np

import saltus

N, STEP, END, TURNS = 100, 0.05, 1e4, 15
HANGING = np.array([np.pi, 0.0])


def move(h, x, u):
    """Angle from upright and rate, weight and length 1."""
    rate = x[..., 1] + h * (np.sin(x[..., 0]) + u[..., 0])
    return np.stack([x[..., 0] + h * rate, rate], axis=-1)


def fixed(k, x, u):
    if k == N:
        return END * (x**2).sum(1), None, None
    return STEP * u[:, 0] ** 2, move(STEP, x, u), None


class Swing(crocoddyl.ActionModelAbstract):
    """The same with derivatives of its own: Crocoddyl wants them."""

    def __init__(self, last):
        super().__init__(crocoddyl.StateVector(2), 1, 0)
        self.last = last

    def calc(self, data, x, u=None):
        if self.last or u is None:
            data.cost = END * (x @ x)
        else:
            data.cost, data.xnext = STEP * u[0] ** 2, move(STEP, x, u)

    def calcDiff(self, data, x, u=None):
        if self.last or u is None:
            data.Lx, data.Lxx = 2 * END * x, 2 * END * np.eye(2)
            return
        slope = STEP * np.cos(x[0])
        data.Fx = np.array([[1 + STEP * slope, STEP], [slope, 1]])
        data.Fu = np.array([[STEP * STEP], [STEP]])
        data.Lu, data.Luu = np.array([2 * STEP * u[0]]), np.array([[2 * STEP]])


def ours():
    found = saltus.solve_ocp(fixed, np.tile(HANGING, (N + 1, 1)), np.zeros((N, 1)))
    return found.status, found.cost, found.iterations


def theirs():
    problem = crocoddyl.ShootingProblem(HANGING, [Swing(False)] * N, Swing(True))
    solver = crocoddyl.SolverFDDP(problem)
    solver.th_stop = 1e-9
    done = solver.solve([HANGING] * (N + 1), [np.zeros(1)] * N, 500)
    return "Solved" if done else "not solved", solver.cost, solver.iter


def free():
    def swing(k, x, u):
        h = x[:, 2] / N
        if k == N:
            return x[:, 2], None, x[:, :2]
        there = np.column_stack([move(h, x, u), x[:, 2]])
        return 1e-3 * h * u[:, 0] ** 2, there, np.column_stack([u[:, 0], x[:, 2]])

    bounds = lambda k: ([0, 0], [0, 0]) if k == N else ([-0.6, 1.0], [0.6, 20.0])  # noqa: E731
    guess = np.tile([np.pi, 0.0, 6.0], (N + 1, 1)), np.zeros((N, 1))
    return saltus.solve_ocp(swing, *guess, bounds, free=[2])


def main():
    solvers = {"saltus.solve_ocp": ours, "Crocoddyl FDDP": theirs}
    least = dict.fromkeys(solvers, np.inf)
    # In turns, so that what else the machine does falls on both; time of the processor.
    for _ in range(TURNS):
        for name, solve in solvers.items():
            begun = time.process_time()
            solve()
            least[name] = min(least[name], time.process_time() - begun)
    costs = []
    for name, solve in solvers.items():
        status, cost, iterations = solve()
        costs.append(cost)
        print(f"{name}: {status}, cost {cost:.6f}, {iterations} iterations, {1e3 * least[name]:.0f} ms")
    times = list(least.values())
    print(f"time ratio {times[0] / times[1]:.2f}, cost ratio {costs[0] / costs[1]:.6f}")
    found = free()
    print(f"duration free, torque at most 0.6: {found.status}, {found.x[0, 2]:.3f} s, {found.iterations} iterations")


if __name__ == "__main__":
    main()
