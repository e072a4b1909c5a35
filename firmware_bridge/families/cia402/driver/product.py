"""What a CiA 402 drive of any maker is: the standard's objects, states and homing, and nothing beside it.

Sources: CiA 301 and CiA 402-2. An object that drives in the field lack is optional: without it they do what
the standard has as the default.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import STATES
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.driver.product import DriveProduct
from firmware_bridge.canopen_drive.driver.scale import Scale, in_units, travel_of
from firmware_bridge.canopen_drive.driver.setup import (
    MODE,
    SERVO_DRIVE,
    method_row,
    motion_rows,
    on_the_bus,
    over_can,
    range_rows,
    search_rows,
)
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.drivers.driver import Reports
from firmware_bridge.families.cia402.settings import Cia402Axis, Cia402Link, Home
from firmware_bridge.families.cia402.wire.address import (
    FACTORS,
    MAX_CURRENT,
    MAX_MOTOR_SPEED,
    PERIOD,
    RATED_CURRENT,
)
from firmware_bridge.families.cia402.wire.causes import CAUSES
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

I8: Final = DataType.INTEGER8
I16: Final = DataType.INTEGER16
I32: Final = DataType.INTEGER32
U8: Final = DataType.UNSIGNED8
U16: Final = DataType.UNSIGNED16
U32: Final = DataType.UNSIGNED32

REPORTS: Final = frozenset(Reports) - {Reports.ZERO}
"""No bit of the Statusword reports that a drive has been referenced; its restart is seen."""
QUICK_STOP_THEN_OFF: Final = 2
"""0x605A: the quick-stop ramp, then Switch On Disabled (CiA 402-2)."""
IN_PLACE: Final = 37
"""0x6098: the current position is home (CiA 402-2)."""
PROFILE: Final = 0xFFFF
"""The bits of 0x1000 that name the profile; the others are the kind of drive."""
PER_MILLE: Final = 1000
MILLIAMPERES: Final = 1000.0
STANDSTILL_RPM: Final = 5
"""A shaft below it stands still (assumed): above the noise of a speed made from encoder edges."""
LONGEST_PERIOD_MS: Final = 255
"""0x60C2:01 is UNSIGNED8; its unit is 1 ms by the default of 0x60C2:02, -3 (CiA 402-2)."""
CONTROLWORD_GAP: Final[Nanoseconds] = 2 * MILLISECOND
"""Some drives do not see a Controlword less than 1 ms after the one before."""
MODE_HINT: Final = (
    "; it takes no mode with its power on, or while it is halted (docs/variations.md: mode-without-power, "
    "no-mode-while-halted)"
)
BOOT_POLLS: Final = 40
"""Reads of 0x1000 after a reset until a drive is absent (assumed): above the 1.5 s of the slowest known."""
MODE_WITHIN: Final[Nanoseconds] = 10 * SECOND
"""One drive known synchronizes for 5 s before it is in a mode."""
OPTIONAL: Final = frozenset(
    {
        od.FAULT_REACTION_OPTION,
        od.MOTION_PROFILE_TYPE,
        od.MAX_PROFILE_VELOCITY,
        od.QUICK_STOP_OPTION,
        MAX_MOTOR_SPEED,
        MAX_CURRENT,
        PERIOD,
    }
)


def product(axis: Axis) -> DriveProduct:
    """Return what the drive of an axis is."""
    settings = Cia402Axis.of(axis)
    return DriveProduct(
        reports=REPORTS,
        states=STATES,
        causes=CAUSES,
        current=Address(settings.current_object),
        amperes=settings.continuous_current_ma / PER_MILLE / MILLIAMPERES,
        velocity=od.VELOCITY_ACTUAL,
        standstill=in_units(axis, STANDSTILL_RPM),
        identity=tuple(_identity(settings)),
        commissioned=tuple(_commissioned(axis)),
        in_place=_in_place if settings.home is Home.NEGATIVE else _in_place_itself,
        homing=by_homing(axis),
        controlword_gap=CONTROLWORD_GAP,
        mode_within=MODE_WITHIN,
        mode_hint=MODE_HINT,
        boot_polls=BOOT_POLLS,
    )


def configuration(axis: Axis, robot: AnyRobot) -> tuple[SetupObject, ...]:
    """Return what is written in pre-operational, with the power stage off, in this order."""
    link = Cia402Link.of_link(robot, axis.link)
    flows = over_can(axis, link, Address(Cia402Axis.of(axis).current_object))
    rows = (*on_the_bus(axis, link, flows), *_period(link.every * robot.cycle_ms), *_commissioned(axis))
    return tuple(_hinted(replace(row, optional=row.address in OPTIONAL)) for row in rows)


def _identity(settings: Cia402Axis) -> Iterator[SetupObject]:
    yield SetupObject(
        od.DEVICE_TYPE,
        U32,
        SERVO_DRIVE,
        "device type",
        "a CiA 402 drive answers",
        mask=PROFILE,
    )
    same = "the drive that the robot file names"
    yield SetupObject(od.VENDOR_ID, U32, settings.vendor_id, "vendor", same)
    yield SetupObject(od.PRODUCT_CODE, U32, settings.product_code, "product code", same)
    yield SetupObject(
        RATED_CURRENT,
        U32,
        settings.continuous_current_ma,
        "rated current",
        "its currents are thousandths of it",
        hint="; its maker's tool sets it, and continuous_current_ma must be the same",
    )


def _period(cycle_ms: int) -> Iterator[SetupObject]:
    why = "some drives are not enabled before it was written"
    yield SetupObject(PERIOD, U8, min(cycle_ms, LONGEST_PERIOD_MS), "interpolation period", why)


def _commissioned(axis: Axis) -> Iterator[SetupObject]:
    settings, profile = Cia402Axis.of(axis), Cia402Axis.of(axis).profile
    protects = "protects the motor and people near it"
    if settings.factors is not None:
        # Before all positions, which are in their unit.
        for address, key in FACTORS.items():
            yield SetupObject(
                address,
                U32,
                getattr(settings.factors, key),
                f"factor {key}",
                "positions are in its unit",
                read_back=True,
                hint="; where the drive has it fixed, leave factors out",
            )
    most, top = in_units(axis, profile.max_velocity_rpm), settings.peak_current_ma * PER_MILLE
    for address, kind, value, name, why in (
        (MAX_CURRENT, U16, top // settings.continuous_current_ma, "current limit", protects),
        (MAX_MOTOR_SPEED, U32, most, "motor speed limit", protects),
        (od.MAX_PROFILE_VELOCITY, U32, most, "profile velocity limit", protects),
        (od.MAX_FOLLOWING_ERROR, U32, profile.max_following_error_qc, "following error limit", protects),
        (od.QUICK_STOP_OPTION, I16, QUICK_STOP_THEN_OFF, "quick stop option", "it ends without power"),
    ):
        yield SetupObject(address, kind, value, name, why, read_back=True)
    yield from range_rows(axis)
    yield from motion_rows(axis)
    yield SetupObject(
        od.MODE_DISPLAY,
        I8,
        MODE[axis.command],
        "mode display",
        "the mode is in force",
        awaited=MODE_WITHIN,
        hint="; a drive without power must take its mode",
    )


def by_homing(axis: Axis) -> tuple[SetupObject, ...]:
    """Return what the homing of an axis hangs on; nothing where it has none."""
    homing, travel = axis.zero.homing, travel_of(axis)
    if homing is None or travel is None:
        return ()
    at = Scale.of(axis).within(homing.at, travel)
    return (
        _home(at if Cia402Axis.of(axis).home is Home.ITSELF else -at),
        *search_rows(axis, homing),
        method_row(homing.method, "as the robot file"),
    )


def _in_place(at: int) -> tuple[SetupObject, ...]:
    return (_home(-at), method_row(IN_PLACE, "no shaft turns"))


def _in_place_itself(at: int) -> tuple[SetupObject, ...]:
    return (_home(at), method_row(IN_PLACE, "no shaft turns"))


def _home(value: int) -> SetupObject:
    return SetupObject(od.HOME_OFFSET, I32, value, "home offset", "the robot file knows this place")


HINTS: Final = {
    od.CONSUMER_HEARTBEAT_1: "; a drive that does not watch the bridge would run on without it",
    od.ABORT_CONNECTION_OPTION: "; without it the drive does not stop when the bridge falls silent",
}
_TRANSMISSION: Final = 2


def _hinted(row: SetupObject) -> SetupObject:
    index, subindex = row.address
    if index in range(0x1800, 0x1A00) and subindex == _TRANSMISSION:
        return replace(
            row, hint="; the bridge samples its drives by SYNC (docs/variations.md: statusword-by-event)"
        )
    return replace(row, hint=HINTS.get(row.address, row.hint))
