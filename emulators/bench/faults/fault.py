"""Common base of all faults: begin and end, the stations concerned, and how they are put on and taken off."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from enum import Enum
from typing import Annotated, ClassVar, Final, Self, TypeAlias

from numpy.random import Generator
from pydantic import Field, model_validator

from emulators.bench.faults.site import BRIDGE, Site
from emulators.family import Trait, family_of
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.problems import near
from firmware_bridge.robot.table import Medium, Table
from firmware_bridge.units import NEVER, Nanoseconds, from_seconds

NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Share = Annotated[float, Field(gt=0, le=1, description="affected share of the frames or datagrams")]
Node: TypeAlias = Annotated[str, Field(min_length=1)] | Annotated[int, Field(ge=1, le=127)]

Problem: TypeAlias = tuple[str, str]
"""A key, and what is wrong with it."""


class Stations(Enum):
    """Group of stations from which `node` chooses."""

    DRIVES = "a drive"
    ON_THE_BUS = "a node on the CAN bus"
    ALL = "a drive or the bridge"
    MOTORS = "a motor at a shield"
    ENCODERS = "a drive or a motor at a shield"
    NONE = "none"

    def of(self, robot: AnyRobot) -> list[str]:
        """Return their names; on the bus in the order in which they lie on the cable."""
        if self is Stations.NONE:
            return []
        if self is Stations.MOTORS:
            return with_trait(robot, Trait.MOTOR)
        if self is Stations.ENCODERS:
            return with_trait(robot, Trait.ENCODER)
        drives = with_trait(robot, Trait.DRIVE)
        on_can = any(link.medium is Medium.CAN for link in robot.links.values())
        bridge = (self is Stations.ALL and bool(drives)) or (self is Stations.ON_THE_BUS and on_can)
        return [BRIDGE, *drives] if bridge else drives


class Fault(Table, ABC):
    """One thing that goes wrong at one instant of a mission."""

    kind: ClassVar[str]
    """The field's name for it."""
    among: ClassVar[Stations] = Stations.DRIVES
    """Stations that its `node` may name, where it has one."""
    bench_only: ClassVar[str] = ""
    """Why no emulated device can bring it about on a real bus; empty where it can."""

    at_s: NonNegative
    title: Annotated[str, Field(max_length=100)] = ""

    @property
    def begin(self) -> Nanoseconds:
        """Time at which it is put on."""
        return from_seconds(self.at_s)

    @property
    def end(self) -> Nanoseconds:
        """Time at which it is taken off; NEVER: not in this run."""
        return self.begin

    def targets(self, robot: AnyRobot) -> frozenset[str]:
        """Return the names of those that it meets; all of them where it names none."""
        node = getattr(self, "node", None)
        # A node that the robot lacks stays as it is named: `problems` reports it.
        addressed = self.among.of(robot)
        return frozenset(addressed if node is None else [named(robot, node) or str(node)])

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Give what this robot lacks for it, key by key."""
        if self.among is not Stations.NONE and not self.among.of(robot):
            yield "kind", f"{robot.name} has not {self.among.value}"
        elif (node := getattr(self, "node", None)) is not None:
            yield from absent("node", node, self.among, robot)

    def real_bus_problem(self, robot: AnyRobot) -> str:
        """Return why this one is not possible on a real bus; empty where it is."""
        del robot
        return self.bench_only

    @abstractmethod
    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it begin, now; `chance` is its own."""

    def take_off(self, site: Site) -> None:
        """Let it end, now; what ends by itself needs nothing."""


class Lasting(Fault, ABC):
    """A fault that has an end: given as `until_s` or `for_s`; with neither it stays."""

    until_s: Annotated[Positive | None, Field(description="time of its end")] = None
    for_s: Annotated[Positive | None, Field(description="duration, instead of `until_s`")] = None

    @model_validator(mode="after")
    def _ends_after_it_begins(self) -> Self:
        if self.until_s is not None and self.for_s is not None:
            raise ValueError("until_s and for_s are alternatives: give one of them")
        if self.until_s is not None and self.until_s <= self.at_s:
            raise ValueError(f"until_s = {self.until_s:g} is not after at_s = {self.at_s:g}")
        return self

    @property
    def end(self) -> Nanoseconds:
        """Time at which it is taken off; NEVER: not in this run."""
        if self.for_s is not None:
            return self.begin + from_seconds(self.for_s)
        return NEVER if self.until_s is None else from_seconds(self.until_s)


class OnBus(Fault, ABC):
    """A fault on the bus of one link."""

    link: Annotated[
        str | None, Field(description="affected link; required with several links where no axis implies it")
    ] = None

    def on(self, robot: AnyRobot) -> str:
        """Return the link's name: the one given, that of the axis, or the robot's first."""
        if self.link is not None:
            return self.link
        name = named(robot, node) if (node := getattr(self, "node", None)) is not None else None
        return next((axis.link for axis in robot.axes if axis.name == name), next(iter(robot.links)))

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Give what this robot lacks for it, key by key."""
        yield from super().problems(robot)
        node = getattr(self, "node", None)
        buses = buses_of(robot)
        if not buses:
            yield "kind", f"{robot.name} has no CAN bus"
        elif self.link is not None and self.link not in buses:
            yield "link", f"{robot.name} has no bus '{self.link}'; {near(self.link, buses)}"
        elif self.link is None and len(robot.links) > 1 and named(robot, node or BRIDGE) == BRIDGE:
            yield "link", f"on which link? there are: {', '.join(robot.links)}"


def with_trait(robot: AnyRobot, trait: Trait) -> list[str]:
    """Return the axes whose devices have this."""
    having = {link for link in robot.links if trait in family_of(robot, link).traits}
    return [axis.name for axis in robot.axes if axis.link in having]


def buses_of(robot: AnyRobot) -> list[str]:
    """Return the links with a CAN bus, also one that a drive's serial port leads to."""
    return [link for link in robot.links if family_of(robot, link).bus(robot, link) is not None]


def named(robot: AnyRobot, node: str | int) -> str | None:
    """Return the name of a station that is given by name or number; None where the robot has none."""
    if node == BRIDGE:
        return BRIDGE
    for axis in robot.axes:
        if node in {axis.name, axis.settings.number}:
            return axis.name
    return None


def absent(key: str, node: str | int, among: Stations, robot: AnyRobot) -> Iterator[Problem]:
    """Give the problem with a node that is not there, or not among those that this fault can meet."""
    known = among.of(robot)
    name = named(robot, node)
    if name is None:
        yield key, f"{robot.name} has no node '{node}'; {near(str(node), known)}"
    elif name not in known:
        yield key, f"'{node}' is not {among.value}; {near(str(node), known)}"


CABLE_ORDER: Final = "the bridge, then the axes as the robot file lists them"
"""Order of the stations along the CAN cable (assumed, to be verified)."""
