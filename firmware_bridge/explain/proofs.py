"""A controller's proof that drives notice its silence: withheld on purpose before any of them has power.

It is no incident. A controller that crashed and came back within a second would look the same, and be as
harmless.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from firmware_bridge.explain import kinds
from firmware_bridge.explain.bus_state import BusState
from firmware_bridge.explain.incident import Incident
from firmware_bridge.units import SECOND, Nanoseconds, to_seconds

HEARTBEAT_LOST: Final = 0x8130
"""EMCY: life guard or heartbeat (CiA 301)."""
WITHIN: Final[Nanoseconds] = SECOND


@dataclass(slots=True)
class Proofs:
    """Those of one bus."""

    bus: BusState
    _seen: list[tuple[Nanoseconds, Incident, list[Incident]]] = field(default_factory=list)
    """A silence with its length, and the emergencies by which each drive that waits for it noticed it."""

    def heartbeat_back(self, controller: int, at: Nanoseconds, gap: Nanoseconds) -> None:
        """Take note that a controller's heartbeat is back, before its silence ends as an incident."""
        silence = self.bus.incidents.recent(kinds.SILENT_CONTROLLER, at - WITHIN, controller)
        if silence is None or gap > WITHIN:
            return
        waiting = [node for (node, _), (watched, _) in self.bus.consumers.items() if watched == controller]
        drives = [self.bus.node(node).drive for node in waiting]
        # A drive whose state was not seen may have power; one that had it before had work to lose.
        if not drives or any(one.state is None or one.enabled or one.enabled_once for one in drives):
            return
        noticed = [self._noticed(node, at - gap) for node in waiting]
        found = [one for one in noticed if one is not None]
        if len(found) < len(waiting):
            return
        found += self._others(at - gap, waiting)
        if self._without_power({one.node for one in found}):
            self._seen.append((gap, silence, found))

    def end(self) -> None:
        """Leave out the incidents of the proofs whose drives are all well again, and remark them."""
        for gap, silence, noticed in self._seen:
            if any(one.recovered_at is None for one in (silence, *noticed)):
                continue
            self.bus.incidents.take_back((silence, *noticed))
            nodes = ", ".join(str(one.node) for one in sorted(noticed, key=lambda one: one.node or 0))
            self.bus.remarks.append(
                f"{silence.where} sent no heartbeat for {to_seconds(gap):.2f} s, seen at "
                f"{self.bus.instant(silence.at)} s, before any drive had power: node {nodes} reported EMCY "
                "0x8130 and was well again, as in a proof that drives notice a silent controller"
            )

    def _without_power(self, noticed: set[int | None]) -> bool:
        """Return whether no node of the bus had power; one whose state was not seen must have noticed."""
        nodes = [one for one in self.bus.nodes.values() if one.seen and not self.bus.is_controller(one.node)]
        return not any(
            one.drive.enabled
            or one.drive.enabled_once
            or (one.drive.state is None and one.node not in noticed)
            for one in nodes
        )

    def _others(self, since: Nanoseconds, waiting: Sequence[int]) -> Iterator[Incident]:
        """Yield those of drives without power whose set-up was not seen: a gateway's is on its serial line.

        One that nothing else is seen of may be such a gateway.
        """
        for one in self.bus.incidents.found:
            if one.kind is kinds.EMERGENCY and one.at >= since and one.detail == HEARTBEAT_LOST:
                node = self.bus.node(one.node or 0)
                unseen = node.drive.state is None and node.addressed
                if not (one.node in waiting or node.drive.enabled or node.drive.enabled_once or unseen):
                    yield one

    def _noticed(self, node: int, since: Nanoseconds) -> Incident | None:
        for one in reversed(self.bus.incidents.found):
            if one.kind is kinds.EMERGENCY and one.node == node and one.at >= since:
                return one if one.detail == HEARTBEAT_LOST else None
        return None
