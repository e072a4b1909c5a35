"""Incidents on a bench's buses while it runs, as `explain` finds them in a recording."""

from typing import Any, Final

from emulators.rig import Rig
from emulators.wires.ends import Observer
from firmware_bridge.dissector.expected import can_links, expected_on
from firmware_bridge.explain.explainer import BusExplainer, Setup
from firmware_bridge.live.bus import incidents
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds, to_seconds


class LiveIncidents:
    """The incidents so far, the oldest first."""

    def __init__(self, rig: Rig) -> None:
        """Take the bench."""
        self._rig: Final = rig
        self._before: list[dict[str, Any]] = []
        """Those of the time before the last rewind."""
        self._buses: list[BusExplainer] = []
        self._count = 0
        self.follow()

    def follow(self) -> None:
        """Begin again at this instant, where time was put back: what came behind it is forgotten."""
        now = to_seconds(self._rig.world.now)
        self._before = [one for one in self.found if one["at_s"] <= now]
        self._buses, self._count = [], -1
        for link, wire in self._rig.can_wires.items():
            expected = tuple(expected_on(self._rig.robot, link)) if link in can_links(self._rig.robot) else ()
            bus = BusExplainer(Setup(expected=expected), link)
            self._buses.append(bus)
            wire.observe(_noted(bus))

    @property
    def found(self) -> list[dict[str, Any]]:
        """All of them, as the page shows them."""
        return [*self._before, *incidents(one for bus in self._buses for one in bus.found)]

    def news(self) -> list[dict[str, Any]] | None:
        """Return all of them where there are more, or fewer, than at the last call; else None."""
        count = len(self._before) + sum(len(bus.found) for bus in self._buses)
        if count == self._count:
            return None
        self._count = count
        return self.found


def _noted(bus: BusExplainer) -> Observer:
    def note(now: Nanoseconds, _sender: str, packet: Packet) -> None:
        bus.take(now, packet.address, packet.payload)

    return note
