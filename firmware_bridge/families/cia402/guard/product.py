"""What the guard knows of a CiA 402 drive of any maker: units, states, objects that may be written.

Sources: CiA 402-2 for objects and types; robot file for values.
"""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import STATES
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.guard.bounds import Units, counts_per_unit
from firmware_bridge.canopen_drive.guard.can import DriveCanRules
from firmware_bridge.canopen_drive.guard.product import GuardedProduct
from firmware_bridge.canopen_drive.guard.values import Values, exactly, within
from firmware_bridge.canopen_drive.guard.zeroing import only, searched
from firmware_bridge.families.cia402.settings import Cia402Axis, Home
from firmware_bridge.families.cia402.wire.address import FACTORS, MAX_CURRENT, MAX_MOTOR_SPEED, PERIOD
from firmware_bridge.robot import AnyRobot, Axis

I16: Final = DataType.INTEGER16
I32: Final = DataType.INTEGER32
U8: Final = DataType.UNSIGNED8
U16: Final = DataType.UNSIGNED16
U32: Final = DataType.UNSIGNED32
CURRENT_POSITION: Final = 37
"""The homing method that turns no shaft."""
QUICK_STOP_THEN_OFF: Final = 2


def units(axis: Axis) -> Units:
    """Return what the drive of an axis counts in."""
    settings = Cia402Axis.of(axis)
    by_rpm = settings.speed_units_per_rpm
    return Units(settings.encoder_counts, by_rpm, "rpm" if by_rpm == 1.0 else "units of speed", "counts")


def product(axis: Axis, _robot: AnyRobot) -> GuardedProduct:
    """Return what the drive of an axis is."""
    return GuardedProduct(
        units=units(axis),
        states=STATES,
        in_place=CURRENT_POSITION,
        places=od.HOME_OFFSET,
        place_sign=_sign(axis),
        homing=by_file(axis),
        kinds={},
        writes=_writes(axis),
    )


def can_rules(robot: AnyRobot, link: str) -> DriveCanRules:
    """Return the rules of a link."""
    return DriveCanRules(robot, link, product)


def by_file(axis: Axis) -> Mapping[Address, range]:
    """Return what the homing of an axis may hang on, by the robot file; nothing where it is not homed."""
    homing = axis.zero.homing
    if homing is None or axis.travel is None:
        return {}
    at = round(homing.at * counts_per_unit(axis, units(axis)))
    return {**searched(axis, units(axis)), od.HOME_OFFSET: only(_sign(axis) * at)}


def _sign(axis: Axis) -> int:
    """Return the sign of 0x607C beside that of the position at home."""
    return 1 if Cia402Axis.of(axis).home is Home.ITSELF else -1


def _writes(axis: Axis) -> Mapping[Address, Values]:
    settings = Cia402Axis.of(axis)
    share = settings.peak_current_ma / settings.continuous_current_ma
    factors = (
        {}
        if settings.factors is None
        else {address: exactly(U32, getattr(settings.factors, key)) for address, key in FACTORS.items()}
    )
    return {
        **factors,
        MAX_CURRENT: within(U16, 0, int(share * 1000)),
        MAX_MOTOR_SPEED: within(U32, 1, units(axis).speed(settings.profile.max_velocity_rpm)),
        od.QUICK_STOP_OPTION: exactly(I16, QUICK_STOP_THEN_OFF),
        PERIOD: within(U8, 1, U8.highest),
    }
