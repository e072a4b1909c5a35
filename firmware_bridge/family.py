"""A family of devices on the bridge's side: all that the bridge knows of it, as one value.

A family is a package with an entry point in the group `firmware_bridge.families`, which names its `Family`.
Nothing outside that package knows the family by name: a robot file's `driver` chooses it.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from firmware_bridge.dissector.dictionary import Dictionary
    from firmware_bridge.dissector.expected import Expected
    from firmware_bridge.dissector.protocols import Protocols
    from firmware_bridge.drivers.driver import Reports
    from firmware_bridge.drivers.link_drivers import LinkDrivers
    from firmware_bridge.drivers.stop_stages import StopStage
    from firmware_bridge.node import Node
    from firmware_bridge.robot import AnyRobot, Axis, Problem
    from firmware_bridge.robot.table import AxisTable, LinkTable, SettingsTable
    from firmware_bridge.safety.guard.wire_rules import WireRules

GROUP: Final = "firmware_bridge.families"


@dataclass(frozen=True, slots=True)
class LinkOptions:
    """A command's options of a robot's links; None: as in the robot file."""

    protocol: str | None = None
    """Protocol of a serial line, or firmware of a board."""
    baud: int | None = None
    """Bit rate of a serial line, bit/s."""
    encoders: int | None = None
    """Number of encoders that a board reads."""
    lines: tuple[str, ...] = ()
    """Names of the links that are at a serial port of this machine."""

    @property
    def given(self) -> frozenset[str]:
        """The names of the options that are given."""
        return frozenset(name for name in ("protocol", "baud", "encoders") if getattr(self, name) is not None)


def _consistent(_table: Mapping[str, Any]) -> "Iterator[Problem]":
    """Yield nothing: a family without a check of its own."""
    return iter(())


def _nothing_moves(_robot: "AnyRobot", _axis: "Axis") -> "tuple[StopStage, ...]":
    """Return no stop stage: the family has no axis."""
    return ()


def _no_reports(_robot: "AnyRobot", _axis: "Axis") -> "frozenset[Reports]":
    """Return no report: the family has no axis."""
    return frozenset()


def _as_it_is(robot: "AnyRobot", _options: LinkOptions) -> "AnyRobot":
    """Return the robot: the family takes no option."""
    return robot


def _complete(robot: "AnyRobot") -> "AnyRobot":
    """Return the robot: nothing is missing."""
    return robot


def _at_the_end(node: "Node", _link: "LinkTable", _name: str) -> "Node":
    """Return the node: its packets are those of the wire."""
    return node


def _no_nodes(_robot: "AnyRobot", _link: str) -> "Iterator[Expected]":
    """Yield nothing: no CANopen is on such a link."""
    return iter(())


def _named(robot: "AnyRobot", link: str) -> str:
    """Return a link's name, driver and cycle."""
    table = robot.links[link]
    return f"{link}: {table.driver}, every {table.every * robot.cycle_ms} ms"


def _nothing_to_stop(_robot: "AnyRobot", _link: str) -> str:
    """Return no text: nothing moves on such a link."""
    return ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """One family: its tables in a robot file, its drivers, and the guard's rules for its links."""

    name: str
    title: str
    """What it is, for people."""
    link: "type[LinkTable]"
    """The table `[links.NAME]`; the words of its `driver` are the family's."""
    axis: "type[AxisTable] | None" = None
    """The table `settings` of an axis; None: it moves nothing."""
    sensor: "type[SettingsTable] | None" = None
    output: "type[SettingsTable] | None" = None
    check: "Callable[[Mapping[str, Any]], Iterator[Problem]]" = _consistent
    """Yield what is wrong in a robot file beyond single keys, from its raw table."""
    link_drivers: "Callable[[AnyRobot, str], LinkDrivers]"
    """Make the drivers of a link by its name; RobotFileError or ValueError where its cycle does not fit."""
    reports: "Callable[[AnyRobot, Axis], frozenset[Reports]]" = _no_reports
    """Return the reports of an axis's device, before there is a driver."""
    stop_stages: "Callable[[AnyRobot, Axis], tuple[StopStage, ...]]" = _nothing_moves
    confirmed_by: str = ""
    """The device's report that confirms a stop, for people."""
    alone: "Callable[[AnyRobot, str], str]" = _nothing_to_stop
    """Return what stops the devices of a link without the bridge, for people; empty where nothing does."""
    wire_rules: "Callable[[AnyRobot, str], WireRules]"
    """Make the guard's rules of a link by its name."""
    line_end: "Callable[[Node, LinkTable, str], Node]" = _at_the_end
    """Put a node behind its end of a link by its name: check sums, handshakes, retransmissions."""
    takes: frozenset[str] = frozenset()
    """Names of the `LinkOptions` that it takes."""
    over: "Callable[[AnyRobot, LinkOptions], AnyRobot]" = _as_it_is
    """Return a robot with its links of the family by these options; RobotFileError where they do not suit."""
    drivable: "Callable[[AnyRobot], AnyRobot]" = _complete
    """Return a robot, by its options; RobotFileError where it lacks what it cannot be driven without."""
    protocols: "Mapping[str, Protocols]" = field(default_factory=dict, hash=False)
    """Who reads the packets of its links, by the kinds of links; CAN frames are read for all."""
    dictionary: "Dictionary | None" = field(default=None, hash=False)
    """The objects of its CANopen devices; None: it has none."""
    expected: "Callable[[AnyRobot, str], Iterator[Expected]]" = _no_nodes
    """Yield the CANopen nodes on a link by its name, for a reader that has not seen their set-up."""
    shown: "Callable[[AnyRobot, str], str]" = _named
    """Describe a link by its name, for people: rate, protocol and load, in some lines."""


@cache
def _loaded() -> tuple[tuple[Family, ...], Mapping[str, str]]:
    """Return the installed families in the order of their names, and why others cannot be loaded."""
    found: list[Family] = []
    broken: dict[str, str] = {}
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        # One broken package must not hide the devices of the others.
        try:
            found.append(entry.load())
        except Exception as error:  # noqa: BLE001 - whatever a package raises
            broken[entry.name] = f"cannot be loaded: {type(error).__name__}: {error} ({entry.value})"
    return tuple(found), broken


def families() -> tuple[Family, ...]:
    """Return the installed families, in the order of their names."""
    return _loaded()[0]


def unloadable() -> Mapping[str, str]:
    """Return why installed families cannot be loaded, by their names."""
    return _loaded()[1]


def family_of(link: "LinkTable") -> Family:
    """Return the family of a link; LookupError where it is not installed."""
    for family in families():
        if type(link) is family.link:
            return family
    raise LookupError(f"no installed family has links of {type(link).__name__}")
