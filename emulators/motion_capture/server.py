"""The server's half of the dialogue: who is served in which version, and what commands are answered.

Not known here: what is seen. Sources: OptiTrack's page on remote requests, and what a Motive 2.1 has
answered. Where they are silent:
* a client that is not received for 10 s is dropped; any packet of his keeps him.
* frames go to the address and port from which the client has connected, as OptiTrack's samples expect it.
* a client of a server from 4.0 on may choose a version from 2.9 on; an older server has one version.
* UnitsToMillimeters is 1000.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

from firmware_bridge.families.motion_capture.wire import messages, models
from firmware_bridge.families.motion_capture.wire.layout import V4_0, NatNetError, Version, known
from firmware_bridge.families.motion_capture.wire.messages import Bytes4, MessageId, ServerInfo, packet
from firmware_bridge.units import SECOND, Nanoseconds

PATIENCE: Final[Nanoseconds] = 10 * SECOND
NOT_DONE: Final = 1
"""The result of a command that was understood, and not done."""
APPLICATIONS: Final[Mapping[Version, Bytes4]] = {
    Version(2, 9): (1, 9, 0, 0),
    Version(2, 10): (1, 10, 0, 0),
    Version(3, 0): (2, 0, 0, 0),
    Version(3, 1): (2, 1, 0, 0),
    Version(4, 0): (3, 0, 0, 0),
    Version(4, 1): (3, 1, 0, 0),
    Version(4, 2): (3, 2, 0, 0),
    Version(4, 3): (3, 3, 0, 0),
    Version(4, 4): (3, 4, 0, 0),
}
"""Motive's version for each protocol version; Motive 3.4 with 4.4 is a guess, the others are OptiTrack's."""

RECORDS: Final[Mapping[str, bool]] = {"StartRecording": True, "StopRecording": False}


@dataclass(frozen=True, slots=True)
class _Requested:
    """A client's request, and its time by both clocks."""

    place: int
    payload: bytes
    now: Nanoseconds
    ticks: int


@dataclass(slots=True)
class _Client:
    version: Version
    received_at: Nanoseconds


class Server:
    """The clients of one capture system, by the numbers of their places."""

    def __init__(
        self,
        version: Version,
        found: tuple[models.Model, ...],
        *,
        rate_hz: int,
        ticks_per_s: int,
        data_port: int = messages.DATA_PORT,
    ) -> None:
        """Serve in this version; NatNetError for one that no one has described."""
        self.version: Final = known(version)
        self.recording = False
        self._models: Final = found
        self._known: Final[Mapping[str, bytes]] = {
            "FrameRate": messages.measure_payload(float(rate_hz)),
            "UnitsToMillimeters": messages.measure_payload(1000.0),
            "AnalogSamplesPerMocapFrame": messages.result_payload(0),
            "CurrentMode": messages.result_payload(0),
        }
        """Answers to named requests."""
        self._answers: Final[Mapping[MessageId, Callable[[_Requested], tuple[bytes, ...]]]] = {
            MessageId.CONNECT: self._connect,
            MessageId.DISCOVERY: self._on_setting,
            MessageId.REQUEST: self._command,
            MessageId.REQUEST_MODELDEF: self._defined,
            MessageId.ECHOREQUEST: self._echo,
            MessageId.DISCONNECT: self._leave,
        }
        """All other messages are taken, and answered by nothing."""
        self._ticks_per_s: Final = ticks_per_s
        self._data_port: Final = data_port
        self._clients: dict[int, _Client] = {}
        self.refused = 0
        """Packets that were none, or were not understood."""

    def clients(self, now: Nanoseconds) -> Mapping[int, Version]:
        """Return who is sent frames, and in which version."""
        for place in [it for it, client in self._clients.items() if now - client.received_at > PATIENCE]:
            del self._clients[place]
        return {place: client.version for place, client in self._clients.items()}

    def receive(self, place: int, datagram: bytes, now: Nanoseconds, ticks: int) -> tuple[bytes, ...]:
        """Take a packet of the command channel; return what is answered to its sender."""
        try:
            message, payload = messages.split(datagram)
            if place in self._clients:
                # Any packet of a client is a sign of life, not only a keep-alive.
                self._clients[place].received_at = now
            answer = self._answers.get(message)
            return () if answer is None else answer(_Requested(place, payload, now, ticks))
        except NatNetError:
            self.refused += 1
            return (packet(MessageId.UNRECOGNIZED_REQUEST),)

    def _connect(self, requested: _Requested) -> tuple[bytes, ...]:
        wants = messages.connected(requested.payload).wants
        version = self.version
        if wants is not None and any(wants):
            version = self._chosen(Version(*wants[:2]))
        # A client that connects once more gets the version of its last request.
        self._clients[requested.place] = _Client(version, requested.now)
        return self._on_setting(requested)

    def _on_setting(self, requested: _Requested) -> tuple[bytes, ...]:
        info = ServerInfo(
            "Motive",
            APPLICATIONS[self.version],
            (*self._spoken(requested.place), 0, 0),
            self._ticks_per_s,
            self._data_port,
        )
        return (packet(MessageId.SERVERINFO, messages.server_info_payload(info)),)

    def _defined(self, requested: _Requested) -> tuple[bytes, ...]:
        defined = models.encoded(self._models, self._spoken(requested.place))
        return (packet(MessageId.MODELDEF, defined),)

    def _echo(self, requested: _Requested) -> tuple[bytes, ...]:
        return (packet(MessageId.ECHORESPONSE, messages.echo_payload(requested.payload, requested.ticks)),)

    def _leave(self, requested: _Requested) -> tuple[bytes, ...]:
        self._clients.pop(requested.place, None)
        return ()

    def _command(self, requested: _Requested) -> tuple[bytes, ...]:
        name, *arguments = messages.text_of(requested.payload).split(",")
        if name == "Bitstream" and arguments:
            payload = messages.result_payload(self._choose(requested.place, arguments[0]))
        elif name == "Bitstream":
            payload = messages.text_payload(f"Bitstream,{self._spoken(requested.place)}.0")
        elif name in self._known:
            payload = self._known[name]
        elif name in RECORDS:
            self.recording = RECORDS[name]
            payload = messages.result_payload(messages.OK)
        else:
            raise NatNetError(f"command {name!r} is not emulated")
        return (packet(MessageId.RESPONSE, payload),)

    def _spoken(self, place: int) -> Version:
        """Return the version in which someone is spoken to."""
        client = self._clients.get(place)
        return self.version if client is None else client.version

    def _chosen(self, version: Version) -> Version:
        """Return the version for a client that requests this one."""
        # Only servers from 4.0 on can send an older stream, and none a newer one.
        return min(known(version), self.version) if self.version >= V4_0 else self.version

    def _choose(self, place: int, text: str) -> int:
        """Give a client another version; return whether that was done."""
        numbers = text.split(".")
        client = self._clients.get(place)
        if client is None or len(numbers) < len(Version._fields) or not all(map(str.isdecimal, numbers)):
            return NOT_DONE
        wanted = Version(int(numbers[0]), int(numbers[1]))
        client.version = self._chosen(wanted)
        return messages.OK if client.version == wanted else NOT_DONE
