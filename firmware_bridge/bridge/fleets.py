"""All links of one robot, each with the fleet of devices on it, as the cycle speaks to them."""

from collections.abc import Collection, Mapping
from typing import Final

from firmware_bridge.drivers.driver import Demand, Driver, Feedback, Level, Reading, Speed, Stop, Task
from firmware_bridge.drivers.fleet import Fleet
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, Nanoseconds


class Fleets:
    """The fleets in the order of the robot file's links; what a method returns is to be sent."""

    def __init__(self, fleets: tuple[Fleet, ...]) -> None:
        self.all: Final = fleets
        self._by_link: Final = {fleet.name: fleet for fleet in fleets}
        self._due = fleets
        """Those that are sampled in this cycle."""
        self._stopped: set[str] = set()
        """The axes that the newest demands stop."""
        self.set_points: dict[str, Demand] = {}
        """The last set-point of each axis; only those due on its link, or a stop, are sent."""
        self._beats: list[Nanoseconds] = [0] * len(fleets)
        """Time of each link's next heartbeat to its devices."""
        self._silent_until: dict[str, Nanoseconds] = {}
        """Until when they shall not, by the link's name."""
        self.drivers: Final[tuple[Driver, ...]] = tuple(
            driver for fleet in fleets for driver in fleet.drivers
        )

    @property
    def busy(self) -> bool:
        """True while any device has tasks under way."""
        return any(fleet.busy for fleet in self.all)

    @property
    def failures(self) -> tuple[str, ...]:
        """The reasons why tasks failed, one line for each device that did."""
        return tuple(failure for fleet in self.all for failure in fleet.failures)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Findings of the links' start for the station in control."""
        return tuple(fleet.link.remark for fleet in self.all if fleet.link.remark)

    def hints(self, now: Nanoseconds) -> tuple[str, ...]:
        """Return what to check where a link's start waits for an answer for long."""
        return tuple(hint for fleet in self.all if (hint := fleet.link.hint(now)))

    @property
    def late(self) -> int:
        """Cycles that began before the samples of the one before were in."""
        return sum(fleet.link.late for fleet in self.all)

    @property
    def wake_at(self) -> Nanoseconds:
        """Time when the next link, device, or heartbeat is due."""
        first = NEVER
        for fleet in self.all:
            first = min(first, fleet.wake_at)
        for at in self._beats:
            first = min(first, at)
        return first

    @property
    def feedback(self) -> dict[str, Feedback]:
        """Feedback of each axis' device, by the axis' name."""
        return {driver.axis.name: driver.feedback for driver in self.drivers}

    @property
    def links_lost(self) -> dict[str, str]:
        """Reasons why no device on a link can be reached, by the link's name."""
        return {fleet.name: fleet.link.lost for fleet in self.all if fleet.link.lost is not None}

    @property
    def listens_for(self) -> Nanoseconds:
        """Time for which a starting bridge listens before it sends anything."""
        return max(fleet.link.listens_for for fleet in self.all)

    def masters(self, now: Nanoseconds) -> dict[str, str]:
        """Return the received traffic of second controllers, by the link's name."""
        received = {fleet.name: fleet.link.master(now) for fleet in self.all}
        return {name: what for name, what in received.items() if what is not None}

    def readings(self, now: Nanoseconds) -> dict[str, Reading]:
        """Return the sensors' readings, by their names, without those too old."""
        return {name: reading for fleet in self.all for name, reading in fleet.readings(now).items()}

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...] | None:
        """Take a packet; None where it came over no link of these."""
        fleet = self._by_link.get(packet.link)
        return None if fleet is None else fleet.link.receive(packet, now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time, beats left out."""
        return joined([fleet.wake(now) for fleet in self.all])

    def begin_beats(self, now: Nanoseconds) -> None:
        """Beat from now on."""
        self._beats = [now] * len(self.all)

    def beat(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Let the devices know that the bridge lives, where that is due; late beats are not made up for.

        None goes to a link that is silenced.
        """
        sent: tuple[Packet, ...] = ()
        for index, fleet in enumerate(self.all):
            at = self._beats[index]
            if now >= at:
                self._beats[index] = at + ((now - at) // fleet.link.beat_every + 1) * fleet.link.beat_every
                if now >= self._silent_until.get(fleet.name, now):
                    sent += fleet.link.beat(now)
        return sent

    def silence(self, link: str, until: Nanoseconds) -> None:
        """Withhold the beats of a link, so that its devices stop by their own watch."""
        self._silent_until[link] = max(until, self._silent_until.get(link, until))

    def begin(
        self, tasks: tuple[Task, ...], now: Nanoseconds, without: frozenset[str] = frozenset()
    ) -> tuple[Packet, ...]:
        """Let all devices do these tasks, side by side; those of the axes `without` are left alone."""
        return joined([fleet.begin(tasks, now, without) for fleet in self.all])

    def sample(self, cycle: int, now: Nanoseconds) -> tuple[Packet, ...]:
        """Begin a cycle, the `cycle`-th: sample the devices of each link that is due."""
        self._due = tuple([fleet for fleet in self.all if cycle % fleet.every == 0])
        return joined([fleet.link.sample(now) for fleet in self._due])

    def answers_within(self) -> Nanoseconds:
        """Return how long the samples of this cycle are waited for."""
        return max([fleet.link.answers_within for fleet in self._due], default=0)

    def sampled(self, since: Nanoseconds) -> bool:
        """Return whether every requested device has sent its sample of the cycle that began at `since`."""
        return all(fleet.sampled(since) for fleet in self._due)

    def measure(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask the sensors that are due."""
        return joined([fleet.measure(now) for fleet in self.all])

    def command(
        self, demands: Mapping[str, Demand], levels: Mapping[str, Level], now: Nanoseconds
    ) -> tuple[Packet, ...]:
        """Send each axis its demand, one without rests; switch the outputs that are named.

        A link that is not due in this cycle is left alone, unless one of its axes shall stop and does not.
        """
        sent: tuple[Packet, ...] = ()
        for fleet in self.all:
            set_points = {
                driver.axis.name: demands.get(driver.axis.name, Stop.REST) for driver in fleet.drivers
            }
            stops = {name for name, demand in set_points.items() if requests_stop(demand)}
            if fleet in self._due or not stops <= self._stopped:
                sent += fleet.command(set_points)
                self.set_points.update(set_points)
            self._stopped.difference_update(set_points)
            self._stopped |= stops
            if levels:
                sent += fleet.switch(levels, now)
        return sent

    def command_all(self, demand: Stop, off: Collection[str] = ()) -> tuple[Packet, ...]:
        """Send all axes the same demand; those named in `off` shall have no power, whatever it is."""
        demands = {driver.axis.name: demand for driver in self.drivers} | dict.fromkeys(off, Stop.POWER_OFF)
        self.set_points.update(demands)
        return joined([fleet.command(demands) for fleet in self.all])

    def release(self) -> tuple[Packet, ...]:
        """End the handshakes that are open."""
        return joined([fleet.release() for fleet in self.all])


def requests_stop(demand: Demand) -> bool:
    """Return whether a demand is a stop, or speed 0."""
    return isinstance(demand, Stop) or (isinstance(demand, Speed) and demand.value == 0.0)


def joined(parts: list[tuple[Packet, ...]]) -> tuple[Packet, ...]:
    """Return the packets of all parts, one after the other."""
    return tuple([packet for part in parts for packet in part])
