"""The serial lines between bridge and devices on the bench, and what the bridge has at its ends of them."""

from dataclasses import dataclass
from typing import TypeAlias

from emulators.bench.adapter import Adapter
from emulators.bench.summary import LineRun
from emulators.wires import SerialWire, usb
from emulators.wires.serial import Inbox
from emulators.wires.usb import ChunkWire
from firmware_bridge.drivers.link_drivers import DeviceLink
from firmware_bridge.families.ar2.driver.board import Ar2Board
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.families.epos2.driver.serial.line import MaxonLine
from firmware_bridge.families.epos2.driver.serial.link import SerialLink
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.families.motor_shield.driver.board import Board
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.node import Node
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds


@dataclass(frozen=True, slots=True)
class EmulatedLine:
    """One serial line of one robot."""

    wire: SerialWire
    adapter: Adapter
    """The bridge's place on the line; its plug can be pulled."""
    end: MaxonLine
    link: SerialLink

    @classmethod
    def of(
        cls, robot: AnyRobot, node: Node, link: DeviceLink, host: str, before: "EmulatedLine | None" = None
    ) -> "EmulatedLine | None":
        """Put a node on a line, under the name `host`; None where this link is no serial one.

        `before` is the line of a node that was: its wire, its plug and what it has carried go on.
        """
        if not isinstance(link, SerialLink):
            return None
        table = Epos2Link.of_link(robot, link.name)
        latency = table.port_latency_us * MICROSECOND
        # Without a latency bytes are handed over one by one, as on a plain UART.
        inboxes = {host: Inbox(usb.BUFFER, latency)} if latency else {}
        end = MaxonLine(node, table.protocol, link.name)
        adapter = Adapter(end, link.name)
        if before is None:
            return cls(SerialWire(table.line_rate, inboxes), adapter, end, link)
        # The cable outlives the process: its plug and its counts go on.
        adapter.plugged, end.commands, end.busy = before.adapter.plugged, before.end.commands, before.end.busy
        return cls(before.wire, adapter, end, link)

    def carried(self, robot: AnyRobot, duration: Nanoseconds) -> LineRun:
        """Return what the line has carried in a run so long."""
        table = Epos2Link.of_link(robot, self.link.name)
        return LineRun(
            link=self.link.name,
            protocol=table.protocol.value,
            baud=table.line_rate,
            bytes=self.wire.bytes,
            commands=self.end.commands,
            busy_percent=round(100.0 * self.end.busy / duration, 3),
            cycle_ms=float(robot.cycle_ms),
            longest_cycle_ms=self.link.longest_cycle / MILLISECOND,
            late_cycles=self.link.late,
        )


@dataclass(frozen=True, slots=True)
class BoardLine:
    """The line to an Arduino: with a motor shield, or with an arm."""

    wire: ChunkWire
    adapter: Adapter
    link: Board | Ar2Board

    @classmethod
    def of(
        cls, robot: AnyRobot, node: Node, link: DeviceLink, before: "EmulatedLine | BoardLine | None" = None
    ) -> "BoardLine | None":
        """Put a node on a line to a board; None where this link is to none; `before` as for other lines."""
        if not isinstance(link, Board | Ar2Board):
            return None
        adapter = Adapter(node, link.name)
        if not isinstance(before, BoardLine):
            delay = _table(robot, link.name).port_latency_us * MICROSECOND
            return cls(ChunkWire(delay, link.name), adapter, link)
        adapter.plugged = before.adapter.plugged
        link.commands, link.busy = before.link.commands, before.link.busy
        return cls(before.wire, adapter, link)

    def carried(self, robot: AnyRobot, duration: Nanoseconds) -> LineRun:
        """Return what the line has carried in a run so long."""
        table = _table(robot, self.link.name)
        return LineRun(
            link=self.link.name,
            protocol=table.protocol.value,
            baud=table.rate,
            bytes=self.wire.bytes,
            commands=self.link.commands,
            busy_percent=round(100.0 * self.link.busy / duration, 3),
            cycle_ms=float(robot.cycle_ms * table.every),
            longest_cycle_ms=self.link.longest_cycle / MILLISECOND,
            late_cycles=self.link.late,
        )


def _table(robot: AnyRobot, name: str) -> ShieldLink | Ar2Link:
    """Return the table of a link to an Arduino."""
    return Ar2Link.of_link(robot, name) if name in Ar2Link.all_of(robot) else ShieldLink.of_link(robot, name)


AnyLine: TypeAlias = EmulatedLine | BoardLine


def line_of(
    robot: AnyRobot, node: Node, link: DeviceLink, host: str, before: AnyLine | None = None
) -> AnyLine | None:
    """Put a node on the line of a link, as its kind wants; None where the link is no line."""
    own = before if isinstance(before, EmulatedLine) else None
    return EmulatedLine.of(robot, node, link, host, own) or BoardLine.of(robot, node, link, before)
