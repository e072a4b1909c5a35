"""Timing of a robot's cycle on its serial line: each command with its cost, from the bytes up.

A command costs the time of its bytes, the latency of this machine's port at each turn of the dialog, and,
where it goes through the gateway, 0.13 ms (EPOS2 Application Notes, p. 168) and its frames on the CAN bus at
their longest. A plan that does not fit is refused before anything moves: a line that is too slow would
otherwise make every cycle late without a report.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.drivers.link_drivers import PlanError
from firmware_bridge.families.epos2.driver.inputs_outputs import outputs_at
from firmware_bridge.families.epos2.driver.serial.client import reading, writing
from firmware_bridge.families.epos2.driver.serial.drive import TARGET
from firmware_bridge.families.epos2.driver.serial.feedback import IN_EVERY_CYCLE, IN_TURN, ReadRow
from firmware_bridge.families.epos2.driver.serial.link import guarding, heartbeat
from firmware_bridge.families.epos2.maxon.frame import ANSWER, Frame, Generation, encode_v1, encode_v2
from firmware_bridge.families.epos2.maxon.messages import Request
from firmware_bridge.families.epos2.maxon.opcodes import encode_request, row_of
from firmware_bridge.families.epos2.settings import Epos2AnalogueInput, Epos2Axis, Epos2Link, nodes_on
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.families.epos2.wire.functions import OUTPUT_STATE
from firmware_bridge.robot import AnyRobot, Axis, CommandForm
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds

BITS_PER_BYTE: Final = 10
GATEWAY: Final[Nanoseconds] = 130 * MICROSECOND
LONGEST_FRAME: Final = 138
"""Bits of a CAN frame with eight bytes, all stuff bits and the space behind it (CIA 301, CAN 2.0A)."""
FRAMES: Final = 2
"""Request and response."""
HANDSHAKES: Final = {True: 4, False: 2}
"""V1's single bytes beside the frames, where a command is answered and where it is not."""
TURNS: Final = {True: 3, False: 2}
"""The host's waits for the device in V1's dialog, with and without an answer; in V2's it waits once."""
WORDS: Final = {
    CommandForm.SPEED: ("controlword",),
    CommandForm.POSITION: ("controlword", "released controlword"),
}
"""Of one set-point: a position's bit is released in the middle of the cycle, too."""
LONGEST_CYCLE_MS: Final = 1_000
"""Longest cycle that a robot file may set."""


@dataclass(frozen=True, slots=True)
class LineCommand:
    """One command of a cycle."""

    what: str
    time: Nanoseconds


@dataclass(frozen=True, slots=True)
class Plan:
    """The fullest cycle, in the order in which its commands leave."""

    cycle: Nanoseconds
    beat: tuple[LineCommand, ...]
    """The commands that satisfy the drives' heartbeat consumers, once."""
    beat_every: Nanoseconds
    reads: tuple[LineCommand, ...]
    """The reads of every cycle."""
    set_points: tuple[LineCommand, ...]
    in_turn: tuple[LineCommand, ...]

    @property
    def samples(self) -> tuple[LineCommand, ...]:
        """The commands before the set-points; a longer cycle has to hold more heartbeats."""
        # Rounded up: a cycle longer than the beat has to carry several.
        return (*self.beat * -(-self.cycle // self.beat_every), *self.reads)

    @property
    def entries(self) -> tuple[LineCommand, ...]:
        """Everything."""
        return (*self.samples, *self.set_points, *self.in_turn)

    @property
    def time(self) -> Nanoseconds:
        """Time that the line is busy in the fullest cycle."""
        return sum(entry.time for entry in self.entries)

    @property
    def answers_within(self) -> Nanoseconds:
        """Longest time of all samples; one command more may have begun before them."""
        return sum(entry.time for entry in self.samples) + max(entry.time for entry in self.entries)

    def excess(self) -> tuple[LineCommand, Nanoseconds] | None:
        """Return the first command that the cycle does not hold, and by how much; None where it holds all."""
        spent: Nanoseconds = 0
        for entry in self.entries:
            spent += entry.time
            # The first that does not fit is named, in the order in which the line carries them.
            if spent > self.cycle:
                return entry, spent - self.cycle
        return None


def fitting_plan(robot: AnyRobot, name: str) -> Plan:
    """Lay out the fullest cycle of the serial link of this name; PlanError where the cycle is too short."""
    plan = plan_for(robot, name)
    excess = plan.excess()
    if excess is None:
        return plan
    entry, late = excess
    raise PlanError(
        f"link '{name}': a cycle of {plan.cycle // MILLISECOND} ms does not hold {entry.what}: it would end "
        f"{late / MILLISECOND:.1f} ms too late, and the whole cycle takes {plan.time / MILLISECOND:.1f} ms. "
        f"{_remedy(plan, robot.links[name].every)}, or use a faster line: protocol v2, a higher baud, "
        f"a port with less latency (links.{name}.port_latency_us)"
    )


def _remedy(plan: Plan, every: int) -> str:
    """Name the shortest cycle of a robot that fits, where the link is served in each `every`-th one."""
    for cycle_ms in range(plan.cycle // every // MILLISECOND, LONGEST_CYCLE_MS + 1):
        if replace(plan, cycle=cycle_ms * every * MILLISECOND).excess() is None:
            return f"Say cycle_ms = {cycle_ms} or more in the robot file"
    return "No longer cycle holds it"


def plan_for(robot: AnyRobot, name: str) -> Plan:
    """Lay out the fullest cycle of the serial link of this name."""
    link, axes, nodes = Epos2Link.of_link(robot, name), robot.axes_on(name), nodes_on(robot, name)
    beat = (
        LineCommand("the bridge's heartbeat", _cost(link, heartbeat(link), through=False)),
        LineCommand(
            f"guarding of node {link.guardian(nodes)}", _cost(link, guarding(link, nodes), through=True)
        ),
    )
    # The fullest of all cycles: the rotating reads meet once in the product of their periods.
    turn = max(
        (tuple(_in_turn(link, axes, cycle)) for cycle in range(_period())),
        key=lambda entries: sum(entry.time for entry in entries),
    )
    return Plan(
        cycle=robot.cycle * link.every,
        beat=beat,
        beat_every=link.bridge_heartbeat_ms * MILLISECOND,
        reads=tuple(_read(link, row, axis) for row in IN_EVERY_CYCLE for axis in axes),
        set_points=tuple(entry for axis in axes for entry in _written(link, axis)),
        in_turn=(*turn, *_at_pins(robot, name, axes)),
    )


def _period() -> int:
    period = 1
    for row in IN_TURN:
        period *= row.every
    return period


def _in_turn(link: Epos2Link, axes: Sequence[Axis], cycle: int) -> Iterator[LineCommand]:
    for row in IN_TURN:
        for place, axis in enumerate(axes):
            if row.due(cycle, place):
                yield _read(link, row, axis)


def _at_pins(robot: AnyRobot, name: str, axes: Sequence[Axis]) -> Iterator[LineCommand]:
    """Give the reads of the sensors on a link, and one write for each drive with outputs."""
    link, by_name = Epos2Link.of_link(robot, name), {axis.name: axis for axis in axes}
    for axis in axes:
        if outputs_at(robot, axis):
            write = writing(Epos2Axis.of(axis).node, OUTPUT_STATE, b"")
            yield LineCommand(f"outputs of {axis.called}", _through(link, axis, write))
    for sensor in robot.sensors:
        if sensor.link == name:
            address = Address(at.ANALOGUE_INPUT_1.index, Epos2AnalogueInput.of(sensor).input)
            row = ReadRow(address, ANY_TYPE[address].type, sensor.name)
            yield _read(link, row, by_name[Epos2AnalogueInput.of(sensor).axis])


def _read(link: Epos2Link, row: ReadRow, axis: Axis) -> LineCommand:
    request = reading(Epos2Axis.of(axis).node, row.address)
    return LineCommand(f"{row.name} of {axis.called}", _through(link, axis, request))


def _written(link: Epos2Link, axis: Axis) -> Iterator[LineCommand]:
    """Give the writes of one set-point."""
    node = Epos2Axis.of(axis).node
    yield LineCommand(
        f"target of {axis.called}", _through(link, axis, writing(node, TARGET[axis.command], b""))
    )
    for word in WORDS[axis.command]:
        yield LineCommand(
            f"{word} of {axis.called}", _through(link, axis, writing(node, od.CONTROLWORD, b""))
        )


def _through(link: Epos2Link, axis: Axis, request: Request) -> Nanoseconds:
    return _cost(link, request, through=Epos2Axis.of(axis).node != link.gateway)


def _cost(link: Epos2Link, request: Request, *, through: bool) -> Nanoseconds:
    """Return the longest time that one command keeps the line busy."""
    row = row_of(request)
    layout = row.answer.layout.size
    frame, answer = encode_request(request), Frame(ANSWER, bytes(layout + layout % 2))
    if link.protocol is Generation.V1:
        answered = Generation.V1 in row.answered
        size = len(encode_v1(frame)) + answered * len(encode_v1(answer)) + HANDSHAKES[answered]
        turns = TURNS[answered]
    else:
        size, turns = len(encode_v2(frame)) + len(encode_v2(answer)), 1
    # Ten bits a byte: one start bit, eight data bits, one stop bit.
    on_line = size * BITS_PER_BYTE * SECOND // link.line_rate
    on_bus = GATEWAY + FRAMES * LONGEST_FRAME * SECOND // link.bit_rate if through else 0
    return on_line + turns * link.port_latency_us * MICROSECOND + on_bus
