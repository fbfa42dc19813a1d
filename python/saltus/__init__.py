"""Jumps of legged robots: plan a quadruped's, audit the plans, step the machine that flies them, simulate, and judge; iCub's on the spot.

    import saltus

    plan = saltus.plan("a1/barrel-roll")
    print(plan.audit()["worst_margin"], saltus.run(plan).outcome)

SI units and Pinocchio's conventions throughout: see `Robot`. Tasks as dataclasses stand in `saltus.tasks`.
"""

from saltus._saltus import (
    Command,
    Envelope,
    Estimator,
    IcubRecord,
    Machine,
    Observation,
    OcpSolution,
    Plan,
    QpSolution,
    Record,
    Robot,
    Task,
    Tick,
    TorqueAnswer,
    TorqueQp,
    WbTask,
    envelope,
    plan,
    run,
    run_icub,
    solve_ocp,
    solve_qp,
)
from saltus.errors import (
    AuditFailed,
    BadInput,
    Error,
    Infeasible,
    NoPlan,
    NotFound,
    OutOfTime,
    Refused,
)

__all__ = [
    "AuditFailed",
    "BadInput",
    "Command",
    "Envelope",
    "Error",
    "Estimator",
    "IcubRecord",
    "Infeasible",
    "Machine",
    "NoPlan",
    "NotFound",
    "Observation",
    "OcpSolution",
    "OutOfTime",
    "Plan",
    "QpSolution",
    "Record",
    "Refused",
    "Robot",
    "Task",
    "Tick",
    "TorqueAnswer",
    "TorqueQp",
    "WbTask",
    "envelope",
    "plan",
    "run",
    "run_icub",
    "solve_ocp",
    "solve_qp",
]
