"""What the package's functions take on this machine: the table of its README."""

import time
from collections.abc import Callable

import numpy as np

import saltus


def least(call: Callable[[], object], times: int) -> float:
    """Least mean of five turns, s."""
    turns = []
    for _ in range(5):
        begun = time.perf_counter()
        for _ in range(times):
            call()
        turns.append((time.perf_counter() - begun) / times)
    return min(turns)


def once(call: Callable[[], object]) -> float:
    """One turn, s."""
    begun = time.perf_counter()
    call()
    return time.perf_counter() - begun


def mass(k: int, x: np.ndarray, u: np.ndarray) -> tuple:
    """A mass is brought to rest: the cost of a node of an optimal-control problem."""
    there = x + 0.1 * np.stack([x[:, 1], u[:, 0]], axis=1)
    return (x**2).sum(1) + (u**2).sum(1), there, None


def main() -> None:
    """Prints the table."""
    plan = saltus.plan("a1/lateral")
    robot, q, tau = plan.robot, plan.q[0], plan.tau[0]
    joints, speeds, v = q[7:].copy(), np.zeros(12), np.zeros(18)
    forces, up, still = np.full(4, robot.mass * 9.81 / 4), np.array([0, 0, 9.81]), np.zeros(3)
    told = saltus.Observation(q, v, forces, tau)
    machine, estimator = plan.machine(start=1e6), saltus.Estimator(robot, q)
    now = np.nditer(np.arange(0.0, 1e3, 1e-3))

    def step() -> saltus.Observation:
        return estimator.step(up, still, joints, speeds, forces, tau)

    guess = np.ones((101, 2)), np.zeros((100, 1))
    nodes = 101 * saltus.solve_ocp(mass, *guess).iterations
    rows = [
        ("`plan`, `a1/lateral`", once(lambda: saltus.plan("a1/lateral"))),
        ("`plan`, `a1/barrel-roll`", once(lambda: saltus.plan("a1/barrel-roll"))),
        ("`Plan.audit`", once(plan.audit)),
        ("`run`", once(lambda: saltus.run(plan))),
        ('`run`, `sim="mujoco"`', once(lambda: saltus.run(plan, sim="mujoco"))),
        ("`Machine.tick`", least(lambda: machine.tick(float(next(now)), told), 10_000)),
        ("`Machine.joint_tick`", least(lambda: machine.joint_tick(joints, speeds), 10_000)),
        ("`Estimator.step`", least(step, 10_000)),
        ("`Robot.rnea`", least(lambda: robot.rnea(q, v, v), 10_000)),
        ("`Robot.crba`", least(lambda: robot.crba(q), 10_000)),
        ("`Robot.aba`", least(lambda: robot.aba(q, v, v), 10_000)),
        ("`solve_ocp`, node", once(lambda: saltus.solve_ocp(mass, *guess)) / nodes),
    ]
    print("| what | time |\n|---|---|")
    for name, seconds in rows:
        text = f"{seconds:.2f} s" if seconds > 0.1 else f"{1e6 * seconds:.1f} µs"
        print(f"| {name} | {text} |")


if __name__ == "__main__":
    main()
