"""The nodes on a robot's CAN buses, for a reader that has not seen their set-up."""

from collections.abc import Iterator
from dataclasses import dataclass

from firmware_bridge.canopen.address import Address
from firmware_bridge.dissector.dictionary import Dictionary
from firmware_bridge.family import family_of
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.table import Medium


@dataclass(frozen=True, slots=True)
class Expected:
    """A node: its number, what it moves, and what the bridge writes to it before it may move."""

    node: int
    title: str
    written: tuple[tuple[Address, bytes], ...]
    dictionary: Dictionary | None = None
    """By which it is read; None: as any node of an unknown maker."""


def expected_on(robot: AnyRobot, link: str) -> Iterator[Expected]:
    """Yield the nodes of a link; KeyError where there is no such link."""
    return family_of(robot.links[link]).expected(robot, link)


def can_links(robot: AnyRobot) -> tuple[str, ...]:
    """Return the names of a robot's CAN buses."""
    return tuple(name for name, link in robot.links.items() if link.medium is Medium.CAN)
