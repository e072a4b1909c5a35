"""What the watchers of one bus share: its nodes, its incidents, and the picture of its set-up."""

from dataclasses import dataclass, field
from typing import Final

from firmware_bridge.explain.followed import FollowedBus
from firmware_bridge.explain.incident import Evidence, Incident, IncidentKind, Incidents, Report
from firmware_bridge.explain.node_state import NodeState
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

NEAR: Final[Nanoseconds] = 300 * MILLISECOND
"""What happens within this time of each other belongs together."""


@dataclass(slots=True)
class BusState:
    """One bus."""

    reader: FollowedBus
    incidents: Incidents
    bit_rate: int
    nodes: dict[int, NodeState] = field(default_factory=dict)
    now: Nanoseconds = 0
    undecoded: set[int] = field(default_factory=set)
    """Nodes with PDOs whose mapping is not known."""
    first_at: Nanoseconds | None = None
    frames: int = 0
    remarks: list[str] = field(default_factory=list)
    """What looked like an incident, and is none."""
    consumers: dict[tuple[int, int], tuple[int, Nanoseconds]] = field(default_factory=dict)
    """Node and sub-index of 0x1016: whose heartbeat it waits for, and how long; node 0 for none."""
    controllers: set[int] = field(default_factory=set)
    """The nodes that were ever waited for."""

    def node(self, number: int) -> NodeState:
        """Return a node by its number."""
        found = self.nodes.get(number)
        if found is None:
            found = self.nodes[number] = NodeState.of(number)
        return found

    def evidence(self, at: Nanoseconds, address: int, payload: bytes) -> Evidence:
        """Return a frame with its text."""
        return self.reader.evidence(at, address, payload)

    def open(self, kind: IncidentKind, at: Nanoseconds, report: Report) -> Incident:
        """Add an incident."""
        return self.incidents.open(kind, at, report)

    def instant(self, at: Nanoseconds) -> str:
        """Return an instant for people: seconds since the first frame."""
        return f"{to_seconds(at - (self.first_at or 0)):.6f}"

    @property
    def watched(self) -> dict[int, Nanoseconds]:
        """The nodes whose heartbeat is waited for, and the shortest time."""
        found: dict[int, Nanoseconds] = {}
        for node, waits in self.consumers.values():
            if node:
                found[node] = min(waits, found.get(node, waits))
        return found

    def is_controller(self, node: int) -> bool:
        """Return whether drives wait, or have waited, for the heartbeat of a node."""
        return node in self.controllers
