"""The board of an AR2 arm in a robot file: its serial line, and one joint at its stepper motor.

Sources: Chris-Annin/AR2, AR2_2.0 for the rate, joints and steps; the times are this project's choice.
"""

import math
from enum import StrEnum
from typing import Annotated, Final

from pydantic import Field

from firmware_bridge.robot.table import AxisTable, Finite, Positive, RequestTable
from firmware_bridge.units import MILLISECOND, Nanoseconds

STEPS_PER_TURN: Final = 400
"""Of each motor: half steps."""
CURRENT_MA: Final = 2_000
"""Current of such motors' drivers: order of magnitude; it is not measured."""


class Ar2Driver(StrEnum):
    """The bridge's connection to the joints."""

    AR2 = "ar2"


class Ar2Firmware(StrEnum):
    """The board's firmware. 1.5 has no TM, by which the end of a move is proved."""

    AR2_2_0 = "ar2-2.0"


class Ar2Device(StrEnum):
    """The actuator of the joint."""

    STEPPER = "ar2-stepper"


class Ar2Link(RequestTable):
    """The serial line to the board, and the times of its moves."""

    driver: Annotated[Ar2Driver, Field(strict=False)]
    protocol: Annotated[Ar2Firmware, Field(strict=False)] = Ar2Firmware.AR2_2_0
    answers_within_ms: Annotated[int, Field(ge=5, le=1_000)] = 60
    """A question that has no answer by then, and by the end of a move, is given up."""
    boots_ms: Annotated[int, Field(ge=0, le=10_000)] = 1_200
    """Silence after a reset: a byte in its first second keeps a Mega's boot loader."""
    boots_within_ms: Annotated[int, Field(ge=100, le=20_000)] = 5_000
    """From a reset, which opening the port may be, to the first answer."""
    move_ms: Annotated[int, Field(ge=10, le=100)] = 60
    """The longest that one move may last: once it is sent nothing stops it but a reset."""

    @property
    def kind(self) -> str:
        """The firmware's protocol."""
        return self.protocol

    @property
    def rate(self) -> int:
        """Bit rate of the line, bit/s."""
        return 115_200

    @property
    def silent_hint(self) -> str:
        """Power and firmware of the board."""
        return (
            f"nothing was received on the line at {self.rate} Bd: is the board on, and was it flashed with "
            "AR2 2.0?"
        )

    @property
    def move(self) -> Nanoseconds:
        """The longest move."""
        return self.move_ms * MILLISECOND


class Ar2Axis(AxisTable):
    """One joint: its motor counts steps from one end of its way."""

    joint: Annotated[int, Field(ge=1, le=6)]
    """J1 to J6, the letters A to F."""
    device: Annotated[Ar2Device, Field(strict=False)]
    motor: str
    counts_from_deg: Finite
    """The joint's angle where its steps are 0: its lower limit, as the GUI counts."""
    full_steps_s: Positive = 500.0
    """The motor is not stepped faster, whatever it carries: it loses steps where it is too weak."""
    continuous_current_ma: Annotated[int, Field(ge=1, le=100_000)] = CURRENT_MA
    peak_current_ma: Annotated[int, Field(ge=1, le=100_000)] = CURRENT_MA

    @property
    def number(self) -> int:
        """The number by which the joint is called on its link."""
        return self.joint

    @property
    def address(self) -> str:
        """The joint as text."""
        return f"joint J{self.joint}"

    @property
    def origin(self) -> float:
        """The joint's angle in rad where its steps are 0."""
        return math.radians(self.counts_from_deg)

    def steps_per_unit(self, ratio: float) -> float:
        """Return the steps for each rad of the joint behind a gear of `ratio`."""
        return STEPS_PER_TURN * ratio / math.tau

    def slowest_ramp(self, ratio: float) -> float:
        """Return the gentlest acceleration of the joint: its steps begin at once."""
        return self.cruise(ratio) / 0.1

    def cruise(self, ratio: float) -> float:
        """Return its top speed behind a gear of `ratio`, rad/s."""
        # Two half steps for each full step.
        return 2.0 * self.full_steps_s / self.steps_per_unit(ratio)

    def furthest(self, ratio: float) -> float:
        """Return how far from 0 a travel may go: the bridge counts, and a move is short."""
        del ratio
        return math.inf
