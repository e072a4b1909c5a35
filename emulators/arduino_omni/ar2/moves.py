"""Pulse patterns of the sketch's loops: the step pins that rise, and the time between them.

They do not depend on pins or time. A move yields one turn of its loop after the other, as beats: microseconds
that pass, and the axes whose pins rise then. No beats: it is over.

Sources: Chris-Annin/AR2, AR2_2.0, its sketch: MJ, LL and ML. ints have 16 bits there, and floats 32.
ArduinoCore-avr, wiring.c: delayMicroseconds() takes its argument four times in 16 bits.

Where they are silent:
* a turn of a loop takes 70 us more than its delays: about 40 to 100 us of digitalWrite() and divisions.
* percentages are divided by 100 before anything else is done with them.
* a pulse of ML is LOW for its width, then HIGH, as one of MJ.
* the track's pin does not move in ML, whose loop then never ends.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Protocol, TypeAlias

from emulators.arduino_omni.ar2.axes import AXES, JOINTS, OVERDRIVE
from emulators.arduino_omni.mega.arithmetic import divided, int16, quotient, single, truncated

TURN_US: Final = 70
"""Time of one turn of a loop beside its delays."""
HUNDRED: Final = 100.0
SWITCH_PULSE_US: Final = 5
SETTLING_US: Final = 500_000
"""Pause after an overdrive."""
WAYPOINT_MULTIPLE: Final = 2.0
"""ML and LL are slower than MJ by this."""
WAYPOINT_PARTS: Final = 6
FOR_EVER_US: Final = 1 << 50
LONGEST_US: Final = 1 << 14
"""Four times this is 0 in 16 bits."""

Beat: TypeAlias = tuple[int, tuple[int, ...]]
Beats: TypeAlias = tuple[Beat, ...]


class Move(Protocol):
    """One of the sketch's loops."""

    def turn(self, reached: Sequence[bool]) -> Beats:
        """Return the beats of its next turn; `reached` is what the switches say."""


@dataclass(frozen=True, slots=True)
class MoveRequest:
    """The motion requested by a line: a direction's digit and steps for each axis, and percentages."""

    steps: tuple[int, ...]
    speed: float
    acceleration: tuple[int, int] = (0, 0)
    """Its part of the way, and the speed that it begins with."""
    deceleration: tuple[int, int] = (0, 0)
    """Its part of the way, and the speed that it would end with."""

    @property
    def moving(self) -> tuple[int, ...]:
        """The axes that have steps."""
        return tuple(axis for axis, steps in enumerate(self.steps) if steps > 0)


def waited(microseconds: int) -> int:
    """Return how long delayMicroseconds() takes for what is put into its 16 bits."""
    word = microseconds % (1 << 16)
    # The loop counts 4 times the us down in 16 bits: from 0 it takes the whole range, 16384 us.
    return (word - 1) % LONGEST_US + 1 if word else 0


def pulse_us(multiplier: float, speed: float) -> int:
    """Return the int of us for a speed in percent; 16 bits."""
    return int16(truncated(divided(multiplier, single(speed / HUNDRED))))


class Pace:
    """Delays of MJ in each turn: faster, steady, slower; it slows down from the steady pace by `+=`."""

    def __init__(self, requested: MoveRequest, multiplier: float) -> None:
        self._active: Final = len(requested.moving)
        high = float(max(requested.steps, default=0))
        share = single(requested.speed / HUNDRED)
        self._steady: Final = pulse_us(multiplier, requested.speed)
        begin, end = (
            divided(single(multiplier + divided(multiplier, single(percent / HUNDRED))), share)
            for percent in (requested.acceleration[1], requested.deceleration[1])
        )
        self._until: Final = single(high * single(requested.acceleration[0] / HUNDRED))
        self._from: Final = single(high - single(high * single(requested.deceleration[0] / HUNDRED)))
        self._faster: Final = divided(single(self._steady - begin), self._until)
        self._slower: Final = divided(single(self._steady + end), self._from)
        self._begin = begin
        self._end = float(self._steady)
        self._turns = 0

    def next(self) -> int:
        """Return the us of one pulse in the next turn."""
        turn, self._turns = self._turns, int16(self._turns + 1)
        if turn <= self._until:
            delay, self._begin = self._begin, single(self._begin + self._faster)
        elif turn >= self._from:
            delay, self._end = self._end, single(self._end + self._slower)
        else:
            delay = float(self._steady)
        return waited(truncated(divided(delay, float(self._active))))


class Thinned:
    """An axis with fewer steps than the longest has: in which turns of the loop it steps."""

    def __init__(self, steps: int, high: int) -> None:
        self._left = steps
        self._every: Final = quotient(high, steps)
        rest = int16(high - int16(steps * self._every))
        self._first: Final = quotient(high, rest) if rest > 0 else 0
        done = int16(steps * self._every)
        more = int16(high - int16(done + quotient(done, self._first))) if self._first else 0
        self._second: Final = quotient(high, more) if more > 0 else 0
        self._turns = 0
        self._first_count = 0
        self._second_count = 0

    @property
    def over(self) -> bool:
        """True once all its steps are done."""
        return self._left <= 0

    def steps_now(self) -> bool:
        """Return whether it steps in this turn of the loop."""
        if self.over:
            return False
        # 0 is "no second thinning": a counter of 1 never meets it.
        if self._second == 0:
            self._second_count = 1
        if self._second_count == self._second:
            self._second_count = 0
            return False
        self._second_count += 1
        # Likewise for the first one.
        if self._first == 0:
            self._first_count = 1
        if self._first_count == self._first:
            self._first_count = 0
            return False
        self._first_count += 1
        self._turns += 1
        if self._turns != self._every:
            return False
        self._turns = 0
        self._left -= 1
        return True


class JointMove:
    """MJ: all axes in the turns of the longest, each pulse by itself."""

    def __init__(self, requested: MoveRequest, multiplier: float) -> None:
        high = max(requested.steps)
        self._pace: Final = Pace(requested, multiplier)
        self._axes: Final = tuple((axis, Thinned(requested.steps[axis], high)) for axis in requested.moving)

    def turn(self, reached: Sequence[bool]) -> Beats:
        """Return the next turn: the axes that are due, one after the other."""
        del reached
        if all(axis.over for _, axis in self._axes):
            return ()
        delay = self._pace.next()
        pulses = tuple((delay, (place,)) for place, axis in self._axes if axis.steps_now())
        return (*pulses, (TURN_US, ()))


class SwitchMove:
    """LL: each joint to its switch or to the end of its steps, then all of them somewhat further."""

    def __init__(self, requested: MoveRequest, multiplier: float) -> None:
        self.commanded: Final = tuple(axis for axis in requested.moving if axis < len(JOINTS))
        self._delay: Final = waited(pulse_us(single(WAYPOINT_MULTIPLE * multiplier), requested.speed))
        self._left: Final = list(requested.steps)
        self._overdrive = OVERDRIVE
        self._searching = True
        self._settled = False

    def turn(self, reached: Sequence[bool]) -> Beats:
        """Return the next turn."""
        due = {it for it in self.commanded if self._left[it] > 0 and not reached[it]}
        if self._searching and due:
            return self._search(due)
        self._searching = False
        if self._overdrive:
            self._overdrive -= 1
            return ((self._delay, self.commanded), (self._delay + TURN_US, ()))
        if self._settled:
            return ()
        self._settled = True
        return ((SETTLING_US, ()),)

    def _search(self, due: set[int]) -> Beats:
        pulses: list[Beat] = []
        waited_us = SWITCH_PULSE_US
        for joint in range(len(JOINTS)):
            if joint in due:
                self._left[joint] -= 1
                pulses.append((waited_us, (joint,)))
                waited_us = 0
            waited_us += 2 * SWITCH_PULSE_US
        return (*pulses, (waited_us - SWITCH_PULSE_US + self._delay + TURN_US, ()))


class WaypointMove:
    """ML: one point; every joint a pulse in each turn until its steps are done."""

    def __init__(self, requested: MoveRequest, multiplier: float) -> None:
        width = pulse_us(single(WAYPOINT_MULTIPLE * multiplier), requested.speed)
        self._delay: Final = waited(quotient(width, WAYPOINT_PARTS))
        self._left: Final = list(requested.steps[: len(JOINTS)])
        self._never_ends: Final = requested.steps[len(AXES) - 1] > 0

    def turn(self, reached: Sequence[bool]) -> Beats:
        """Return the next turn."""
        del reached
        due = [joint for joint, left in enumerate(self._left) if left > 0]
        for joint in due:
            self._left[joint] -= 1
        if due:
            return (*((self._delay, (joint,)) for joint in due), (TURN_US, ()))
        return ((FOR_EVER_US, ()),) if self._never_ends else ()
