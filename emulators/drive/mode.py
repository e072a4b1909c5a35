"""A mode of operation: the calls that the drive makes, and the default reaction to each.

A mode that adds nothing brings the shaft to standstill and holds its position, as a real drive does in a mode
before its start signal.
"""

from typing import ClassVar, Final

from emulators.drive.shaft import Shaft
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Status

_FOLLOWING_ERROR: Final = int(Status.FOLLOWING_ERROR)


class ModeOfOperation:
    """One mode. All but `forget` and the status are called only while the drive is enabled and free."""

    heeds_halt: ClassVar[bool] = False
    """True if bit 8 of the controlword counts."""
    goes_by_writes: ClassVar[bool] = False
    """True if each write of a controlword with bit 4 is a set-point, not only one that raises it."""
    heeds: ClassVar[tuple[Address, ...]] = ()
    """Objects whose writes `written` takes."""

    def __init__(self, shaft: Shaft) -> None:
        self.shaft: Final = shaft

    # Taking over and letting go

    def begin(self) -> None:
        """Take the shaft over from where it is: the drive has become enabled."""
        self.enter()

    def enter(self) -> None:
        """Take the shaft over, maybe moving: the mode has changed. Assumed: it is stopped by 0x6084."""
        self.shaft.hold()

    def forget(self) -> None:
        """Drop what was going on: the power stage is off, a stop has cut in, or the mode has changed."""

    def fail(self) -> None:
        """Take note of a fault: `forget` follows where it ends the motion."""

    def restart(self) -> None:
        """Begin as after power-on."""
        self.forget()

    # At work

    def halt(self) -> None:
        """Bit 8 has come up."""
        self.shaft.halt()

    def release(self) -> None:
        """Bit 8 has gone down."""

    def controls(self, word: int, before: int) -> bool:
        """Heed the controlword's bits 4 to 6; return True if a set-point awaits `take_setpoint`."""
        del word, before
        return False

    def take_setpoint(self, word: int) -> bool:
        """Take the set-point that the objects hold by now; say whether there was room for it."""
        del word
        return True

    def written(self, address: Address, value: int) -> None:
        """Take a new value of an object that the mode heeds; the store has not got it yet."""

    def advance(self) -> None:
        """Execute the actions that are due; called after every event and every command."""

    # Status

    @property
    def sought(self) -> int:
        """Switches that the mode is looking for, as a mask."""
        return 0

    @property
    def arrived(self) -> bool:
        """Bit 10: the target is reached, or the halt has come to its end."""
        return self.shaft.arrived

    def status(self, *, failed: bool) -> int:
        """Return bits 12 and 13; `failed`: the following error is present."""
        return _FOLLOWING_ERROR if failed else 0
