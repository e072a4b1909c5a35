"""What may leave towards the drives: the guard's list of identifiers and of what each may carry.

It knows the robot file and the wire, no interlock, no time, and nothing of the bridge's present state. An
identifier that is not in the list is refused; so is one with a flag (extended, remote).

How fast a set-point may CHANGE is not judged here: a late cycle or a substituted frame makes honest jumps.
The drive's own profile acceleration bounds every jump; this list lets nobody raise it above the robot file,
and the bridge reads it back at start-up.

Sources: CiA 301 for identifiers and services; EPOS Firmware Specification and maxon's command library for
controlwords.
"""

import math
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, Protocol

from firmware_bridge.motion import davis, lift
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, Mode, Robot, Role
from firmware_bridge.safety.guard_writes import Bounds, writes_for
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.canopen import NmtCommand, NmtState
from firmware_bridge.wire.epos2.address import Address

SET_POINT: Final = struct.Struct("<Hi")
"""Controlword and target, as the bridge maps them."""
_SET_POINT_ID: Final = {Mode.VELOCITY: canopen.RECEIVE_PDO[3], Mode.POSITION: canopen.RECEIVE_PDO[2]}
_TARGET_UNIT: Final = {Mode.VELOCITY: "rpm", Mode.POSITION: "qc"}

NEW_SET_POINT: Final = 0x003F
"""Go to the target now."""
ENABLE: Final = 0x000F
HALT: Final = 0x010F
FAULT_RESET: Final = 0x0080
UNPOWERED: Final = (0x0000, 0x0002, 0x0006, 0x0007, 0x000B)
"""Disable voltage, quick stop (twice), shutdown, switch on: none puts the power on or asks for motion."""
POWERED: Final = (ENABLE, HALT, NEW_SET_POINT)
"""Words after which the drive has power and may have torque."""
CONTROLWORDS: Final = {
    Mode.VELOCITY: (*UNPOWERED, FAULT_RESET, ENABLE, HALT),
    Mode.POSITION: (*UNPOWERED, FAULT_RESET, *POWERED),
}

LISTED_NMT: Final = (
    NmtCommand.START,
    NmtCommand.ENTER_PRE_OPERATIONAL,
    NmtCommand.RESET_NODE,
    NmtCommand.RESET_COMMUNICATION,
)
"""Not STOP: a stopped drive hears neither set-points nor SDO."""

_SDO_LENGTH: Final = 8
_SPECIFIER: Final = 0xE0
_DOWNLOAD: Final = 0x20
_READING: Final = (0x40, 0x60, 0x80)
"""Initiate upload, upload segment, abort: they change nothing in a drive."""
_EXPEDITED_SIZED: Final = 0x23
_EXPEDITED_BITS: Final = 0x33


class Content(Protocol):
    """What one identifier may carry."""

    def refuses(self, payload: bytes) -> str | None:
        """Return why these bytes may not leave, or None."""


@dataclass(frozen=True, slots=True)
class Exactly:
    """One of a few payloads."""

    payloads: tuple[bytes, ...]

    def refuses(self, payload: bytes) -> str | None:
        """Compare."""
        return None if payload in self.payloads else f"content '{payload.hex(' ')}' is not listed"


@dataclass(frozen=True, slots=True)
class SetPoint:
    """Controlword and target of one axis."""

    axis: Axis
    words: tuple[int, ...]
    """Controlwords that its mode knows."""
    low: int
    high: int

    def refuses(self, payload: bytes) -> str | None:
        """Check length, controlword and target."""
        if len(payload) != SET_POINT.size:
            return f"{len(payload)} bytes where {SET_POINT.size} are mapped"
        told: tuple[int, int] = SET_POINT.unpack(payload)
        word, target = told
        if word not in self.words:
            return f"controlword 0x{word:04X} is not listed"
        if not self.low <= target <= self.high:
            unit = _TARGET_UNIT[self.axis.mode]
            return f"target {target} {unit} is not within {self.low} to {self.high} {unit}"
        return None


@dataclass(frozen=True, slots=True)
class SdoRequest:
    """Requests to one drive: uploads of anything, expedited downloads of what is listed."""

    writes: Mapping[Address, Bounds]

    def refuses(self, payload: bytes) -> str | None:
        """Check length, service, object, size and value."""
        if len(payload) != _SDO_LENGTH:
            return f"an SDO request of {len(payload)} bytes"
        if payload[0] & _SPECIFIER in _READING:
            return None
        if payload[0] & _EXPEDITED_BITS != _EXPEDITED_SIZED or payload[0] & _SPECIFIER != _DOWNLOAD:
            return f"SDO command 0x{payload[0]:02X} is not listed"
        address = Address(int.from_bytes(payload[1:3], "little"), payload[3])
        bounds = self.writes.get(address)
        if bounds is None:
            return f"{address} is not an object that may be written"
        unused = payload[0] >> 2 & 0b11
        return bounds.refuses(address, payload[4 : _SDO_LENGTH - unused])


@dataclass(frozen=True, slots=True)
class AxisRules:
    """One axis: where its set-points and requests go, and within which bounds."""

    axis: Axis
    set_point_id: int
    sdo_id: int
    low: int
    """Smallest target, rpm or quadcounts."""
    high: int


@dataclass(frozen=True, slots=True)
class Rules:
    """The guard's list for one robot."""

    cycle: Nanoseconds
    axes: tuple[AxisRules, ...]
    listed: dict[int, Content]

    def refuses(self, packet: Packet) -> str | None:
        """Return why this CAN frame may not leave, or None."""
        content = self.listed.get(packet.address)
        if content is None:
            return f"identifier 0x{packet.address:X} is not listed"
        return content.refuses(packet.payload)


def rules_for(robot: Robot) -> Rules:
    """Make the list for a robot file."""
    bus = robot.bus
    nodes = (canopen.ALL_NODES, *(axis.node for axis in robot.axes))
    states = (NmtState.OPERATIONAL, NmtState.PRE_OPERATIONAL, NmtState.STOPPED, NmtState.BOOT_UP)
    listed: dict[int, Content] = {
        canopen.NMT: Exactly(tuple(bytes((command, node)) for command in LISTED_NMT for node in nodes)),
        canopen.SYNC: Exactly((b"",)),
        canopen.ERROR_CONTROL + bus.bridge_node: Exactly(tuple(bytes((state,)) for state in states)),
    }
    axes = tuple(axis_rules(robot, axis) for axis in robot.axes)
    for rules in axes:
        listed[rules.set_point_id] = SetPoint(
            rules.axis, CONTROLWORDS[rules.axis.mode], rules.low, rules.high
        )
        ends = (rules.low, rules.high) if rules.axis.mode is Mode.POSITION else None
        listed[rules.sdo_id] = SdoRequest(writes_for(rules.axis, bus, ends))
    return Rules(bus.cycle_ms * MILLISECOND, axes, listed)


def axis_rules(robot: Robot, axis: Axis) -> AxisRules:
    """Return where an axis's words go on CAN, and the bounds of its target on any link."""
    top = axis.profile.max_velocity_rpm
    low, high = (-top, top) if axis.mode is Mode.VELOCITY else _TRAVEL[axis.role](robot, axis)
    return AxisRules(axis, _SET_POINT_ID[axis.mode] + axis.node, canopen.SDO_REQUEST + axis.node, low, high)


def _steering_travel(robot: Robot, axis: Axis) -> tuple[int, int]:
    full = math.radians(robot.limits.steer_angle_deg)
    left = davis.steer_quadcounts(robot.base, axis, full)
    return -abs(left), abs(left)


def _lift_travel(robot: Robot, axis: Axis) -> tuple[int, int]:
    top = lift.lift_quadcounts(robot.lift, axis, lift.highest(robot.lift))
    return min(0, top), max(0, top)


_TRAVEL: Final[Mapping[Role, Callable[[Robot, Axis], tuple[int, int]]]] = {
    Role.STEERING: _steering_travel,
    Role.LIFT: _lift_travel,
}
"""The mechanical range of a position axis, in quadcounts from where the drive was switched on: steering
straight ahead, lift collapsed (ASSUME: the source names no absolute encoder and no switch)."""
