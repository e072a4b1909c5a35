"""The serial line between the bridge and an IMU: bytes in one direction, with their true timing."""

from dataclasses import dataclass
from typing import Final

from emulators.family import BridgeLink, Devices, Lane, Line, LineRun
from emulators.wires.adapter import Adapter
from emulators.wires.played import PlayedLine
from emulators.wires.serial import Inbox, SerialWire
from firmware_bridge.families.imu.settings import ImuLink
from firmware_bridge.node import Node
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MICROSECOND, Nanoseconds

BUFFER: Final = 4_096
"""Size of the host's receive buffer, bytes."""


@dataclass(frozen=True, slots=True)
class ListenedLine:
    """A line on which the bridge only listens."""

    wire: SerialWire
    adapter: Adapter
    link: BridgeLink
    table: ImuLink

    def lane(self, kind: str, player: str) -> Lane:
        """Return a line on which a recording's bytes arrive as they did: only it has their times."""
        played = PlayedLine(self.wire.baud, player, self.link.name)
        return Lane(kind, played, played.duration)

    def carried(self, robot: AnyRobot, duration: Nanoseconds, devices: Devices) -> LineRun:
        """Return what the line has carried in a run so long."""
        del duration, devices
        return LineRun(
            link=self.link.name,
            protocol=self.table.kind,
            baud=self.wire.baud,
            bytes=self.wire.bytes,
            commands=0,
            busy_percent=0.0,
            cycle_ms=float(robot.cycle_ms * self.table.every),
            longest_cycle_ms=0.0,
            late_cycles=0,
        )


def listened_line(
    robot: AnyRobot, node: Node, link: BridgeLink, host: str, before: Line | None
) -> ListenedLine:
    """Put a node on the line of a link; see `emulators.family.MakeLine`."""
    table = ImuLink.of_link(robot, link.name)
    adapter = Adapter(node, link.name)
    if isinstance(before, ListenedLine):
        # The cable outlives the process: its plug and its counts go on.
        adapter.plugged = before.adapter.plugged
        return ListenedLine(before.wire, adapter, link, table)
    inboxes = {host: Inbox(BUFFER, table.latency_us * MICROSECOND)} if table.latency_us else {}
    return ListenedLine(SerialWire(table.rate, inboxes, link.name), adapter, link, table)
