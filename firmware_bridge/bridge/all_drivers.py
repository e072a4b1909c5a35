"""The drivers of all links of one robot, as the cycle commands them."""

from collections import deque
from collections.abc import Collection, Mapping
from typing import Final

from firmware_bridge.drivers.driver import Driver, Feedback, Level, Reading, SetPoint, Speed, Stop
from firmware_bridge.drivers.life_cycle import AT_REST, START_UP, Task, Transition
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, Nanoseconds


class AllDrivers:
    """The drivers of each link, in the robot file's order; what a method returns is to be sent."""

    def __init__(self, all_drivers: tuple[LinkDrivers, ...]) -> None:
        self.all: Final = all_drivers
        self._by_link: Final = {link_drivers.name: link_drivers for link_drivers in all_drivers}
        self._due = all_drivers
        """Those that are sampled in this cycle."""
        self._stopped: set[str] = set()
        """The axes that the newest set-points stop."""
        self.set_points: dict[str, SetPoint] = {}
        """The last set-point of each axis; only those due on its link, or a stop, are sent."""
        self.taken_at: dict[str, Nanoseconds] = {}
        """Time of the newest command that took an axis's power, after one that did not."""
        self._beats: list[Nanoseconds] = [0] * len(all_drivers)
        """Time of each link's next heartbeat to its devices."""
        self._silent_until: dict[str, Nanoseconds] = {}
        """Until when they shall not, by the link's name."""
        self.drivers: Final[tuple[Driver, ...]] = tuple(
            driver for link_drivers in all_drivers for driver in link_drivers.drivers
        )
        self._start = deque(START_UP)
        self.task: Task | None = None
        """The newest one of the start; None before the first."""

    @property
    def busy(self) -> list[Driver]:
        """The drivers with a transition under way."""
        return [driver for driver in self.drivers if driver.state not in AT_REST]

    @property
    def failures(self) -> tuple[str, ...]:
        """The reasons why transitions failed, one line for each device that did."""
        return tuple(str(driver.failure) for driver in self.drivers if driver.failure is not None)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Findings of the links' start for the station in control."""
        return tuple(link_drivers.link.remark for link_drivers in self.all if link_drivers.link.remark)

    def hints(self, now: Nanoseconds) -> tuple[str, ...]:
        """Return what to check where a link's start waits for an answer for long."""
        return tuple(hint for link_drivers in self.all if (hint := link_drivers.link.hint(now)))

    @property
    def late(self) -> int:
        """Cycles that began before the samples of the one before were in."""
        return sum(link_drivers.link.late for link_drivers in self.all)

    @property
    def wake_at(self) -> Nanoseconds:
        """Time when the next link, device, or heartbeat is due."""
        first = NEVER
        for link_drivers in self.all:
            first = min(first, link_drivers.wake_at)
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
        return {
            link_drivers.name: link_drivers.link.lost
            for link_drivers in self.all
            if link_drivers.link.lost is not None
        }

    @property
    def listens_for(self) -> Nanoseconds:
        """Time for which a starting bridge listens before it sends anything."""
        return max(link_drivers.link.listens_for for link_drivers in self.all)

    def masters(self, now: Nanoseconds) -> dict[str, str]:
        """Return the received traffic of second controllers, by the link's name."""
        received = {link_drivers.name: link_drivers.link.master(now) for link_drivers in self.all}
        return {name: what for name, what in received.items() if what is not None}

    def readings(self, now: Nanoseconds) -> dict[str, Reading]:
        """Return the sensors' readings, by their names, without those too old."""
        return {
            name: reading for link_drivers in self.all for name, reading in link_drivers.readings(now).items()
        }

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...] | None:
        """Take a packet; None where it came over no link of these."""
        link_drivers = self._by_link.get(packet.link)
        return None if link_drivers is None else link_drivers.link.receive(packet, now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time, beats left out."""
        return joined([link_drivers.wake(now) for link_drivers in self.all])

    def begin_beats(self, now: Nanoseconds) -> None:
        """Beat from now on."""
        self._beats = [now] * len(self.all)

    def beat(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Let the devices know that the bridge lives, where that is due; late beats are not made up for.

        None goes to a link that is silenced.
        """
        sent: tuple[Packet, ...] = ()
        for index, link_drivers in enumerate(self.all):
            at = self._beats[index]
            if now >= at:
                self._beats[index] = (
                    at + ((now - at) // link_drivers.link.beat_every + 1) * link_drivers.link.beat_every
                )
                if now >= self._silent_until.get(link_drivers.name, now):
                    sent += link_drivers.link.beat(now)
        return sent

    def silence(self, link: str, until: Nanoseconds) -> None:
        """Withhold the beats of a link, so that its devices stop by their own watch."""
        self._silent_until[link] = max(until, self._silent_until.get(link, until))

    def start(self, now: Nanoseconds, without: frozenset[str], *, power: bool) -> tuple[Packet, ...] | None:
        """Begin the next task of the start with all devices but those of the axes `without`, side by side.

        None where none is left, or none without `power`.
        """
        if not self._start or (self._start[0][0] is Transition.ACTIVATE and not power):
            return None
        transition, self.task = self._start.popleft()
        used = [driver for driver in self.drivers if driver.axis.name not in without]
        return joined([driver.begin(transition, now, self.task) for driver in used])

    def sample(self, cycle: int, now: Nanoseconds) -> tuple[Packet, ...]:
        """Begin a cycle, the `cycle`-th: sample the devices of each link that is due."""
        self._due = tuple([link_drivers for link_drivers in self.all if cycle % link_drivers.every == 0])
        return joined([link_drivers.link.sample(now) for link_drivers in self._due])

    def answers_within(self) -> Nanoseconds:
        """Return how long the samples of this cycle are waited for."""
        return max([link_drivers.link.answers_within for link_drivers in self._due], default=0)

    def sampled(self, since: Nanoseconds) -> bool:
        """Return whether every requested device has sent its sample of the cycle that began at `since`."""
        return all(link_drivers.sampled(since) for link_drivers in self._due)

    def measure(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask the sensors that are due."""
        return joined([link_drivers.measure(now) for link_drivers in self.all])

    def command(
        self, commanded: Mapping[str, SetPoint], levels: Mapping[str, Level], now: Nanoseconds
    ) -> tuple[Packet, ...]:
        """Send each axis its set-point, one without rests; switch the outputs that are named.

        A link that is not due in this cycle is left alone, unless one of its axes shall stop and does not.
        """
        sent: tuple[Packet, ...] = ()
        for link_drivers in self.all:
            set_points = {
                driver.axis.name: commanded.get(driver.axis.name, Stop.STANDSTILL)
                for driver in link_drivers.drivers
            }
            stops = {name for name, set_point in set_points.items() if requests_stop(set_point)}
            if link_drivers in self._due or not stops <= self._stopped:
                sent += link_drivers.command(set_points)
                self._note(set_points, now)
            self._stopped.difference_update(set_points)
            self._stopped |= stops
            if levels:
                sent += link_drivers.switch(levels, now)
        return sent

    def follow(self, set_points: Mapping[str, SetPoint]) -> tuple[Packet, ...]:
        """Send these axes set-points between two cycles; the others keep theirs."""
        sent: tuple[Packet, ...] = ()
        for driver in self.drivers:
            name = driver.axis.name
            if name in set_points:
                sent += driver.command(set_points[name])
        self.set_points.update(set_points)
        return sent

    def _note(self, set_points: Mapping[str, SetPoint], now: Nanoseconds) -> None:
        """Keep what is commanded, and since when an axis shall have no power."""
        for name, set_point in set_points.items():
            if set_point is Stop.POWER_OFF and self.set_points.get(name) is not Stop.POWER_OFF:
                self.taken_at[name] = now
        self.set_points.update(set_points)

    def command_all(self, set_point: Stop, now: Nanoseconds, off: Collection[str] = ()) -> tuple[Packet, ...]:
        """Send all axes the same set-point; those named in `off` shall have no power, whatever it is."""
        commanded = {driver.axis.name: set_point for driver in self.drivers} | dict.fromkeys(
            off, Stop.POWER_OFF
        )
        self._note(commanded, now)
        return joined([link_drivers.command(commanded) for link_drivers in self.all])

    def release(self) -> tuple[Packet, ...]:
        """End the handshakes that are open."""
        return joined([link_drivers.release() for link_drivers in self.all])


def requests_stop(set_point: SetPoint) -> bool:
    """Return whether a set-point is a stop, or speed 0."""
    return isinstance(set_point, Stop) or (isinstance(set_point, Speed) and set_point.value == 0.0)


def joined(parts: list[tuple[Packet, ...]]) -> tuple[Packet, ...]:
    """Return the packets of all parts, one after the other."""
    return tuple([packet for part in parts for packet in part])
