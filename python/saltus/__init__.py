"""Jumps of quadrupeds: plan them, audit the plans, step the machine that flies them, simulate, and judge.

    import saltus

    plan = saltus.plan("a1/barrel-roll")
    print(plan.audit()["worst_margin"], saltus.run(plan).outcome)

SI units and Pinocchio's conventions throughout: see `Robot`.
"""

from saltus._saltus import Robot
from saltus.errors import AuditFailed, BadInput, Error, Infeasible, NoPlan, NotFound, Refused

__all__ = [
    "AuditFailed",
    "BadInput",
    "Error",
    "Infeasible",
    "NoPlan",
    "NotFound",
    "Refused",
    "Robot",
]
