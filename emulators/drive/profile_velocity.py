"""Profile velocity mode: ramps to a velocity, with halt."""

from typing import ClassVar, Final

from emulators.drive.mode import ModeOfOperation
from emulators.servo.axis import AT_REST
from emulators.servo.commands import regulate_velocity
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Status

_SPEED_IS_ZERO: Final = int(Status.SPEED_IS_ZERO)


class ProfileVelocity(ModeOfOperation):
    """Mode that regulates to the velocity 0x60FF."""

    heeds_halt: ClassVar[bool] = True
    heeds: ClassVar[tuple[Address, ...]] = (od.TARGET_VELOCITY,)

    def begin(self) -> None:
        """Go over to the velocity that the object holds."""
        regulate_velocity(self.shaft.axis)
        self._go(self.shaft.store.get(od.TARGET_VELOCITY))

    def enter(self) -> None:
        """Come to standstill; a velocity counts when it is written, or with the next controlword."""
        regulate_velocity(self.shaft.axis)
        self.shaft.brake()

    def controls(self, word: int, before: int) -> bool:
        """Every controlword starts the velocity that the object holds."""
        del word, before
        self._go(self.shaft.store.get(od.TARGET_VELOCITY))
        return False

    def written(self, address: Address, value: int) -> None:
        """Go over to another velocity in rpm."""
        del address
        self._go(value)

    def _go(self, rpm: int) -> None:
        """Ramp to a velocity within 0x607F and the motor's; in a halt the ramp goes to 0."""
        shaft = self.shaft
        # Halt keeps 0x60FF: without it the ramp goes back to that velocity.
        if shaft.halted:
            shaft.ramp(0, od.PROFILE_ACCELERATION, shaft.halt_deceleration)
        else:
            shaft.ramp(shaft.bounded(rpm), od.PROFILE_ACCELERATION, od.PROFILE_DECELERATION)

    def status(self, *, failed: bool) -> int:
        """Bit 12: speed is 0; bit 13 is not used."""
        del failed
        return _SPEED_IS_ZERO if self.shaft.axis.flags & AT_REST else 0
