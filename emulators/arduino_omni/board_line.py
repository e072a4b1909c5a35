"""The serial line between the bridge and an Arduino, as a motor shield's and an arm's board share it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from emulators.family import BridgeLink, CountedLink, Devices, Lane, Line, LineRun
from emulators.wires.adapter import Adapter
from emulators.wires.usb import ChunkWire
from firmware_bridge.node import Node
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MICROSECOND, MILLISECOND, Nanoseconds


class BoardLink(Protocol):
    """The table of a link to a board in the robot file."""

    @property
    def port_latency_us(self) -> int:
        """Longest time that the port may keep received bytes."""

    @property
    def rate(self) -> int:
        """Bit rate, bit/s."""

    @property
    def every(self) -> int:
        """The link's cycles, in cycles of the robot."""


@dataclass(frozen=True, slots=True)
class BoardLine:
    """The line to a board."""

    wire: ChunkWire
    adapter: Adapter
    link: CountedLink
    table: BoardLink
    protocol: str
    i2c_busy: Callable[[Devices], Nanoseconds] | None = None
    """Time in which the board's own bus was busy; None where it has no shield."""

    def lane(self, kind: str, player: str) -> Lane:
        """Return the same line: the board's second chip takes the time that it took."""
        del player
        return Lane(kind, self.wire, lambda _: self.wire.delay)

    def carried(self, robot: AnyRobot, duration: Nanoseconds, devices: Devices) -> LineRun:
        """Return what the line has carried in a run so long."""
        i2c = None if self.i2c_busy is None else round(100.0 * self.i2c_busy(devices) / duration, 3)
        return LineRun(
            link=self.link.name,
            protocol=self.protocol,
            baud=self.table.rate,
            bytes=self.wire.bytes,
            commands=self.link.commands,
            busy_percent=round(100.0 * self.link.busy / duration, 3),
            cycle_ms=float(robot.cycle_ms * self.table.every),
            longest_cycle_ms=self.link.longest_cycle / MILLISECOND,
            late_cycles=self.link.late,
            i2c_percent=i2c,
        )


def board_line(
    node: Node,
    link: BridgeLink,
    table: BoardLink,
    protocol: str,
    before: Line | None,
    *,
    i2c_busy: Callable[[Devices], Nanoseconds] | None = None,
) -> BoardLine:
    """Put a node on the line to a board; see `emulators.family.MakeLine`. TypeError for another link."""
    if not isinstance(link, CountedLink):
        raise TypeError(f"the bridge's link '{link.name}' is none to a board")
    adapter = Adapter(node, link.name)
    if not isinstance(before, BoardLine):
        wire = ChunkWire(table.port_latency_us * MICROSECOND, link.name)
    else:
        # The cable outlives the process: its plug and its counts go on.
        wire, adapter.plugged = before.wire, before.adapter.plugged
        link.commands, link.busy = before.link.commands, before.link.busy
    return BoardLine(wire, adapter, link, table, protocol, i2c_busy)
