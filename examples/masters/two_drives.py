"""Turn two drives at one speed, and stop both when one of them falls silent.

Usage: python two_drives.py INTERFACE CHANNEL [SECONDS]

Nothing but python-can is needed. The drives are nodes 1 and 2; each sends a heartbeat ten times a second.
Exit status 0: they have turned for so long; 1: one fell silent; 2: one does not answer, or refuses.
"""

import sys
import time
from collections.abc import Iterable
from typing import NoReturn

import can

NODES = (1, 2)
HEARTBEAT_MS = 100
SILENT_S = 3.0
ANSWERS_S = 5.0
RPM = 500
VELOCITY_MODE = 3
SHUTDOWN, SWITCH_ON, ENABLE = 0x06, 0x07, 0x0F


class Drives:
    """Two drives on one bus, and the time of each one's last heartbeat."""

    def __init__(self, interface: str, channel: str) -> None:
        # Datagrams would otherwise leave this machine.
        more: dict[str, int] = {"hop_limit": 0} if interface == "udp_multicast" else {}
        self.bus = can.Bus(interface=interface, channel=channel, **more)
        self.received: dict[int, float] = {}

    def receives(self, until: float) -> can.Message | None:
        """Take one frame in, and return it; None where none comes in time."""
        message = self.bus.recv(max(0.0, until - time.monotonic()))
        if message is not None and 0x700 < message.arbitration_id < 0x780:
            self.received[message.arbitration_id - 0x700] = time.monotonic()
        return message

    def writes(self, node: int, index: int, value: int, size: int) -> None:
        """Write an object by SDO; the program ends where the drive refuses it."""
        request = bytes([0x23 | (4 - size) << 2, index & 0xFF, index >> 8, 0]) + value.to_bytes(4, "little")
        self.sends(0x600 + node, request)
        until = time.monotonic() + ANSWERS_S
        while time.monotonic() < until:
            message = self.receives(until)
            if message is None or message.arbitration_id != 0x580 + node:
                continue
            if message.data[1:4] == request[1:4]:
                if message.data[0] == 0x80:
                    ends(2, f"node {node} refuses 0x{index:04X}")
                return
        ends(2, f"node {node} does not answer")

    def sends(self, address: int, data: bytes) -> None:
        """Put a frame on the bus."""
        self.bus.send(can.Message(arbitration_id=address, data=data, is_extended_id=False))

    def turns(self, seconds: float) -> list[int]:
        """Let them turn for so long; return who has fallen silent."""
        until = time.monotonic() + seconds
        self.received = dict.fromkeys(NODES, time.monotonic())
        while time.monotonic() < until:
            self.receives(time.monotonic() + 0.1)
            silent = [node for node in NODES if time.monotonic() - self.received[node] > SILENT_S]
            if silent:
                return silent
        return []

    def stops(self, nodes: Iterable[int]) -> None:
        """Stop these, without power afterwards."""
        for node in nodes:
            self.writes(node, 0x60FF, 0, 4)
            self.writes(node, 0x6040, SHUTDOWN, 2)


def ends(status: int, what: str) -> NoReturn:
    """Print the reason, and end the program."""
    print(what, flush=True)
    sys.exit(status)


def main(interface: str, channel: str, seconds: float = 10.0) -> None:
    """Set both up, turn them, and stop those that answer."""
    drives = Drives(interface, channel)
    for node in NODES:
        drives.writes(node, 0x1017, HEARTBEAT_MS, 2)
        drives.writes(node, 0x6060, VELOCITY_MODE, 1)
        drives.writes(node, 0x60FF, RPM, 4)
        for word in (SHUTDOWN, SWITCH_ON, ENABLE):
            drives.writes(node, 0x6040, word, 2)
    print("both turn", flush=True)
    silent = drives.turns(seconds)
    drives.stops([node for node in NODES if node not in silent])
    if silent:
        ends(1, f"silent: node {silent[0]}; the other one stands")
    ends(0, "both stand")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], *(float(word) for word in sys.argv[3:4]))
