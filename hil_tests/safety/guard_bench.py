"""A node that says what the test wrote down, behind a guard; and the frames that it says."""

import struct
from dataclasses import dataclass, field

from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Robot
from firmware_bridge.safety.guard import Guarded, Refusal
from firmware_bridge.safety.guard_rules import rules_for
from firmware_bridge.units import NEVER, Nanoseconds


@dataclass
class Puppet:
    """A node that says what the test wrote down."""

    says: tuple[Packet, ...] = ()
    wake_at: Nanoseconds = NEVER
    heard: list[tuple[Packet | None, Nanoseconds]] = field(default_factory=list)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.heard.append((packet, now))
        return self._said()

    def wake(self, now: Nanoseconds) -> Reaction:
        self.heard.append((None, now))
        return self._said()

    def _said(self) -> Reaction:
        said, self.says = self.says, ()
        return Reaction(said, self.wake_at)


class Stopping(Puppet):
    """A node that can be stopped."""

    breaks = False

    def stop(self, now: Nanoseconds) -> Reaction:
        if self.breaks:
            raise ValueError("no more")
        return self.wake(now)


class Bench:
    """A puppet behind a guard."""

    def __init__(self, robot: Robot, puppet: Puppet | None = None) -> None:
        self.puppet = puppet or Puppet()
        self.told: list[Refusal] = []
        self.guard = Guarded(self.puppet, rules_for(robot), self.told.append)

    def says(self, *packets: Packet, now: Nanoseconds = 0) -> tuple[Packet, ...]:
        self.puppet.says = packets
        return self.guard.wake(now).sent

    def refuses(self, packet: Packet, now: Nanoseconds = 0) -> tuple[str, tuple[Packet, ...]]:
        before = self.guard.refused
        sent = self.says(packet, now=now)
        assert self.guard.refused == before + 1
        refusal = self.guard.refusals[-1]
        assert (refusal.at, refusal.packet, refusal.sent) == (now, packet, sent)
        assert self.told[-1] is refusal
        return refusal.reason, sent


def frame(address: int, text: str) -> Packet:
    return Packet(CAN, address, bytes.fromhex(text))


def wheel(node: int, word: int, rpm: int) -> Packet:
    return Packet(CAN, 0x500 + node, struct.pack("<Hi", word, rpm))


def position(node: int, word: int, counts: int) -> Packet:
    return Packet(CAN, 0x400 + node, struct.pack("<Hi", word, counts))


def write(node: int, index: int, subindex: int, raw: bytes) -> Packet:
    """Expedited download with its size, CiA 301."""
    command = 0x23 | (4 - len(raw)) << 2
    return Packet(
        CAN, 0x600 + node, bytes((command,)) + struct.pack("<HB", index, subindex) + raw.ljust(4, b"\0")
    )


def aborted(node: int, index: int, subindex: int) -> tuple[Packet, ...]:
    return (Packet(CAN, 0x600 + node, b"\x80" + struct.pack("<HBI", index, subindex, 0x0800_0000)),)


def raw(value: int, size: int) -> bytes:
    return (value & ((1 << 8 * size) - 1)).to_bytes(size, "little")
