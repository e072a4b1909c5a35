"""A recording of serial lines or of cameras, decoded: a line of text for each of its own."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from firmware_bridge.cli.console import WRONG_INPUT, one_message, refusal, say
from firmware_bridge.cli.fitted import linked
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.dissector import Carried, Dissector, kinds_of
from firmware_bridge.family import LinkOptions
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.recording import Direction, RecordingError, parse_chunk, side_of
from firmware_bridge.robot import RobotFileError

BRIDGE = "bridge"


@dataclass(frozen=True, slots=True)
class LinesOrder:
    """A recording, with the options for reading it."""

    path: Path
    robot: str | None
    """The robot of the lines; None: by the recording."""
    protocol: str | None
    """Of a board; None: the robot file's."""
    link: str | None
    """Only this one; None: all."""


def show_lines(order: LinesOrder, lines: Iterable[tuple[int, str]]) -> None:
    """Say what numbered lines of a recording carry; what is wrong ends the program with a message."""
    kinds = _kinds(order)
    known = None if order.robot is None else set(kinds)
    if known is not None and order.link is not None and order.link not in kinds:
        raise refusal(f"-c {order.link}: {order.robot} has no such link; it has: {', '.join(kinds)}")
    dissector, seen = Dissector(kinds), dict[str, None]()
    for where, carried, spoken in _carried(order, lines):
        if known is None and spoken is not None:
            kinds[carried.link] = spoken
        if carried.link not in kinds:
            has = f"{order.robot} has no link '{carried.link}'; it has: {', '.join(kinds)}"
            unknown = f"nothing states what the link '{carried.link}' speaks; name its robot with --robot"
            raise refusal(f"{where}: {unknown if known is None else has}", WRONG_INPUT)
        seen[carried.link] = None
        if order.link in {None, carried.link}:
            say(dissector.read(carried))
    if order.link not in {None, *seen}:
        nothing = f"{order.path}: holds nothing of '{order.link}', but of {', '.join(seen)}"
        say(f"firmware-bridge: {nothing}", err=True)


def _kinds(order: LinesOrder) -> dict[str, str]:
    """Return what each link of the robot speaks; without a robot the recording has to say it."""
    if order.robot is None:
        return {}
    with one_message(RobotFileError):
        robot = linked(find_robot(order.robot), LinkOptions(order.protocol))
    # A link with bytes in a log of lines was driven over a line, whatever the robot file gives.
    return {name: SERIAL if kind == CAN else kind for name, kind in kinds_of(robot).items()}


def _carried(
    order: LinesOrder, lines: Iterable[tuple[int, str]]
) -> Iterator[tuple[str, Carried, str | None]]:
    """Yield where it stands, what was carried, and what the device speaks that has recorded it.

    Instants count from the first.
    """
    begin: int | None = None
    for number, line in lines:
        where = f"{order.path}, line {number}"
        try:
            at, direction, packet = parse_chunk(line.rstrip("\r\n"))
        except RecordingError as error:
            if line.startswith("(") and not line.endswith("\n") and begin is not None:
                say(f"{order.path}: its end is cut off; line {number} is left out")
                return
            raise refusal(f"{where}: {error}", WRONG_INPUT) from None
        begin = at if begin is None else begin
        name, spoken = side_of(packet.link)
        # SENT is the end that has recorded: the device in its own log, the bridge in all others.
        by_device = (direction is Direction.SENT) == (spoken is not None)
        yield where, Carried(at - begin, name, name if by_device else BRIDGE, packet), spoken
