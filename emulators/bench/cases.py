"""Boundary cases of a robot's own rows: what just trips each one, and the nearest that it lets pass.

A robot's package declares them; the tests that every robot gets look whether each row has some, and holds.
"""

from typing import Final, Generic, TypeVar

from firmware_bridge.robot import AnyRobot

M = TypeVar("M")
S = TypeVar("S")


class Situation(Generic[M, S]):
    """What differs from a robot that is well, armed and at rest."""

    __slots__ = ("body", "demanded", "wish")

    def __init__(self, *, wish: M | None = None, body: S | None = None, demanded: M | None = None) -> None:
        self.wish: Final = wish
        """What the operator wants; None: to rest."""
        self.body: Final = body
        """What is known of the body; None: what axes at their zero tell."""
        self.demanded: Final = demanded
        """What the bridge asks for already; None: for rest."""


class Case(Generic[M, S]):
    """One way to trip one row, and the nearest way that does not."""

    __slots__ = ("reason", "robot", "row", "spares", "trips")

    def __init__(
        self,
        row: str,
        *,
        trips: Situation[M, S],
        spares: Situation[M, S],
        reason: str,
        robot: AnyRobot | None = None,
    ) -> None:
        self.row: Final = row
        """The interlock's or the limit's name."""
        self.trips: Final = trips
        self.spares: Final = spares
        self.reason: Final = reason
        """What is said then, with the numbers."""
        self.robot: Final = robot
        """One with other numbers, where those of the robot file never trip the row; None for the file's."""
