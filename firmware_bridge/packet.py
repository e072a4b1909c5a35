"""Data of the seam: a packet on a link, and a node's reaction to it.

Both are written out, and no dataclasses: a mission makes eighty thousand of them a minute, and a frozen
dataclass takes three times as long to make, fifteen times where this module is compiled.
"""

from typing import Final

from firmware_bridge.units import NEVER, Nanoseconds


class Packet:
    """One CAN frame, one chunk of serial bytes, or one datagram. Packets with the same content are equal.

    `address` is the CAN identifier with the flags of `firmware_bridge.wire.can`; of a datagram the place that
    it comes from or goes to, as `firmware_bridge.wire.internet` numbers it; 0 on links with one other end. On
    a serial link an empty packet with the address `LINE_LOST` or `LINE_BACK` reports the line's state. A
    remote frame carries as many zero bytes as its length code gives.
    """

    __slots__ = ("address", "link", "payload")

    def __init__(self, link: str, address: int, payload: bytes) -> None:
        self.link: Final = link
        self.address: Final = address
        self.payload: Final = payload

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Packet):
            return NotImplemented
        return self.address == other.address and self.payload == other.payload and self.link == other.link

    def __hash__(self) -> int:
        return hash((self.link, self.address, self.payload))

    def __repr__(self) -> str:
        return f"Packet(link={self.link!r}, address={self.address!r}, payload={self.payload!r})"


class Reaction:
    """The packets that leave now, in this order, and the node's next wake-up.

    `wake_at` replaces every earlier wake-up of the node; `NEVER` stands for none. Equal where both are.
    """

    __slots__ = ("sent", "wake_at")

    def __init__(self, sent: tuple[Packet, ...] = (), wake_at: Nanoseconds = NEVER) -> None:
        self.sent: Final = sent
        self.wake_at: Final = wake_at

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Reaction):
            return NotImplemented
        return self.wake_at == other.wake_at and self.sent == other.sent

    def __hash__(self) -> int:
        return hash((self.sent, self.wake_at))

    def __repr__(self) -> str:
        return f"Reaction(sent={self.sent!r}, wake_at={self.wake_at!r})"
