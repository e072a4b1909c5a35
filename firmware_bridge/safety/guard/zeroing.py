"""One drive that is told where its axis stands: what it may be sent for it, and in which order.

Homing by method 35 turns no shaft; by any other the word that starts it does. So that word passes only where
the drive itself has said, since it was last written to, that the method is 35, that the home position is
within the axis's travel, and that its mode is homing. In that mode no new position passes, and the mode is
left only when the word that starts is out of force: in another one it would be a new position.
"""

from typing import Final

from firmware_bridge.robot import Axis, Command
from firmware_bridge.safety.guard.bounds import ends_qc
from firmware_bridge.safety.guard.epos2_words import ENABLE, HALT, NEW_SET_POINT, START_HOMING
from firmware_bridge.wire.cia402 import Mode
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.rows import DataType

ACTUAL_POSITION: Final = 35
OWN_MODE: Final = {Command.SPEED: Mode.PROFILE_VELOCITY, Command.POSITION: Mode.PROFILE_POSITION}
READ: Final = {
    at.MODE: DataType.INTEGER8,
    at.MODE_DISPLAY: DataType.INTEGER8,
    at.HOME_POSITION: DataType.INTEGER32,
    at.HOMING_METHOD: DataType.INTEGER8,
}
"""What the drive says of itself that counts here."""
WRITTEN: Final = {
    at.MODE: DataType.INTEGER8,
    at.HOME_POSITION: DataType.INTEGER32,
    at.HOMING_METHOD: DataType.INTEGER8,
}
_PREPARED: Final = (at.MODE, at.HOME_POSITION, at.HOMING_METHOD)
_SAME: Final = {at.MODE: at.MODE_DISPLAY}
"""Which object tells that another one was written."""


class Zeroing:
    """What one drive was told, and has said, of its homing."""

    __slots__ = ("_own", "_said", "homes", "in_homing")

    def __init__(self, axis: Axis) -> None:
        """Take the axis; one without travel has no zero to be set."""
        low, high = ends_qc(axis)
        self.homes: Final = None if axis.travel is None else range(low, high + 1)
        """The home positions that it may be given, in quadcounts; None for none."""
        self._own: Final = int(OWN_MODE[axis.command])
        self.in_homing = False
        """Whether it was sent to homing mode, and has not said since that it is in its own."""
        self._said: dict[Address, int] = {}

    @property
    def prepared(self) -> bool:
        """Whether the drive has said that to start its homing moves nothing."""
        said = self._said
        home = said.get(at.HOME_POSITION)
        return (
            self.in_homing
            and said.get(at.MODE_DISPLAY) == Mode.HOMING
            and said.get(at.HOMING_METHOD) == ACTUAL_POSITION
            and home is not None
            and self.homes is not None
            and home in self.homes
        )

    def refuses_write(self, address: Address, value: int, word: int, moving: str | None) -> str | None:
        """Return why an object may not be written now; `word` is in force, `moving` says who moves."""
        if address not in _PREPARED:
            return None
        if address == at.MODE and value == self._own:
            return (
                "bit 4 is up, and would be a new position in another mode" if word == START_HOMING else None
            )
        return None if moving is None else f"{address} written while {moving} may move"

    def refuses_word(self, word: int, *, by_object: bool) -> str | None:
        """Return why a controlword may not be sent now; `by_object` where it is by SDO."""
        if word == START_HOMING and not self.prepared:
            return "the drive has not said that its homing moves nothing"
        if word == NEW_SET_POINT and self.in_homing:
            return "a new position in homing mode"
        if by_object and word in {ENABLE, HALT} and not self.in_homing:
            return f"controlword 0x{word:04X} by object"
        return None

    def wrote(self, address: Address, value: int) -> None:
        """Note what was written: what the drive has said of it before counts no more."""
        if address in _PREPARED:
            self._said.pop(_SAME.get(address, address), None)
            self.in_homing = self.in_homing or (address == at.MODE and value == Mode.HOMING)

    def read(self, address: Address, value: int) -> None:
        """Note what the drive has said."""
        self._said[address] = value
        if address in {at.MODE, at.MODE_DISPLAY} and value == self._own:
            self.in_homing = False

    def restarted(self) -> None:
        """Note that the drive starts anew, in the mode that was saved, and with any method."""
        self._said.clear()
        self.in_homing = False
