"""What differs by product between the drives of CiA 402: one value for each axis's drive."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import StateTable
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.drivers.driver import Reports
from firmware_bridge.units import Nanoseconds


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveProduct:
    """One axis's drive as its product has it."""

    reports: frozenset[Reports]
    states: StateTable
    """The power states that its Statusword shows."""
    causes: Mapping[int, str]
    """Causes of its errors by their codes, for people."""
    current: Address
    """The motor's current: INTEGER16, mapped into its sample."""
    amperes: float
    """Of one unit of that."""
    velocity: Address
    """The motor's speed: INTEGER32, read until it stands."""
    standstill: int
    """Most that this shows of a resting shaft."""
    referenced: int = 0
    """Statusword bits of a drive that knows its position; 0: it has none."""
    identity: tuple[SetupObject, ...]
    """What it must answer before anything is written to it."""
    commissioned: tuple[SetupObject, ...]
    """What belongs to motor and mechanics: what who commissions the axis saves in its drive, too."""
    in_place: Callable[[int], tuple[SetupObject, ...]]
    """Return what a homing hangs on that turns no shaft: the present place becomes this position, counts."""
    homing: tuple[SetupObject, ...] = ()
    """What the homing by the robot file hangs on; empty without one."""
    controlword_gap: Nanoseconds = 0
    """Least time between two Controlwords whose order counts."""
    mode_within: Nanoseconds = 0
    """Time until it shows a mode that was written; 0: at once."""
    mode_hint: str = ""
    """What a drive that does not show it is like, for people."""
    boot_polls: int = 5
    """Attempts to read the Statusword of a drive that starts."""
