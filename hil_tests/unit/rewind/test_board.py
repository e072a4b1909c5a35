"""A whole board is kept at any instant and put back, and goes on from there as it went."""

from collections.abc import Mapping

import pytest

from emulators.arduino_omni.board import FIRMWARES, Board
from emulators.arduino_omni.faults import FaultyBoard, planned
from emulators.arduino_omni.motors import four_motors
from emulators.rewind import Rewind
from firmware_bridge.node import DTR_DOWN, DTR_UP, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds
from hil_tests.unit.rewind.digest import digest

FAULTS = ("current-limit@3.1", "over-temperature@3.65", "encoder-1@3.7-3.85", "unpowered@4.25-4.26")
# Half a word, one that is under way on the bus, and one that waits in the ring: by firmware.
WORDS: Mapping[str, tuple[bytes, ...]] = {
    "ros-arduino-bridge": (b"m 20 -30 4", b"0\re\r", b"o 200 0 0\re\rb\r", b"r\re\r"),
    "mw": (
        bytes.fromhex("5A 08 00 81 02 00 00 60 40 06 CF 5A 06 00 82 02 02 00 00"),
        bytes.fromhex("74 5A 08 00 83 02 03 00 00 7F 01 F0"),
        bytes.fromhex("5A 07 00 86 03 01 00 02 03 6A 5A 06 00 87 03 04 00 00 6C"),
    ),
    "arduinoio": (b"E0cdA1", b"\xc8B1fG0", b"99X5G0"),
    "firmata": (
        bytes.fromhex("F0 78 00 00 F7 F0 76 60 00 00 00 21"),
        bytes.fromhex("01 F7 F0 76 60 00 26 00 00 00 00 00 00 00 08 00 F7"),
        bytes.fromhex("F0 76 60 08 00 00 01 00 F7 F0 79 F7"),
    ),
}


class Host:
    """Says the words, each 100 ms after the one before, and drops DTR and raises it in the middle."""

    def __init__(self, firmware: str) -> None:
        board = Board(FIRMWARES[firmware], four_motors())
        self.node = FaultyBoard(board, map(planned, FAULTS))
        self.now: Nanoseconds = 0
        self.wake_at: Nanoseconds = 0
        self.heard = bytearray()
        dtr = Packet(SERIAL, DTR_DOWN, b""), Packet(SERIAL, DTR_UP, b"")
        words = [Packet(SERIAL, 0, it) for it in WORDS[firmware]]
        said = [*words, *words, *dtr]
        self.said = [((3_600 + 100 * place) * MILLISECOND, it) for place, it in enumerate(said)][::-1]

    def run(self, until: Nanoseconds) -> bytes:
        while (at := min(self.wake_at, self.said[-1][0] if self.said else until + 1)) <= until:
            self.now = max(self.now, at)
            if self.said and self.said[-1][0] <= self.now:
                self.take(self.node.receive(self.said.pop()[1], self.now))
            else:
                self.take(self.node.wake(self.now))
        return bytes(self.heard)

    def take(self, reaction: Reaction) -> None:
        self.heard += b"".join(packet.payload for packet in reaction.sent)
        self.wake_at = reaction.wake_at


# In mid-byte, in mid-transfer between two faults, in the boot loader after them.
MOMENTS = [3_600_123_457, 3_803_050_001, 4_900_000_000]
END = 5_100 * MILLISECOND


@pytest.mark.parametrize("firmware", WORDS)
def test_it_goes_on_as_it_went(firmware: str) -> None:
    it = Host(firmware)
    rewind = Rewind(it)
    kept = []
    for moment in MOMENTS:
        it.run(moment)
        kept.append((rewind.snapshot(), digest(it)))
    heard, end = it.run(END), digest(it)
    assert len(heard) > 4
    for snapshot, before in reversed(kept):
        rewind.restore(snapshot)
        assert digest(it) == before
        assert (it.run(END), digest(it)) == (heard, end)
