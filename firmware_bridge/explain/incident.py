"""An incident on a bus, and the list of those that a recording shows.

Texts and causes of each kind are in `firmware_bridge.explain.kinds`.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field

from firmware_bridge.units import NEVER, Nanoseconds


@dataclass(frozen=True, slots=True)
class Evidence:
    """A frame that shows something: its instant, its bytes as candump writes them, its decoded text."""

    at: Nanoseconds
    frame: str
    text: str


@dataclass(frozen=True, slots=True)
class IncidentKind:
    """One kind of incident: its row in the table."""

    name: str
    title: str
    causes: tuple[str, ...]
    """The most likely one first, where the frames do not decide."""
    consequence: str
    check: str
    """The first thing to look at."""


@dataclass(slots=True, kw_only=True)
class Incident:
    """One incident."""

    kind: IncidentKind
    at: Nanoseconds
    node: int | None
    """None: the bus itself."""
    where: str
    """The node or the bus, for people."""
    what: str
    evidence: Evidence | None
    causes: tuple[str, ...]
    consequence: str
    check: str
    count: int = 1
    """Number of times that it was seen before it ended."""
    last_at: Nanoseconds = 0
    recovery: str = ""
    recovered_at: Nanoseconds | None = None
    detail: Hashable = None
    """What distinguishes it from another one of its kind at its node: an error's code."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """What a watcher has seen: an incident without the texts of its kind.

    Empty texts and causes are replaced by those of the kind.
    """

    what: str
    evidence: Evidence | None = None
    node: int | None = None
    detail: Hashable = 0
    """Distinguishes incidents of one kind and node: an error code, an object."""
    causes: tuple[str, ...] = ()
    consequence: str = ""
    check: str = ""


@dataclass(slots=True)
class Incidents:
    """The incidents of one bus, and which of them are still open."""

    called: dict[int, str] = field(default_factory=dict)
    """Titles of the nodes."""
    bus: str = "the bus"
    noun: str = "node"
    """What has a number here: a node, or the motor of a board."""
    found: list[Incident] = field(default_factory=list)
    _open: dict[tuple[str, int | None, Hashable], Incident] = field(default_factory=dict)

    def where(self, node: int | None) -> str:
        """Return a node, or the bus, for people."""
        if node is None:
            return self.bus
        title = self.called.get(node, "")
        return f"{self.noun} {node} ({title})" if title else f"{self.noun} {node}"

    def open(self, kind: IncidentKind, at: Nanoseconds, report: Report) -> Incident:
        """Add an incident; one of the same kind, node and detail that is open is counted once more."""
        key = (kind.name, report.node, report.detail)
        known = self._open.get(key)
        if known is not None:
            known.count += 1
            known.last_at = at
            return known
        made = self._open[key] = Incident(
            kind=kind,
            at=at,
            node=report.node,
            where=self.where(report.node),
            what=report.what,
            evidence=report.evidence,
            causes=report.causes or kind.causes,
            consequence=report.consequence or kind.consequence,
            check=report.check or kind.check,
            last_at=at,
            detail=report.detail,
        )
        self.found.append(made)
        return made

    def is_open(self, kind: IncidentKind, node: int | None = None) -> bool:
        """Return whether an incident of this kind has not ended."""
        return any(name == kind.name and of == node for name, of, _ in self._open)

    def close(self, kinds: Sequence[IncidentKind], at: Nanoseconds, node: int | None, recovery: str) -> None:
        """End the open incidents of these kinds at a node."""
        names = {kind.name for kind in kinds}
        for key in [key for key in self._open if key[0] in names and key[1] == node]:
            ended = self._open.pop(key)
            if recovery:
                ended.recovery, ended.recovered_at = recovery, at

    def withdraw(self, kind: IncidentKind, since: Nanoseconds) -> None:
        """Take back the open incidents of a kind that began after an instant: another one has more."""
        for key in [key for key, one in self._open.items() if key[0] == kind.name and one.at >= since]:
            self.found.remove(self._open.pop(key))

    def take_back(self, those: Sequence[Incident]) -> None:
        """Leave out what was no incident after all."""
        self.found[:] = [one for one in self.found if all(one is not other for other in those)]

    def quiet_since(self, kind: IncidentKind, before: Nanoseconds, recovery: str) -> None:
        """End the open incidents of a kind that were not seen since `before`."""
        for key in [key for key, one in self._open.items() if key[0] == kind.name and one.last_at < before]:
            ended = self._open.pop(key)
            ended.recovery, ended.recovered_at = recovery, ended.last_at

    def recent(self, kind: IncidentKind, since: Nanoseconds, node: int | None = None) -> Incident | None:
        """Return the last incident of a kind that began, or went on, after an instant."""
        for one in reversed(self.found):
            if one.kind is kind and one.node == node and (one.recovered_at or NEVER) >= since:
                return one
        return None

    def any_of(self, node: int) -> bool:
        """Return whether there was an incident at a node."""
        return any(one.node == node for one in self.found)
