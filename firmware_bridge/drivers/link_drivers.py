"""All devices on one link of a robot: drives, sensors, outputs. It knows no kind of them, nor of link."""

from collections.abc import Iterable, Mapping
from typing import Final, Protocol

from firmware_bridge.drivers.driver import (
    Driver,
    Level,
    OutputDriver,
    Reading,
    SensorDriver,
    SetPoint,
    Stop,
)
from firmware_bridge.packet import Packet
from firmware_bridge.robot.table import LinkTable
from firmware_bridge.units import MILLISECOND, Nanoseconds


class PlanError(ValueError):
    """A cycle that does not fit on its link: what is too long, by how much, and what to do."""


class DeviceLink(Protocol):
    """The connection to the devices: their requests, and the heartbeat that shows the bridge is alive.

    It does not know what a drive is commanded.
    """

    name: str
    """The link's name in the robot file, which its packets have."""
    answers_within: Nanoseconds
    """Time for the drives' samples after the begin of a cycle."""
    beat_every: Nanoseconds
    """Period of the heartbeat to the devices."""

    listens_for: Nanoseconds
    """Time in which a starting bridge listens for a second controller; 0 where none can be received."""

    remark: str
    """Findings of its start for the station in control, as text; empty without any."""

    late: int
    """Cycles that began before the samples of the one before were in."""

    def hint(self, now: Nanoseconds) -> str:
        """Return what to check while its start waits for an answer for long; empty otherwise."""

    @property
    def lost(self) -> str | None:
        """The reason why no drive can be reached, as text; None while the link works."""

    def master(self, now: Nanoseconds) -> str | None:
        """Return the recent traffic that only a second controller sends, as text; None without any."""

    @property
    def wake_at(self) -> Nanoseconds:
        """Time of its next wake-up, beside its drives'."""

    def sample(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Begin a cycle: have all drives report where they are."""

    def beat(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Let the drives know that the bridge lives."""

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a packet; what belongs to no drive is ignored."""

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""


class LinkDrivers:
    """The devices in the order of the robot file; what a method returns is to be sent."""

    def __init__(
        self,
        link: DeviceLink,
        table: LinkTable,
        drivers: Iterable[Driver],
        sensors: Iterable[SensorDriver] = (),
        outputs: Iterable[OutputDriver] = (),
    ) -> None:
        self.link: Final = link
        self.every: Final = table.every
        """The devices are sampled and commanded in each so many-th cycle of the robot."""
        self.drivers: Final = tuple(drivers)
        self.sensors: Final = tuple(sensors)
        self.outputs: Final = tuple(outputs)
        self._ask_at: dict[str, Nanoseconds] = {}
        """Time of each sensor's next request."""

    @property
    def name(self) -> str:
        """The link's name in the robot file."""
        return self.link.name

    @property
    def wake_at(self) -> Nanoseconds:
        """Time of the next wake-up of the link or the first drive."""
        first = self.link.wake_at
        for driver in self.drivers:
            first = min(first, driver.wake_at)
        return first

    def sampled(self, since: Nanoseconds) -> bool:
        """Return whether every drive has reported its sample of the cycle that began at `since`."""
        # The oldest sample decides; a link without drives has nothing to wait for.
        return min([driver.sampled_at for driver in self.drivers], default=since) >= since

    def readings(self, now: Nanoseconds) -> Mapping[str, Reading]:
        """Return what the sensors have reported, by their names; what is silent for too long is left out."""
        known = {driver.sensor.name: (driver.reading, driver.sensor.silent_ms) for driver in self.sensors}
        return {
            name: reading
            for name, (reading, silent_ms) in known.items()
            if reading is not None and now - reading.received_at <= silent_ms * MILLISECOND
        }

    def command(self, set_points: Mapping[str, SetPoint]) -> tuple[Packet, ...]:
        """Send each axis its set-point; an axis without one rests."""
        return _joined(
            [driver.command(set_points.get(driver.axis.name, Stop.STANDSTILL)) for driver in self.drivers]
        )

    def release(self) -> tuple[Packet, ...]:
        """End the handshakes that are open."""
        return _joined([driver.release() for driver in self.drivers])

    def switch(self, levels: Mapping[str, Level], now: Nanoseconds) -> tuple[Packet, ...]:
        """Bring outputs to these levels; one that is left out stays, and is off before it was ever named."""
        return _joined([driver.switch(levels, now) for driver in self.outputs])

    def measure(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask the sensors that are due; called at the begin of a cycle while the robot runs."""
        sent: tuple[Packet, ...] = ()
        for driver in self.sensors:
            sensor = driver.sensor
            # A sensor that was never read is due at once.
            if now >= self._ask_at.get(sensor.name, now):
                self._ask_at[sensor.name] = now + sensor.every_ms * MILLISECOND
                sent += driver.measure(now)
        return sent

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        if now < self.wake_at:
            return ()
        sent = self.link.wake(now) if self.link.wake_at <= now else ()
        return sent + _joined([driver.wake(now) for driver in self.drivers if driver.wake_at <= now])


def _joined(parts: list[tuple[Packet, ...]]) -> tuple[Packet, ...]:
    return tuple([packet for part in parts for packet in part])
