"""A device family on the bench: how the emulated half of a robot's links of one family is built.

An entry in the group `firmware_bridge.emulated_families` names an `EmulatedFamily`. The `driver` of a link in
the robot file chooses the link's table, and this the family.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum, auto
from functools import cache
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol, TypeVar, runtime_checkable

from emulators.physics import Actuators, Motor, Physics
from emulators.servo.fmu_axes import PlantNeeds
from emulators.wires import CanWire, DatagramWire, SerialWire
from emulators.wires.adapter import Adapter
from emulators.world import Physics as WorldPhysics
from emulators.world import Wire
from firmware_bridge.node import Node
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Problem, RobotFileError
from firmware_bridge.robot.table import LinkTable
from firmware_bridge.units import Nanoseconds
from fmu.plant import FmuPlant

if TYPE_CHECKING:
    from emulators.bench.faults.kind import FaultKind
    from emulators.cli.emulate_robot import RobotOptions
    from emulators.cli.emulation import Emulation
    from emulators.new_drive import AxisDrive, AxisTable
    from firmware_bridge.runtime.ports import Port

GROUP: Final = "firmware_bridge.emulated_families"
_T = TypeVar("_T")


@dataclass(frozen=True, slots=True, kw_only=True)
class BuildOrder:
    """The robot whose devices are to be built, and for which surroundings."""

    robot: AnyRobot
    seed: int = 0
    realistic_latency: bool = False
    """True if devices take their published times to answer; otherwise they answer at once."""
    on_bench: bool = False
    """True if each link has one wire; on real ports a device may have several of its own."""
    on_lines: bool = True
    """False if devices with a bus of their own are on it alone, whatever the robot file has."""
    report: Callable[[str], None] | None = None
    """Take what a client has set up otherwise than it is mounted; None: no one looks at it."""
    options: tuple[object, ...] = ()
    """The families' own options, each of a class of its family."""

    def option(self, kind: type[_T]) -> _T | None:
        """Return the options of this class; None without any."""
        return next((one for one in self.options if isinstance(one, kind)), None)


class Trait(Enum):
    """What the devices of a family have, as far as faults care."""

    DRIVE = auto()
    """Each motor has a drive, with a supply and a processor of its own."""
    MOTOR = auto()
    """Motors hang on a board."""
    ENCODER = auto()
    """An encoder is at each motor."""


class Way(Enum):
    """Kinds of wires that a link may have."""

    BUS = auto()
    LINE = auto()
    DATAGRAMS = auto()


@dataclass(frozen=True, slots=True, eq=False)
class Station:
    """A device as a node, and the wires of its link that it joins, by the node's own names for them."""

    node: Node
    link: str
    on: Mapping[str, Way]


class Built(NamedTuple):
    """Devices by the names of their stations, and their actuators."""

    stations: Mapping[str, Station]
    actuators: Actuators


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """Devices that share one group of actuators, before there is a plant."""

    title: str
    """Description for messages."""
    needs: PlantNeeds
    build: Callable[[FmuPlant, bool], Built]
    """Constructor; True if they step the plant. RobotFileError, PlantError, StorageError, ServoError."""
    every: Nanoseconds
    """Period in which they step the plant; where others do, the longest time without them."""
    follows: bool = True
    """False if they always step the plant themselves."""


class Observed(NamedTuple):
    """Devices that only look at the plant, and the physics that shows it to them."""

    stations: Mapping[str, Station]
    physics: WorldPhysics


@dataclass(frozen=True, slots=True, eq=False)
class Devices:
    """The emulated half of a robot: its stations, their motors, and the plant below."""

    stations: Mapping[str, Station]
    actuated: Physics
    plant: FmuPlant
    physics: WorldPhysics
    """The physics to be advanced, observers of the plant included."""

    @property
    def axes(self) -> tuple[Motor, ...]:
        """Every motor."""
        return self.actuated.axes

    def nodes(self, kind: type[_T]) -> dict[str, _T]:
        """Return the devices of a class, by the names of their stations."""
        return {name: one.node for name, one in self.stations.items() if isinstance(one.node, kind)}

    def motors(self, kind: type[_T]) -> dict[str, _T]:
        """Return the motors of a class, by their axes."""
        return {axis.name: axis for axis in self.axes if isinstance(axis, kind)}


@dataclass(frozen=True, slots=True)
class LineRun:
    """Traffic of a serial line to the drives."""

    link: str
    """The link's name in the robot file."""
    protocol: str
    baud: int
    bytes: int
    """Number of bytes in both directions."""
    commands: int
    busy_percent: float
    """Share of the time in which a command was under way."""
    cycle_ms: float
    longest_cycle_ms: float
    """Longest time from the begin of a cycle to the end of its last command; above `cycle_ms` it was late."""
    late_cycles: int
    """Cycles that began before the samples of the one before were in."""
    i2c_percent: float | None = None
    """Share of the time in which a board's own bus to its shield was busy; None where no board is."""


@dataclass(frozen=True, slots=True)
class Lane:
    """One link of a replay: its kind, its wire, and a packet's duration on it."""

    kind: str
    """Kind of the link, as in `dissector.KINDS`."""
    wire: CanWire | SerialWire | DatagramWire
    duration: Callable[[Packet], Nanoseconds]


class BridgeLink(Protocol):
    """The bridge's end of a link, as `firmware_bridge.drivers.link_drivers.DeviceLink` has it."""

    name: str
    late: int
    """Cycles that began before the samples of the one before were in."""


@runtime_checkable
class TimedLink(BridgeLink, Protocol):
    """The bridge's end of a line that measures its cycles."""

    longest_cycle: Nanoseconds


@runtime_checkable
class CountedLink(TimedLink, Protocol):
    """The bridge's end of a line that counts its commands, too."""

    commands: int
    busy: Nanoseconds


class Line(Protocol):
    """A serial line of a robot, from the bridge's end to the device."""

    @property
    def wire(self) -> SerialWire | DatagramWire:
        """The wire between both."""

    @property
    def adapter(self) -> Adapter:
        """The bridge's place on the line; its plug can be pulled."""

    def lane(self, kind: str, player: str) -> Lane:
        """Return such a line for a replay, in which the station `player` has the place of the device."""

    def carried(self, robot: AnyRobot, duration: Nanoseconds, devices: Devices) -> LineRun:
        """Return what the line has carried in a run so long."""


class MakeLine(Protocol):
    """Constructor of a line."""

    def __call__(
        self, robot: AnyRobot, node: Node, link: BridgeLink, host: str, before: Line | None, /
    ) -> Line | None:
        """Put a node on the line of a link, under the name `host`; None where this link is no line.

        `before` is the line of a node that was: its wire, its plug and what it has carried go on.
        """


class CanBus(NamedTuple):
    """The CAN bus of a link."""

    bit_rate: int
    """In bit/s."""
    bridge_node: int
    """Node number of the bridge on it."""


def _no_bus(_robot: AnyRobot, _link: str) -> CanBus | None:
    return None


def _no_plans(_: BuildOrder) -> Sequence[Plan]:
    return ()


class Question(Protocol):
    """Request over a line that changes nothing, and the answer to it."""

    def begin(self) -> bytes:
        """Return the bytes that ask, from the beginning."""

    def receive(self, chunk: bytes) -> bytes:
        """Take bytes; return those to send."""

    @property
    def answered(self) -> bool:
        """True once the device has answered without an error."""


@dataclass(frozen=True, slots=True)
class Beside:
    """Observers beside a robot's other devices on real ports: their nodes, links, and what opens these."""

    members: Mapping[str, Node]
    links: Mapping[str, Mapping[str, str]]
    openers: Mapping[str, Callable[[], "Port"]]
    where: tuple[str, ...]
    """Their addresses, as text."""


def _kind_of(robot: AnyRobot, link: str) -> str:
    return robot.links[link].kind


def _silent(_node: Node, _link: str) -> None:
    """Report nothing."""


def _no_faults() -> "Sequence[FaultKind]":
    return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class EmulatedFamily:
    """The devices of one family, emulated."""

    links: tuple[type[LinkTable], ...]
    """Tables of the links that it emulates."""
    aliases: tuple[str, ...] = ()
    """Other words for its name, as `emulate` has them."""
    plans: Callable[[BuildOrder], Sequence[Plan]] = _no_plans
    """Devices that move the plant; RobotFileError."""
    sees: PlantNeeds = field(default_factory=PlantNeeds)
    """Variables of the plant that its observers use."""
    observe: Callable[[BuildOrder, FmuPlant, WorldPhysics], Observed] | None = None
    """Constructor of its observers; RobotFileError."""
    bus: Callable[[AnyRobot, str], CanBus | None] = _no_bus
    """A link's CAN bus; None without one."""
    line: MakeLine | None = None
    """Constructor of a link's serial line; None without one."""
    datagrams: bool = False
    """True if a link carries datagrams."""
    electric: bool = True
    """True if the plant has current and speed of each of its motors' shafts."""
    protocols: Callable[[AnyRobot, str], tuple[str, ...]] | None = None
    """Protocols of which a link's board speaks one, first that of the robot file; None without boards."""
    traits: frozenset[Trait] = frozenset()
    faults: "Callable[[], Sequence[FaultKind]]" = _no_faults
    """Return the kinds of faults that only its devices can have."""
    alone: Callable[[], AnyRobot] | None = None
    """Return a stand-in for the robot of a device that `emulate` runs alone; None where none is."""
    on_ports: "Callable[[AnyRobot, RobotOptions], Emulation] | None" = None
    """Make a robot of its devices for `emulate ROBOT`; None: each is on a serial line of its own."""
    spoken: Callable[[AnyRobot, str], str] = _kind_of
    """Describe for people what a device on a line speaks."""
    reports_to_console: Callable[[Node, str], None] = _silent
    """Let a device, by its link's name, report on the console what a real one shows to no one."""
    beside: Callable[[AnyRobot, Devices], Beside] | None = None
    """Return its observers for real ports; None without any."""
    axis_table: "Callable[[AxisDrive], AxisTable] | None" = None
    """Write its drive of one axis into a robot file, for `new`, or SpecificationError; None: it has none."""
    presence: Callable[[str, int], Question] | None = None
    """Ask the device of a number on a line in a protocol, which it has to answer; None where none has one."""
    questions: Mapping[str, tuple[bytes, bytes]] = field(default_factory=dict)
    """By the protocol of a line: a request that changes nothing, and the begin of its answer."""


@cache
def _loaded() -> tuple[Mapping[str, EmulatedFamily], tuple[str, ...]]:
    """Return the installed families by their names, and why others cannot be loaded."""
    found: dict[str, EmulatedFamily] = {}
    broken: list[str] = []
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        # One broken package must not hide the devices of the others.
        try:
            found[entry.name] = entry.load()
        except Exception as error:  # noqa: BLE001 - whatever a package raises
            broken.append(f"'{entry.name}' cannot be loaded: {type(error).__name__}: {error} ({entry.value})")
    return found, tuple(broken)


def families() -> Mapping[str, EmulatedFamily]:
    """Return the installed families by their names, in alphabetical order."""
    return _loaded()[0]


def family_of(robot: AnyRobot, link: str) -> EmulatedFamily:
    """Return the family of a link; RobotFileError where none of the installed ones emulates it."""
    table = robot.links[link]
    for family in families().values():
        if isinstance(table, family.links):
            return family
    missing = f"no installed package has a family for it ({GROUP})"
    problem = "; ".join((f"'{table.driver.value}' is not emulated: {missing}", *_loaded()[1]))
    raise RobotFileError(robot.name, Problem(f"links.{link}.driver", problem))


def families_of(robot: AnyRobot) -> tuple[EmulatedFamily, ...]:
    """Return the families of a robot, in the order of its links; RobotFileError."""
    found: list[EmulatedFamily] = []
    for link in robot.links:
        family = family_of(robot, link)
        if family not in found:
            found.append(family)
    return tuple(found)


class LinkWires:
    """The wires of a robot's links by the links' names; lines come with the bridge: see `MakeLine`."""

    def __init__(
        self, buses: Mapping[str, Wire], lines: Mapping[str, Line], datagrams: Mapping[str, Wire]
    ) -> None:
        self._buses, self._lines, self._datagrams = buses, lines, datagrams

    def of(self, station: Station) -> dict[str, Wire]:
        """Return the wires of a station by its own names for them."""
        return {own: self._wire(station.link, way) for own, way in station.on.items()}

    def _wire(self, link: str, way: Way) -> Wire:
        if way is Way.LINE:
            return self._lines[link].wire
        return (self._buses if way is Way.BUS else self._datagrams)[link]
