"""The common properties of every interlock and limit, which its interlock events carry."""

from enum import IntEnum
from typing import Final

from firmware_bridge.immutable import Immutable
from firmware_bridge.units import Nanoseconds

ALL_GROUPS: Final[frozenset[str] | None] = None


class Severity(IntEnum):
    """Severity of an interlock event's report: MAV_SEVERITY, after RFC 5424."""

    EMERGENCY = 0
    ALERT = 1
    CRITICAL = 2
    ERROR = 3
    WARNING = 4
    NOTICE = 5
    INFO = 6
    DEBUG = 7


class InterlockBase(Immutable):
    """An interlock's name, its remedy, and everything that follows while it is active."""

    __slots__ = (
        "blocks_arming",
        "clear_after",
        "disables_power",
        "disarms",
        "latches",
        "name",
        "parts",
        "remedy",
        "severity",
        "stops",
    )  # fmt: skip

    def __init__(
        self,
        name: str,
        remedy: str,
        *,
        stops: frozenset[str] | None = ALL_GROUPS,
        clear_after: Nanoseconds = 0,
        severity: Severity = Severity.WARNING,
        disarms: bool = False,
        blocks_arming: bool = True,
        latches: bool = False,
        parts: bool = False,
        disables_power: bool = False,
    ) -> None:
        self.name: Final = name
        self.remedy: Final = remedy
        """The operator's action that clears it."""
        self.stops: Final = stops
        """The groups that stop while it holds; None for all of the robot."""
        self.clear_after: Final = clear_after
        """Release delay: how long it must be clear at every evaluation before it clears."""
        self.severity: Final = severity
        self.disarms: Final = disarms
        """It removes motion permission: to go on, arm again."""
        # What was armed would be disarmed by the next look.
        self.blocks_arming: Final = blocks_arming or disarms or latches
        """While it holds the robot cannot be armed."""
        self.latches: Final = latches
        """It latches the emergency stop, which stays until it is cleared by an order."""
        self.parts: Final = parts
        """It forgets the operator's targets, and requires neutral controls before they count again."""
        self.disables_power: Final = disables_power
        """Its axis loses its power until arming gives it back: an untrusted axis cannot ramp."""
