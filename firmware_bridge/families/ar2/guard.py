"""The output guard of an AR2 arm's board: requests, positions, short moves within the joints' bounds.

A move cannot be stopped once it is sent. So one is under way at a time, until the board has echoed a line
sent after it; it is short, and no joint gets further in it than its top speed allows in a cycle, nor beyond
its travel, counted here again from the position sent last. Without such a position a joint is not moved.

Source: Chris-Annin/AR2, AR2_2.0, its sketch: the grammar, and the time of each pulse; robot file for bounds.
"""

import math
import re
from collections.abc import Mapping
from typing import Final, NamedTuple

from firmware_bridge.families.ar2.settings import Ar2Axis, Ar2Link
from firmware_bridge.node import DTR_DOWN, DTR_UP, LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.safety.guard.wire_rules import ROUNDING, WireRules
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

HALT: Final = b"TMhalt\n"
"""The guard's safe line. It stops nothing, as nothing can; its echo proves that the move is over."""
QUESTION: Final = re.compile(rb"TM(q[0-9]{1,12}|halt)\n")
PLACE: Final = re.compile(rb"TM([A-F])(-?[0-9]{1,5})\n")
MOVE: Final = re.compile(
    rb"MJA([01])(\d{1,4})B([01])(\d{1,4})C([01])(\d{1,4})D([01])(\d{1,4})E([01])(\d{1,4})F([01])(\d{1,4})"
    rb"T00S(\d{1,3}(?:\.\d{1,6})?)G0H100I0K100\n"
)
RECEIVED: Final = 256
"""Newest bytes that are searched for an echo."""
STEPS_PER_TURN: Final = 400
FULL_MS: Final = 20.0
"""Of all pulses of a turn of the sketch's loop at 1 %."""
TURN_MS: Final = 0.1
"""Most further time of a turn in ms; the longest joint takes no more than two turns for a step."""
SLOWEST: Final = 1.3
"""Percent: below it a pulse is longer than delayMicroseconds() can count."""
SHORTEST_MS: Final = 0.28
"""Between two pulses: at less a motor may lose steps without a load."""
LONGEST_MS: Final = 100.0
"""Longest time of any move in ms, regardless of the robot file."""


class Move(NamedTuple):
    """Steps of J1 to J6, ahead positive, and how fast."""

    steps: tuple[int, ...]
    percent: float

    @property
    def pulse_ms(self) -> float:
        """The time of one pulse."""
        # The sketch divides its delay by the joints that step: a turn of its loop takes as long for six as
        # for one.
        return FULL_MS / self.percent / max(1, sum(1 for it in self.steps if it))

    @property
    def lasts_ms(self) -> float:
        """The longest that it may take."""
        turns = 2.0 * max(map(abs, self.steps))
        # Its first turn waits twice as long.
        first = sum(1 for it in self.steps if it)
        return (sum(map(abs, self.steps)) + first) * self.pulse_ms + turns * TURN_MS


def move_of(line: bytes) -> Move | None:
    """Parse a move in the bridge's own format; None for anything else."""
    found = MOVE.fullmatch(line)
    if found is None:
        return None
    fields = found.groups()
    steps = tuple(
        # The grammar has no signs: a digit gives the direction, 1 for ahead.
        int(count) * (1 if digit == b"1" else -1)
        for digit, count in zip(fields[0:12:2], fields[1:12:2], strict=True)
    )
    return Move(steps, float(fields[12]))


class GuardedJoint:
    """One joint: its commanded position, and the move that is under way."""

    def __init__(self, axis: Axis, robot: AnyRobot) -> None:
        self.axis: Final = axis
        link = Ar2Link.of_link(robot, axis.link)
        self.cycle: Final = robot.cycle * link.every
        self.all: tuple[InForce, ...] = ()
        self.commanded_at: Nanoseconds = -NEVER
        self.homes: Final = False
        self.homes_within_s: Final = 0.0
        self.speed: Final = 0.0
        self.number: Final = Ar2Axis.of(axis).joint
        per_rad = axis.direction * STEPS_PER_TURN * axis.ratio / math.tau
        low, high = axis.travel or (0.0, 0.0)
        ends = sorted(per_rad * (end - math.radians(Ar2Axis.of(axis).counts_from_deg)) for end in (low, high))
        self.least: Final = round(ends[0])
        self.most: Final = round(ends[1])
        self.at_once: Final = math.floor(axis.top_speed * abs(per_rad) * self.cycle / SECOND) + 1
        """Most steps of one move, with one for the rounding of the command."""
        self.place: int | None = None
        """Position in steps; None before the first was sent."""
        self.moving = False

    @property
    def powered(self) -> bool:
        """True while it may move: its motor has its current always."""
        return self.moving

    @property
    def permitted(self) -> str:
        """Its places, and the longest move."""
        return f"{self.least} to {self.most} steps, {self.at_once} at once"

    def refuses_place(self, place: int) -> str | None:
        """Return why no one can mean that it stands there, or None."""
        if self.least <= place <= self.most:
            return None
        return f"{self.axis.called}: {place} steps are not within {self.least} to {self.most}"

    def refuses(self, steps: int) -> str | None:
        """Return why it may not go so many steps, or None."""
        if not steps:
            return None
        if self.place is None:
            return f"{self.axis.called}: moved by {steps} steps, and its position is not confirmed"
        if abs(steps) > self.at_once:
            return f"{self.axis.called}: {steps} steps at once, {self.at_once} are allowed"
        there = self.place + steps
        if not self.least <= there <= self.most:
            return f"{self.axis.called}: to {there} steps, its travel is {self.least} to {self.most}"
        return None


class Ar2Rules(WireRules):
    """Lines to one board, and the echoes of it."""

    def __init__(self, robot: AnyRobot, link: str) -> None:
        self.link = link
        joints = tuple(GuardedJoint(axis, robot) for axis in robot.axes_on(link))
        self._joints: Final = {joint.number: joint for joint in joints}
        self.axes: tuple[InForce, ...] = joints
        self._longest: Final = min(LONGEST_MS, float(Ar2Link.of_link(robot, link).move_ms))
        self._under_way = False
        """True while the end of a move is not proved."""
        self._proves: bytes | None = None
        """The echo that would prove it: of the newest line sent after it."""
        self._received = b""

    def axes_of(self, packet: Packet) -> tuple[InForce, ...]:
        """Return all joints: a request commands none of them to move, a move sets the target of each."""
        line = packet.payload
        # A request counts for all joints: it shows that the bridge is alive while none of them is moved.
        is_command = packet.address == 0 and (QUESTION.fullmatch(line) or MOVE.fullmatch(line))
        return self.axes if is_command else ()

    def requested_by(self, packet: Packet) -> Mapping[InForce, RequestedMotion]:
        """Return which joints a line moves."""
        steps = self._steps(packet)
        return {joint: RequestedMotion(moves=bool(steps.get(joint.number)), speed=0.0) for joint in self._all}

    def permitted(self, axis: Axis) -> str:
        """Describe the targets that an axis of the link may be sent."""
        return next(one.permitted for one in self._joints.values() if one.axis.name == axis.name)

    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Look into the list, and at what is under way."""
        del now
        line = packet.payload
        if packet.address in {DTR_UP, DTR_DOWN} and not line:
            return None
        if packet.address != 0:
            return f"address {packet.address} is none of a line's"
        if QUESTION.fullmatch(line):
            return None
        position = PLACE.fullmatch(line)
        if position is not None:
            return self._refuses_place(position[1][0] - ord("A") + 1, int(position[2]))
        move = move_of(line)
        return f"the line {line!r} is not listed" if move is None else self._refuses_move(move)

    def _refuses_place(self, number: int, place: int) -> str | None:
        joint = self._joints.get(number)
        if joint is None:
            return f"no axis is joint J{number}"
        if self._under_way:
            return f"{joint.axis.called}: its position set to {place} steps while the arm may move"
        return joint.refuses_place(place)

    def _refuses_move(self, move: Move) -> str | None:
        # The sketch blocks while it moves: a second line would wait in its receive buffer and then be moved,
        # too.
        if self._under_way:
            return "a move before the end of the one before was proved"
        if move.percent < SLOWEST or move.pulse_ms < SHORTEST_MS:
            return f"a move with a pulse of {move.pulse_ms:.3g} ms at {move.percent:g} %"
        if move.lasts_ms > self._longest + LONGEST_MS * ROUNDING:
            return f"a move of up to {move.lasts_ms:.0f} ms, {self._longest:.0f} are allowed"
        for number, steps in enumerate(move.steps, 1):
            joint = self._joints.get(number)
            if joint is None and steps:
                return f"joint J{number} is no axis of this robot, and moves by {steps} steps"
            reason = None if joint is None else joint.refuses(steps)
            if reason is not None:
                return reason
        return None

    def safe(self, axis: GuardedJoint) -> tuple[Packet, ...]:
        """Return the one line for all joints: a request."""
        del axis
        return (Packet(self.link, 0, HALT),)

    def replacement_of(self, packet: Packet) -> tuple[Packet, ...]:
        """Return a question: no line but a move moves anything."""
        del packet
        return (Packet(self.link, 0, HALT),)

    def sends(self, packet: Packet, now: Nanoseconds, *, requested: bool) -> tuple[InForce, ...]:
        """Note a line that leaves."""
        del now, requested
        if packet.address != 0:
            self._forget()
            return self.axes
        steps = self._steps(packet)
        if any(steps.values()):
            # An echo that was requested before the move proves nothing about its end.
            self._under_way, self._proves = True, None
            for joint in self._all:
                joint.moving = bool(steps.get(joint.number))
                if joint.place is not None:
                    joint.place += steps.get(joint.number, 0)
            return self.axes
        position = PLACE.fullmatch(packet.payload)
        if position is not None:
            self._joints[position[1][0] - ord("A") + 1].place = int(position[2])
        # println() adds CR LF to a text that has kept its own LF.
        self._proves = packet.payload[2:] + b"\r\n"
        self._received = b""
        return ()

    def receives(self, packet: Packet, now: Nanoseconds) -> bool:
        """Accept everything; an echo of a line sent after a move proves its end."""
        del now
        if packet.address in {LINE_LOST, LINE_BACK} and not packet.payload:
            self._forget()
            return True
        # An echo may arrive in pieces.
        self._received = (self._received + bytes(packet.payload))[-RECEIVED:]
        if self._proves is not None and self._proves in self._received:
            self._under_way, self._proves = False, None
            for joint in self._all:
                joint.moving = False
        return True

    @property
    def _all(self) -> tuple[GuardedJoint, ...]:
        return tuple(self._joints.values())

    def _steps(self, packet: Packet) -> Mapping[int, int]:
        move = move_of(packet.payload) if packet.address == 0 else None
        return {} if move is None else dict(enumerate(move.steps, 1))

    def _forget(self) -> None:
        """Know no place any more: the board starts again, or was not to be reached. A move has ended then."""
        self._under_way, self._proves = False, None
        for joint in self._all:
            joint.place, joint.moving = None, False
