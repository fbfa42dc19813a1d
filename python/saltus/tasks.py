"""A task as dataclasses: the tables and keys of a task file, so what is learnt of one holds for the other.

    jump = Jump(
        goal_m=(0.0, -0.3, 0.0),
        turn=Turn(axis=(1.0, 0.0, 0.0), angle_deg=360.0),
        phases=[
            Phase(["FL", "FR", "RL", "RR"], guess_s=0.5, intervals=50),
            Phase(["FR", "RR"], guess_s=0.3, intervals=30),
            Phase([], guess_s=0.4),
        ],
        total=Total(max_s=1.2),
    )
    plan = saltus.plan(jump.task())

What is None is left to the planner, whose defaults stand in one place. Values are checked where a Task is made of them.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields

from saltus._saltus import Robot, Task


@dataclass(frozen=True)
class Turn:
    """The turn of the body."""

    axis: Sequence[float]
    """Axis in the world at the start, of any length, three numbers."""
    angle_deg: float
    """May exceed 360."""


@dataclass(frozen=True)
class Box:
    """A step of the ground. Give either `beyond_feet_m` or `distance_m`."""

    drop_m: float
    """Height of the start over the landing, m; negative jumps up."""
    axis: str
    """Axis across the edge, "x" or "y"."""
    side: int
    """Side of the landing along the axis, 1 or -1."""
    beyond_feet_m: float | None = None
    """Distance of the edge from the feet that stand nearest, m."""
    distance_m: float | None = None
    """Distance of the edge from the middle of the robot, m."""


@dataclass(frozen=True)
class Phase:
    """One contact phase."""

    feet: Sequence[str]
    """Feet on the ground, of FL, FR, RL and RR; none in a flight."""
    guess_s: float
    """Guess of the duration, s, from min_s to max_s where these are given."""
    intervals: int | None = None
    """Intervals of the rigid body's plan."""
    min_s: float | None = None
    """Shortest duration, s."""
    max_s: float | None = None
    """Longest duration, s."""
    turn_deg: float | None = None
    """Turn at the end of the phase that the body should follow, degrees: in all phases or in none."""


@dataclass(frozen=True)
class Total:
    """Bounds of the whole duration."""

    min_s: float | None = None
    """Shortest, s."""
    max_s: float | None = None
    """Longest, s."""


@dataclass(frozen=True)
class Limits:
    """What the plan may use."""

    friction: float | None = None
    """Friction of the ground."""
    friction_share: float | None = None
    """Share of it that the plan may use."""
    force_weights: float | None = None
    """Normal force per foot in weights of the robot."""
    clearance_m: float | None = None
    """Least height of the trunk over the ground, m; not negative."""
    torque_shares: Sequence[float] | None = None
    """Three shares of the joints' torque limits: the first with which the task is solved."""
    speed_share: float | None = None
    """Share of the motors' speeds."""


@dataclass(frozen=True)
class Weights:
    """Weights of the costs."""

    omega: float | None = None
    """Rigid body: angular velocity, s²/rad²."""
    force: float | None = None
    """Rigid body: forces, 1/N²."""
    rotation: float | None = None
    """Rigid body: rotation from its reference, 1/rad²."""
    position: float | None = None
    """Whole body: distance from the reference, 1/m² and 1/rad²."""
    torque: float | None = None
    """Whole body: torques, 1/(N m)²."""
    goal: float | None = None
    """Whole body: distance from the goal, 1/m² and 1/rad²."""


@dataclass(frozen=True)
class Jump:
    """A whole task."""

    goal_m: Sequence[float]
    """Displacement of the centre of mass, world axes, m, three numbers."""
    phases: Sequence[Phase]
    """Contact phases in order; the last one is the flight."""
    turn: Turn | None = None
    """Without it the body ends as it began."""
    box: Box | None = None
    """A box to jump off or onto."""
    trunk_may_touch: bool = False
    """The trunk may touch the ground in the landing."""
    total: Total = field(default_factory=Total)
    """Bounds of the whole duration."""
    limits: Limits = field(default_factory=Limits)
    """What the plan may use."""
    weights: Weights = field(default_factory=Weights)
    """Weights of the costs."""
    feet_m: Sequence[Sequence[float]] | None = None
    """Where FL, FR, RL and RR stand at the start, seen from below the centre of mass, m, two numbers each; below the hips without it."""

    def toml(self) -> str:
        """As a task file, for A1."""
        head = ['robot = "a1"', f"goal_m = {_value(self.goal_m)}"]
        if self.feet_m is not None:
            head.append(f"feet_m = {_value(self.feet_m)}")
        if self.trunk_may_touch:
            head.append("trunk_may_touch = true")
        names = ("turn", "box", "total", "limits", "weights")
        tables = ((f"[{name}]", getattr(self, name)) for name in names)
        parts = ["\n".join(head)]
        parts += [_table(title, table) for title, table in tables if table is not None]
        parts += [_table("[[phase]]", phase) for phase in self.phases]
        return "\n\n".join(part for part in parts if part) + "\n"

    def task(self, robot: Robot | None = None, *, name: str = "jump") -> Task:
        """The task for a robot, A1 by default. Raises BadInput that names the key."""
        return Task.from_toml(self.toml(), robot, name=name)


def _table(title: str, table: object) -> str:
    """The keys of a table that are given; nothing where none is."""
    pairs = ((key.name, getattr(table, key.name)) for key in fields(table))  # type: ignore[arg-type]
    lines = [f"{name} = {_value(x)}" for name, x in pairs if x is not None]
    return "\n".join([title, *lines]) if lines else ""


def _value(x: object) -> str:
    """A value as TOML; numbers keep all their digits."""
    if isinstance(x, str):
        return json.dumps(x)
    if isinstance(x, Iterable):
        return f"[{', '.join(_value(y) for y in x)}]"
    if isinstance(x, int):
        return str(int(x))
    return repr(float(x))  # type: ignore[arg-type]
