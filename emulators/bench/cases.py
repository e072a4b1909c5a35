"""Boundary cases of a robot's own interlocks: what just trips each one, and the nearest that it lets pass.

A robot's package declares them; the inherited tests check that each interlock has some, and acts.
They have no slots: a frozen generic class with slots cannot be called by a subscripted name (CPython 90562).
"""

from dataclasses import KW_ONLY, dataclass
from typing import Generic, TypeVar

from firmware_bridge import renamed
from firmware_bridge.motion.captured import Located
from firmware_bridge.robot import AnyRobot

M = TypeVar("M")
S = TypeVar("S")


@renamed.arguments(demanded="commanded", wish="command")
@dataclass(frozen=True, kw_only=True)
class Situation(Generic[M, S]):
    """Differences from a robot that is well, armed and at standstill."""

    command: M | None = None
    """The operator's command; None: standstill."""
    body: S | None = None
    """The known state of the kinematic model; None: that of axes at their zero."""
    commanded: M | None = None
    """The bridge's present set-point; None: for standstill."""
    located: Located | None = None
    """Quality of its localization by cameras; None: there are none."""


@renamed.arguments(row="interlock")
@dataclass(frozen=True)
class Case(Generic[M, S]):
    """One way to trip one interlock or limit, and the nearest way that does not."""

    interlock: str
    """The interlock's or the limit's name."""
    _: KW_ONLY
    trips: Situation[M, S]
    spares: Situation[M, S]
    reason: str
    """The reported reason, with its numbers."""
    robot: AnyRobot | None = None
    """One with other numbers, where those of the robot file never trip it; None for the file's."""

    @property
    def row(self) -> str:
        """The old name of `interlock`."""
        renamed.warn("row", "interlock", "Case")
        return self.interlock
