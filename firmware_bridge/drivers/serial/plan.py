"""Whether a robot's cycle fits on its serial line: each command with its price, from the bytes up.

A command costs the time of its bytes, what this machine's port keeps back at each turn of the talk, and,
where it goes through the gateway, 0.13 ms (EPOS2 Application Notes, p. 168) and its frames on the CAN bus at
their longest. A plan that does not fit is refused before anything moves: a line that is too slow would
otherwise make every cycle late, and nobody would know.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from firmware_bridge.drivers.serial.client import reading, writing
from firmware_bridge.drivers.serial.link import guarding, heartbeat
from firmware_bridge.drivers.serial.rows import IN_EVERY_CYCLE, IN_TURN, ReadRow
from firmware_bridge.robot import Axis, Mode, Robot
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.maxon.frame import ANSWER, Frame, Generation, encode_v1, encode_v2
from firmware_bridge.wire.maxon.messages import Request
from firmware_bridge.wire.maxon.opcodes import encode_request, row_of

BITS_PER_BYTE: Final = 10
GATEWAY: Final[Nanoseconds] = 130 * MICROSECOND
LONGEST_FRAME: Final = 138
"""Bits of a CAN frame with eight bytes, all stuff bits and the space behind it (CIA 301, CAN 2.0A)."""
FRAMES: Final = 2
"""Request and response."""
HANDSHAKES: Final = {True: 4, False: 2}
"""V1's single bytes beside the frames, where a command is answered and where it is not."""
TURNS: Final = {True: 3, False: 2}
"""How often in V1's dialogue the host waits for the device; in V2's it does once."""


LONGEST_CYCLE_MS: Final = 1_000
"""What a robot file may say."""


class PlanError(Exception):
    """A cycle that does not fit on the line: which object is too many, by how much, and what to do."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One command of a cycle."""

    what: str
    time: Nanoseconds


@dataclass(frozen=True, slots=True)
class Plan:
    """The fullest cycle, in the order in which its commands leave."""

    cycle: Nanoseconds
    samples: tuple[Entry, ...]
    """What keeps the drives' watch quiet, and what is read in every cycle."""
    set_points: tuple[Entry, ...]
    in_turn: tuple[Entry, ...]

    @property
    def entries(self) -> tuple[Entry, ...]:
        """Everything."""
        return (*self.samples, *self.set_points, *self.in_turn)

    @property
    def time(self) -> Nanoseconds:
        """How long the line is busy in the fullest cycle."""
        return sum(entry.time for entry in self.entries)

    @property
    def answers_within(self) -> Nanoseconds:
        """How long all samples take at most; one command more may have begun before them."""
        return sum(entry.time for entry in self.samples) + max(entry.time for entry in self.entries)

    def excess(self) -> tuple[Entry, Nanoseconds] | None:
        """Return the first command that the cycle does not hold, and by how much; None where it holds all."""
        spent: Nanoseconds = 0
        for entry in self.entries:
            spent += entry.time
            if spent > self.cycle:
                return entry, spent - self.cycle
        return None


def fitting_plan(robot: Robot) -> Plan:
    """Lay out the fullest cycle of a robot; PlanError where the cycle is too short for it."""
    plan = plan_for(robot)
    excess = plan.excess()
    if excess is None:
        return plan
    entry, late = excess
    raise PlanError(
        f"a cycle of {robot.bus.cycle_ms} ms does not hold {entry.what}: it would end "
        f"{late / MILLISECOND:.1f} ms too late, and the whole cycle takes {plan.time / MILLISECOND:.1f} ms. "
        f"{_remedy(robot)}, or use a faster line: protocol v2, a higher baud, a port with less latency "
        "(bus.port_latency_us)"
    )


def _remedy(robot: Robot) -> str:
    """Name the shortest cycle that fits; a longer one has to hold more heartbeats."""
    for cycle_ms in range(robot.bus.cycle_ms, LONGEST_CYCLE_MS + 1):
        bus = robot.bus.model_copy(update={"cycle_ms": cycle_ms})
        if plan_for(robot.model_copy(update={"bus": bus})).excess() is None:
            return f"Say cycle_ms = {cycle_ms} or more under [bus] in the robot file"
    return "No longer cycle holds it"


def plan_for(robot: Robot) -> Plan:
    """Lay out the fullest cycle of a robot."""
    bus = robot.bus
    beats = (
        Entry("the bridge's heartbeat", _cost(robot, heartbeat(robot), through=False)),
        Entry(f"guarding of node {robot.guardian}", _cost(robot, guarding(robot), through=True)),
    ) * -(-bus.cycle_ms // bus.bridge_heartbeat_ms)
    reads = [_read(robot, row, axis) for row in IN_EVERY_CYCLE for axis in robot.axes]
    writes = [entry for axis in robot.axes for entry in _written(robot, axis)]
    battery = robot.battery
    owner = next(axis for axis in robot.axes if axis.name == battery.axis)
    analogue = ReadRow(Address(at.ANALOGUE_INPUT_1.index, battery.analogue_input), IN_TURN[0].type, "battery")
    turn = max(
        (tuple(_in_turn(robot, cycle)) for cycle in range(_period())),
        key=lambda entries: sum(entry.time for entry in entries),
    )
    return Plan(
        bus.cycle_ms * MILLISECOND,
        (*beats, *reads),
        tuple(writes),
        (*turn, _read(robot, analogue, owner)),
    )


def _period() -> int:
    period = 1
    for row in IN_TURN:
        period *= row.every
    return period


def _in_turn(robot: Robot, cycle: int) -> Iterator[Entry]:
    for row in IN_TURN:
        for place, axis in enumerate(robot.axes):
            if row.due(cycle, place):
                yield _read(robot, row, axis)


def _read(robot: Robot, row: ReadRow, axis: Axis) -> Entry:
    return Entry(f"{row.name} of {_called(axis)}", _through(robot, axis, reading(axis.node, row.address)))


def _written(robot: Robot, axis: Axis) -> Iterator[Entry]:
    """Give the writes of one set-point: a position's bit is released in the middle of the cycle, too."""
    target = {Mode.VELOCITY: at.TARGET_VELOCITY, Mode.POSITION: at.TARGET_POSITION}[axis.mode]
    words = {Mode.VELOCITY: ("controlword",), Mode.POSITION: ("controlword", "released controlword")}
    yield Entry(f"target of {_called(axis)}", _through(robot, axis, writing(axis.node, target, b"")))
    for word in words[axis.mode]:
        request = writing(axis.node, at.CONTROLWORD, b"")
        yield Entry(f"{word} of {_called(axis)}", _through(robot, axis, request))


def _through(robot: Robot, axis: Axis, request: Request) -> Nanoseconds:
    return _cost(robot, request, through=axis.node != robot.bus.gateway)


def _cost(robot: Robot, request: Request, *, through: bool) -> Nanoseconds:
    """Return the longest time that one command keeps the line busy."""
    bus = robot.bus
    row = row_of(request)
    layout = row.answer.layout.size
    frame, answer = encode_request(request), Frame(ANSWER, bytes(layout + layout % 2))
    if bus.protocol is Generation.V1:
        answered = Generation.V1 in row.answered
        size = len(encode_v1(frame)) + answered * len(encode_v1(answer)) + HANDSHAKES[answered]
        turns = TURNS[answered]
    else:
        size, turns = len(encode_v2(frame)) + len(encode_v2(answer)), 1
    on_line = size * BITS_PER_BYTE * SECOND // bus.line_rate
    on_bus = GATEWAY + FRAMES * LONGEST_FRAME * SECOND // bus.bit_rate if through else 0
    return on_line + turns * bus.port_latency_us * MICROSECOND + on_bus


def _called(axis: Axis) -> str:
    return f"node {axis.node} ({axis.title})"
