"""The bench's half of the family: an emulated toy drive, its motor on a plant, its serial line.

Guesses, where a manual would be silent: a line that is no request gets no answer; a speed without power, or
after a stop, is answered and not taken; the speed loop is P, with the motor's back-EMF ahead of it.
"""

import math
import re
from typing import Final

from emulators.plain_line import line_family
from emulators.servo.plant_part import PlantPart
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER, Nanoseconds, to_seconds
from firmware_bridge.wire.lines import LineReader

from toy_drive.settings import ToyAxis, ToyLink

STEP: Final[Nanoseconds] = 500 * MICROSECOND
SUPPLY_V: Final = 24.0
GAIN_V_S: Final = 0.2
"""Volts for each rad/s that the shaft is too slow; assumed."""
STEEPER: Final = 3.0
"""Factor of a quick stop's deceleration."""
REQUEST: Final = re.compile(rb"P[01]|S|Q|V(-?\d{1,7})")
OFF, ON, STOPPED = range(3)


class ToyDrive:
    """The device as a node on its line, and as the motor of its axis."""

    def __init__(self, robot: AnyRobot, axis: Axis, part: PlantPart) -> None:
        settings = ToyAxis.of(axis)
        self.name: Final = axis.name
        self.state = OFF
        self._part = part
        self._watchdog = ToyLink.of_link(robot, axis.link).watchdog_ms * MILLISECOND
        self._change = settings.acceleration * axis.ratio * to_seconds(STEP)
        self._counts_per_rad = settings.counts_per_turn / math.tau
        self._back_emf = SUPPLY_V / (settings.full_speed_rpm * math.tau / 60.0)
        self._reader = LineReader(b"\n")
        self._target = self._speed = 0.0
        self._sign = 1.0
        self._stops_at: Nanoseconds = NEVER

    @property
    def powered(self) -> bool:
        """True while its power stage is on."""
        return self.state != OFF

    def swap_channels(self, *, swapped: bool) -> None:
        """Exchange the channels of its encoder: it counts backwards, for its own loop, too."""
        self._sign = -1.0 if swapped else 1.0

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Answer each request that these bytes complete."""
        answers = [self._answer(line, now) for line in self._reader.receive(packet.payload)]
        return Reaction(tuple(Packet(SERIAL, 0, answer) for answer in answers if answer), self._stops_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Stop where no request has come for too long."""
        if now >= self._stops_at:
            self._stops_at = NEVER
            self._take(b"S")
        return Reaction((), self._stops_at)

    def act(self) -> None:
        """Set the voltage of the plant's next step."""
        turns = self._sign * self._part.outputs[1:2][0]
        change = self._change * (STEEPER if self.state == STOPPED else 1.0)
        self._speed += min(max(self._target - self._speed, -change), change)
        if self.state == OFF:
            # Without power there is no current: the terminals have the back-EMF.
            self._speed = turns = self._sign * turns
        volts = self._back_emf * self._speed + GAIN_V_S * (self._speed - turns)
        self._part.inputs[0] = min(max(volts, -SUPPLY_V), SUPPLY_V)

    def _answer(self, line: bytes, now: Nanoseconds) -> bytes:
        if REQUEST.fullmatch(line) is None:
            return b""
        self._stops_at = now + self._watchdog
        self._take(line)
        angle, speed = (self._sign * it for it in self._part.outputs[0:2])
        counts = math.floor(angle * self._counts_per_rad)
        return b"%b %d %d %d\n" % (line, self.state, counts, round(1000.0 * speed))

    def _take(self, line: bytes) -> None:
        if line in {b"P0", b"P1"}:
            self.state, self._target = int(line[1:]), 0.0
        elif line == b"S" and self.state == ON:
            self.state, self._target = STOPPED, 0.0
        elif line[:1] == b"V" and self.state == ON:
            self._target = int(line[1:]) / 1000.0


FAMILY: Final = line_family(
    ToyLink,
    ToyDrive,
    # The variables of the plant `single_axis`, which has one axis, whatever the robot file calls it.
    inputs=lambda _axis: ("voltage_axis",),
    outputs=lambda _axis: ("angle_axis", "speed_axis"),
    every=STEP,
    electric=False,
)
