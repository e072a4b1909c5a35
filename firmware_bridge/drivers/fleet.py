"""All drives of one robot: who a frame belongs to, what all of them do next. It knows no kind of drive."""

from collections.abc import Iterable, Mapping
from itertools import chain

from firmware_bridge.drivers.drive import Demand, Drive, Stop, Task
from firmware_bridge.node import Packet
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire import can
from firmware_bridge.wire.canopen import NODE_MASK


class Fleet:
    """The drives in the order of the robot file; what a method returns is to be sent."""

    __slots__ = ("_by_node", "drives")

    def __init__(self, drives: Iterable[Drive]) -> None:
        self.drives = tuple(drives)
        self._by_node = {drive.axis.node: drive for drive in self.drives}

    @property
    def busy(self) -> bool:
        """Whether any drive has tasks under way."""
        return any(drive.busy for drive in self.drives)

    @property
    def failures(self) -> tuple[str, ...]:
        """Why tasks failed, one line for each drive that did."""
        return tuple(str(drive.failure) for drive in self.drives if drive.failure is not None)

    @property
    def wake_at(self) -> Nanoseconds:
        """When the first drive wants to be woken."""
        return min([drive.wake_at for drive in self.drives], default=NEVER)

    def sampled(self, since: Nanoseconds) -> bool:
        """Whether every drive has answered the SYNC sent at `since`."""
        return all(drive.heard.sampled_at >= since for drive in self.drives)

    def begin(self, tasks: tuple[Task, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Let all drives do these tasks, side by side."""
        return _joined(drive.begin(tasks, now) for drive in self.drives)

    def command(self, demands: Mapping[str, Demand]) -> tuple[Packet, ...]:
        """Send each axis its demand; an axis without one rests."""
        return _joined([drive.command(demands.get(drive.axis.name, Stop.REST)) for drive in self.drives])

    def command_all(self, demand: Demand) -> tuple[Packet, ...]:
        """Send all axes the same demand."""
        return _joined(drive.command(demand) for drive in self.drives)

    def release(self) -> tuple[Packet, ...]:
        """End the handshakes that are open."""
        return _joined(drive.release() for drive in self.drives)

    def synchronised(self, now: Nanoseconds) -> None:
        """Tell all drives that a SYNC leaves now."""
        for drive in self.drives:
            drive.synchronised(now)

    def hear(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a frame; those of strangers, remote requests and error reports are ignored."""
        if packet.address & ~can.STANDARD_MASK:
            return ()
        drive = self._by_node.get(packet.address & NODE_MASK)
        return () if drive is None else drive.hear(packet, now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        return _joined([drive.wake(now) for drive in self.drives if drive.wake_at <= now])


def _joined(parts: Iterable[tuple[Packet, ...]]) -> tuple[Packet, ...]:
    return tuple(chain.from_iterable(parts))
