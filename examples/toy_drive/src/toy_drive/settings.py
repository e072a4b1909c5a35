"""The toy drive in a robot file: `[links.NAME]`, its serial line, and `settings` of an axis, its motor."""

import math
from enum import StrEnum
from typing import Annotated

from firmware_bridge.robot.table import AxisTable, LineTable, Positive
from pydantic import Field


class ToyDriver(StrEnum):
    """The word of `driver` that chooses the family."""

    TOY_DRIVE = "toy-drive"


class ToyProduct(StrEnum):
    """The word of `device` that chooses the family's table of an axis."""

    TOY_1 = "toy-1"


class ToyLink(LineTable):
    """The line, and the device's watchdog."""

    driver: Annotated[ToyDriver, Field(strict=False)]
    watchdog_ms: Annotated[int, Field(ge=50, le=2_000)] = 250
    """The device stops by itself after this time without a request; as its switch is set."""

    @property
    def rate(self) -> int:
        """Bit rate of the line, bit/s."""
        return 115_200


class ToyAxis(AxisTable):
    """The motor."""

    device: Annotated[ToyProduct, Field(strict=False)]
    counts_per_turn: Annotated[int, Field(ge=4, le=100_000)]
    """Of the motor's shaft, all edges."""
    full_speed_rpm: Positive
    """Of the motor at full voltage, without load."""
    acceleration: Positive
    """With which the device changes its speed, in the axis's unit a second squared."""
    continuous_current_ma: Annotated[int, Field(ge=1, le=100_000)]
    peak_current_ma: Annotated[int, Field(ge=1, le=100_000)]

    @property
    def number(self) -> int:
        """1: each line has one device."""
        return 1

    @property
    def address(self) -> str:
        """The motor as text."""
        return "toy drive"

    def slowest_ramp(self, ratio: float) -> float:
        """Return the acceleration of the axis, whatever the gear of `ratio`."""
        del ratio
        return self.acceleration

    def cruise(self, ratio: float) -> float:
        """Return its top speed behind a gear of `ratio`; it goes to no position by itself."""
        return self.full_speed_rpm * math.tau / 60.0 / ratio
