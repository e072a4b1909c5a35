"""The CAN bus as one link of the robot: SYNC samples the drives, a heartbeat shows the bridge is alive."""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen.cia301 import NODE_MASK, NmtState
from firmware_bridge.canopen_drive.driver.can_drive import DriveOnCan
from firmware_bridge.canopen_drive.driver.process_data import SET_POINT_COB_ID
from firmware_bridge.canopen_drive.settings import DriveAxis, DriveLink
from firmware_bridge.drivers.plain_link import PlainLink
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire import can

ANSWERS_WITHIN: Final[Nanoseconds] = 10 * MILLISECOND
"""The drives answer a SYNC within a millisecond; later ones are not waited for."""
_WRITES: Final = (sdo.DownloadRequest, sdo.SdoSegment)
REMEMBERED: Final[Nanoseconds] = SECOND
"""Time for which a second controller's frame counts: it may be back any moment."""


class CanLink(PlainLink):
    """A `firmware_bridge.drivers.link_drivers.DeviceLink`."""

    def __init__(self, name: str, drives: Iterable[DriveOnCan], table: DriveLink) -> None:
        super().__init__(
            name,
            ANSWERS_WITHIN,
            table.bridge_heartbeat_ms * MILLISECOND,
            # The heartbeat producer that satisfies the drives' consumers sends within that time.
            table.bridge_silent_ms * MILLISECOND,
        )
        self._drives = tuple(drives)
        self._by_node = {DriveAxis.of(drive.axis).node: drive for drive in self._drives}
        beat = cia301.encode_heartbeat(NmtState.OPERATIONAL)
        self._beat = Packet(name, cia301.ERROR_CONTROL + table.bridge_node, beat)
        self._sync = Packet(name, cia301.SYNC, b"")
        self._masters = _masters(self._drives, table)
        """Identifiers that only a master sends: our own frames do not come back to us."""
        self._master: tuple[Nanoseconds, str, Packet] | None = None
        """Time of the last such frame, its kind, and the frame."""

    def master(self, now: Nanoseconds) -> str | None:
        """Return the recent traffic of a second controller, with its frame."""
        if self._master is None or now >= self._master[0] + REMEMBERED:
            return None
        _, what, packet = self._master
        return f"someone else sends {what}: {packet.address:03X}#{packet.payload.hex().upper()}"

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Send SYNC."""
        for drive in self._drives:
            drive.synchronized(now)
        return (self._sync,)

    def beat(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Send the bridge's heartbeat."""
        return (self._beat,)

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a frame; those of foreign nodes, remote requests and error reports are ignored."""
        if packet.address & ~can.STANDARD_MASK:
            return ()
        if packet.address in self._masters:
            self._master = (now, self._masters[packet.address], packet)
            return ()
        drive = self._by_node.get(packet.address & NODE_MASK)
        if drive is None:
            return ()
        if packet.address & ~NODE_MASK == cia301.SDO_REQUEST:
            if isinstance(sdo.decode_request(packet.payload), _WRITES):
                drive.rewritten(f"{packet.address:03X}#{packet.payload.hex().upper()}", now)
            return ()
        return drive.receive(packet, now)


def _masters(drives: Iterable[DriveOnCan], table: DriveLink) -> dict[int, str]:
    """Return the frames that only the master of these drives sends, as text, by identifier.

    Requests for objects are not in it: an engineer may read a drive while the robot drives. His writes are
    the drive's own matter.
    """
    beat = cia301.ERROR_CONTROL + table.bridge_node
    axes = [drive.axis for drive in drives]
    return {
        cia301.NMT: "a network command",
        cia301.SYNC: "SYNC",
        beat: f"the heartbeat of this bridge, node {table.bridge_node}",
        **{
            SET_POINT_COB_ID[axis.command] + DriveAxis.of(axis).node: f"{axis.called} set-points"
            for axis in axes
        },
    }
