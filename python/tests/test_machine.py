"""The machine and the estimator, stepped from outside."""

import numpy as np
import pytest

import saltus

WEIGHT = 13.741 * 9.81


def standing(plan: saltus.Plan) -> saltus.Observation:
    return saltus.Observation(plan.q[0], np.zeros(18), np.full(4, WEIGHT / 4), plan.tau[0])


def test_it_holds_the_first_node_then_walks_through_the_phases(lateral: saltus.Plan) -> None:
    machine = lateral.machine()
    tick = machine.tick(-0.9, standing(lateral))
    assert (tick.phase, tick.fault, tick.refusal) == ("Hold", None, None)
    assert tick.work == "Cartesian"
    command = tick.command
    shapes = {x.shape for x in (command.q, command.dq, command.kp, command.kd, command.tau)}
    assert shapes == {(12,)}
    assert np.allclose(
        command.tau + command.kp * (command.q - lateral.q[0, 7:]), lateral.tau[0], atol=0.5
    )
    # A robot that does exactly what was planned.
    phases = []
    for k in range(-899, int(1e3 * lateral.touchdown)):
        i = np.searchsorted(lateral.times, 1e-3 * k, side="right") - 1
        i = max(i, 0)
        forces = lateral.forces[i, :, 2]
        observed = saltus.Observation(lateral.q[i], lateral.v[i], forces, lateral.tau[i])
        tick = machine.tick(1e-3 * k, observed)
        if not phases or phases[-1] != tick.phase:
            phases.append(tick.phase)
        tau = machine.joint_tick(lateral.q[i, 7:], lateral.v[i, 6:])
        assert (np.abs(tau) <= lateral.robot.max_torque + 1e-9).all()
    assert phases == ["Hold", "Stance", "Flight", "PreLanding"]


def test_what_cannot_be_acted_on_ends_in_damping(lateral: saltus.Plan) -> None:
    for wrong, told in (
        (lambda q: q[7:].__setitem__(4, np.nan), "joint 4"),
        (lambda q: q.__setitem__(0, np.inf), "base"),
        (lambda q: q.__setitem__(slice(3, 7), 0.0), "base"),
        (lambda q: q.__setitem__(6, np.nan), "base"),
    ):
        machine = lateral.machine()
        machine.tick(-0.3, standing(lateral))
        q = lateral.q[0].copy()
        wrong(q)
        observed = saltus.Observation(q, np.zeros(18), np.zeros(4), np.zeros(12))
        tick = machine.tick(-0.299, observed)
        assert tick.phase == machine.phase == "Abort"
        assert told in tick.fault
        assert tick.work == "Damping"
        assert (tick.command.kp == 0).all()
        assert (tick.command.tau == 0).all()
        assert (tick.command.kd > 0).all()
        assert np.isfinite(machine.joint_tick(q[7:], np.ones(12))).all()


def test_silence_is_borne_for_ten_milliseconds(lateral: saltus.Plan) -> None:
    machine = lateral.machine()
    machine.tick(-0.3, standing(lateral))
    silent = [machine.tick(-0.3 + 1e-3 * k).phase for k in range(1, 15)]
    assert silent[:9] == ["Hold"] * 9
    assert silent[-1] == "Abort"
    assert "too old" in machine.fault
    with pytest.raises(saltus.Refused, match="does not stand"):
        machine.arm(1.0)


def test_machines_are_strangers_to_each_other(lateral: saltus.Plan) -> None:
    one, other = lateral.machine(), lateral.machine(start=1.0)
    # Without a tick before its start it has no gains for the push-off.
    assert "too late" in one.tick(0.0, standing(lateral)).refusal
    other.tick(0.0, standing(lateral))
    assert (one.phase, other.phase) == ("Stand", "Hold")
    del one
    assert other.tick(1e-3, standing(lateral)).phase == "Hold"


def test_the_estimator_stands_still_and_says_when_it_is_lost(lateral: saltus.Plan) -> None:
    q = lateral.q[0]
    estimator = saltus.Estimator(lateral.robot, q)
    up, still = [0.0, 0.0, 9.81], np.zeros(3)
    for _ in range(200):
        told = estimator.step(up, still, q[7:], np.zeros(12), np.full(4, 34.0), lateral.tau[0])
    assert np.allclose(told.q, q, atol=1e-4)
    assert np.allclose(told.v, 0, atol=1e-3)
    assert (estimator.status, estimator.fault) == ("Good", None)
    assert (estimator.confidence > 0.5).all()
    assert told.age == 0
    for _ in range(40):
        estimator.coast()
    assert estimator.status == "Lost"
    tipped = estimator.step([np.nan] * 3, still, q[7:], np.zeros(12), np.zeros(4), np.zeros(12))
    assert "accelerometer" in estimator.fault
    assert np.isfinite(tipped.q).all()


def test_an_imu_elsewhere_is_told_where(lateral: saltus.Plan) -> None:
    q = lateral.q[0]
    # Turned by a quarter about x: gravity is felt along its y.
    half = np.sqrt(0.5)
    estimator = saltus.Estimator(lateral.robot, q, imu=[0.1, 0.0, 0.05, half, 0.0, 0.0, half])
    for _ in range(200):
        told = estimator.step(
            [0.0, 9.81, 0.0], np.zeros(3), q[7:], np.zeros(12), np.full(4, 34.0), lateral.tau[0]
        )
    assert np.allclose(told.q, q, atol=1e-3)
    with pytest.raises(saltus.BadInput, match="loaded"):
        saltus.Estimator(lateral.robot, q, loaded=0.0)
