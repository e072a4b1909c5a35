"""After an emergency stop all axes lose their power, for any report of one of them."""

import struct
from collections.abc import Callable
from contextlib import ExitStack
from typing import Final

import pytest

from firmware_bridge.packet import Packet
from hil_tests.safety.driving import ORDERS, SAMPLE, changed, driving, runs, with_payload

NODE: Final = 1
ENABLED, DISABLED = 0x8237, 0x0240


def duplicate(statusword: int, *, first: bool) -> Callable[[Packet], tuple[Packet, ...]]:
    """Return what puts the samples of a second drive with the same number, which stands, beside these."""

    def change(packet: Packet) -> tuple[Packet, ...]:
        if packet.address != SAMPLE + NODE:
            return (packet,)
        other = with_payload(packet, struct.pack("<Hih", statusword, 0, 0))
        return (other, packet) if first else (packet, other)

    return change


def broken() -> Callable[[Packet], tuple[Packet, ...]]:
    """Return what makes each so-manieth sample one whose position is anywhere."""
    count = 0

    def change(packet: Packet) -> tuple[Packet, ...]:
        nonlocal count
        if packet.address != SAMPLE + NODE:
            return (packet,)
        count += 1
        return (with_payload(packet, packet.payload[:2] + struct.pack("<ih", 9_000 * (count % 3), 0)),)

    return change


LIARS: Final = {
    "a duplicate that is off": lambda: duplicate(DISABLED, first=False),
    "a duplicate that is off, received first": lambda: duplicate(DISABLED, first=True),
    "a duplicate that is enabled": lambda: duplicate(ENABLED, first=False),
    "positions from anywhere": broken,
}


@pytest.mark.parametrize("liar", LIARS)
@pytest.mark.parametrize("order", ["emergency stop", "forced disarm"])
def test_the_others_are_without_power_soon(liar: str, order: str) -> None:
    with driving("rars") as rig, ExitStack() as stack:
        stack.enter_context(changed(rig, "left", LIARS[liar]()))
        rig.runs(0.5)
        ORDERS[order](rig)
        assert runs(rig, 6.0) < 0.5
        assert not any(axis.powered for axis in rig.bench.devices.axes)
