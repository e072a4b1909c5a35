"""The drives on a robot file's CAN buses, for a reader that has not seen their set-up."""

from collections.abc import Iterator
from dataclasses import dataclass

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.drivers.epos2.setup import MODE, configuration
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.settings.epos2 import Epos2Axis, Epos2Driver, Epos2Link


@dataclass(frozen=True, slots=True)
class Expected:
    """A drive: its number, what it moves, and what the bridge writes to it before it may move."""

    node: int
    title: str
    written: tuple[tuple[Address, bytes], ...]


def expected_on(robot: AnyRobot, link: str) -> Iterator[Expected]:
    """Yield the drives of a link to EPOS2 drives over CAN; KeyError or TypeError where it is none."""
    settings = Epos2Link.of_link(robot, link)
    for axis in robot.axes_on(link):
        rows = [(row.address, row.raw) for row in configuration(axis, settings)]
        rows.append((od.MODE, int(MODE[axis.command]).to_bytes(1, "little", signed=True)))
        yield Expected(Epos2Axis.of(axis).node, axis.title, tuple(rows))


def can_links(robot: AnyRobot) -> tuple[str, ...]:
    """Return the names of a robot's links to EPOS2 drives over CAN."""
    return tuple(name for name, link in Epos2Link.all_of(robot).items() if link.driver is Epos2Driver.CAN)
