"""A capture system as a node: exposures at the cameras' rate, frames that leave later, and its clients.

The links are "command", Motive's port 1510, and "data", from which frames come, 1511. Only a client that has
connected is sent frames. A frame shows the truth as it was in the middle of its exposure.

Sources: a Motive 2.1 at 120 Hz took 4.6 ms from the exposure until the image was in, and 0.8 ms more until
the frame left, 5.4 in all; they came up to a few ms apart from their rhythm. Where they are silent:
* at 240 Hz it takes as long as at 120 Hz.
* a frame leaves up to some tenths of a ms sooner or later, normally distributed, and never before another.
* the server's clock ticks at 10 MHz, runs 30 ppm fast, and did not begin with the run.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from numpy.random import Generator

from emulators.motion_capture.bodies import TrackedBody
from emulators.motion_capture.chance import Chance
from emulators.motion_capture.exposure import NORMALS, Cameras, Exposure, Hidden, Shaken, Swapped
from emulators.motion_capture.server import Server
from firmware_bridge.families.motion_capture.wire import frame as frames
from firmware_bridge.families.motion_capture.wire import messages
from firmware_bridge.families.motion_capture.wire.frame import Frame, FrameFlag
from firmware_bridge.families.motion_capture.wire.layout import Version
from firmware_bridge.families.motion_capture.wire.messages import MessageId
from firmware_bridge.families.motion_capture.wire.models import (
    MarkerSetModel,
    Model,
    ModelMarker,
    RigidBodyModel,
)
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds, to_seconds

COMMAND: Final = "command"
DATA: Final = "data"
DEFAULT: Final = Version(3, 1)
"""Protocol of Motive 2.1, which cameras of 2018 to 2020 came with."""
_TICKS_PER_S: Final = 10_000_000
_FAST: Final = 30e-6
_BEGAN: Final = 123_456_789_000
"""The server's clock at the begin of the run."""
_FRAMES_OF_TIMECODE: Final = 100


@dataclass(frozen=True, slots=True)
class Timing:
    """Times of exposure and departure of the frames."""

    rate_hz: int = 240
    received_after: Nanoseconds = 4_600 * MICROSECOND
    """Time from the middle of the exposure until the image is in."""
    sent_after: Nanoseconds = 800 * MICROSECOND
    """Time from then until the frame leaves."""
    jitter: Nanoseconds = 250 * MICROSECOND
    """The standard deviation of the latter."""

    def exposed_at(self, number: int) -> Nanoseconds:
        """Return the middle of an exposure, counted from 0."""
        # From the first exposure on: periods of 4.1667 ms, each cut to ns, would drift.
        return number * SECOND // self.rate_hz


class MotionCapture:
    """Cameras around a room; `exposure` takes disturbances while it runs."""

    def __init__(
        self,
        bodies: Sequence[TrackedBody],
        generator: Generator,
        *,
        version: Version = DEFAULT,
        cameras: Cameras | None = None,
        timing: Timing | None = None,
        data_link: str = DATA,
        data_port: int = messages.DATA_PORT,
    ) -> None:
        """Watch these bodies; frames leave on `data_link`. NatNetError for a version that is not known."""
        self.timing: Final = Timing() if timing is None else timing
        self.exposure: Final = Exposure(bodies, Cameras() if cameras is None else cameras)
        self.server: Final = Server(
            version,
            _models(bodies, self.exposure),
            rate_hz=self.timing.rate_hz,
            ticks_per_s=_TICKS_PER_S,
            data_port=data_port,
        )
        self._data_link: Final = data_link
        self._chance: Final = Chance(generator)
        self._number = -1
        """Number of the frame that leaves next; chance decides its time and its errors."""
        self._received: Nanoseconds = 0
        self._leaves_at: Nanoseconds = 0
        self._normals: list[float] = []
        self.frames = 0
        """Frames that have left, to however many clients."""
        self._plan()

    def hide(self, what: Hidden | Swapped | Shaken) -> None:
        """Hide a body, or have its markers taken for others, as described."""
        self.exposure.disturbances.append(what)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Answer a client on the command channel."""
        sent: tuple[Packet, ...] = ()
        if packet.link == COMMAND:
            answers = self.server.receive(packet.address, packet.payload, now, ticks_at(now))
            sent = tuple([Packet(COMMAND, packet.address, answer) for answer in answers])
        return Reaction(sent, self._leaves_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send the frames that are due."""
        sent: list[Packet] = []
        while self._leaves_at <= now:
            sent += self._sent(self._frame(), now)
            self.frames += 1
            self._plan()
        return Reaction(tuple(sent), self._leaves_at)

    def _plan(self) -> None:
        """Turn to the next frame, and let chance say when it leaves."""
        timing, number = self.timing, self._number + 1
        self._number = number
        self._normals = self._chance.normals(NORMALS * len(self.exposure.bodies) + 1)
        self._received = timing.exposed_at(number) + timing.received_after
        late = round(timing.jitter * self._normals[-1])
        # Never before its image is in, nor before the frame in front of it.
        self._leaves_at = max(self._received, self._received + timing.sent_after + late, self._leaves_at)

    def _frame(self) -> Frame:
        """Return the frame that leaves next, as it was exposed."""
        exposed, received, sent = self.timing.exposed_at(self._number), self._received, self._leaves_at
        bodies, markers = self.exposure.bodies_at(exposed, self._normals)
        return Frame(
            self._number,
            bodies=bodies,
            markers=markers,
            timecode=_timecode(exposed),
            timestamp_s=to_seconds(exposed),
            exposed=ticks_at(exposed),
            received=ticks_at(received),
            sent=ticks_at(sent),
            latency_s=to_seconds(sent - received),
            precise=(0, 0),
            params=FrameFlag.RECORDING if self.server.recording else 0,
        )

    def _sent(self, frame: Frame, now: Nanoseconds) -> list[Packet]:
        """Return the frame for each client, in his version."""
        made: dict[Version, bytes] = {}
        sent: list[Packet] = []
        for place, version in self.server.clients(now).items():
            # Encoded once for all clients of one version.
            if version not in made:
                made[version] = messages.packet(MessageId.FRAMEOFDATA, frames.encoded(frame, version))
            sent.append(Packet(self._data_link, place, made[version]))
        return sent


def ticks_at(now: Nanoseconds) -> int:
    """Return the server's clock at an instant."""
    return _BEGAN + round(now * (1.0 + _FAST) * _TICKS_PER_S / SECOND)


def _timecode(now: Nanoseconds) -> int:
    """Return hours, minutes, seconds and hundredths, a byte each."""
    seconds, rest = divmod(now, SECOND)
    minutes, second = divmod(seconds, 60)
    hours, minute = divmod(minutes, 60)
    return hours % 24 << 24 | minute << 16 | second << 8 | rest * _FRAMES_OF_TIMECODE // SECOND


def _models(bodies: Sequence[TrackedBody], exposure: Exposure) -> tuple[Model, ...]:
    """Return what the bodies and their markers are called, in the stream's axes."""
    found: list[Model] = []
    for body in bodies:
        names = tuple(f"Marker{number}" for number in range(1, len(body.markers) + 1))
        places = [exposure.outside(marker) for marker in body.markers]
        found.append(MarkerSetModel(body.name, names))
        found.append(
            RigidBodyModel(
                body.name,
                body.id,
                markers=tuple(
                    ModelMarker(place, name=name) for place, name in zip(places, names, strict=True)
                ),
            )
        )
    return tuple(found)
