"""All drives of one robot and the link to them. It knows no kind of drive, and no kind of link."""

from collections.abc import Iterable, Mapping

from firmware_bridge.drivers.drive import Demand, Drive, Stop, Task
from firmware_bridge.drivers.link import Link
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds


class Fleet:
    """The drives in the order of the robot file; what a method returns is to be sent."""

    __slots__ = ("drives", "link")

    def __init__(self, drives: Iterable[Drive], link: Link) -> None:
        self.drives = tuple(drives)
        self.link = link

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
        """When the link or the first drive wants to be woken."""
        first = self.link.wake_at
        for drive in self.drives:
            first = min(first, drive.wake_at)
        return first

    def sampled(self, since: Nanoseconds) -> bool:
        """Whether every drive has told its sample of the cycle that began at `since`."""
        return all(drive.heard.sampled_at >= since for drive in self.drives)

    def begin(self, tasks: tuple[Task, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Let all drives do these tasks, side by side."""
        return _joined([drive.begin(tasks, now) for drive in self.drives])

    def command(self, demands: Mapping[str, Demand]) -> tuple[Packet, ...]:
        """Send each axis its demand; an axis without one rests."""
        return _joined([drive.command(demands.get(drive.axis.name, Stop.REST)) for drive in self.drives])

    def command_all(self, demand: Demand) -> tuple[Packet, ...]:
        """Send all axes the same demand."""
        return _joined([drive.command(demand) for drive in self.drives])

    def release(self) -> tuple[Packet, ...]:
        """End the handshakes that are open."""
        return _joined([drive.release() for drive in self.drives])

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Begin a cycle: have all drives tell where they are."""
        return self.link.sample(now)

    def beat(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Let the drives know that the bridge lives."""
        return self.link.beat(now)

    def hear(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a packet of the link."""
        return self.link.hear(packet, now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        if now < self.wake_at:
            return ()
        sent = self.link.wake(now) if self.link.wake_at <= now else ()
        return sent + _joined([drive.wake(now) for drive in self.drives if drive.wake_at <= now])


def _joined(parts: list[tuple[Packet, ...]]) -> tuple[Packet, ...]:
    return tuple([packet for part in parts for packet in part])
