"""What may leave towards the drives as commands of maxon's serial protocol: opcodes, nodes, objects, values.

It knows the robot file and the wire, no interlock, no time, and nothing of the bridge's present state. A
command that has no row here is refused, and so is one with a byte too many.

Sources: maxon's command library for the commands; as `guard_rules` for controlwords and objects.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from firmware_bridge.packet import Packet
from firmware_bridge.robot import Mode, Robot
from firmware_bridge.safety.guard_rules import CONTROLWORDS, LISTED_NMT, AxisRules, axis_rules
from firmware_bridge.safety.guard_writes import Bounds, writes_over_serial
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.can import MAX_PAYLOAD
from firmware_bridge.wire.canopen import NmtState
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.rows import DataType
from firmware_bridge.wire.maxon.messages import (
    ReadObject,
    Request,
    RequestCanFrame,
    SendCanFrame,
    SendNmtService,
    WriteObject,
    address_of,
)
from firmware_bridge.wire.maxon.packets import request_of

TARGET: Final = {Mode.VELOCITY: at.TARGET_VELOCITY, Mode.POSITION: at.TARGET_POSITION}
_STATES: Final = (NmtState.OPERATIONAL, NmtState.PRE_OPERATIONAL, NmtState.STOPPED, NmtState.BOOT_UP)
_Judge: TypeAlias = Callable[["SerialRules", Any], str | None]


@dataclass(frozen=True, slots=True)
class SerialRules:
    """The guard's list for one robot on a serial line."""

    cycle: Nanoseconds
    axes: tuple[AxisRules, ...]
    writes: Mapping[int, Mapping[Address, Bounds]]
    """By node."""
    bridge_node: int
    guardian: int

    def refuses(self, packet: Packet) -> str | None:
        """Return why this command may not leave, or None."""
        request = request_of(packet)
        judge = None if request is None else _JUDGES.get(type(request))
        if judge is None:
            return f"command 0x{packet.address:02X} '{packet.payload.hex(' ')}' is not listed"
        return judge(self, request)


def serial_rules_for(robot: Robot) -> SerialRules:
    """Make the list for a robot file."""
    axes = tuple(axis_rules(robot, axis) for axis in robot.axes)
    return SerialRules(
        robot.bus.cycle_ms * MILLISECOND,
        axes,
        {rules.axis.node: _writes(robot, rules) for rules in axes},
        robot.bus.bridge_node,
        robot.guardian,
    )


def _writes(robot: Robot, rules: AxisRules) -> Mapping[Address, Bounds]:
    axis = rules.axis
    ends = (rules.low, rules.high) if axis.mode is Mode.POSITION else None
    return {
        **writes_over_serial(axis, robot, ends),
        at.CONTROLWORD: Bounds(DataType.UNSIGNED16, CONTROLWORDS[axis.mode]),
        TARGET[axis.mode]: Bounds(DataType.INTEGER32, range(rules.low, rules.high + 1)),
    }


def _read(rules: SerialRules, request: ReadObject) -> str | None:
    return None if request.node in rules.writes else f"node {request.node} is not listed"


def _write(rules: SerialRules, request: WriteObject) -> str | None:
    writes = rules.writes.get(request.node)
    if writes is None:
        return f"node {request.node} is not listed"
    address = address_of(request)
    bounds = writes.get(address)
    if bounds is None:
        return f"{address} is not an object that may be written"
    size = bounds.type.size
    if any(request.raw[size:]):
        return f"{address} written with more than its {size} bytes"
    return bounds.refuses(address, request.raw[:size])


def _command(rules: SerialRules, request: SendNmtService) -> str | None:
    if request.node != canopen.ALL_NODES and request.node not in rules.writes:
        return f"node {request.node} is not listed"
    return None if request.command in LISTED_NMT else f"network command {request.command} is not listed"


def _frame(rules: SerialRules, request: SendCanFrame) -> str | None:
    beats = tuple(bytes((state,)).ljust(MAX_PAYLOAD, b"\0") for state in _STATES)
    ours = request.identifier == canopen.ERROR_CONTROL + rules.bridge_node
    if ours and request.length == 1 and request.raw in beats:
        return None
    content = request.raw[: request.length].hex(" ")
    return f"frame 0x{request.identifier:X} '{content}' is not listed"


def _remote(rules: SerialRules, request: RequestCanFrame) -> str | None:
    guarding = request.identifier == canopen.ERROR_CONTROL + rules.guardian
    return None if guarding else f"remote frame 0x{request.identifier:X} is not listed"


_JUDGES: Final[Mapping[type[Request], _Judge]] = MappingProxyType(
    {
        ReadObject: _read,
        WriteObject: _write,
        SendNmtService: _command,
        SendCanFrame: _frame,
        RequestCanFrame: _remote,
    }
)
"""No segmented transfer: nothing that the bridge writes or needs is longer than four bytes."""
