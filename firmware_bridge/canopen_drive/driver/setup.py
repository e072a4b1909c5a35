"""Set-up of one drive before it may move: rows of (object, value, why, source) from the robot file.

It knows no time and no answers; `firmware_bridge.canopen_drive.driver.tasks` carries the rows to the drive.
"""

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import Mode
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.driver.process_data import Pdo, pdos
from firmware_bridge.canopen_drive.driver.scale import Scale, in_units, travel_of
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.canopen_drive.settings import DriveAxis, DriveLink
from firmware_bridge.robot import Axis, CommandForm
from firmware_bridge.robot.zero import Homing

U8: Final = DataType.UNSIGNED8
U16: Final = DataType.UNSIGNED16
U32: Final = DataType.UNSIGNED32
I8: Final = DataType.INTEGER8
I16: Final = DataType.INTEGER16
I32: Final = DataType.INTEGER32

SERVO_DRIVE: Final = 0x0002_0192
QUICK_STOP_ON_LOST_CONNECTION: Final = 3
QUICK_STOP_ON_FAULT: Final = 2
TRAPEZOID: Final = 0
INHIBIT_UNITS_PER_MS: Final = 10
"""Of 100 us each."""
MODE: Final = {
    CommandForm.SPEED: Mode.PROFILE_VELOCITY,
    CommandForm.POSITION: Mode.PROFILE_POSITION,
}
CIA_301: Final = "CiA 301"
WATCHED: Final = "a drive that cannot watch the bridge would run on when the bridge falls silent"


class Traffic(NamedTuple):
    """Traffic between bridge and drive beside reading and writing objects."""

    pdos: tuple[Pdo, ...]
    watched: int
    """The node whose silence stops the drive."""
    heartbeat_ms: int
    """Period of the drive's heartbeat in ms; 0: none."""


def over_can(axis: Axis, link: DriveLink, current: Address) -> Traffic:
    """Return what flows where the bridge is on the CAN bus; `current` is the object of the motor's."""
    return Traffic(pdos(axis, current), link.bridge_node, link.drive_heartbeat_ms)


def on_the_bus(axis: Axis, link: DriveLink, flows: Traffic) -> tuple[SetupObject, ...]:
    """Return what makes a drive one of this bus: its process data, whom it watches, how it reacts."""
    return (
        *(row for pdo in flows.pdos for row in _process_data(pdo, DriveAxis.of(axis).node)),
        *_supervision(link, flows),
    )


def range_rows(axis: Axis) -> Iterator[SetupObject]:
    """Yield the drive's own limits of position; an axis without `travel` leaves them alone."""
    travel = travel_of(axis)
    if travel is None:
        return
    # The drive judges the actual position, too: without the margin an overshoot at the end would be a fault.
    margin = DriveAxis.of(axis).profile.max_following_error_qc
    why = "no target beyond the mechanics; the margin is the following error, within which all is well"
    low, high = travel.low - margin, travel.high + margin
    yield SetupObject(od.MIN_POSITION_LIMIT, I32, low, "lower position limit", why, read_back=True)
    yield SetupObject(od.MAX_POSITION_LIMIT, I32, high, "upper position limit", why, read_back=True)


def motion_rows(axis: Axis) -> Iterator[SetupObject]:
    """Yield mode and profile."""
    profile, mode = DriveAxis.of(axis).profile, MODE[axis.command]
    yield SetupObject(od.MODE, I8, mode, "mode of operation", "by the robot file", read_back=True)
    why = "a trapezoid: its acceleration is bounded"
    yield SetupObject(od.MOTION_PROFILE_TYPE, I16, TRAPEZOID, "motion profile type", why)
    for address, rpm, name in (
        (od.PROFILE_VELOCITY, profile.velocity_rpm, "profile velocity"),
        (od.PROFILE_ACCELERATION, profile.acceleration_rpm_s, "profile acceleration"),
        (od.PROFILE_DECELERATION, profile.deceleration_rpm_s, "profile deceleration"),
        (od.QUICK_STOP_DECELERATION, profile.quick_stop_rpm_s, "quick stop deceleration"),
    ):
        value = in_units(axis, rpm)
        yield SetupObject(address, U32, value, name, "how the axis starts and stops", read_back=True)


def search_rows(axis: Axis, homing: Homing) -> Iterator[SetupObject]:
    """Yield how fast the axis moves for homing."""
    for address, speed, name in (
        (od.HOMING_SPEED_SWITCH, homing.speed, "speed for switch search"),
        (od.HOMING_SPEED_ZERO, homing.zero_speed, "speed for zero search"),
        (od.HOMING_ACCELERATION, homing.acceleration, "homing acceleration"),
    ):
        # Rounded down, but never 0: a homing at 0 would not end.
        value = max(1, math.floor(abs(Scale.of(axis).speed(speed))))
        yield SetupObject(address, U32, value, name, "no faster than the robot file allows")


def method_row(method: int, why: str) -> SetupObject:
    """Return the choice of a homing method."""
    return SetupObject(od.HOMING_METHOD, I8, method, "homing method", why)


def farewell() -> tuple[SetupObject, ...]:
    """Return what is written before the bridge leaves for good."""
    return (
        SetupObject(
            od.CONSUMER_HEARTBEAT_1, U32, 0, "heartbeat consumer", "the bridge's silence is no fault now"
        ),
    )


def _process_data(pdo: Pdo, node: int) -> Iterator[SetupObject]:
    """Give the procedure of a mapping: invalid, empty, entries, how many, how sent, valid."""
    title = f"PDO 0x{pdo.communication:04X}"
    cob_id = Address(pdo.communication, 1)
    count = Address(pdo.mapping, 0)
    off = pdo.cob_id_entry(node, valid=False)
    on = pdo.cob_id_entry(node, valid=True)
    if pdo.layout is None:
        yield SetupObject(cob_id, U32, off, f"{title} COB-ID", "not used", read_back=True)
        return
    yield SetupObject(cob_id, U32, off, f"{title} COB-ID", "a mapping changes only while it is off", CIA_301)
    yield SetupObject(count, U8, 0, f"{title} entries", "a mapping changes only while it is empty", CIA_301)
    entries = pdo.layout.entries()
    for number, entry in enumerate(entries, 1):
        where = Address(pdo.mapping, number)
        yield SetupObject(where, U32, entry.encode(), f"{title} entry {number}", f"carries {entry.address}")
    yield SetupObject(count, U8, len(entries), f"{title} entries", "the drive checks length and objects now")
    kind = Address(pdo.communication, 2)
    yield SetupObject(kind, U8, pdo.transmission, f"{title} type", "1 with each SYNC, 255 on change")
    if pdo.transmits:
        inhibit = Address(pdo.communication, 3)
        why = "what is sent on change must not fill the bus; unit 100 us"
        units = INHIBIT_UNITS_PER_MS * pdo.inhibit_ms
        yield SetupObject(inhibit, U16, units, f"{title} inhibit time", why)
    yield SetupObject(cob_id, U32, on, f"{title} COB-ID", "on", CIA_301, read_back=True)


def _supervision(link: DriveLink, flows: Traffic) -> Iterator[SetupObject]:
    # 0x1016: the node in bits 16 to 23, the consumer time in ms below (CiA 301).
    watch = flows.watched << 16 | link.bridge_silent_ms
    why = "the bridge sees that the drive lives; without, it answers node guarding"
    yield SetupObject(od.PRODUCER_HEARTBEAT, U16, flows.heartbeat_ms, "heartbeat producer", why)
    why = "a dead bridge stops the drive"
    yield SetupObject(od.CONSUMER_HEARTBEAT_1, U32, watch, "heartbeat consumer", why, read_back=True)
    why = "a dead bridge means a quick stop, not a coasting motor"
    reaction = QUICK_STOP_ON_LOST_CONNECTION
    yield SetupObject(
        od.ABORT_CONNECTION_OPTION, I16, reaction, "abort connection option", why, read_back=True
    )
    why = "a fault ends in a quick stop"
    yield SetupObject(
        od.FAULT_REACTION_OPTION, I16, QUICK_STOP_ON_FAULT, "fault reaction option", why, read_back=True
    )
