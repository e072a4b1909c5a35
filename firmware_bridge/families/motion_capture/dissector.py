"""Cameras' NatNet stream, decoded; frames are read by the version that the server has reported."""

from collections.abc import Iterator

from firmware_bridge.families.motion_capture.wire import frame, messages
from firmware_bridge.families.motion_capture.wire.frame import BodyFlag
from firmware_bridge.families.motion_capture.wire.layout import NatNetError, Version
from firmware_bridge.families.motion_capture.wire.messages import MessageId
from firmware_bridge.packet import Packet


class NatNet:
    """A reader of one link's datagrams."""

    def __init__(self) -> None:
        self._version: Version | None = None

    def read(self, _sender: str, packet: Packet) -> str:
        """Return the decoded text of a datagram."""
        try:
            message, payload = messages.split(packet.payload)
            return ": ".join((message.name.lower().replace("_", " "), *self._texts(message, payload)))
        except NatNetError as error:
            return f"no packet of NatNet's: {error}"

    def _texts(self, message: MessageId, payload: bytes) -> Iterator[str]:
        if message is MessageId.SERVERINFO:
            server = messages.server_info(payload)
            self._version = server.version
            yield f"{server.name}, NatNet {'.'.join(map(str, server.natnet))}"
        elif message is MessageId.FRAMEOFDATA and self._version is not None:
            seen = frame.decoded(payload, self._version)
            yield f"number {seen.number}"
            yield ", ".join(map(_body, seen.bodies)) or "no body"


def _body(body: frame.RigidBody) -> str:
    """Return where a body is, in m, or that it is not seen."""
    if not body.params & BodyFlag.TRACKED:
        return f"body {body.id} not seen"
    x, y, z = body.position
    return f"body {body.id} at {x:.4f} {y:.4f} {z:.4f} m"
