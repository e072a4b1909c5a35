"""The selection of the mode of operation that moves the shaft, of those that a product has."""

from collections.abc import Mapping
from typing import Final

from emulators.drive.mode import ModeOfOperation
from emulators.drive.shaft import Shaft
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import ControlwordBit
from firmware_bridge.canopen.emergency import NO_ERROR

# The controlword's bits as plain numbers: flags are slow, and every frame is looked at.
_HALT: Final = int(ControlwordBit.HALT)
_NEW_SETPOINT: Final = int(ControlwordBit.NEW_SETPOINT)


class ModeSelector:
    """The mode that is set, and all others. Every method but those of the status needs power."""

    def __init__(self, shaft: Shaft, modes: Mapping[int, type[ModeOfOperation]]) -> None:
        """`modes`: by their numbers in 0x6060; none of them is set before `restart`."""
        self.shaft: Final = shaft
        self._modes: Final = {number: mode(shaft) for number, mode in modes.items()}
        self._other: Final = ModeOfOperation(self.shaft)
        """Mode for a number that no mode has: none is set, or it comes from edited saved parameters."""
        self.number = 0
        """The mode that is set, as in 0x6060."""
        self.mode = self._other
        self._latching = False
        """A rising edge of bit 4 whose target is taken when the whole write has arrived."""

    def set(self, number: int) -> None:
        """Set the mode of a drive that is not enabled."""
        self.number = number
        self.mode = self._modes.get(number, self._other)

    def restart(self, number: int) -> None:
        """Begin as after power-on, in a mode."""
        for mode in self._modes.values():
            mode.restart()
        self.shaft.error = NO_ERROR
        self.shaft.referenced = False
        self.forget()
        self.set(number)

    def forget(self) -> None:
        """Drop what was going on: the power stage is off, or a stop has cut in."""
        self.shaft.halted = False
        self._latching = False
        self.mode.forget()

    def hold(self) -> None:
        """Hold the shaft before the mode may have it: the brake is still on its way."""
        self.forget()
        self.shaft.hold()

    def begin(self, controlword: int) -> None:
        """Start from standstill or from where the shaft is: the drive has become enabled."""
        self.forget()
        # maxon's library enables with 0x010F: the mode has to begin halted.
        self.shaft.halted = bool(controlword & _HALT)
        self.mode.begin()

    def change(self, number: int, *, enabled: bool) -> None:
        """Take a mode over, with the halt that stands and without a set-point that no one has taken.

        The mode that is set already changes nothing: the default RPDO2 carries it behind each controlword.
        """
        if number == self.number:
            return
        # A set-point of the former mode must not start a move in this one.
        self._latching = False
        self.mode.forget()
        self.set(number)
        if enabled:
            self.mode.enter()

    def controls(self, controlword: int, before: int) -> None:
        """Heed halt and the mode's own bits while enabled; a new set-point is taken by `advance`."""
        halt = bool(controlword & _HALT)
        if halt != self.shaft.halted and self.mode.heeds_halt:
            self.shaft.halted = halt
            if halt:
                self.mode.halt()
            else:
                self.mode.release()
        if self.mode.controls(controlword, before):
            self._latching = True
            # The target may follow in the same PDO: it is taken at the next refresh, in 1 ms at most.
            self.shaft.axis.call = 1
        elif not controlword & _NEW_SETPOINT:
            self._latching = False

    def advance(self, controlword: int) -> None:
        """Go on with what is due; a rising edge of bit 4 counts with the target that is written by now."""
        self.mode.advance()
        if self._latching and self.mode.take_setpoint(controlword):
            self._latching = False

    def written(self, address: Address, value: int) -> None:
        """Give the mode a value that was written, if it heeds that object."""
        if address in self.mode.heeds:
            self.mode.written(address, value)
