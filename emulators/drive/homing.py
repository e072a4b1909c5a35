"""Homing mode: the moves of a method, then the way to home; that sets the position.

The moves are rows in `emulators.canopen.homing_methods`; a product's subclass names those that it has, and
its objects. Assumed: the next move begins with a ramp out of the last one; the way to home at the end is
moved at the speed of the switch search; a halt ends a homing for good; what a method needs and the drive has
not got (a switch, a sensor with index) is a homing error at once.
"""

from collections.abc import Mapping
from typing import ClassVar, Final

from emulators.canopen.homing_methods import CIA_402, NOTHING_TO_DO, Goal, HomingMove
from emulators.drive.mode import ModeOfOperation
from emulators.drive.profile_position import HIGHEST, LOWEST
from emulators.drive.shaft import Shaft
from emulators.servo.axis import CURRENT_REACHED, TARGET_REACHED
from emulators.servo.commands import displace
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import ControlwordBit, Status

_START: Final = int(ControlwordBit.NEW_SETPOINT)
_ATTAINED: Final = int(Status.HOMING_ATTAINED)
_ERROR: Final = int(Status.HOMING_ERROR)


class HomingMode(ModeOfOperation):
    """Homing by the method in 0x6098."""

    heeds_halt: ClassVar[bool] = True
    methods: ClassVar[Mapping[int, tuple[HomingMove, ...]]] = CIA_402

    def __init__(self, shaft: Shaft) -> None:
        super().__init__(shaft)
        self._ways: tuple[HomingMove, ...] = ()
        """Moves of the method; empty while no homing runs."""
        self._number = 0
        """Index of the present move; past the last one it is the offset."""
        self._reference = 0
        """Position at the end of the last move, qc."""
        self._turned = False
        """The present move goes the other way: it has met the end of the shaft's way."""
        self._left = 0
        """Index passes before this way, or whether its switch has been closed."""
        self._attained = False
        self._failed = False

    # Taking over and letting go

    def begin(self) -> None:
        """Hold the position; a failure of before is over."""
        self._failed = False
        self.enter()

    def forget(self) -> None:
        """Give a homing up."""
        self._ways = ()
        self.shaft.axis.index_watched = self.shaft.axis.current_watched_ma = 0

    def fail(self) -> None:
        """Take a fault in a homing for a homing error."""
        self._failed = self._failed or bool(self._ways)

    def halt(self) -> None:
        """Give a homing up, with the homing acceleration."""
        self.forget()
        self.shaft.brake(od.HOMING_ACCELERATION)

    def controls(self, word: int, before: int) -> bool:
        """Start with a rising edge of bit 4, give up without it."""
        if not word & _START:
            if self._ways:
                self.halt()
            return False
        return not before & _START and not self.shaft.halted

    def take_setpoint(self, word: int) -> bool:
        """Start a homing by the method that the object holds by now."""
        del word
        self.forget()
        self._attained = self._failed = False
        method = self.shaft.store.get(od.HOMING_METHOD)
        if method == NOTHING_TO_DO:
            self._attained = self.shaft.referenced = True
        elif method in self.methods and not self.methods[method]:
            self._settle(self.shaft.axis.position)
        elif method in self.methods and self._can(self.methods[method]):
            self._ways, self._number = self.methods[method], 0
            self._set_out()
        else:
            self._fail()
        return True

    # A product's

    @property
    def has_index(self) -> bool:
        """True if the encoder has an index."""
        return True

    @property
    def home_position(self) -> int:
        """The position that counts at home, qc: zero lies 0x607C beyond it."""
        return -self.shaft.store.get(od.HOME_OFFSET)

    @property
    def moved_offset(self) -> int:
        """The way from the reference to home, qc, which is moved at the end."""
        return 0

    @property
    def stop_current_ma(self) -> int:
        """The current beyond which the shaft is at a stop; 0 where no method goes by one."""
        return 0

    # Setting out

    def _can(self, ways: tuple[HomingMove, ...]) -> bool:
        fitted = self.shaft.inputs.fitted
        return all(
            fitted >> way.switch & 1
            if way.switch is not None
            else way.goal is not Goal.INDEX or self.has_index
            for way in ways
        )

    def _fail(self) -> None:
        self.halt()
        self._failed = True

    # Under way

    def advance(self) -> None:
        """Begin the next way where one has ended; after the last one, go the offset; then be home."""
        self._turn()
        while self._ways and self._number < len(self._ways) and self._reached(self._ways[self._number]):
            self._number += 1
            self._set_out()
        if self._ways and self._number == len(self._ways) and self.shaft.axis.flags & TARGET_REACHED:
            self._settle(self.shaft.axis.target_position >> self.shaft.axis.fraction)

    def _set_out(self) -> None:
        """Begin the present way, or the offset after the last."""
        axis = self.shaft.axis
        axis.index_watched = axis.current_watched_ma = 0
        self._turned = False
        if self._number == len(self._ways):
            self._go_offset()
            return
        way = self._ways[self._number]
        if way.goal is Goal.INDEX:
            axis.index_watched, self._left = 1, axis.index_passes
        elif way.goal is Goal.STOP:
            axis.current_watched_ma = self.stop_current_ma
            # Judged once a ms: the flag of the move before must not end this one.
            axis.flags &= ~CURRENT_REACHED
        else:
            self._left = self._closed(way)
        self._go(way, way.direction)

    def _go(self, way: HomingMove, direction: int) -> None:
        velocity = direction * self.shaft.bounded(self.shaft.store.get(way.speed))
        self.shaft.ramp(velocity, od.HOMING_ACCELERATION, od.HOMING_ACCELERATION)

    def _turn(self) -> None:
        """Go the other way where the present move has met the end of the shaft's way."""
        if self._turned or not self._ways or self._number == len(self._ways):
            return
        way = self._ways[self._number]
        if way.turns_at is not None and self.shaft.inputs.active & way.turns_at.bit:
            self._turned = True
            self._go(way, -way.direction)

    def _go_offset(self) -> None:
        shaft, axis = self.shaft, self.shaft.axis
        # From the latched reference: the ramp down from the search speed has led past it.
        target = self._reference + self.moved_offset
        if not LOWEST <= target <= HIGHEST:
            self._fail()
            return
        axis.target_position = target << axis.fraction
        cruise = shaft.bounded(shaft.store.get(od.HOMING_SPEED_SWITCH))
        shaft.move(cruise, od.HOMING_ACCELERATION, od.HOMING_ACCELERATION)

    def _reached(self, way: HomingMove) -> bool:
        """Return True if a move has come to its end, and note the position there."""
        axis = self.shaft.axis
        # While the ramp of the move before runs out, the shaft goes the other way: an edge does not count.
        turned = axis.velocity_demand * way.direction > 0
        self._reference = axis.position
        if way.goal is Goal.CLOSED:
            return bool(self._closed(way))
        if way.goal is Goal.STOP:
            if axis.flags & CURRENT_REACHED:
                # No longer against the stop: the demand is where the shaft is.
                axis.clear_demand()
                return True
            return False
        if way.goal is Goal.INDEX:
            # The latched count: at the end of the ms the shaft has passed the index already.
            self._reference = axis.index_position
            passed, self._left = axis.index_passes != self._left, axis.index_passes
            return passed and turned
        closed = self._closed(way)
        left = self._left and not closed
        self._left = closed
        return bool(left) and turned

    def _closed(self, way: HomingMove) -> int:
        return 0 if way.switch is None else self.shaft.inputs.active >> way.switch & 1

    def _settle(self, place: int) -> None:
        """Complete the homing: `place`, in qc, has the home position from now on."""
        self.forget()
        displace(self.shaft.axis, self.home_position - place)
        self._attained = self.shaft.referenced = True

    # Status

    @property
    def sought(self) -> int:
        """The switches of the method, while it is gone."""
        # A limit switch that the method looks for is its reference, not the fault FF06 or FF07.
        bits = 0
        for way in self._ways:
            for switch in (way.switch, way.turns_at):
                bits |= 0 if switch is None else switch.bit
        return bits

    @property
    def arrived(self) -> bool:
        """Bit 10: at standstill, and no homing runs."""
        return not self._ways and self.shaft.arrived

    def status(self, *, failed: bool) -> int:
        """Bit 12: homing attained; bit 13: homing error."""
        bits = _ATTAINED if self._attained and self.shaft.referenced else 0
        return bits | (_ERROR if failed or self._failed else 0)
