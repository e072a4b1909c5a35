"""MAVLink messages, decoded: name, sequence number, and every field with its enumeration's name."""

from typing import TYPE_CHECKING, Final

from firmware_bridge.packet import Packet

if TYPE_CHECKING:
    from firmware_bridge.mavlink.frames import Message

_NO_ONE: Final = 0
"""The reader sends nothing, so its own number does not matter."""


class Mavlink:
    """A reader of one link's datagrams."""

    def __init__(self) -> None:
        # MAVLink's dialects take a while to load, and most programs read none of it.
        from firmware_bridge.mavlink.frames import Codec  # noqa: PLC0415

        self._codec = Codec(_NO_ONE, _NO_ONE)

    def read(self, _sender: str, packet: Packet) -> str:
        """Return what the messages of a datagram say."""
        messages = self._codec.decode(packet.payload)
        return "; ".join(map(_text_of, messages)) or "no message that MAVLink's dialects know"


def _text_of(message: "Message") -> str:
    head = message.get_header()
    name = message.get_type()
    origin = f"{name} #{head.seq} of {head.srcSystem}/{head.srcComponent}"
    fields = [f"{field}={_value(message, field)}" for field in message.get_fieldnames()]
    return f"{origin}: {' '.join(fields)}"


def _value(message: "Message", field: str) -> str:
    from firmware_bridge.mavlink.frames import dialect, text_of  # noqa: PLC0415 - as above

    value = getattr(message, field)
    if isinstance(value, bytes | str):
        return f"'{text_of(value)}'"
    enumeration = dialect.enums.get(message.fieldenums_by_name.get(field, ""), {})
    named = enumeration.get(value) if isinstance(value, int) else None
    return f"{value}" if named is None else f"{value} ({named.name})"
