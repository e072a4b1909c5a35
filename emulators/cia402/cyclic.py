"""Cyclic synchronous position, velocity and torque mode: the master makes the profile, the drive follows it.

Source: CiA 402-2. Set-points count as soon as they are there, without a start bit; a PDO of a synchronous
type brings them with SYNC. Between two positions the drive goes at one speed, for the time 0x60C2; with a
time too short it stops and goes, with one too long it lags. Assumed: a target beyond 0x607D, and a way
faster than 0x607F and 0x6080, is shortened, and bit 11 shows that; halt brakes, and the next set-point after
it counts. Not described here: torque offsets in position and velocity mode.
"""

from abc import ABC, abstractmethod
from typing import ClassVar, Final

from emulators.drive.mode import ModeOfOperation
from emulators.drive.shaft import Shaft
from emulators.servo import spline
from emulators.servo.axis import CURRENT, DIRECT
from emulators.servo.commands import regulate_position, regulate_velocity
from emulators.servo.scaling import speed_units
from emulators.servo.spline import SplineSegment
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Status
from firmware_bridge.families.cia402.wire import address as at

PER_MILLE: Final = 1000
_FOLLOWS: Final = int(Status.SETPOINT_ACKNOWLEDGED)
"""Bit 12 in these modes: the drive follows the command value."""


class CyclicMode(ModeOfOperation, ABC):
    """A mode whose set-points count when they are written, and whenever the mode begins."""

    heeds_halt: ClassVar[bool] = True

    def __init__(self, shaft: Shaft) -> None:
        super().__init__(shaft)
        self.limited = False
        """The newest set-point was beyond a limit: bit 11."""

    def enter(self) -> None:
        """Follow what the objects hold by now; in a halt come to standstill."""
        # Masters enable with bit 8 set, and with a set-point of before: that must move nothing.
        if self.shaft.halted:
            self.shaft.hold()
        else:
            self._follow({})

    def forget(self) -> None:
        """Drop the limit."""
        self.limited = False

    def release(self) -> None:
        """Follow again."""
        self._follow({})

    def written(self, address: Address, value: int) -> None:
        """Take a new set-point or offset."""
        if not self.shaft.halted:
            self._follow({address: value})

    @abstractmethod
    def _follow(self, new: dict[Address, int]) -> None:
        """Go by the objects; `new` holds those that the store has not got yet."""

    def _sum(self, new: dict[Address, int], *addresses: Address) -> int:
        store = self.shaft.store
        return sum(new[each] if each in new else store.get(each) for each in addresses)

    @property
    def arrived(self) -> bool:
        """Bit 10: the halt has come to its end."""
        return self.shaft.halted and self.shaft.arrived

    def status(self, *, failed: bool) -> int:
        """Bit 12: follows the command value; bit 13: following error."""
        return super().status(failed=failed) | (0 if self.shaft.halted else _FOLLOWS)


class CyclicPosition(CyclicMode):
    """Mode that follows 0x607A + 0x60B0."""

    heeds: ClassVar[tuple[Address, ...]] = (od.TARGET_POSITION, at.POSITION_OFFSET)

    def _follow(self, new: dict[Address, int]) -> None:
        axis, shaft = self.shaft.axis, self.shaft
        regulate_position(axis)
        low, high = shaft.limits()
        wanted = self._sum(new, od.TARGET_POSITION, at.POSITION_OFFSET)
        target = max(low, min(high, wanted))
        period = _milliseconds(shaft)
        way = (target << axis.fraction) - axis.position_demand
        longest = shaft.fastest() * period
        bounded = max(-longest, min(longest, way))
        self.limited = target != wanted or bounded != way
        spline.begin(axis, SplineSegment(axis.position_demand, bounded, 0, 0, period))


class CyclicVelocity(CyclicMode):
    """Mode that regulates to 0x60FF + 0x60B1."""

    heeds: ClassVar[tuple[Address, ...]] = (od.TARGET_VELOCITY, at.VELOCITY_OFFSET)

    def _follow(self, new: dict[Address, int]) -> None:
        axis, wanted = self.shaft.axis, self._sum(new, od.TARGET_VELOCITY, at.VELOCITY_OFFSET)
        regulate_velocity(axis)
        axis.profile = DIRECT
        speed = self.shaft.bounded(wanted)
        axis.velocity_demand = axis.target_velocity = speed
        self.limited = speed != speed_units(axis, wanted)


class CyclicTorque(CyclicMode):
    """Mode that regulates to 0x6071 + 0x60B2, as a current."""

    heeds: ClassVar[tuple[Address, ...]] = (at.TARGET_TORQUE, at.TORQUE_OFFSET)

    def _follow(self, new: dict[Address, int]) -> None:
        axis, store = self.shaft.axis, self.shaft.store
        wanted = self._sum(new, at.TARGET_TORQUE, at.TORQUE_OFFSET)
        most = min(store.get(at.MAX_TORQUE), store.get(at.MAX_CURRENT))
        torque = max(-most, min(most, wanted))
        self.limited = torque != wanted
        axis.regulator, axis.profile = CURRENT, DIRECT
        axis.velocity_demand = 0
        axis.current_setting_ma = torque * store.get(at.RATED_CURRENT) // PER_MILLE


def _milliseconds(shaft: Shaft) -> int:
    """Return the interpolation time in whole milliseconds, 1 at least: the profile runs at 1 kHz."""
    value, exponent = shaft.store.get(at.PERIOD), shaft.store.get(at.PERIOD_EXPONENT)
    return max(1, round(value * 10.0 ** (exponent + 3)))
