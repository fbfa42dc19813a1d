"""Runs in our own simulator, and studies of many."""

import threading

import numpy as np
import pytest

import saltus


def test_the_nominal_run_is_on_target(lateral: saltus.Plan) -> None:
    record = saltus.run(lateral)
    assert record.on_target
    assert record.outcome == "target"
    assert record.stands
    assert record.fault is None
    assert record.summary == "on target"
    assert record.verdict["failures"] == []
    count = len(record)
    assert record.q.shape == (count, 19)
    assert record.v.shape == (count, 18)
    assert record.forces.shape == (count, 4, 3)
    assert record.phases[0] == "Hold"
    assert record.phases[-1] == "Stand"
    assert record.q[-1, 1] == pytest.approx(0.3, abs=0.05)
    assert record.touchdown == pytest.approx(lateral.touchdown, abs=0.1)
    # What is told as a velocity is one: beside differences of what is told as a place.
    robot = lateral.robot
    steps = [robot.difference(a, b) for a, b in zip(record.q[200:400], record.q[201:401])]
    assert np.abs(np.array(steps) / 1e-3 - record.v[200:400]).max() < 0.5


def test_a_seed_is_a_lab_of_its_own_and_repeats(lateral: saltus.Plan) -> None:
    one, two = (saltus.run(lateral, seed=5) for _ in range(2))
    assert (one.q == two.q).all()
    assert not (one.q[:500] == saltus.run(lateral, seed=6).q[:500]).all()


def test_heavier_differs(lateral: saltus.Plan) -> None:
    heavy = saltus.run(lateral, plant="payload=6@0,0,0.1", without=["weighing"])
    assert not heavy.on_target
    assert heavy.verdict["failures"][0]["name"] == heavy.outcome


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"sim": "gazebo"}, ["sim", "gazebo", "native"]),
        ({"plant": "wind=3"}, ["plant", "wind", "mass"]),
        ({"interface": "bus"}, ["interface", "joint-pd"]),
        ({"without": ["luck"]}, ["without", "luck", "weighing"]),
    ],
)
def test_what_there_is_not_is_named(lateral: saltus.Plan, wrong: dict, words: list[str]) -> None:
    with pytest.raises(saltus.BadInput) as caught:
        saltus.run(lateral, **wrong)
    assert all(word in str(caught.value) for word in words), caught.value


def test_a_study_is_the_same_on_one_core_and_on_two(lateral: saltus.Plan) -> None:
    told = []
    one = saltus.envelope(lateral, 3, seed=4, jobs=1)
    two = saltus.envelope(lateral, 3, lambda *x: told.append(x), seed=4, jobs=2)
    assert told == [(1, 3), (2, 3), (3, 3)]
    assert (len(one), one.outcomes, one.seeds) == (3, two.outcomes, two.seeds)
    assert np.array_equal(one.feet_error, two.feet_error, equal_nan=True)
    assert one.values["mass"].shape == (3,)
    low, high = one.interval
    assert low <= one.rate <= high
    assert sum(one.failed.values()) == 3 - round(3 * one.rate)
    assert one.table().startswith("cell,from,to")
    # Any sample can be looked at.
    record = saltus.run(lateral, seed=one.seeds[1])
    assert record.outcome == one.outcomes[1]


def test_an_error_of_progress_ends_a_study(lateral: saltus.Plan) -> None:
    def enough(done: int, samples: int) -> None:
        raise LookupError(done)

    before = threading.active_count()
    with pytest.raises(LookupError):
        saltus.envelope(lateral, 1_000_000, enough, jobs=2)
    assert threading.active_count() == before
    with pytest.raises(saltus.BadInput, match="jobs"):
        saltus.envelope(lateral, 1, jobs=0)


def test_icub_jumps_on_the_spot() -> None:
    record = saltus.run_icub("velocity", height=0.03)
    count = len(record)
    assert record.stands, record.summary
    assert record.q.shape == (count, 30)
    assert record.v.shape == (count, 29)
    assert record.tau.shape == (count, len(record.joint_names))
    assert record.forces.shape == (count, 2, 3)
    assert record.com_gain == pytest.approx(0.03, abs=0.01)
    assert record.takeoff < record.touchdown
    # Before the push-off the soles carry the robot, in the air nothing does.
    waiting = (record.times > -0.2) & (record.times < 0)
    assert record.forces[waiting, :, 2].sum(1).mean() == pytest.approx(9.81 * 33, rel=0.15)
    flight = (record.times > record.contact_loss) & (record.times < record.touchdown)
    assert (record.forces[flight, :, 2] == 0).all()


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"level": "position"}, ["level", "position", "torque"]),
        ({"height": -0.1}, ["height", "-0.1"]),
        ({"height": float("nan")}, ["height", "NaN"]),
        ({"torque_share": 2}, ["torque_share", "2"]),
        ({"landing": "soft"}, ["landing", "soft", "stiff"]),
        ({"plant": "wind=3"}, ["plant", "wind"]),
    ],
)
def test_what_icub_cannot_is_named(wrong: dict, words: list[str]) -> None:
    with pytest.raises(saltus.BadInput) as caught:
        saltus.run_icub(**wrong)
    assert all(word in str(caught.value) for word in words), caught.value
