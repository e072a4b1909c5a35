"""What an EPOS2 has beside the drive profile: rows of set-up and homing, objects for speed and current.

Sources: EPOS2 EDS for objects and types; EPOS Firmware Specification, homing mode, by analogy. Assumed: the
offset 0x607C is a distance that it goes from the found reference, with its sign, and the home position
(0x2081) is its position then.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.driver.process_data import pdos
from firmware_bridge.canopen_drive.driver.product import DriveProduct
from firmware_bridge.canopen_drive.driver.scale import Scale, travel_of
from firmware_bridge.canopen_drive.driver.setup import (
    SERVO_DRIVE,
    Traffic,
    method_row,
    motion_rows,
    on_the_bus,
    over_can,
    range_rows,
    search_rows,
)
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.drivers.driver import Reports
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2DigitalOutput, Epos2Link
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.emergency import EMERGENCIES
from firmware_bridge.families.epos2.wire.functions import OUTPUT_MASK, OUTPUT_PINS, OutputFunction
from firmware_bridge.families.epos2.wire.hardware import alike
from firmware_bridge.families.epos2.wire.power_states import REFERENCED, STATES
from firmware_bridge.families.epos2.wire.rows import EDS, FIRMWARE_SPECIFICATION
from firmware_bridge.robot import Axis, Output

U8: Final = DataType.UNSIGNED8
U16: Final = DataType.UNSIGNED16
U32: Final = DataType.UNSIGNED32
I8: Final = DataType.INTEGER8
I16: Final = DataType.INTEGER16
I32: Final = DataType.INTEGER32

MAXON: Final = 0xFB
MILLIAMPERES: Final = 1000.0
STANDSTILL_RPM: Final = 5
"""At the motor; the averaged velocity of a resting shaft shows one or two."""
REPORTS: Final = frozenset(Reports)
"""An EPOS2 has all reports that there are."""
CAUSES: Final = {code: row.cause for code, row in EMERGENCIES.items()}
ACTUAL_POSITION: Final = 35
_WHY: Final = "it stands there, someone saw it"


def product(axis: Axis) -> DriveProduct:
    """Return what the drive of an axis is."""
    return DriveProduct(
        reports=REPORTS,
        states=STATES,
        causes=CAUSES,
        current=at.CURRENT_AVERAGED,
        amperes=1.0 / MILLIAMPERES,
        velocity=at.VELOCITY_AVERAGED,
        standstill=STANDSTILL_RPM,
        referenced=REFERENCED,
        identity=identity(axis),
        commissioned=commissioned(axis),
        in_place=in_place,
        homing=by_homing(axis),
    )


def general_purpose(pin: int) -> OutputFunction:
    """Return the function of an output pin, from 1, that the bridge switches: A at the first (EDS)."""
    # The functions count down: A is 15, B is 14.
    return OutputFunction(OutputFunction.GENERAL_A + 1 - pin)


def through_gateway(axis: Axis, link: Epos2Link, nodes: Sequence[int]) -> Traffic:
    """Return the traffic where the bridge is on the gateway's serial port: no process data, no heartbeat.

    No node there would receive either; and a drive with a heartbeat of its own does not answer node guarding,
    which the gateway's watchdog depends on.
    """
    off = tuple(replace(pdo, layout=None) for pdo in pdos(axis, at.CURRENT_AVERAGED))
    return Traffic(off, link.watched_by(Epos2Axis.of(axis).node, nodes), 0)


def identity(axis: Axis) -> tuple[SetupObject, ...]:
    """Return what the drive must answer before anything is written to it."""
    return (
        SetupObject(od.DEVICE_TYPE, U32, SERVO_DRIVE, "device type", "a CiA 402 servo drive answers"),
        SetupObject(od.VENDOR_ID, U32, MAXON, "vendor", "the objects below are maxon's"),
        SetupObject(
            od.PRODUCT_CODE,
            U32,
            Epos2Axis.of(axis).product_code,
            "product code",
            "the drive that the robot file names",
            also=alike(Epos2Axis.of(axis).product_code),
        ),
    )


def configuration(
    axis: Axis, link: Epos2Link, outputs: Sequence[Output] = (), traffic: Traffic | None = None
) -> tuple[SetupObject, ...]:
    """Return what is written in pre-operational, with the power stage off, in this order.

    `outputs` are those at this drive. `traffic` is what flows on the link, without it what flows on CAN.
    """
    flows = traffic or over_can(axis, link, at.CURRENT_AVERAGED)
    return (*on_the_bus(axis, link, flows), *commissioned(axis), *_switched(outputs))


def commissioned(axis: Axis) -> tuple[SetupObject, ...]:
    """Return what belongs to motor and mechanics: what who commissions the axis saves in its drive, too."""
    return (*_protection(axis), *range_rows(axis), *motion_rows(axis), *_gains(axis))


def _protection(axis: Axis) -> Iterator[SetupObject]:
    motor, profile = Epos2Axis.of(axis), Epos2Axis.of(axis).profile
    protects = "protects the motor and people near it"
    yield SetupObject(
        od.MOTOR_TYPE, U16, motor.motor_type, "motor type", "how the winding is driven", read_back=True
    )
    if motor.pole_pairs is not None:
        why = "the winding is commutated by them"
        yield SetupObject(at.POLE_PAIRS, U8, motor.pole_pairs, "pole pairs", why, read_back=True)
    for address, kind, value, name, why in (
        (at.ENCODER_PULSES, U32, motor.encoder_lines, "encoder lines", "every position is counted in them"),
        (at.CONTINUOUS_CURRENT_LIMIT, U16, motor.continuous_current_ma, "continuous current limit", protects),
        (at.OUTPUT_CURRENT_LIMIT, U16, motor.peak_current_ma, "output current limit", protects),
        (at.THERMAL_TIME_CONSTANT, U16, motor.thermal_time_constant_100ms, "thermal time constant", protects),
        (at.MAX_MOTOR_SPEED, U32, profile.max_velocity_rpm, "motor speed limit", protects),
        (od.MAX_PROFILE_VELOCITY, U32, profile.max_velocity_rpm, "profile velocity limit", protects),
        (od.MAX_FOLLOWING_ERROR, U32, profile.max_following_error_qc, "following error limit", protects),
    ):
        yield SetupObject(address, kind, value, name, why, EDS, read_back=True)


def _gains(axis: Axis) -> Iterator[SetupObject]:
    gains = Epos2Axis.of(axis).gains
    for address, kind, value, name in (
        (at.CURRENT_P, I16, gains.current_p, "current P gain"),
        (at.CURRENT_I, I16, gains.current_i, "current I gain"),
        (at.VELOCITY_P, I16, gains.velocity_p, "velocity P gain"),
        (at.VELOCITY_I, I16, gains.velocity_i, "velocity I gain"),
        (at.VELOCITY_FEEDFORWARD, U16, gains.velocity_feedforward, "velocity feed-forward"),
        (at.VELOCITY_ACCELERATION_FEEDFORWARD, U16, gains.acceleration_feedforward, "its acceleration part"),
        (at.POSITION_P, I16, gains.position_p, "position P gain"),
        (at.POSITION_I, I16, gains.position_i, "position I gain"),
        (at.POSITION_D, I16, gains.position_d, "position D gain"),
        (
            at.POSITION_VELOCITY_FEEDFORWARD,
            U16,
            gains.position_velocity_feedforward,
            "position feed-forward",
        ),
        (
            at.POSITION_ACCELERATION_FEEDFORWARD,
            U16,
            gains.position_acceleration_feedforward,
            "position feed-forward of acceleration",
        ),
    ):
        yield SetupObject(address, kind, value, name, "the regulators as tuned for this axis", EDS)


def in_place(home_qc: int) -> tuple[SetupObject, ...]:
    """Return what method 35 hangs on."""
    source = FIRMWARE_SPECIFICATION
    return (
        SetupObject(at.HOME_POSITION, I32, home_qc, "home position", _WHY, source),
        method_row(ACTUAL_POSITION, "no shaft turns"),
    )


def by_homing(axis: Axis) -> tuple[SetupObject, ...]:
    """Return what the homing of an axis hangs on; nothing where it has none."""
    homing, travel, scale, source = axis.zero.homing, travel_of(axis), Scale.of(axis), FIRMWARE_SPECIFICATION
    if homing is None or travel is None:
        return ()
    current = () if homing.current_a is None else (math.floor(homing.current_a * MILLIAMPERES),)
    there = "the robot file knows this place"
    return (
        SetupObject(at.HOME_POSITION, I32, scale.within(homing.at, travel), "home position", there, source),
        SetupObject(
            od.HOME_OFFSET, I32, scale.counts(homing.offset), "home offset", "off stop and switch", source
        ),
        *search_rows(axis, homing),
        *(
            SetupObject(at.HOMING_CURRENT, U16, threshold, "current threshold", "this is the stop", source)
            for threshold in current
        ),
        method_row(homing.method, "as the robot file"),
    )


def _switched(outputs: Sequence[Output]) -> Iterator[SetupObject]:
    """Give pins to the bridge; their polarity stays as the wiring needs it, their state is not touched."""
    if not outputs:
        return
    mask = 0
    for output in outputs:
        pin = Epos2DigitalOutput.of(output).output
        function = general_purpose(pin)
        mask |= function.bit
        why = f"switched by the bridge: {output.title}"
        yield SetupObject(OUTPUT_PINS[pin - 1], U16, function, f"digital output {pin}", why, read_back=True)
    why = "lets the bridge's outputs through, and no others"
    yield SetupObject(
        OUTPUT_MASK, U16, mask, "digital outputs' mask", why, FIRMWARE_SPECIFICATION, read_back=True
    )
