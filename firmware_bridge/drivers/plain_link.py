"""What the links of most families share."""

from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER, SECOND, Nanoseconds


class PlainLink:
    """A `firmware_bridge.drivers.link_drivers.DeviceLink` that sends nothing; a family overrides its part."""

    def __init__(
        self,
        name: str,
        answers_within: Nanoseconds = 0,
        beat_every: Nanoseconds = SECOND,
        listens_for: Nanoseconds = 0,
    ) -> None:
        self.name = name
        self.answers_within = answers_within
        self.beat_every = beat_every
        self.listens_for = listens_for
        self.remark = ""
        self.late = 0
        self.longest_cycle: Nanoseconds = 0
        """From the begin of a cycle to the end of its last request, where no tasks were under way."""
        self.commands = 0
        """Requests so far."""
        self.busy: Nanoseconds = 0
        """Time in which an answer was awaited."""
        self.gone = ""
        """The reason why its devices cannot be reached; empty while the link works."""

    @property
    def lost(self) -> str | None:
        """The reason why its devices cannot be reached."""
        return self.gone or None

    def hint(self, _now: Nanoseconds) -> str:
        """Return no hint."""
        return ""

    def master(self, _now: Nanoseconds) -> str | None:
        """Report nothing: a second controller is not received here."""
        return None

    @property
    def wake_at(self) -> Nanoseconds:
        """Never."""
        return NEVER

    def sample(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Send nothing."""
        return ()

    def beat(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Send nothing: the devices count no heartbeat."""
        return ()

    def receive(self, _packet: Packet, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Send nothing."""
        return ()

    def wake(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Send nothing."""
        return ()
