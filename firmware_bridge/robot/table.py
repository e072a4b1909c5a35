"""The common part of all tables of a robot file."""

import math
from collections.abc import Mapping, Sequence
from enum import Enum, StrEnum
from typing import Annotated, Any, ClassVar, Protocol, Self

from pydantic import BaseModel, ConfigDict, Field

from firmware_bridge.units import MILLISECOND, Nanoseconds

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Unsigned16 = Annotated[int, Field(ge=0, le=0xFFFF)]
Signed16 = Annotated[int, Field(ge=-0x8000, le=0x7FFF)]
Unsigned32 = Annotated[int, Field(ge=0, le=0xFFFF_FFFF)]


class Table(BaseModel):
    """A table of a robot file: no unknown key, no value of another kind, nothing changed later."""

    # Strict: "0.1" is no number, so that a value with quotes is reported and not guessed.
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, str_strip_whitespace=True)


class Names(Enum):
    """What a key's text names."""

    SENSOR = "sensor"


SensorName = Annotated[str, Names.SENSOR]
"""The name of one of the robot's sensors; it is checked that there is one."""


class HasSettings(Protocol):
    """A row of a robot file with the table of its device."""

    @property
    def name(self) -> str:
        """The row's name."""

    @property
    def settings(self) -> Any:
        """The table of its device's family."""


class HasLinks(Protocol):
    """A robot, as far as its links go."""

    @property
    def links(self) -> Mapping[str, "LinkTable"]:
        """The links by their names."""


class HasAxes(Protocol):
    """A robot, as far as its axes go."""

    def axes_on(self, link: str) -> Sequence[Any]:
        """Return the axes on a link."""


class OdometryBounds(Table):
    """Odometry's error bounds where the robot is not seen; see `firmware_bridge.motion.captured`."""

    slips: Positive
    """The share of the way, and of the turn, by which odometry may be wrong."""
    lost_m: Positive
    """Odometry alone may be wrong by so much before the robot is lost."""
    slip_mps: Positive
    """So fast, in the mean of half a second, it may move otherwise than its wheels turn."""
    jump_m: Positive
    """Largest distance of an accepted captured pose from odometry's expectation."""
    jump_rad: Positive
    silent_ms: Annotated[int, Field(ge=10, le=10_000)]
    """A captured pose that is older does not show that the robot is seen."""

    @property
    def silent(self) -> Nanoseconds:
        """Age limit of a captured pose."""
        return self.silent_ms * MILLISECOND


class SettingsTable(Table):
    """The part of an axis, a sensor or an output that its device's family defines: `settings`."""

    VOLTAGE: ClassVar[bool] = False
    """True for a sensor that may measure a voltage, as the battery's."""

    @classmethod
    def of(cls, row: HasSettings) -> Self:
        """Return a row's own table; TypeError where a device of another family has it."""
        if not isinstance(row.settings, cls):
            raise TypeError(f"'{row.name}' has no {cls.__name__}, but a {type(row.settings).__name__}")
        return row.settings

    @property
    def locates(self) -> OdometryBounds | None:
        """Odometry's bounds, where it is a sensor by which the robot's pose is known; None for all others."""
        return None


class AxisTable(SettingsTable):
    """One motor at its device, whatever that is; a family adds `device`, whose words choose its table."""

    continuous_current_ma: int
    peak_current_ma: int

    @property
    def number(self) -> int:
        """The number by which the motor is called on its link."""
        raise NotImplementedError

    @property
    def address(self) -> str:
        """The motor as text."""
        raise NotImplementedError

    def slowest_ramp(self, ratio: float) -> float:
        """Return the gentlest of its accelerations in the axis's unit, behind a gear of `ratio`."""
        raise NotImplementedError

    def cruise(self, ratio: float) -> float:
        """Return the speed at which it goes to a position, behind a gear of `ratio`."""
        raise NotImplementedError

    def furthest(self, ratio: float) -> float:
        """Return how far from 0 a travel may go, with `ratio` rad for each unit."""
        del ratio
        return math.inf

    def profile_rpm(self) -> float:
        """Return the speed of the motor that its profile is made for; 0 where it has none."""
        return 0.0


class Medium(StrEnum):
    """The carrier of a link, by the port that opens it."""

    CAN = "can"
    SERIAL = "serial"
    UDP = "udp"


class LinkTable(Table):
    """A link to devices, whatever they are: `[links.NAME]`."""

    driver: StrEnum
    """The bridge's connection to the devices; it names their family."""
    every: Annotated[int, Field(ge=1, le=100)] = 1
    """The link's devices are sampled and commanded in each so many-th cycle of the robot."""
    silent_ms: Annotated[int, Field(ge=10, le=10_000)]
    """The bridge stops the robot after this silence of a device on the link."""
    stops: Annotated[tuple[str, ...] | None, Field(strict=False)] = None
    """The groups that stop when the link is lost, or an axis on it fails; the others go on. None for all."""

    @property
    def medium(self) -> Medium:
        """Its carrier, which this machine opens."""
        raise NotImplementedError

    @property
    def kind(self) -> str:
        """The kind of its packets, as a recording has them: see `firmware_bridge.dissector`."""
        return self.driver

    @property
    def rate(self) -> int:
        """Bit rate of the bus or the line, bit/s; 0 where it has none."""
        return 0

    @property
    def latency_us(self) -> int:
        """Longest time that this machine's serial port may keep received bytes."""
        return 0

    @property
    def place(self) -> str:
        """Where this machine listens, HOST:PORT, on a link whose place is in the robot file."""
        return ""

    @property
    def described(self) -> str:
        """Protocol and further devices behind its port, as text; empty for a bus."""
        return ""

    @property
    def silent_hint(self) -> str:
        """What to check where nothing was received on a line."""
        return ""

    @property
    def unwatched(self) -> str:
        """What its devices do when the bridge falls silent, as text; empty where they stop by themselves."""
        return ""

    @property
    def unwatched_remedy(self) -> str:
        """What gives them a watchdog."""
        return ""

    @property
    def accepts_unwatched(self) -> bool:
        """True where the robot file permits to drive them all the same."""
        return False

    @classmethod
    def all_of(cls, robot: HasLinks) -> dict[str, Self]:
        """Return a robot's links of this family, by their names."""
        return {name: link for name, link in robot.links.items() if isinstance(link, cls)}

    @classmethod
    def of_link(cls, robot: HasLinks, name: str) -> Self:
        """Return one link of a robot; KeyError, or TypeError where devices of another family are on it."""
        link = robot.links[name]
        if not isinstance(link, cls):
            raise TypeError(f"the link '{name}' has no {cls.__name__}, but a {type(link).__name__}")
        return link


class RequestTable(LinkTable):
    """A serial line whose devices answer each request: `[links.NAME]`."""

    port_latency_us: Annotated[int, Field(ge=0, le=20_000)] = 1_000
    """Longest time that this machine's port may keep received bytes."""
    answers_within_ms: Annotated[int, Field(ge=5, le=1_000)] = 60
    """Timeout of a request, after which it is sent again."""

    @property
    def medium(self) -> Medium:
        """A serial line."""
        return Medium.SERIAL

    @property
    def latency_us(self) -> int:
        """Longest time that this machine's port may keep received bytes."""
        return self.port_latency_us

    def confirmed(self, cycle: Nanoseconds) -> Nanoseconds:
        """Return the time for the confirmation of a stop stage; `cycle` is the robot's."""
        # A sample may have been requested before the command, and the next one may be lost.
        return 3 * self.every * cycle


class LineTable(RequestTable):
    """A serial line to one device that answers each request: `[links.NAME]`."""

    found_within_ms: Annotated[int, Field(ge=100, le=20_000)] = 5_000
    """From the first request to the first answer."""

    @property
    def silent_hint(self) -> str:
        """Power, port and rate of the device."""
        return f"nothing was received on the line at {self.rate} Bd: is the device on, and is it this port?"
