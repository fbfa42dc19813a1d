"""Plans, how planning ends otherwise, and how it is stopped."""

import os
import signal
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_tasks import LATERAL

import saltus
from saltus.tasks import Jump, Limits


def test_a_plan_is_a_motion(lateral: saltus.Plan) -> None:
    robot, count = lateral.robot, len(lateral)
    assert lateral.q.shape == (count, 19)
    assert lateral.v.shape == (count, 18)
    assert lateral.tau.shape == (count, 12)
    assert lateral.forces.shape == (count, 4, 3)
    assert lateral.contacts.shape == (count, 4)
    assert lateral.times[0] < 0 < lateral.takeoff < lateral.posing < lateral.touchdown
    assert lateral.durations.sum() == pytest.approx(lateral.touchdown, abs=1e-3)
    # Feet that stand are on the ground, and feet that do not carry nothing.
    height = np.array([robot.feet(q)[:, 2] for q in lateral.q])
    assert np.abs(height - robot.foot_radius)[lateral.contacts].max() < 5e-3
    assert np.abs(lateral.forces[~lateral.contacts]).max() < 1e-6
    # In flight the centre of mass falls freely.
    flight = lateral.times >= lateral.takeoff
    com = np.array([robot.com(q) for q in lateral.q])[flight]
    fall = np.polyfit(lateral.times[flight], com[:, 2], 2)[0]
    assert fall == pytest.approx(-9.81 / 2, rel=0.01)


def test_it_passes_its_audit(lateral: saltus.Plan) -> None:
    audit = lateral.audit()
    assert audit["passes"] is True
    assert audit["complaint"] == ""
    assert audit["crc32"] == lateral.crc32
    assert audit["flight_orientation_error_deg"] < 2
    assert len(audit["margins"]) > 50


def test_it_is_stored_bit_by_bit(lateral: saltus.Plan, tmp_path: Path) -> None:
    file = tmp_path / "plan.bin"
    lateral.save(file)
    again = saltus.Plan.load(file)
    assert again.to_bytes() == file.read_bytes() == lateral.to_bytes()
    assert (again.q == lateral.q).all()
    damaged = bytearray(lateral.to_bytes())
    damaged[1000] ^= 1
    file.write_bytes(damaged)
    with pytest.raises(saltus.BadInput, match=r"plan\.bin"):
        saltus.Plan.load(file)
    with pytest.raises(saltus.BadInput, match="nowhere"):
        saltus.Plan.load(tmp_path / "nowhere")
    with pytest.raises(saltus.BadInput, match="nowhere"):
        lateral.save(tmp_path / "nowhere" / "plan.bin")


def test_a_plan_of_a_task_of_ones_own_wants_its_task(tmp_path: Path) -> None:
    task = LATERAL.task(name="mine")
    plan = saltus.plan(task)
    plan.save(tmp_path / "plan.bin")
    with pytest.raises(saltus.BadInput, match=r"mine.*give the plan's task"):
        saltus.Plan.load(tmp_path / "plan.bin")
    assert saltus.Plan.load(tmp_path / "plan.bin", task).to_bytes() == plan.to_bytes()
    with pytest.raises(saltus.BadInput, match="goal"):
        saltus.Plan.load(tmp_path / "plan.bin", saltus.Task.load("a1/diagonal"))


def test_what_cannot_be_is_proven() -> None:
    far = Jump((0.0, 20.0, 0.0), LATERAL.phases)
    with pytest.raises(saltus.Infeasible, match="friction") as caught:
        saltus.plan(far.task())
    assert "bound" in caught.value.because
    assert caught.value.relaxations != []


# The solver finds neither a plan nor a proof that there is none.
SLIPPERY = replace(LATERAL, limits=Limits(friction=0.1))


def test_what_is_not_found_says_what_blocks_and_what_would_help() -> None:
    with pytest.raises(saltus.NotFound, match="friction would have to be") as caught:
        saltus.plan(SLIPPERY.task())
    assert "goal along y" in caught.value.because
    assert len(caught.value.relaxations) >= 2
    assert caught.value.because in str(caught.value)


def test_a_search_ends_with_the_time_there_is() -> None:
    with pytest.raises(saltus.OutOfTime, match="after 0 s the body's motion"):
        saltus.plan("a1/lateral", within=0.0)
    with pytest.raises(saltus.BadInput, match="within"):
        saltus.plan("a1/lateral", within=-1.0)


def test_progress_is_told_and_its_error_ends_planning() -> None:
    told = []
    saltus.plan("a1/lateral", progress=lambda *step: told.append(step))
    assert {step for step, _, _ in told} == {"body", "whole body"}
    assert all(iteration >= 0 and violation >= 0 for _, iteration, violation in told)

    def enough(step: str, iteration: int, violation: float) -> None:
        if iteration == 3:
            raise LookupError(step)

    with pytest.raises(LookupError, match="body"):
        saltus.plan("a1/lateral", progress=enough)


def test_ctrl_c_ends_planning_also_while_it_looks_for_easier_tasks() -> None:
    def interrupt(step: str, iteration: int, violation: float) -> None:
        steps.add(step)
        if step == wanted:
            os.kill(os.getpid(), signal.SIGINT)

    for jump, wanted in ((LATERAL, "whole body"), (SLIPPERY, "relaxations")):
        steps: set[str] = set()
        with pytest.raises(KeyboardInterrupt):
            saltus.plan(jump.task(), progress=interrupt)
        assert wanted in steps


def test_other_threads_run_meanwhile() -> None:
    worker = threading.Thread(target=saltus.plan, args=("a1/lateral",))
    worker.start()
    longest, last = 0.0, time.perf_counter()
    while worker.is_alive():
        time.sleep(1e-3)
        now = time.perf_counter()
        longest, last = max(longest, now - last), now
    assert longest < 0.2


def test_timing_is_named() -> None:
    with pytest.raises(saltus.BadInput, match="timing"):
        saltus.plan("a1/lateral", timing="loose")


def test_a_plan_near_another_one_is_found_sooner_and_audited(lateral: saltus.Plan) -> None:
    task = replace(LATERAL, goal_m=(0.1, 0.3, 0.0)).task()
    told: dict = {"whole body": []}
    near = saltus.plan(
        task, progress=lambda step, i, _: told.setdefault(step, []).append(i), near=lateral
    )
    afar: dict = {"whole body": []}
    same = saltus.plan(task, progress=lambda step, i, _: afar.setdefault(step, []).append(i))
    assert len(told["whole body"]) < len(afar["whole body"])
    assert len(told["body"]) < len(afar["body"])
    assert near.audit()["passes"]
    np.testing.assert_allclose(near.q[-1], same.q[-1], atol=2e-3)
