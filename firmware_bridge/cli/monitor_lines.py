"""A recording of serial lines or of cameras in words: a line of text for each of its own."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from firmware_bridge.cli.console import WRONG_INPUT, one_message, refusal, say
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.dissector import Carried, Dissector, kinds_of
from firmware_bridge.drivers.shield.fleet import over_protocol
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.recording import Direction, RecordingError, parse_chunk
from firmware_bridge.robot import RobotFileError

BRIDGE = "bridge"


@dataclass(frozen=True, slots=True)
class LinesOrder:
    """Which recording, and how it is read."""

    path: Path
    robot: str
    protocol: str | None
    """Of a board; None: the robot file's."""
    link: str | None
    """Only this one; None: all."""


def tell_lines(order: LinesOrder, lines: Iterable[tuple[int, str]]) -> None:
    """Say what numbered lines of a recording carry; what is wrong ends the program with a message."""
    with one_message(RobotFileError):
        robot = over_protocol(find_robot(order.robot), order.protocol)
    # What has bytes in a log of lines was driven over a line, whatever the robot file says.
    kinds = {name: SERIAL if kind == CAN else kind for name, kind in kinds_of(robot).items()}
    if order.link is not None and order.link not in kinds:
        raise refusal(f"-c {order.link}: {robot.name} has no such link; it has: {', '.join(kinds)}")
    dissector = Dissector(kinds)
    for where, carried in _carried(order, lines):
        if carried.link not in kinds:
            raise refusal(
                f"{where}: {robot.name} has no link '{carried.link}'; it has: {', '.join(kinds)}", WRONG_INPUT
            )
        if order.link in {None, carried.link}:
            say(dissector.read(carried))


def _carried(order: LinesOrder, lines: Iterable[tuple[int, str]]) -> Iterator[tuple[str, Carried]]:
    """Yield what was carried, and where it stands; instants count from the first."""
    begin: int | None = None
    for number, line in lines:
        where = f"{order.path}, line {number}"
        try:
            at, direction, packet = parse_chunk(line)
        except RecordingError as error:
            raise refusal(f"{where}: {error}", WRONG_INPUT) from None
        begin = at if begin is None else begin
        sender = BRIDGE if direction is Direction.SENT else packet.link
        yield where, Carried(at - begin, packet.link, sender, packet)
