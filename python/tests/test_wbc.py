"""The program on torques: what it says obeys the equations of motion, and what stands in its way is named."""

import numpy as np
import pytest

import saltus

STILL = np.zeros(18)


@pytest.fixture(scope="module")
def robot() -> saltus.Robot:
    return saltus.Robot.a1()


def standing(robot: saltus.Robot) -> np.ndarray:
    """Knees bent, feet on the floor."""
    q = np.array([0, 0, 0, 0, 0, 0, 1, *[0, 0.9, -1.8] * 4], dtype=float)
    q[2] = robot.foot_radius - robot.feet(q)[0, 2]
    return q


def contact_jacobians(robot: saltus.Robot, q: np.ndarray) -> np.ndarray:
    """Of the lowest points of the feet's balls: that is where the ground pushes."""
    down = np.array([0, 0, -robot.foot_radius])
    return np.array([j[:3] + np.cross(j[3:].T, down).T for j in robot.foot_jacobians(q)])


def begun(robot: saltus.Robot, **options: object) -> saltus.TorqueQp:
    """A program with what every tick has."""
    qp = saltus.TorqueQp(robot)
    qp.begin(standing(robot), STILL, **options)
    qp.minimise_joints(np.zeros(12), np.full(12, 1e-2))
    qp.minimise_forces(np.zeros((4, 3)), np.full((4, 3), 1e-3))
    qp.limit_torques()
    return qp


def test_the_answer_obeys_the_equations_of_motion(robot: saltus.Robot) -> None:
    qp = begun(robot)
    qp.minimise(qp.com(), [0, 0, 2.0], [1e3] * 3)
    qp.minimise(qp.trunk(), np.zeros(6), [0, 0, 0, 1e3, 1e3, 1e3])
    answer = qp.solve()
    q = standing(robot)
    jacobians = contact_jacobians(robot, q)
    pushed = sum(j.T @ f for j, f in zip(jacobians, answer.forces))
    effort = robot.rnea(q, STILL, answer.acceleration) - pushed
    np.testing.assert_allclose(effort, [0] * 6 + list(answer.tau), atol=1e-9)
    # Newton's law, the contacts, and what was asked for.
    np.testing.assert_allclose(answer.forces.sum(0), [0, 0, robot.mass * 11.81], atol=0.1)
    for j in jacobians:
        np.testing.assert_allclose(j @ answer.acceleration, 0, atol=1e-9)
    assert (answer.yielded, answer.limits) == ("Nothing", [])


def test_friction_limits_and_says_so(robot: saltus.Robot) -> None:
    qp = begun(robot, friction=0.2)
    qp.minimise(qp.com(), [6.0, 0, 0], [1e3] * 3)
    answer = qp.solve()
    assert any(line.startswith("friction of") for line in answer.limits), answer.limits
    across = np.abs(answer.forces[:, :2]).max(1)
    assert (across <= 0.2 * answer.forces[:, 2] + 1e-6).all()


def test_a_held_task_comes_first_and_an_impossible_one_yields(robot: saltus.Robot) -> None:
    qp = begun(robot)
    qp.hold(qp.com(), [0, 0, 1.0])
    qp.minimise(qp.com(), [0, 0, -3.0], [1e6] * 3)
    answer = qp.solve()
    assert (qp.com().jacobian @ answer.acceleration)[2] == pytest.approx(1.0, abs=1e-8)
    qp.begin(standing(robot), STILL)
    qp.limit_torques()
    qp.minimise_joints(np.zeros(12), np.full(12, 1e-2))
    qp.hold(qp.com(), [0, 0, 1e3])
    answer = qp.solve()
    assert answer.yielded == "Tasks"
    assert "row 2: missed by" in " ".join(answer.limits)
    assert (np.abs(answer.tau) <= robot.max_torque + 1e-9).all()


def test_a_foot_in_the_air_carries_nothing_and_follows_its_task(robot: saltus.Robot) -> None:
    qp = begun(robot, loads=[0, 1, 1, 1])
    foot = qp.foot(0)
    wanted = foot.feedback([0, 0, 0.01], 900.0, 60.0)
    np.testing.assert_allclose(wanted, [0, 0, 9.0])
    qp.hold(foot, wanted)
    answer = qp.solve()
    np.testing.assert_allclose(answer.forces[0], 0, atol=1e-9)
    np.testing.assert_allclose(foot.jacobian @ answer.acceleration, wanted, atol=1e-8)


def test_a_task_of_ones_own_is_kept_in_its_range(robot: saltus.Robot) -> None:
    qp = begun(robot)
    knee = np.zeros((1, 18))
    knee[0, 6 + 2] = 1.0
    mine = saltus.WbTask(knee)
    assert (len(mine), mine.drift.shape, mine.rate.shape) == (1, (1,), (1,))
    qp.minimise(qp.com(), [0, 0, 5.0], [1e3] * 3)
    free = qp.solve().acceleration[8]
    for rank in (None, "limit", "task", 1e9):
        qp.begin(standing(robot), STILL)
        qp.minimise_joints(np.zeros(12), np.full(12, 1e-2))
        qp.minimise(qp.com(), [0, 0, 5.0], [1e3] * 3)
        qp.constrain(mine, [free + 1.0], [np.inf], rank)
        answer = qp.solve()
        assert answer.acceleration[8] == pytest.approx(free + 1.0, abs=1e-4), rank


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda qp: qp.begin(np.zeros(18), STILL), ["q", "(19,)"]),
        (lambda qp: qp.begin(standing(saltus.Robot.a1()), STILL, [1, 1, 1, 2]), ["loads", "2"]),
        (lambda qp: qp.begin(standing(saltus.Robot.a1()), STILL, friction=-1), ["friction", "-1"]),
        (lambda qp: qp.foot(4), ["foot", "4"]),
        (lambda qp: qp.minimise(qp.com(), [0, 0], [1] * 3), ["target", "(3,)"]),
        (lambda qp: qp.constrain(qp.com(), [0] * 3, [1] * 3, "soft"), ["rank", "soft"]),
        (lambda qp: qp.constrain(qp.com(), [0] * 3, [1] * 3, -1.0), ["rank", "-1"]),
        (lambda qp: qp.limit_torques(0), ["share", "0"]),
        (lambda qp: [qp.hold(qp.com(), [0] * 3) for _ in range(9)], ["rows", "24"]),
        (lambda qp: saltus.WbTask(np.zeros((2, 17))), ["jacobian", "(2, 18)"]),
    ],
)
def test_what_cannot_be_is_named(robot: saltus.Robot, wrong: object, words: list[str]) -> None:
    with pytest.raises(saltus.BadInput) as caught:
        wrong(begun(robot))  # type: ignore[operator]
    assert all(word in str(caught.value) for word in words), caught.value
