"""The arm's sketch: it executes one line after the other; meanwhile received bytes only enter its ring.

Sources: Chris-Annin/AR2, AR2_2.0. A move is answered before it begins. Fields are found by their letters in
the whole line, a line with an unknown word is ignored without an answer, and the end of a move is not
reported.

Where they are silent:
* while points are read it waits for each without an end; a point is kept without the end of its line.
* points beyond the table are passed over, where the sketch writes over what lies behind it.
* a line is forgotten from its 6,000th byte on: there is no memory for more.
* percentages but the speed's are ints.
"""

from collections import deque
from collections.abc import Callable, Mapping
from typing import Final

from emulators.arduino_omni.ar2.axes import AXES, JOINTS
from emulators.arduino_omni.ar2.firmwares import Firmware
from emulators.arduino_omni.ar2.joints import Joints
from emulators.arduino_omni.ar2.moves import (
    Beat,
    JointMove,
    Move,
    MoveRequest,
    SwitchMove,
    WaypointMove,
)
from emulators.arduino_omni.ar2.strings import number, real, steps, substring
from emulators.arduino_omni.mega.arithmetic import atoi, int16, single, truncated
from emulators.arduino_omni.mega.jobs import Call, Delay, Say
from emulators.arduino_omni.mega.mega import Mega
from emulators.arduino_omni.mega.pins import FIRST_ANALOG, INPUT_PULLUP, OUTPUT
from firmware_bridge.families.ar2 import wire
from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER, Nanoseconds

LETTERS: Final = wire.LETTERS
OUTPUTS: Final = range(38, 54)
FIRST_HIGH: Final = range(38, 46)
"""Outputs that are high from the beginning."""
SERVOS: Final = 8
SERVO_US: Final = (544, 2_400)
LARGEST_ANGLE: Final = 180
POLL: Final[Nanoseconds] = 100 * MILLISECOND
POINTS: Final = 101
KEPT: Final = 49
"""Characters of a point."""
LONGEST: Final = 6_000
_LONG: Final = 1 << 32


class Ar2Sketch:
    """One run of the sketch."""

    def __init__(self, mega: Mega, joints: Joints, firmware: Firmware) -> None:
        self._mega: Final = mega
        self._joints: Final = joints
        self._firmware: Final = firmware
        self.servos: Final[dict[int, int]] = {}
        """Pulse of each servo in us, once one was commanded."""
        self._now: Nanoseconds = 0
        self._line = bytearray()
        self._points = [b""] * POINTS
        self._expected = 0
        """Points that are still to come."""
        self._point = 0
        self._last_point = 0
        """The last point of the move: one more than the line requested."""
        self._searched: tuple[int, ...] = ()
        self._move: Move | None = None
        self._after: Callable[[Nanoseconds], None] = self._ended
        self._beats: deque[Beat] = deque()
        self._rising: tuple[int, ...] = ()
        self._awaited = (0, 0)
        """A pin, and the level that it is waited for."""
        self._handlers: Final[Mapping[str, Callable[[bytes], None]]] = {
            "SV": self._servo,
            "WT": self._wait,
            "JF": self._input,
            "ON": self._switch_on,
            "OF": self._switch_off,
            "WI": self._await_high,
            "WO": self._await_low,
            "TM": self._echo,
            "LL": self._switches,
            "MJ": self._joint_move,
            "ML": self._waypoints,
        }

    @property
    def moves(self) -> bool:
        """True while a move is under way."""
        return self._move is not None

    def setup(self) -> None:
        """Configure the pins."""
        pins = self._mega.pins
        for axis in AXES:
            pins.configure(axis.step_pin, OUTPUT)
            pins.configure(axis.direction_pin, OUTPUT)
            if axis.switch_pin is not None:
                pins.configure(axis.switch_pin, INPUT_PULLUP)
        for pin in OUTPUTS:
            pins.configure(pin, OUTPUT)
        for pin in FIRST_HIGH:
            pins.write(pin, 1)

    def due(self, now: Nanoseconds) -> Nanoseconds:
        """Return that nothing happens by itself."""
        del now
        return NEVER

    def loop(self, now: Nanoseconds) -> None:
        """Read up to the end of a line, and obey it."""
        self._now = now
        while (byte := self._mega.serial.read()) >= 0:
            if len(self._line) < LONGEST:
                self._line.append(byte)
            if byte == wire.END[0]:
                if self._expected:
                    self._keep_point()
                else:
                    self._obey()
                return

    def _obey(self) -> None:
        line = bytes(self._line)
        self._line.clear()
        name = line[:2].decode("latin-1")
        if name in self._firmware.commands:
            self._handlers[name](line)

    def _say(self, text: bytes) -> None:
        self._mega.do(Say(text))

    # Pins

    def _write(self, pin: int, level: int, at: Nanoseconds) -> None:
        """Write a pin as digitalWrite() does; the driver of an axis takes each rise of its step pin."""
        pins = self._mega.pins
        axis = _STEP_PINS.get(pin)
        rises = axis is not None and level and not pins.read(pin)
        pins.write(pin, level)
        if axis is not None and rises:
            self._joints.pulse(axis, pins.read(AXES[axis].direction_pin), at)

    def _servo(self, line: bytes) -> None:
        servo, value = number(line, "V", "P"), number(line, "P")
        least, most = SERVO_US
        if 0 <= servo < SERVOS:
            # Servo.write(): below 544 it is an angle in degrees, from there on a pulse in us.
            if value < least:
                value = least + min(max(value, 0), LARGEST_ANGLE) * (most - least) // LARGEST_ANGLE
            self.servos[servo] = min(value, most)
            self._mega.pins.configure(FIRST_ANALOG + servo, OUTPUT)
        self._say(wire.SERVO_DONE)

    def _wait(self, line: bytes) -> None:
        # A negative int becomes a long without a sign: seven weeks.
        milliseconds = int16(truncated(single(real(line, "S") * 1_000.0))) % _LONG
        self._mega.do(Delay(milliseconds * MILLISECOND), Say(wire.DONE))

    def _input(self, line: bytes) -> None:
        high, low = self._firmware.input
        self._say(high if self._mega.pins.read(number(line, "X", "T") & 0xFF) else low)

    def _switch_on(self, line: bytes) -> None:
        self._switch(line, 1)

    def _switch_off(self, line: bytes) -> None:
        self._switch(line, 0)

    def _switch(self, line: bytes, level: int) -> None:
        self._write(number(line, "X") & 0xFF, level, self._now)
        self._say(wire.DONE)

    def _await_high(self, line: bytes) -> None:
        self._await(line, 1)

    def _await_low(self, line: bytes) -> None:
        self._await(line, 0)

    def _await(self, line: bytes, level: int) -> None:
        self._awaited = (number(line, "N") & 0xFF, level)
        self._mega.do(Call(self._look))

    def _look(self, _: Nanoseconds) -> None:
        pin, level = self._awaited
        if self._mega.pins.read(pin) == level:
            self._say(wire.DONE)
        else:
            # The sketch polls: in the meantime received bytes only enter its ring.
            self._mega.do(Delay(POLL), Call(self._look))

    def _echo(self, line: bytes) -> None:
        self._say(substring(line, 2) + wire.ECHO_END)

    # Moves

    def _joint_move(self, line: bytes) -> None:
        self._say(wire.MOVING)
        self._begin(JointMove(self._requested(line, "G"), self._firmware.multiplier), self._ended)

    def _switches(self, line: bytes) -> None:
        requested = self._requested(line, "", LETTERS[: len(JOINTS)])
        self._searched = requested.moving
        self._begin(SwitchMove(requested, self._firmware.multiplier), self._found)

    def _found(self, _: Nanoseconds) -> None:
        reached = self._reached()
        passed, failed = self._firmware.reached
        self._say(passed if all(reached[joint] for joint in self._searched) else failed)

    def _ended(self, _: Nanoseconds) -> None:
        """Send nothing."""

    def _requested(self, line: bytes, after_speed: str, letters: str = LETTERS) -> MoveRequest:
        """Set the direction pins, and return the steps and percentages requested beside them."""
        found = []
        for letter, following, axis in zip(letters, letters[1:] + "S", AXES, strict=False):
            digit, count = steps(line, letter, following)
            self._mega.pins.write(axis.direction_pin, int(digit != axis.ahead_digit))
            found.append(count)
        return MoveRequest(
            tuple(found),
            real(line, "S", after_speed),
            (number(line, "G", "H"), number(line, "H", "I")),
            (number(line, "I", "K"), number(line, "K")),
        )

    def _begin(self, move: Move, after: Callable[[Nanoseconds], None]) -> None:
        self._move, self._after = move, after
        self._mega.do(Call(self._go_on))

    def _go_on(self, at: Nanoseconds) -> None:
        """Let the pins rise that are due, and wait for the next ones."""
        # A pulse is LOW for its width: the pins that fell with the last beat rise now.
        for axis in self._rising:
            self._write(AXES[axis].step_pin, 1, at)
        self._rising = ()
        if not self._beats and self._move is not None:
            self._beats.extend(self._move.turn(self._reached()))
        if not self._beats:
            self._move = None
            self._after(at)
            return
        wait, self._rising = self._beats.popleft()
        for axis in self._rising:
            self._write(AXES[axis].step_pin, 0, at)
        self._mega.do(Delay(wait * MICROSECOND), Call(self._go_on))

    def _reached(self) -> tuple[bool, ...]:
        return tuple(self._mega.pins.read(pin) == 1 for pin in _SWITCH_PINS)

    # Points

    def _waypoints(self, line: bytes) -> None:
        self._point, self._expected = 0, max(0, atoi(substring(line, 2)))
        self._last_point = atoi(substring(line, 2))
        self._say(wire.POINTS)
        if not self._expected:
            self._begin_points()

    def _keep_point(self) -> None:
        if self._point < POINTS:
            self._points[self._point] = bytes(self._line[:-1][:KEPT])
        self._line.clear()
        self._say(str(self._point).encode())
        self._point += 1
        self._expected -= 1
        if not self._expected:
            self._begin_points()

    def _begin_points(self) -> None:
        self._say(wire.ALL_POINTS)
        self._point = -1
        self._mega.do(Call(self._next_point))

    def _next_point(self, _: Nanoseconds) -> None:
        """Go to the next of n + 1 points; the last one's text stays in front of the next line."""
        self._point += 1
        # `<=` in the sketch's loop: it moves once more than it has points.
        if self._point > self._last_point or self._point >= POINTS:
            return
        line = self._points[self._point]
        self._line[:] = line
        self._begin(WaypointMove(self._requested(line, "G"), self._firmware.multiplier), self._next_point)


_STEP_PINS: Final = {axis.step_pin: place for place, axis in enumerate(AXES)}
_SWITCH_PINS: Final = tuple(axis.switch_pin for axis in JOINTS if axis.switch_pin is not None)
