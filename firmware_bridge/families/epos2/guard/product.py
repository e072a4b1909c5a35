"""What the guard knows of an EPOS2 beside the drive profile: units, states, objects that may be written.

Sources: EPOS2 EDS for objects and types; robot file for values.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.guard.bounds import Units, counts_per_unit
from firmware_bridge.canopen_drive.guard.can import DriveCanRules
from firmware_bridge.canopen_drive.guard.product import GuardedProduct
from firmware_bridge.canopen_drive.guard.values import Bits, Values, Writes, exactly, within
from firmware_bridge.canopen_drive.guard.writes import watch_of, writes
from firmware_bridge.canopen_drive.guard.zeroing import only, searched, up_to
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2DigitalOutput, Epos2Link, nodes_on
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire import functions
from firmware_bridge.families.epos2.wire.functions import OutputFunction
from firmware_bridge.families.epos2.wire.power_states import STATES
from firmware_bridge.robot import AnyRobot, Axis, Output

I16: Final = DataType.INTEGER16
I32: Final = DataType.INTEGER32
U8: Final = DataType.UNSIGNED8
U16: Final = DataType.UNSIGNED16
U32: Final = DataType.UNSIGNED32
ACTUAL_POSITION: Final = 35
MILLIAMPERES: Final = 1000.0
_EDGES_PER_LINE: Final = 4
"""Of an encoder with two channels."""
KINDS: Final = {at.HOME_POSITION: I32, at.HOMING_CURRENT: U16}


def units(axis: Axis) -> Units:
    """Return what the drive of an axis counts in: edges of its encoder, and rpm."""
    return Units(_EDGES_PER_LINE * Epos2Axis.of(axis).encoder_lines)


def product(axis: Axis, robot: AnyRobot) -> GuardedProduct:
    """Return what the drive of an axis is."""
    return GuardedProduct(
        units=units(axis),
        states=STATES,
        in_place=ACTUAL_POSITION,
        places=at.HOME_POSITION,
        homing=by_file(axis),
        kinds=KINDS,
        writes=dict((*_protection(axis), *_gains(axis), *_outputs(outputs_at(axis, robot)))),
    )


def can_rules(robot: AnyRobot, link: str) -> DriveCanRules:
    """Return the rules of a link on CAN."""
    return DriveCanRules(robot, link, product)


def writes_over_serial(axis: Axis, robot: AnyRobot) -> Writes:
    """Return the objects of one drive that the bridge reaches by serial commands, set-points left out.

    The drive has no heartbeat there, and watches whom the robot file makes it watch.
    """
    link = Epos2Link.of_link(robot, axis.link)
    watched = link.watched_by(Epos2Axis.of(axis).node, nodes_on(robot, axis.link))
    return writes(axis, product(axis, robot), watch_of(link, watched), 0)


def by_file(axis: Axis) -> Mapping[Address, range]:
    """Return what the homing of an axis may hang on, by the robot file; nothing where it is not homed.

    Speeds in rpm, the acceleration in rpm/s, places in quadcounts, the current in mA; its own arithmetic.
    """
    homing = axis.zero.homing
    if homing is None or axis.travel is None:
        return {}
    per_unit = counts_per_unit(axis, units(axis))
    return {
        **searched(axis, units(axis)),
        at.HOME_POSITION: only(round(homing.at * per_unit)),
        od.HOME_OFFSET: only(round(homing.offset * per_unit)),
        **({at.HOMING_CURRENT: up_to(homing.current_a * MILLIAMPERES)} if homing.current_a else {}),
    }


def outputs_at(axis: Axis, robot: AnyRobot) -> Sequence[Output]:
    """Return the outputs at the drive of an axis."""
    return [
        row for row in robot.outputs if row.link == axis.link and Epos2DigitalOutput.of(row).axis == axis.name
    ]


def output_function(output: Output) -> OutputFunction:
    """Return the function that the output's pin must have: general purpose A for pin 1 to D for pin 4.

    That is how the drive leaves the factory (EPOS2 EDS).
    """
    return OutputFunction(OutputFunction.GENERAL_A - (Epos2DigitalOutput.of(output).output - 1))


def _protection(axis: Axis) -> Iterator[tuple[Address, Values]]:
    drive = Epos2Axis.of(axis)
    profile = drive.profile
    yield od.MOTOR_TYPE, exactly(U16, drive.motor_type)
    if drive.pole_pairs is not None:
        yield at.POLE_PAIRS, exactly(U8, drive.pole_pairs)
    yield at.ENCODER_PULSES, exactly(U32, drive.encoder_lines)
    yield at.CONTINUOUS_CURRENT_LIMIT, within(U16, 0, drive.continuous_current_ma)
    yield at.OUTPUT_CURRENT_LIMIT, within(U16, 0, drive.peak_current_ma)
    yield at.THERMAL_TIME_CONSTANT, within(U16, 1, drive.thermal_time_constant_100ms)
    yield at.MAX_MOTOR_SPEED, within(U32, 1, profile.max_velocity_rpm)


def _gains(axis: Axis) -> Iterator[tuple[Address, Values]]:
    gains = Epos2Axis.of(axis).gains
    for address, kind, value in (
        (at.CURRENT_P, I16, gains.current_p),
        (at.CURRENT_I, I16, gains.current_i),
        (at.VELOCITY_P, I16, gains.velocity_p),
        (at.VELOCITY_I, I16, gains.velocity_i),
        (at.VELOCITY_FEEDFORWARD, U16, gains.velocity_feedforward),
        (at.VELOCITY_ACCELERATION_FEEDFORWARD, U16, gains.acceleration_feedforward),
        (at.POSITION_P, I16, gains.position_p),
        (at.POSITION_I, I16, gains.position_i),
        (at.POSITION_D, I16, gains.position_d),
        (at.POSITION_VELOCITY_FEEDFORWARD, U16, gains.position_velocity_feedforward),
        (at.POSITION_ACCELERATION_FEEDFORWARD, U16, gains.position_acceleration_feedforward),
    ):
        yield address, exactly(kind, value)


def _outputs(outputs: Sequence[Output]) -> Iterator[tuple[Address, Values]]:
    if not outputs:
        return
    bits = 0
    for output in outputs:
        function = output_function(output)
        bits |= function.bit
        yield functions.OUTPUT_PINS[Epos2DigitalOutput.of(output).output - 1], exactly(U16, function)
    yield functions.OUTPUT_STATE, Values(U16, Bits(bits))
    yield functions.OUTPUT_MASK, Values(U16, Bits(bits))
