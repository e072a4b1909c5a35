"""Profile position mode: moves to set-points, one after the other or at once, with halt.

Source: CiA 402-2, profile position mode. A set-point is a rising edge of bit 4. Here the target is refused
where it lies outside 0x607D, by a product's emergency, not clipped.
"""

from typing import ClassVar, Final

from emulators.drive.mode import ModeOfOperation
from emulators.drive.shaft import Shaft
from emulators.servo.axis import MOVE, PROFILE_DONE
from emulators.servo.scaling import speed_units
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import ControlwordBit, Status

# The controlword's bits as plain numbers: flags are slow, and every set-point is looked at.
_NEW_SETPOINT: Final = int(ControlwordBit.NEW_SETPOINT)
_CHANGE_IMMEDIATELY: Final = int(ControlwordBit.CHANGE_IMMEDIATELY)
_RELATIVE: Final = int(ControlwordBit.RELATIVE)
_SETPOINT_ACKNOWLEDGED: Final = int(Status.SETPOINT_ACKNOWLEDGED)
LOWEST: Final = -(1 << 31)
HIGHEST: Final = (1 << 31) - 1


class ProfilePosition(ModeOfOperation):
    """Mode that moves to the position 0x607A."""

    heeds_halt: ClassVar[bool] = True

    def __init__(self, shaft: Shaft) -> None:
        super().__init__(shaft)
        self._acknowledged = False
        """Bit 12: the set-point was taken and bit 4 is still up."""
        self._waiting: tuple[int, bool] | None = None
        """The set-point after the present one: target (qc) and whether it is relative."""
        self._interrupted = False
        """A halt cut a move short."""

    def forget(self) -> None:
        """Drop set-points and interrupted moves."""
        self._acknowledged = False
        self._waiting = None
        self._interrupted = False

    @property
    def arrived(self) -> bool:
        """Bit 10: there, and no set-point waits."""
        return self.shaft.arrived and (self.shaft.halted or self._waiting is None)

    def status(self, *, failed: bool) -> int:
        """Bit 12: set-point acknowledge; bit 13: following error."""
        return super().status(failed=failed) | (_SETPOINT_ACKNOWLEDGED if self._acknowledged else 0)

    def controls(self, word: int, before: int) -> bool:
        """Take a rising edge of bit 4 for a set-point; in a word that was written each one rises."""
        if not word & _NEW_SETPOINT:
            self._acknowledged = False
            return False
        return not before & _NEW_SETPOINT

    def take_setpoint(self, word: int) -> bool:
        """Take the target position: start it, or keep it until the present one is done; False: no room yet.

        In a halt the new set-point takes the place of the interrupted one, and starts when the halt ends.
        """
        setpoint = self.shaft.store.get(od.TARGET_POSITION), bool(word & _RELATIVE)
        at_once = bool(word & _CHANGE_IMMEDIATELY)
        if self.shaft.halted:
            self._waiting = setpoint
        elif at_once or self.shaft.axis.flags & PROFILE_DONE:
            self._waiting = None
            self._start(*setpoint)
        elif self._waiting is None:
            self._waiting = setpoint
        # One set-point waits; a further one stays latched until there is room, without its acknowledge.
        else:
            return False
        self._acknowledged = True
        return True

    def advance(self) -> None:
        """Start the waiting set-point once the present one is done."""
        if self._waiting is not None and not self.shaft.halted and self.shaft.axis.flags & PROFILE_DONE:
            setpoint, self._waiting = self._waiting, None
            self._start(*setpoint)

    def halt(self) -> None:
        """Come to standstill, and remember the move that this cuts short."""
        axis = self.shaft.axis
        self._interrupted = axis.profile == MOVE and not axis.flags & PROFILE_DONE
        self.shaft.halt()

    def release(self) -> None:
        """Go on with what the halt interrupted, or with the set-point that came meanwhile."""
        if self._waiting is not None:
            setpoint, self._waiting = self._waiting, None
            self._start(*setpoint)
        elif self._interrupted:
            self._go_on()

    def _start(self, target: int, relative: bool) -> None:  # noqa: FBT001 - the pair that waits, unpacked
        axis = self.shaft.axis
        if relative:
            # Relative to the demand value, not to the actual
            # one, so that errors do not add up; rounded to qc.
            target += (axis.position_demand + (1 << axis.fraction >> 1)) >> axis.fraction
        low, high = self.shaft.limits()
        # Refused, not clipped: a clipped target would be reported as reached.
        if not max(low, LOWEST) <= target <= min(high, HIGHEST):
            self.shaft.error = self.shaft.impossible.outside
            return
        axis.target_position = target << axis.fraction
        self._go_on()

    def _go_on(self) -> None:
        cruise = speed_units(self.shaft.axis, self.shaft.store.get(od.PROFILE_VELOCITY))
        self.shaft.move(cruise, od.PROFILE_ACCELERATION, od.PROFILE_DECELERATION)
