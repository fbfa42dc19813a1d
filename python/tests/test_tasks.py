"""Tasks: by name, as text and as dataclasses."""

from pathlib import Path

import numpy as np
import pytest

import saltus
from saltus.tasks import Box, Jump, Limits, Phase, Total, Turn, Weights

LATERAL = Jump(
    goal_m=(0.0, 0.3, 0.0),
    phases=[
        Phase(["FL", "FR", "RL", "RR"], guess_s=0.5, intervals=50),
        Phase([], guess_s=0.3, intervals=30),
    ],
    total=Total(min_s=0.5, max_s=0.8),
)


def test_every_built_in_task_loads() -> None:
    names = saltus.Task.built_in()
    assert len(names) == 9
    for name in names:
        task = saltus.Task.load(name)
        assert task.name == name
        feet = task.robot.feet(task.start)
        assert np.allclose(feet[:, 2], task.robot.foot_radius, atol=1e-6)


def test_dataclasses_are_the_file(lateral: saltus.Plan) -> None:
    plan = saltus.plan(LATERAL.task(name="a1/lateral"))
    assert plan.to_bytes() == lateral.to_bytes()


def test_every_key_of_a_task_file_has_its_field() -> None:
    jump = Jump(
        goal_m=np.array([0.5, 0.0, -0.3]),
        phases=[
            Phase(["FL", "FR", "RL", "RR"], 0.5, 50, 0.1, 0.6, 0.0),
            Phase([], 0.4, 40, 0.3, 0.6, 90.0),
        ],
        feet_m=[(0.18, 0.15), (0.18, -0.15), (-0.18, 0.14), (-0.18, -0.14)],
        turn=Turn((0, 0, 1), 90.0),
        box=Box(0.3, "x", 1, beyond_feet_m=0.1),
        trunk_may_touch=True,
        total=Total(0.4, 1.4),
        limits=Limits(0.7, 0.8, 1.1, 0.02, (0.7, 0.8, 0.9), 0.9),
        weights=Weights(1e-2, 1e-5, 1.0, 1.0, 1e-4, 10.0),
    )
    task = jump.task()
    assert np.allclose(task.goal, [0.5, 0.0, -0.3])
    assert np.allclose(task.robot.feet(task.start)[:, :2], jump.feet_m)
    assert task.heading == pytest.approx(np.pi / 2)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: saltus.Task.load("a1/laterall"), ["a1/laterall", "a1/lateral,"]),
        (lambda: saltus.Task.from_toml("goal = 3", name="mine"), ["mine", "goal"]),
        (lambda: Jump((0, 0, 0), [Phase(["XX"], 0.4)]).task(), ["phase 1", "XX", "FL"]),
        (lambda: Jump((0, 0, 0), []).task(), ["jump", "phase"]),
        (lambda: Jump((0, 0, 1e9), LATERAL.phases).task(name="far"), ["far", "goal_m", "100"]),
    ],
)
def test_what_is_wrong_is_named(make, words) -> None:
    with pytest.raises(saltus.BadInput) as caught:
        make()
    assert all(word in str(caught.value) for word in words), caught.value


def test_another_robot_jumps(urdf: Path) -> None:
    robot = saltus.Robot.load(urdf)
    task = saltus.Task.load("a1/lateral", robot)
    assert (task.robot.armature == 0).all()
    assert (saltus.Task.load("a1/lateral").robot.armature > 0).all()
