"""Runs in the MuJoCo of Python's own package."""

import os
import signal
import sys
import threading
import time
from pathlib import Path
from typing import Any

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
    told: list[tuple[int, int]] = []
    one = saltus.envelope(lateral, 2, sim="mujoco", jobs=1)
    two = saltus.envelope(lateral, 2, lambda *x: told.append(x), sim="mujoco", jobs=2)
    assert told == [(1, 2), (2, 2)]
    assert (one.seeds, one.outcomes) == (two.seeds, two.outcomes)
    assert np.array_equal(one.feet_error, two.feet_error, equal_nan=True)
    # Of the program that is linked with MuJoCo 3.17.0: `saltus envelope a1/lateral --sim mujoco --samples 2`.
    assert one.seeds == [12323649364400974661, 7095607484609012044]
    assert one.outcomes == ["target", "target"]
    assert one.feet_error == pytest.approx([0.029313, 0.024057], abs=1e-3)
    assert one.rotation_error == pytest.approx([1.7863, 1.8087], abs=0.1)
    # Any sample can be looked at.
    record = saltus.run(lateral, sim="mujoco", seed=one.seeds[1])
    assert record.outcome == one.outcomes[1]


def test_ctrl_c_ends_a_run_after_its_end_and_a_study_between_two(lateral: saltus.Plan) -> None:
    with pytest.raises(KeyboardInterrupt):
        saltus.envelope(
            lateral, 1_000_000, lambda *_: os.kill(os.getpid(), signal.SIGINT), sim="mujoco", jobs=2
        )
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        saltus.run(lateral, sim="mujoco")
    timer.join()


def test_other_threads_run_meanwhile(lateral: saltus.Plan) -> None:
    worker = threading.Thread(target=saltus.run, args=(lateral,), kwargs={"sim": "mujoco"})
    worker.start()
    turns = 0
    while worker.is_alive():
        time.sleep(1e-3)
        turns += 1
    assert turns > 50


def test_a_robot_that_mujoco_refuses_is_refused_in_its_words(urdf: Path, tmp_path: Path) -> None:
    # A hip that is a point: to our own dynamics, which turn it with its rotor, a body like any other.
    words = urdf.read_text().split('ixx="0.000469246"', 1)
    zero = 'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"'
    point = tmp_path / "point.urdf"
    point.write_text(f"{words[0]}{zero}{words[1][words[1].index('/>') :]}")
    plan = saltus.plan("a1/lateral", saltus.Robot.load(point))
    assert saltus.run(plan).stands
    with pytest.raises(saltus.Error, match=r"MuJoCo refused the model: .*inertia"):
        saltus.run(plan, sim="mujoco")


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

    told: list[Any] = []
    monkeypatch.setattr(sys, "unraisablehook", told.append)
    monkeypatch.setattr(mujoco, "mj_step", step)
    with pytest.raises(saltus.Error, match="MuJoCo"):
        saltus.run(lateral, sim="mujoco")
    assert [str(one.exc_value) for one in told] == ["stack overflow"]
