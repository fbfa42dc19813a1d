"""Runs in the MuJoCo of Python's own package."""

import sys

import mujoco
import numpy as np
import pytest

import saltus


def test_a_lateral_jump_is_on_target_in_both(lateral: saltus.Plan) -> None:
    ours, theirs = (saltus.run(lateral, sim=sim) for sim in ("native", "mujoco"))
    assert ours.on_target, ours.summary
    assert theirs.on_target, theirs.summary
    assert len(ours) == len(theirs)
    # They agree at the take-off to a centimetre, and not to the bit: they are two.
    takeoff = np.searchsorted(ours.times, lateral.takeoff)
    apart = np.abs(ours.q[takeoff] - theirs.q[takeoff])[:3]
    assert 0 < apart.max() < 0.01
    # Before the push-off the feet carry the robot, in the air nothing touches them.
    waiting = (theirs.times > -0.2) & (theirs.times < 0)
    weight = 9.81 * lateral.robot.mass
    assert theirs.forces[waiting, :, 2].sum(1).mean() == pytest.approx(weight, rel=0.02)
    flight = (theirs.times > lateral.takeoff + 0.05) & (theirs.times < lateral.touchdown - 0.05)
    assert (theirs.forces[flight] == 0).all()


def test_icub_jumps_in_mujoco() -> None:
    record = saltus.run_icub("velocity", height=0.03, sim="mujoco")
    assert record.stands, record.summary
    assert record.com_gain == pytest.approx(0.03, abs=0.01)


def test_a_study_is_the_same_on_one_core_and_on_two(lateral: saltus.Plan) -> None:
    told = []
    one = saltus.envelope(lateral, 2, sim="mujoco", jobs=1)
    two = saltus.envelope(lateral, 2, lambda *x: told.append(x), sim="mujoco", jobs=2)
    assert told == [(1, 2), (2, 2)]
    assert (one.seeds, one.outcomes) == (two.seeds, two.outcomes)
    assert np.array_equal(one.feet_error, two.feet_error, equal_nan=True)
    record = saltus.run(lateral, sim="mujoco", seed=one.seeds[1])
    assert record.outcome == one.outcomes[1]


def test_without_the_package_the_remedy_is_named(
    lateral: saltus.Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    for call in (
        lambda: saltus.run(lateral, sim="mujoco"),
        lambda: saltus.run_icub(sim="mujoco"),
        lambda: saltus.envelope(lateral, 2, sim="mujoco"),
    ):
        with pytest.raises(saltus.BadInput, match=r"^sim: .*`pip install mujoco`"):
            call()
    assert saltus.run(lateral).on_target


def test_another_module_of_that_name_is_no_mujoco(
    lateral: saltus.Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", np)
    with pytest.raises(saltus.BadInput, match=r"^sim: the package mujoco cannot be used.*MjModel"):
        saltus.run(lateral, sim="mujoco")


def test_what_mujoco_raises_in_a_step_is_told(
    lateral: saltus.Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    def step(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        if data.time > 0.5:
            raise mujoco.FatalError("stack overflow")
        mujoco.mj_forward(model, data)
        data.time += 0.1

    told = []
    monkeypatch.setattr(sys, "unraisablehook", told.append)
    monkeypatch.setattr(mujoco, "mj_step", step)
    with pytest.raises(saltus.Error, match="MuJoCo"):
        saltus.run(lateral, sim="mujoco")
    assert [str(one.exc_value) for one in told] == ["stack overflow"]
