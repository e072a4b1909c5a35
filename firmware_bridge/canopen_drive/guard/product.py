"""What differs by product for the guard of a CiA 402 drive: one value for each axis."""

from collections.abc import Mapping
from dataclasses import dataclass

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import StateTable
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.guard.bounds import Units
from firmware_bridge.canopen_drive.guard.values import Values


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardedProduct:
    """One axis's drive, as far as the guard judges it."""

    units: Units
    states: StateTable
    """The power states that its Statusword shows."""
    in_place: int
    """The homing method that turns no shaft."""
    places: Address
    """The object by which homing in place knows where it is."""
    place_sign: int = 1
    """-1 where that object holds the negative of the position."""
    homing: Mapping[Address, range]
    """What its homing with motion may hang on, by the robot file; empty where it is not homed."""
    kinds: Mapping[Address, DataType]
    """The objects of its own among those."""
    writes: Mapping[Address, Values]
    """Objects that may be written beside those of every drive."""
