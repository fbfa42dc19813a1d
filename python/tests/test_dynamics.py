"""Dynamics beside Pinocchio's own numbers, and beside each other."""

from pathlib import Path

import numpy as np
import pytest
from golden import states, symmetric

import saltus


def close(a: np.ndarray, b: np.ndarray) -> bool:
    return np.allclose(a, b, rtol=0.0, atol=1e-10 * max(1.0, np.abs(b).max()))


def test_pinocchio_says_the_same(urdf: Path) -> None:
    robot = saltus.Robot.load(urdf)
    jacobians = 0
    all_states = list(states("a1"))
    for state in all_states:
        q, v, a = state["q"], state["v"], state["a"]
        assert close(robot.rnea(q, v, a), state["rnea"])
        assert close(robot.aba(q, v, state["tau"]), state["aba"])
        assert close(robot.crba(q), symmetric(state["mass_matrix_lower"], robot.nv))
        feet = [state[f"{name}_foot.position"] for name in robot.foot_names]
        assert close(robot.feet(q), np.array(feet))
        all_jacobians = robot.foot_jacobians(q)
        for foot, name in enumerate(robot.foot_names):
            jacobian = all_jacobians[foot]
            assert close(jacobian @ v, state[f"{name}_foot.velocity_a"])
            if f"{name}_foot.jacobian_a" in state:
                assert close(jacobian, state[f"{name}_foot.jacobian_a"])
                jacobians += 1
    assert len(all_states) == 32
    assert jacobians > 0


def test_the_manifold_goes_both_ways() -> None:
    robot = saltus.Robot.a1()
    random = np.random.default_rng(1)
    q = robot.neutral()
    step = random.normal(size=robot.nv)
    there = robot.integrate(q, step)
    assert close(robot.difference(q, there), step)
    # The centre of mass moves as its velocity says: a difference of finite steps.
    h = 1e-6
    ahead, behind = (robot.com(robot.integrate(q, s * h * step)) for s in (1, -1))
    base = robot.crba(q)[:3] @ step / robot.mass
    assert np.allclose((ahead - behind) / (2 * h), base, atol=1e-7)


def test_the_built_in_robot_is_described() -> None:
    robot = saltus.Robot.a1()
    assert (robot.name, robot.nq, robot.nv) == ("a1", 19, 18)
    assert robot.foot_names == ["FL", "FR", "RL", "RR"]
    assert robot.joint_names[0] == "FL_hip_joint"
    assert robot.mass == pytest.approx(13.741)
    assert (robot.lower < robot.upper).all()
    assert (robot.armature > 0).all()
    assert robot.placeholders == []


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda r, q, v: r.rnea(q[:-1], v, v), ["q:", "(19,)", "(18,)"]),
        (lambda r, q, v: r.aba(q, v, np.zeros((2, 9))), ["tau:", "(18,)", "(2, 9)"]),
        (lambda r, q, v: r.crba(np.zeros(19)), ["q[3:7]"]),
        (lambda r, q, v: r.com(np.full(19, np.nan)), ["q[3:7]"]),
    ],
)
def test_arrays_that_cannot_be_are_named(wrong, words) -> None:
    robot = saltus.Robot.a1()
    with pytest.raises(saltus.BadInput) as caught:
        wrong(robot, robot.neutral(), np.zeros(18))
    assert all(word in str(caught.value) for word in words)


def test_files_that_are_no_robot_are_named(tmp_path: Path) -> None:
    with pytest.raises(saltus.BadInput, match=r"nowhere\.urdf.*check the path"):
        saltus.Robot.load("nowhere.urdf")
    file = tmp_path / "none.urdf"
    file.write_text("<robot")
    with pytest.raises(saltus.BadInput, match=r"none\.urdf"):
        saltus.Robot.load(file)
