"""The reference of an axis: `[axes.zero]` in a robot file."""

from collections.abc import Mapping
from enum import StrEnum
from types import MappingProxyType
from typing import Annotated, Final, NamedTuple, Self

from pydantic import Field, field_validator, model_validator

from firmware_bridge.robot.table import Finite, Name, Positive, Table


class ZeroFrom(StrEnum):
    """Source of an axis' reference."""

    CONFIRM = "confirm"
    """The station in control confirms its position by sight; before, and after each restart of its drive."""
    HOME = "home"
    """It is homed to a switch, a stop or its encoder's index; the station in control may confirm it, too."""
    AT_POWER_ON = "at power-on"
    """It is 0 where its drive was switched on; only where a wrong zero does no harm, as with wheels."""


class Switch(StrEnum):
    """Switch at the drive for a homing."""

    NEGATIVE_LIMIT = "negative_limit"
    POSITIVE_LIMIT = "positive_limit"
    HOME = "home"


class Method(NamedTuple):
    """The reference of a homing method."""

    switch: Switch | None = None
    by_stop: bool = False
    """A mechanical stop, felt by the current."""
    by_index: bool = False
    """The encoder's, at last."""


METHODS: Final[Mapping[int, Method]] = MappingProxyType(
    {
        -4: Method(by_stop=True),
        -3: Method(by_stop=True),
        -2: Method(by_stop=True, by_index=True),
        -1: Method(by_stop=True, by_index=True),
        1: Method(Switch.NEGATIVE_LIMIT, by_index=True),
        2: Method(Switch.POSITIVE_LIMIT, by_index=True),
        7: Method(Switch.HOME, by_index=True),
        11: Method(Switch.HOME, by_index=True),
        17: Method(Switch.NEGATIVE_LIMIT),
        18: Method(Switch.POSITIVE_LIMIT),
        23: Method(Switch.HOME),
        27: Method(Switch.HOME),
        33: Method(by_index=True),
        34: Method(by_index=True),
    }
)
"""The ways of homing by their numbers in 0x6098 (CiA 402; below 0 maxon's). 35, which confirms, is none."""


class Homing(Table):
    """Homing of an axis: in its unit behind the gear, positive as the axis is."""

    method: int
    """The drive's own number: its negative direction is the drive's, before the axis's `direction`."""
    speed: Positive
    """In a second: towards switch or stop, and along `offset`."""
    zero_speed: Positive
    """In a second: off the switch, and towards the index."""
    acceleration: Positive
    """In a second squared; with it an interrupted homing is halted, too."""
    offset: Finite = 0.0
    """Distance of the axis' travel from the reference found."""
    at: Finite = 0.0
    """Position of the axis after that."""
    current_a: Positive | None = None
    """Of a method by a stop: more than this is the stop."""
    within_s: Annotated[float, Field(gt=0, le=600, allow_inf_nan=False)]
    after: Annotated[tuple[Name, ...], Field(strict=False)] = ()
    """Axes whose zero must be known first, as what they stand at decides whether this one may move."""

    @field_validator("method")
    @classmethod
    def _is_known(cls, method: int) -> int:
        if method not in METHODS:
            raise ValueError(f"must be one of {', '.join(map(str, METHODS))}")
        return method

    @model_validator(mode="after")
    def _feels_its_stop(self) -> Self:
        # `is not` of two truths: exactly the methods by a stop need a current.
        if METHODS[self.method].by_stop is not (self.current_a is not None):
            needs = "needs" if self.current_a is None else "goes by no stop and takes no"
            raise ValueError(f"method {self.method} {needs} current_a")
        return self

    @property
    def goes_by(self) -> Method:
        """The reference of its method."""
        return METHODS[self.method]

    @property
    def fastest(self) -> float:
        """The higher of its speeds."""
        return max(self.speed, self.zero_speed)

    def furthest(self, travel: tuple[float, float], turn: float) -> float:
        """Return the longest way from end to end: its travel, the offset, and a `turn` to the index."""
        # The index lies within one turn of the reference that was found before.
        return travel[1] - travel[0] + abs(self.offset) + (turn if self.goes_by.by_index else 0.0)

    def lasts_s(self, travel: tuple[float, float], turn: float) -> float:
        """Return how long it takes from the far end of the travel, ramps left out."""
        goes_by = self.goes_by
        # Methods 33 and 34 look for the index alone, which is less than a turn away.
        seeks = travel[1] - travel[0] if goes_by.switch is not None or goes_by.by_stop else 0.0
        to_index = turn / self.zero_speed if goes_by.by_index else 0.0
        return (seeks + abs(self.offset)) / self.speed + to_index


class Zero(Table):
    """The reference of an axis; without it an axis with `travel` is confirmed, others need nothing."""

    how: Annotated[ZeroFrom | None, Field(strict=False)] = None
    homing: Homing | None = None

    @model_validator(mode="after")
    def _has_a_homing_method(self) -> Self:
        if (self.how is ZeroFrom.HOME) is not (self.homing is not None):
            raise ValueError("how = 'home' and the table homing, method and speeds, need each other")
        return self
