"""Senders of recorded packets: by the CAN identifier, or by a MAVLink message's own origin."""

from dataclasses import dataclass
from typing import Final

from emulators.family import family_of
from emulators.replay.recordings import RecordedPacket, Recording
from firmware_bridge.dissector.canopen import MASTER, Canopen
from firmware_bridge.recording import Direction, mavlink_origin
from firmware_bridge.robot import AnyRobot

BRIDGE: Final = "bridge"
OPERATOR_STATION: Final = "operator"
UNKNOWN: Final = "unknown"


@dataclass(frozen=True, slots=True)
class Sent:
    """A recorded packet, and who has sent it: `BRIDGE`, an axis, or a name for someone else."""

    entry: RecordedPacket
    sender: str


def frames_of(recording: Recording, robot: AnyRobot, link: str) -> list[Sent]:
    """Name the sender of each frame on a link's bus.

    The identifiers are CANopen's, those of PDOs as the recorded SDOs set them. Any network master's frames
    count as the bridge's.
    """
    reader, bus = Canopen(), family_of(robot, link).bus(robot, link)
    names = {axis.settings.number: axis.name for axis in robot.axes_on(link)} | {
        MASTER: BRIDGE,
        **({} if bus is None else {bus.bridge_node: BRIDGE}),
    }
    named = []
    for entry in recording.entries:
        node = reader.sender(entry.packet)
        sender = UNKNOWN if node is None else names.get(node, f"node {node}")
        named.append(Sent(entry, sender))
        # Behind the naming: an SDO that moves a PDO's COB-ID counts from the next frame on.
        reader.read(sender, entry.packet)
    return named


def chunks_of(recording: Recording) -> list[Sent]:
    """Name the sender of what passed the bridge on lines: the bridge, or who is on the link, by its name."""
    return [
        Sent(entry, BRIDGE if entry.direction is Direction.SENT else entry.packet.link)
        for entry in recording.entries
    ]


def messages_of(recording: Recording, robot: AnyRobot) -> list[Sent]:
    """Name the sender of each message: the bridge by the numbers in the robot file, or else the operator."""
    own = (robot.operator.system_id, robot.operator.component_id)
    return [
        Sent(entry, BRIDGE if mavlink_origin(entry.packet.payload)[:2] == own else OPERATOR_STATION)
        for entry in recording.entries
    ]
