"""Referencing and homing of one drive's axis: the permitted commands and their order.

Homing in place turns no shaft; by any other method the Controlword that starts it does. So that one passes
only where the drive itself has reported, since it was last written to, that its mode is homing, and either
that the method is the one in place and the position within the axis's travel, or that all is by the robot
file: method and places, and speeds, acceleration and current not above the file's. In that mode no new
position passes, and the mode is left only when the Controlword that starts is out of force: in another one it
would be a new position.
"""

import math
from collections.abc import Mapping
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Mode
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.guard.bounds import Units, ends, speed_per_unit
from firmware_bridge.canopen_drive.guard.product import GuardedProduct
from firmware_bridge.canopen_drive.guard.words import ENABLE, HALT, NEW_SET_POINT, START_HOMING
from firmware_bridge.robot import Axis, CommandForm
from firmware_bridge.safety.guard.wire_rules import ROUNDING

OWN_MODE: Final = {CommandForm.SPEED: Mode.PROFILE_VELOCITY, CommandForm.POSITION: Mode.PROFILE_POSITION}
WRITTEN: Final = {
    od.MODE: DataType.INTEGER8,
    od.HOMING_METHOD: DataType.INTEGER8,
    od.HOME_OFFSET: DataType.INTEGER32,
    od.HOMING_SPEED_SWITCH: DataType.UNSIGNED32,
    od.HOMING_SPEED_ZERO: DataType.UNSIGNED32,
    od.HOMING_ACCELERATION: DataType.UNSIGNED32,
}
"""The objects of every drive whose values decide what a homing does."""
_SAME: Final = {od.MODE: od.MODE_DISPLAY}
"""The object that confirms the write of another one."""


def searched(axis: Axis, units: Units) -> Mapping[Address, range]:
    """Return how an axis may move for homing by the robot file; nothing where it is not homed."""
    homing = axis.zero.homing
    if homing is None or axis.travel is None:
        return {}
    per_unit = abs(speed_per_unit(axis, units))
    return {
        od.HOMING_METHOD: only(homing.method),
        od.HOMING_SPEED_SWITCH: up_to(homing.speed * per_unit),
        od.HOMING_SPEED_ZERO: up_to(homing.zero_speed * per_unit),
        od.HOMING_ACCELERATION: up_to(homing.acceleration * per_unit),
    }


def only(value: int) -> range:
    """Return one value."""
    return range(value, value + 1)


def up_to(value: float) -> range:
    """Return the whole numbers from 1 on that are not above a value; 1 in any case."""
    return range(1, max(1, math.floor(value * (1.0 + ROUNDING))) + 1)


class Zeroing:
    """The homing objects of one drive, as written and as reported."""

    __slots__ = ("_in_place", "_own", "_reported", "_ways", "in_homing", "read_kinds", "within_s", "written")

    def __init__(self, axis: Axis, product: GuardedProduct) -> None:
        """Take the axis and its drive; one without travel has no zero to be set."""
        self._in_place: Final = product.in_place
        self.written: Final = {**WRITTEN, **product.kinds}
        """The objects whose writes count here, with their types."""
        self.read_kinds: Final = self.written | {od.MODE_DISPLAY: DataType.INTEGER8}
        """The objects whose values the drive reports and that count here."""
        # A method in place turns no shaft, so neither speeds nor current need to be known.
        in_place: Mapping[Address, range] = {}
        if axis.travel is not None:
            low, high = sorted(product.place_sign * end for end in ends(axis, product.units))
            in_place = {od.HOMING_METHOD: only(product.in_place), product.places: range(low, high + 1)}
        self._ways: Final = tuple(way for way in (in_place, product.homing) if way)
        """The sets of values that the drive must have reported; one of them is enough."""
        homing = axis.zero.homing
        self.within_s: Final = 0.0 if homing is None else homing.within_s
        """Longest permitted time of its homing, in s."""
        self._own: Final = int(OWN_MODE[axis.command])
        self.in_homing = False
        """True from its switch to homing mode until it reports its own mode."""
        self._reported: dict[Address, int] = {}

    @property
    def prepared(self) -> bool:
        """True where its reports prove that its homing moves nothing, or runs by the robot file."""
        reported = self._reported
        # 0x6061, not 0x6060: the mode counts once the drive reports it, as it may refuse the switch or delay
        # it.
        homes = self.in_homing and reported.get(od.MODE_DISPLAY) == Mode.HOMING
        return homes and any(
            all(reported.get(address) in allowed for address, allowed in way.items()) for way in self._ways
        )

    @property
    def turns(self) -> bool:
        """True where its homing would turn its shaft, as far as reported."""
        return self._reported.get(od.HOMING_METHOD) != self._in_place

    def refuses_write(self, address: Address, value: int, word: int | None, moving: str | None) -> str | None:
        """Return why one of `WRITTEN` may not be written now; `word` is in force, `moving` moves."""
        if address == od.MODE and value == self._own:
            return (
                "bit 4 is up, and would be a new position in another mode" if word == START_HOMING else None
            )
        return None if moving is None else f"{address} written while {moving} may move"

    def refuses_word(self, word: int, *, by_object: bool) -> str | None:
        """Return why a controlword may not be sent now; `by_object` where it is by SDO."""
        if word == START_HOMING and not self.prepared:
            moves = (
                "nothing"
                if len(self._ways) < len(("in place", "by file"))
                else "no more than the file allows"
            )
            return f"the drive has not reported that its homing moves {moves}"
        # In this mode bit 4 starts a homing, and the target may be in counts of another reference.
        if word == NEW_SET_POINT and self.in_homing:
            return "a new position in homing mode"
        if by_object and word in {ENABLE, HALT} and not self.in_homing:
            return f"controlword 0x{word:04X} by object"
        return None

    def wrote(self, address: Address, value: int) -> None:
        """Note a write of one of `WRITTEN`: the drive's earlier report of it no longer counts."""
        self._reported.pop(_SAME.get(address, address), None)
        self.in_homing = self.in_homing or (address == od.MODE and value == Mode.HOMING)

    def read(self, address: Address, value: int) -> None:
        """Note a value that the drive reports."""
        self._reported[address] = value
        if address in {od.MODE, od.MODE_DISPLAY} and value == self._own:
            self.in_homing = False

    def restarted(self) -> None:
        """Note that the drive starts again, in the mode that was saved, and with any method."""
        self._reported.clear()
        self.in_homing = False
