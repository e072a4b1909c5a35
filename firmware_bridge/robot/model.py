"""The whole robot file: the tables of any robot, its links, axes, sensors, outputs, and its type's own."""

import math
from collections.abc import Mapping
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, Final, Generic, Self, TypeAlias, TypeVar

from pydantic import ConfigDict, Field, field_validator, model_validator

from firmware_bridge.robot.family_tables import FamilyTable
from firmware_bridge.robot.guard_table import GuardTable
from firmware_bridge.robot.operator_link import OperatorLink
from firmware_bridge.robot.plausibility import RUBS, STANDSTILL, Plausibility
from firmware_bridge.robot.table import (
    AxisTable,
    Finite,
    LinkTable,
    Name,
    OdometryBounds,
    Positive,
    SettingsTable,
    Table,
)
from firmware_bridge.robot.zero import Homing, Zero, ZeroFrom
from firmware_bridge.units import MILLISECOND, RPM_PER_RAD_S, Nanoseconds

G_co = TypeVar("G_co", bound=Table, covariant=True)

AnyLink: TypeAlias = Annotated[LinkTable, FamilyTable("link")]
AnyAxis: TypeAlias = Annotated[AxisTable, FamilyTable("axis")]
AnySensor: TypeAlias = Annotated[SettingsTable, FamilyTable("sensor")]
AnyOutput: TypeAlias = Annotated[SettingsTable, FamilyTable("output")]
"""One table for each family of devices that is installed."""

MILLIAMPERES: Final = 1000.0


LATER: Final = ConfigDict(defer_build=True)
"""The families that are installed import this module: they are looked for when the first file is read."""


class CommandForm(StrEnum):
    """The command form of an axis."""

    SPEED = "speed"
    POSITION = "position"


class Unit(StrEnum):
    """Of an axis behind its gear."""

    RADIAN = "rad"
    METRE = "m"


class Unpowered(StrEnum):
    """Effect of power loss on an axis at standstill."""

    HOLDS = "holds"
    """It stays: its gear locks itself."""
    FREE = "free"
    """Only its device keeps it from moving."""


class Axis(Table):
    """One axis: what moves, how far and how fast it may, and the device that moves it."""

    model_config = LATER

    name: Name
    title: str
    role: Name
    """Its role in its robot type; without one, its name."""
    link: Name
    command: Annotated[CommandForm, Field(strict=False)]
    unit: Annotated[Unit, Field(strict=False)] = Unit.RADIAN
    """Of all that follows: position behind the gear."""
    travel: Annotated[tuple[Finite, Finite], Field(strict=False)] | None = None
    """The lowest and the highest position; needed where the axis is commanded by position."""
    top_speed: Positive
    """In `unit` a second, to both sides."""
    ratio: Positive
    """Radians of the motor for each `unit`."""
    direction: Annotated[int, Field(ge=-1, le=1)] = 1
    zero: Zero = Zero()
    unpowered: Annotated[Unpowered, Field(strict=False)] = Unpowered.FREE
    """Effect of power loss at standstill; a free axis keeps its power on a slope."""
    standstill_group: Name | None = None
    """A name that free axes on one floor share.

    The floor may strain them against each other: the sum of their currents reveals a slope. An axis without a
    name is judged alone.
    """
    plausibility: Plausibility = Plausibility()
    settings: AnyAxis

    @model_validator(mode="before")
    @classmethod
    def _its_name_is_its_role(cls, table: object) -> object:
        return {"role": table["name"], **table} if isinstance(table, dict) and "name" in table else table

    @field_validator("direction")
    @classmethod
    def _has_a_sign(cls, direction: int) -> int:
        if direction == 0:
            raise ValueError("must be 1 or -1")
        return direction

    @field_validator("travel")
    @classmethod
    def _rises(cls, travel: tuple[float, float] | None) -> tuple[float, float] | None:
        if travel is not None and travel[0] >= travel[1]:
            raise ValueError("must rise from the lowest to the highest position")
        return travel

    @model_validator(mode="after")
    def _makes_sense(self) -> Self:
        if self.travel is None and self.command is CommandForm.POSITION:
            raise ValueError("an axis that is commanded by position needs travel = [lowest, highest]")
        if self.travel is not None and self.zero.how is ZeroFrom.AT_POWER_ON:
            raise ValueError("an axis with travel takes no zero 'at power-on': it may stand anywhere then")
        if self.travel is None and self.zero.how is ZeroFrom.CONFIRM:
            raise ValueError("an axis without travel has no place to confirm; leave zero out")
        self._homes_within(self.zero.homing)
        # A counter that runs over its 32 bits would put the axis at the other end.
        furthest = self.settings.furthest(self.ratio)
        if self.travel is not None and max(map(abs, self.travel)) > furthest:
            raise ValueError(f"travel goes beyond {furthest:.6g} {self.unit}, all that the drive can count")
        return self

    def _homes_within(self, homing: Homing | None) -> None:
        """Check a homing against the axis; ValueError where the axis cannot do it."""
        if homing is None:
            return
        if self.travel is None:
            raise ValueError("an axis without travel has no place to be homed to; leave zero out")
        low, high = self.travel
        # The drive takes whole rpm: a homing speed below 1 rpm would be 0.
        lowest = 1.0 / RPM_PER_RAD_S / self.ratio
        slowest = min(homing.speed, homing.zero_speed, homing.acceleration)
        threshold_ma = (homing.current_a or 0.0) * MILLIAMPERES
        lasts = homing.lasts_s(self.travel, self.motor_turn)
        for wrong, problem in (
            (
                homing.fastest > self.top_speed,
                f"goes with {homing.fastest:g}, top_speed is {self.top_speed:g}",
            ),
            (slowest < lowest, f"has {slowest:g} where 1 rpm of the motor is {lowest:.4g}"),
            (not low <= homing.at <= high, f"ends at {homing.at:g}, which is not within travel"),
            (abs(homing.offset) > high - low, "has an offset longer than travel"),
            (
                threshold_ma > self.settings.peak_current_ma,
                "waits for more current_a than the drive may give",
            ),
            (homing.within_s < lasts, f"lasts {lasts:.3g} s from end to end, within_s is less"),
        ):
            if wrong:
                raise ValueError(f"zero.homing {problem}")

    @property
    def motor_turn(self) -> float:
        """The way in its unit for one turn of the motor, from one index to the next."""
        return math.tau / self.ratio

    @property
    def needs_confirmation(self) -> bool:
        """True where it needs confirmation of its position, or homing, before it may move."""
        return self.travel is not None

    @property
    def standstill_below(self) -> float:
        """The speed in its unit a second at which it does not stand any more."""
        return self.plausibility.standstill_below or STANDSTILL * self.top_speed

    @property
    def holds_with(self) -> float:
        """The current in A above which it does not only stand."""
        return self.plausibility.holds_with or self.settings.continuous_current_ma / MILLIAMPERES

    @property
    def friction(self) -> float:
        """The current in A that friction alone may hold, where the axis stands."""
        return self.plausibility.friction or RUBS * self.settings.continuous_current_ma / MILLIAMPERES

    @property
    def called(self) -> str:
        """The axis as text for people, with its device."""
        return f"{self.settings.address} ({self.title})"


class Sensor(Table):
    """One sensor beside the axes, on one of their links."""

    model_config = LATER

    name: Name
    title: str
    link: Name
    every_ms: Annotated[int, Field(ge=10, le=60_000)]
    """Period of its requests."""
    silent_ms: Annotated[int, Field(ge=10, le=600_000)]
    """After this silence its value is not known any more."""
    settings: AnySensor


class Output(Table):
    """Something that is switched: a lamp, a relay, a magnet."""

    model_config = LATER

    name: Name
    title: str
    link: Name
    settings: AnyOutput


class Battery(Table):
    """The sensor of the battery's voltage, and the threshold of a low one; V."""

    sensor: Name
    nominal_v: Positive
    low_v: Positive
    stops_after_s: Positive = 10.0
    """So long it may be low before the robot stops; the current of a start lowers it for less."""

    @model_validator(mode="after")
    def _low_is_below_nominal(self) -> Self:
        if self.low_v >= self.nominal_v:
            raise ValueError("low_v must be below nominal_v")
        return self


class PlantFile(Table):
    """The simulated robot: which FMU, which of its named parameter sets, and single values that differ."""

    fmu: str
    parameter_set: str | None = None
    parameters: dict[str, float] = Field(default_factory=dict)


class Robot(Table, Generic[G_co]):
    """A whole robot file, checked; `G_co` is its kind's table of geometry and limits."""

    model_config = LATER

    name: Name
    kind: Name
    """Its robot type; without it, that of its name."""
    title: str
    source: str
    cycle_ms: Annotated[int, Field(ge=5, le=1000)]
    links: Annotated[dict[Name, AnyLink], Field(min_length=1)]
    geometry: G_co
    operator: OperatorLink
    battery: Battery | None = None
    guard: GuardTable = GuardTable()
    plant: PlantFile
    axes: Annotated[tuple[Axis, ...], Field(min_length=1, strict=False)]
    sensors: Annotated[tuple[Sensor, ...], Field(strict=False)] = ()
    outputs: Annotated[tuple[Output, ...], Field(strict=False)] = ()

    @property
    def cycle(self) -> Nanoseconds:
        """The time from one set-point to the next."""
        return self.cycle_ms * MILLISECOND

    @property
    def silent_after(self) -> dict[str, Nanoseconds]:
        """Timeouts of the devices, by the axes' names."""
        return {axis.name: self.links[axis.link].silent_ms * MILLISECOND for axis in self.axes}

    def axis(self, role: str) -> Axis:
        """Return the axis with this role; KeyError where the robot has none."""
        for axis in self.axes:
            if axis.role == role:
                return axis
        raise KeyError(role)

    def axes_on(self, link: str) -> tuple[Axis, ...]:
        """Return the axes whose devices are on this link, in the file's order."""
        return tuple(axis for axis in self.axes if axis.link == link)

    @property
    def located_by(self) -> tuple[str, OdometryBounds] | None:
        """The sensor by which the robot's pose is known, and how far without it; None: by odometry alone."""
        for sensor in self.sensors:
            if sensor.settings.locates is not None:
                return sensor.name, sensor.settings.locates
        return None

    def discriminated_by(self, bandwidth_bit_s: int | None) -> Self:
        """Return the same robot on an operator's link of this bandwidth; None: the robot file's."""
        if bandwidth_bit_s is None:
            return self
        operator = self.operator.model_copy(update={"bandwidth_bit_s": bandwidth_bit_s})
        return self.model_copy(update={"operator": operator})

    def agreed_on(self, max_delay_s: float | None) -> Self:
        """Return the same robot in a session with commands of this age; None: the robot file's limit.

        RobotFileError above the file's ceiling.
        """
        if max_delay_s is None:
            return self
        operator = self.operator.agreed_on(max_delay_s, self.name)
        return self.model_copy(update={"operator": operator})

    def with_links(self, links: Mapping[str, AnyLink]) -> Self:
        """Return the same robot with these links in the place of those of the same name."""
        return self.model_copy(update={"links": {**self.links, **links}})


if TYPE_CHECKING:
    AnyRobot: TypeAlias = Robot[Any]
else:
    # Naming its parameter would make the schema here, before there are families.
    AnyRobot = Robot
