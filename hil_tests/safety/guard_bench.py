"""A node that sends the test's frames, behind a guard; and those frames."""

import struct
from dataclasses import dataclass, field
from typing import Final

from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard import Refusal, guarded
from firmware_bridge.units import NEVER, Nanoseconds

LINK: Final = "drives"
"""The name of RARS's link."""


@dataclass
class ScriptedNode:
    """A node that sends the test's frames."""

    states: tuple[Packet, ...] = ()
    wake_at: Nanoseconds = NEVER
    received: list[tuple[Packet | None, Nanoseconds]] = field(default_factory=list)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.received.append((packet, now))
        return self._stated()

    def wake(self, now: Nanoseconds) -> Reaction:
        self.received.append((None, now))
        return self._stated()

    def _stated(self) -> Reaction:
        stated, self.states = self.states, ()
        return Reaction(stated, self.wake_at)


class Stopping(ScriptedNode):
    """A node that can be stopped."""

    breaks = False
    requested = 0

    def stop(self, now: Nanoseconds) -> Reaction:
        self.requested += 1
        if self.breaks:
            raise ValueError("no more")
        return self.wake(now)


class Bench:
    """A scripted node behind a guard."""

    def __init__(self, robot: AnyRobot, scripted: ScriptedNode | None = None) -> None:
        self.scripted = scripted or ScriptedNode()
        self.refusals: list[Refusal] = []
        self.guard = guarded(self.scripted, robot, self.refusals.append)

    def states(self, *packets: Packet, now: Nanoseconds = 0) -> tuple[Packet, ...]:
        self.scripted.states = packets
        return self.guard.wake(now).sent

    def receives(self, *packets: Packet, now: Nanoseconds = 0) -> tuple[Packet, ...]:
        """Bring packets to the guard; return what leaves meanwhile."""
        return tuple(sent for packet in packets for sent in self.guard.receive(packet, now).sent)

    def refuses(self, packet: Packet, now: Nanoseconds = 0) -> tuple[str, tuple[Packet, ...]]:
        before = self.guard.refused
        sent = self.states(packet, now=now)
        assert self.guard.refused == before + 1
        refusal = self.guard.refusals[-1]
        assert (refusal.at, refusal.packet, refusal.sent) == (now, packet, sent)
        assert self.refusals[-1] is refusal
        return refusal.reason, sent


def frame(address: int, text: str) -> Packet:
    return Packet(LINK, address, bytes.fromhex(text))


def wheel(node: int, word: int, rpm: int) -> Packet:
    return Packet(LINK, 0x500 + node, struct.pack("<Hi", word, rpm))


def position(node: int, word: int, counts: int) -> Packet:
    return Packet(LINK, 0x400 + node, struct.pack("<Hi", word, counts))


def write(node: int, index: int, subindex: int, raw: bytes) -> Packet:
    """Expedited download with its size, CiA 301."""
    command = 0x23 | (4 - len(raw)) << 2
    return Packet(
        LINK, 0x600 + node, bytes((command,)) + struct.pack("<HB", index, subindex) + raw.ljust(4, b"\0")
    )


def aborted(node: int, index: int, subindex: int) -> tuple[Packet, ...]:
    return (Packet(LINK, 0x600 + node, b"\x80" + struct.pack("<HBI", index, subindex, 0x0800_0000)),)


def raw(value: int, size: int) -> bytes:
    return (value & ((1 << 8 * size) - 1)).to_bytes(size, "little")


def status(node: int, statusword: int) -> Packet:
    """Return the first transmit PDO, which reports the statusword when it changes."""
    return Packet(LINK, 0x180 + node, struct.pack("<H", statusword))


def sample(node: int, statusword: int, position_qc: int = 4711) -> Packet:
    """The second transmit PDO: statusword, position, current."""
    return Packet(LINK, 0x280 + node, struct.pack("<Hih", statusword, position_qc, 12))


def status_read(node: int, statusword: int) -> Packet:
    """The answer to a read of 0x6041, CiA 301."""
    return Packet(LINK, 0x580 + node, b"\x4b\x41\x60\x00" + struct.pack("<HH", statusword, 0))
