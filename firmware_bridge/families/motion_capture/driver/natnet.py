"""A NatNet server as a link: the bridge connects, receives frames, and looks for its bodies in them.

It connects again and again until it is answered, and when no frame has come for the link's `silent_ms`: then
the server was started again. It decodes by the version that the server reports. A packet that is not the
server's, or cannot be read, is counted and left; nothing of it reaches the robot.
"""

from collections.abc import Iterable
from typing import Final

from firmware_bridge.drivers.plain_link import PlainLink
from firmware_bridge.families.motion_capture.driver.body import SeenBody, Sighting
from firmware_bridge.families.motion_capture.driver.clock import StampClock
from firmware_bridge.families.motion_capture.settings import CaptureLink
from firmware_bridge.families.motion_capture.wire import messages, models
from firmware_bridge.families.motion_capture.wire.frame import BodyFlag, FrameFlag
from firmware_bridge.families.motion_capture.wire.glance import Glance, glance
from firmware_bridge.families.motion_capture.wire.layout import V3_0, NatNetError, Version
from firmware_bridge.families.motion_capture.wire.messages import Connect, MessageId, ServerInfo, packet
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, from_seconds
from firmware_bridge.wire.internet import same_host

AGAIN: Final[Nanoseconds] = SECOND
"""So long an answer is waited for."""
ALIVE_EVERY: Final[Nanoseconds] = 2 * SECOND
"""Period of the message that a listener is there, as OptiTrack's own samples send it."""
CONNECT: Final = packet(
    MessageId.CONNECT,
    messages.connect_payload(Connect("firmware-bridge", (1, 0, 0, 0), (4, 4, 0, 0), (0, 0, 0, 0))),
)
_MODELS_CHANGED: Final = int(FrameFlag.MODELS_CHANGED)
_TRACKED: Final = int(BodyFlag.TRACKED)
_ALIVE: Final = packet(MessageId.KEEPALIVE)
_WHICH: Final = packet(MessageId.REQUEST_MODELDEF)


class NatNetLink(PlainLink):
    """A link whose loss is none: a stream that is not there makes readings old, and nothing else."""

    def __init__(self, name: str, table: CaptureLink, bodies: Iterable[SeenBody]) -> None:
        super().__init__(name, beat_every=ALIVE_EVERY)
        self._wake_at: Nanoseconds = 0
        self.refused = 0
        """Packets that could not be read."""
        self.problem = ""
        """The reason why the newest of them was refused."""
        self.server: ServerInfo | None = None
        """The server; None before it has answered."""
        self._version: Version | None = None
        """In which version."""
        self._table: Final = table
        self._place: Final = table.server_number
        self._bodies: Final = tuple(bodies)
        self._numbers: dict[str, int] = {}
        """Of the bodies that are named in the robot file, by name."""
        self._silent: Final = table.silent_ms * MILLISECOND
        self._received_at: Nanoseconds = -self._silent
        """Time of the newest frame."""
        self._clock = StampClock()

    @property
    def wake_at(self) -> Nanoseconds:
        """Time of the next request."""
        return self._wake_at

    def beat(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Show the server that a listener is there."""
        return () if self.server is None else (self._sent(_ALIVE),)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Connect where nothing is received, and request names that are not known."""
        self._wake_at = now + AGAIN
        if now - self._received_at >= self._silent:
            return (self._sent(CONNECT),)
        return (self._sent(_WHICH),) if self._wanted() else ()

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a packet; one of another host is left."""
        if not same_host(packet.address, self._place):
            return ()
        try:
            return self._taken(*messages.split(packet.payload), now)
        except NatNetError as refused:
            self.refused += 1
            self.problem = str(refused)
            return ()

    def _taken(self, message: MessageId, payload: bytes, now: Nanoseconds) -> tuple[Packet, ...]:
        if message is MessageId.SERVERINFO:
            server = messages.server_info(payload)
            if server != self.server:
                # Another start of the server: its clock begins again, and numbers may have changed.
                self.server, self._version, self._clock = server, server.version, StampClock()
                self._numbers.clear()
            return (self._sent(_WHICH),) if self._wanted() else ()
        version = self._version
        if self.server is None or version is None:
            return ()
        if message is MessageId.MODELDEF:
            found = models.decoded(payload, version)
            self._numbers = {name: models.body_named(found, name) for name in self._names()}
        elif message is MessageId.FRAMEOFDATA:
            frame = glance(payload, version)
            self._received_at = now
            ticks_per_s = self.server.ticks_per_s if version >= V3_0 else 0
            self._look(frame, self._exposed_at(frame, ticks_per_s, now), now)
            if frame.params & _MODELS_CHANGED and any(self._names()):
                return (self._sent(_WHICH),)
        return ()

    def _look(self, frame: Glance, at: Nanoseconds, now: Nanoseconds) -> None:
        """Look for the bodies in a frame that shows the instant `at`."""
        for one in self._bodies:
            wanted = one.settings.body
            # A body without a known number has none that occurs in a stream.
            body = frame.body(self._numbers.get(wanted, -1) if isinstance(wanted, str) else wanted)
            if body is None:
                one.missed(Sighting.ABSENT)
            elif not body.params & _TRACKED:
                one.missed(Sighting.LOST)
            else:
                one.seen(body.position, body.attitude, body.mean_error_m, at, now)

    def _exposed_at(self, frame: Glance, ticks_per_s: int, now: Nanoseconds) -> Nanoseconds:
        """Return the middle of the exposure by our clock; the robot file fills in for missing stamps."""
        if ticks_per_s > 0 and frame.sent:
            left = self._clock.left_at(frame.sent * SECOND // ticks_per_s, now)
            # From the middle of the exposure until it was sent, by the server's own clock.
            if 0 < frame.exposed <= frame.sent:
                return left - (frame.sent - frame.exposed) * SECOND // ticks_per_s
            return left - self._table.latency
        stamp = frame.timestamp_s
        # A stamp that is no number, or beyond all bounds, must not reach integer arithmetic.
        if not 0.0 <= stamp < NEVER / SECOND:
            return now - self._table.latency
        return self._clock.left_at(from_seconds(stamp), now) - self._table.latency

    def _names(self) -> tuple[str, ...]:
        return tuple(one.settings.body for one in self._bodies if isinstance(one.settings.body, str))

    def _wanted(self) -> bool:
        """Return whether a body's name is not known yet."""
        return self.server is not None and any(name not in self._numbers for name in self._names())

    def _sent(self, datagram: bytes) -> Packet:
        return Packet(self.name, self._place, datagram)
