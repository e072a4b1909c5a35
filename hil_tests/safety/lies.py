"""False reports of a drive, of a second node with its number, or of a serial line's gateway: a row each."""

import struct
from collections.abc import Callable, Mapping
from itertools import count
from typing import Final, TypeAlias

from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from hil_tests.safety.driving import SAMPLE, with_payload

Change: TypeAlias = Callable[[Packet], tuple[Packet, ...]]

OFF, FAULT, QUICK_STOP, ENABLED = 0x0240, 0x0208, 0x8207, 0x8237
"""Statuswords: what a drive may say that it is."""
NODE: Final = 1
STATUS: Final = 0x180
"""COB-ID of the statusword alone, TPDO 1, beside its node."""


def states(word: int, *, every: int = 1) -> Change:
    """Put this statusword into each so-many-th sample."""
    number = count(1)

    def change(packet: Packet) -> tuple[Packet, ...]:
        if packet.address == STATUS + NODE and every == 1:
            return ()
        if packet.address != SAMPLE + NODE or next(number) % every:
            return (packet,)
        return (with_payload(packet, struct.pack("<H", word) + packet.payload[2:]),)

    return change


def beside(word: int, *, first: bool = False) -> Change:
    """Send beside each sample another one, of a drive that stands at 0."""
    sample = struct.pack("<Hih", word, 0, 0)

    def change(packet: Packet) -> tuple[Packet, ...]:
        if packet.address != SAMPLE + NODE:
            return (packet,)
        other = with_payload(packet, sample)
        return (other, packet) if first else (packet, other)

    return change


def stale() -> Change:
    """Put the position of the sample before into each second one: a speed of 0, and twice the true one."""
    before: list[bytes] = []
    number = count(1)

    def change(packet: Packet) -> tuple[Packet, ...]:
        if packet.address != SAMPLE + NODE:
            return (packet,)
        place = packet.payload[2:6]
        if next(number) % 2 and before:
            packet = with_payload(packet, packet.payload[:2] + before[0] + packet.payload[6:])
        before[:] = [place]
        return (packet,)

    return change


def on_the_line(change: Change) -> Change:
    """Leave the gateway's frames on the bus behind it as they are."""
    return lambda packet: change(packet) if packet.link != CAN and packet.payload else (packet,)


def each(every: int, make: Callable[[bytes], tuple[bytes, ...]]) -> Change:
    """Put something else in the place of each so-many-th answer on a line."""
    number = count(1)

    def change(packet: Packet) -> tuple[Packet, ...]:
        if next(number) % every:
            return (packet,)
        return tuple(with_payload(packet, payload) for payload in make(packet.payload))

    return change


def behind(*, of_its_length: bool) -> Change:
    """Answer with the answer before; with `of_its_length` that of another node."""
    kept: dict[int, bytes] = {}

    def change(packet: Packet) -> tuple[Packet, ...]:
        key = len(packet.payload) if of_its_length else 0
        before, kept[key] = kept.get(key), packet.payload
        return () if before is None else (with_payload(packet, before),)

    return change


def still() -> Change:
    """Answer with the first answer of that length for ever."""
    kept: dict[int, bytes] = {}
    return lambda packet: (with_payload(packet, kept.setdefault(len(packet.payload), packet.payload)),)


def damaged(payload: bytes) -> tuple[bytes, ...]:
    return (payload[:-1] + bytes((payload[-1] ^ 0x5A,)),)


IGNORES: Final = "set_points_ignored"
OF_A_DRIVE: Final[Mapping[str, tuple[str, Callable[[], Change]]]] = {
    "reports off, and drives on": (IGNORES, lambda: states(OFF)),
    "reports off every 2nd time, and drives on": (IGNORES, lambda: states(OFF, every=2)),
    "reports off every 3rd time, and drives on": (IGNORES, lambda: states(OFF, every=3)),
    "reports quick stop, and drives on": (IGNORES, lambda: states(QUICK_STOP)),
    "reports fault, and drives on": (IGNORES, lambda: states(FAULT)),
    "reports off every 2nd time, and obeys": ("", lambda: states(OFF, every=2)),
    "reports quick stop, and obeys": ("", lambda: states(QUICK_STOP)),
    "a duplicate stands, enabled": ("", lambda: beside(ENABLED)),
    "a duplicate stands, enabled; ignores": (IGNORES, lambda: beside(ENABLED)),
    "a duplicate is off": ("", lambda: beside(OFF)),
    "a duplicate is off, and speaks first": ("", lambda: beside(OFF, first=True)),
    "each 2nd position is stale; ignores": (IGNORES, stale),
}
"""Lies of a drive: a fault, or none, and the report beside it."""
OF_A_GATEWAY: Final[Mapping[str, Callable[[], Change]]] = {
    "each 2nd check sum is wrong": lambda: each(2, damaged),
    "each 3rd check sum is wrong": lambda: each(3, damaged),
    "each 2nd answer is lost": lambda: each(2, lambda _: ()),
    "each answer comes twice": lambda: each(1, lambda it: (it, it)),
    "it is one answer behind": lambda: behind(of_its_length=False),
    "it mixes up its nodes": lambda: behind(of_its_length=True),
    "its answers stand": still,
    "rubbish comes between": lambda: each(1, lambda it: (b"\x90\x02\xff" * 3 + it,)),
    "frames begin without end": lambda: each(1, lambda it: (b"\x90\x02" * 40 + it,)),
}
