"""What can go wrong, as exceptions; each names the culprit."""

from __future__ import annotations

from collections.abc import Sequence


class Error(Exception):
    """Whatever Saltus raises of its own."""


class BadInput(Error, ValueError):
    """A file, a value or an array that cannot be used: the text names it and says what it must be."""


class NoPlan(Error):
    """There is no plan."""

    because: str
    """What blocks."""
    relaxations: list[str]
    """Changes with which there would be a plan, each on its own."""

    def __init__(self, text: str, because: str = "", relaxations: Sequence[str] = ()) -> None:
        """With the text for people, and its parts."""
        super().__init__(text)
        self.because = because
        self.relaxations = list(relaxations)


class Infeasible(NoPlan):
    """No plan can exist: a bound in closed form proves it, and the text says which."""


class NotFound(NoPlan):
    """The solver ended without a plan, which proves nothing."""


class AuditFailed(NoPlan):
    """A plan was found, and its audit refuses it."""


class OutOfTime(NoPlan):
    """The time that was given ended before the solver did: the text says what stood in the way then."""


class Refused(Error):
    """The machine does not begin the jump; the robot goes on standing."""
