"""Frames of a bench's buses in words, as many as a page can show."""

from collections import deque
from typing import Any, Final

from emulators.rig import Rig
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.dissector.expected import can_links, expected_on
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds, to_seconds
from firmware_bridge.wire.can import identifier

BIT_RATE: Final = 1_000_000
"""Only for the load, which is not shown from here."""
MOST: Final = 100
"""So many frames at a time; of more the newest."""


class TracedFrames:
    """The newest frames, from the moment on at which a page wants them."""

    def __init__(self, rig: Rig) -> None:
        """Take the bench; its set-up is followed from the start, so that each PDO's mapping is known."""
        self._new: Final[deque[tuple[Nanoseconds, str, Packet, str]]] = deque(maxlen=MOST)
        self._on = False
        self._wanted = ""
        self._rig: Final = rig
        self.follow()

    def follow(self) -> None:
        """Receive the frames of the buses from now on."""
        rig = self._rig
        for link, wire in rig.can_wires.items():
            expected = tuple(expected_on(rig.robot, link)) if link in can_links(rig.robot) else ()
            picture = BusPicture(BIT_RATE, expected)
            wire.observe(self._noted(link, picture))

    def watch(self, *, on: bool, wanted: str) -> None:
        """Show frames whose text holds `wanted`, or none."""
        self._on, self._wanted = on, wanted.lower()
        self._new.clear()

    def forget(self) -> None:
        """Leave out what was not shown yet."""
        self._new.clear()

    def take(self) -> list[list[Any]]:
        """Return what is new: instant in s, bus, identifier, text."""
        taken = [
            [to_seconds(at), bus, f"{identifier(packet.address):03X}", text]
            for at, bus, packet, text in self._new
        ]
        self._new.clear()
        return taken

    def _noted(self, bus: str, picture: BusPicture) -> Any:
        last: Nanoseconds = 0

        def note(now: Nanoseconds, _sender: str, packet: Packet) -> None:
            nonlocal last
            if not self._on:
                return
            last = max(last, now)
            picture.note(last, packet)
            text = picture.text_of(packet)
            if self._wanted in text.lower() or self._wanted in f"{identifier(packet.address):03x}":
                self._new.append((now, bus, packet, text))

        return note
