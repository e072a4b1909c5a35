"""Master encoder mode and step/direction mode: the shaft follows the digital position input by a gear.

Source: maxon EDS (0x2300, 0x607F, 0x60C5). Where it is silent:
* both modes count the same input: the second encoder's quadcounts, or the steps;
* counting begins when the mode gets the shaft, at the position demand plus the offset 0x2300:05, so that
  nothing jumps; an offset that changes later moves the shaft by the difference;
* polarity 0x2300:04 is 1 for the other way round; the way that the scaling leaves over is not lost;
* speed and acceleration stay within 0x607F and 0x60C5, the target within 0x607D; halt is not heeded.
"""

from typing import ClassVar, Final

from emulators.drive.mode import ModeOfOperation
from emulators.drive.shaft import Shaft
from emulators.servo.axis import ELECTRONIC_GEAR
from emulators.servo.commands import judge_again
from emulators.servo.profile import stopping_distance
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address

NUMERATOR: Final = Address(0x2300, 2)
DENOMINATOR: Final = Address(0x2300, 3)
POLARITY: Final = Address(0x2300, 4)
OFFSET: Final = Address(0x2300, 5)


class DigitalPosition(ModeOfOperation):
    """Mode that follows a second encoder or steps, from standstill on."""

    heeds: ClassVar[tuple[Address, ...]] = (NUMERATOR, DENOMINATOR, POLARITY, OFFSET)

    def __init__(self, shaft: Shaft) -> None:
        super().__init__(shaft)
        self._following = False

    def enter(self) -> None:
        """Come to standstill; then it follows."""
        super().enter()
        self._following = False

    def forget(self) -> None:
        """Let go of the input."""
        self._following = False

    def advance(self) -> None:
        """Begin to follow once the shaft rests."""
        if not self._following and self.shaft.stopped:
            self._following = True
            self._follow()

    def written(self, address: Address, value: int) -> None:
        """Take another gear at once; another offset moves the target."""
        if not self._following:
            return
        store, axis = self.shaft.store, self.shaft.axis
        if address == OFFSET:
            # The store still has the former offset: hooks run before it takes a value.
            axis.target_position += value - store.get(OFFSET) << axis.fraction
        else:
            gear = {each: store.get(each) for each in (NUMERATOR, DENOMINATOR, POLARITY)} | {address: value}
            self._gear(gear[NUMERATOR], gear[DENOMINATOR], gear[POLARITY])

    def _follow(self) -> None:
        store, axis = self.shaft.store, self.shaft.axis
        # Counts from before this mode must not move the shaft.
        axis.gear_counted, axis.gear_rest = axis.master, 0
        self._gear(store.get(NUMERATOR), store.get(DENOMINATOR), store.get(POLARITY))
        low, high = self.shaft.limits()
        axis.lowest, axis.highest = low << axis.fraction, high << axis.fraction
        axis.cruise = self.shaft.fastest()
        axis.acceleration = axis.deceleration = self.shaft.acceleration(od.MAX_ACCELERATION)
        axis.stopping_distance = stopping_distance(axis.cruise, axis.deceleration)
        axis.target_position = axis.position_demand + (store.get(OFFSET) << axis.fraction)
        axis.profile = ELECTRONIC_GEAR
        judge_again(axis, there=False)

    def _gear(self, numerator: int, denominator: int, polarity: int) -> None:
        axis = self.shaft.axis
        numerator = -numerator if polarity else numerator
        # What the scaling leaves over belongs to the gear that it is left by.
        if (numerator, denominator) != (axis.gear_numerator, axis.gear_denominator):
            axis.gear_numerator, axis.gear_denominator, axis.gear_rest = numerator, denominator, 0
