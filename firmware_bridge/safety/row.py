"""What every row of the safety tables says of the hold that it makes, whatever it judges."""

from enum import IntEnum
from typing import Final

from firmware_bridge.immutable import Immutable
from firmware_bridge.units import Nanoseconds

ALL_GROUPS: Final[frozenset[str] | None] = None


class Severity(IntEnum):
    """How loud a hold is told: MAV_SEVERITY, after RFC 5424."""

    EMERGENCY = 0
    ALERT = 1
    CRITICAL = 2
    ERROR = 3
    WARNING = 4
    NOTICE = 5
    INFO = 6
    DEBUG = 7


class Row(Immutable):
    """A row's name, its remedy, and everything that follows while it holds."""

    __slots__ = (
        "blocks_arming", "clear_after", "disarms", "latches", "name", "parts", "remedy", "severity", "stops",
        "takes_power",
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
        takes_power: bool = False,
    ) -> None:
        self.name: Final = name
        self.remedy: Final = remedy
        """What to do so that it lets go."""
        self.stops: Final = stops
        """The groups that stop while it holds; None for all of the robot."""
        self.clear_after: Final = clear_after
        """How long it must be clear at every look before it lets go."""
        self.severity: Final = severity
        self.disarms: Final = disarms
        """It takes the leave to move away: to go on, arm again."""
        # What was armed would be disarmed by the next look.
        self.blocks_arming: Final = blocks_arming or disarms or latches
        """While it holds the robot cannot be armed."""
        self.latches: Final = latches
        """It latches the emergency stop, which stays until it is cleared by an order."""
        self.parts: Final = parts
        """It parts the operator from the robot: his targets are forgotten, and his controls count again when
        they have been let go."""
        self.takes_power: Final = takes_power
        """Its axis loses its power until arming gives it back: what is not believed cannot ramp."""
