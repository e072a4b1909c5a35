"""All failures that a robot can have: every kind of fault, at its worst, at every place."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from emulators.bench.faults.kind import FaultKind
from emulators.bench.faults.severe import SEVERE
from emulators.bench.faults.table import kinds
from firmware_bridge.robot import AnyRobot


@dataclass(frozen=True, slots=True)
class Failure:
    """One fault at one place."""

    kind: str
    place: str
    """An axis, a link, or the bridge; empty where it has no place."""
    keys: Mapping[str, Any]
    """Keys of the fault's table, beside its time."""
    lasts: bool
    """True if it has an end."""

    @property
    def title(self) -> str:
        """Return the kind and how bad, in one cell of a table."""
        how = ", ".join(f"{key} {value}" for key, value in self.keys.items() if key not in _PLACES)
        return f"{self.kind}: {how}" if how else self.kind


_PLACES = frozenset({"node", "link", "between"})


def failures_of(robot: AnyRobot) -> tuple[Failure, ...]:
    """Return every failure that this robot can have, in the order of the table of kinds."""
    found = []
    for kind in kinds().values():
        for how in kind.severe or SEVERE.get(kind.name, ({},)):
            for place, keys in _places(kind, robot):
                failure = Failure(kind.name, place, {**how, **keys}, kind.lasts)
                # A fault that this robot cannot have is no row: the fault's own check decides.
                fault = kind.fault.model_validate({"at_s": 0.0, **failure.keys})
                if not tuple(fault.problems(robot)):
                    found.append(failure)
    return tuple(found)


def _places(kind: FaultKind, robot: AnyRobot) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield where a kind may be tried: one node after the other, or one link, or as it is."""
    fields, nodes = kind.fault.model_fields, kind.fault.among.of(robot)
    if "between" in fields:
        yield from ((f"{one} / {other}", {"between": (one, other)}) for one, other in pairwise(nodes))
    elif "node" in fields:
        names = nodes or [axis.name for axis in robot.axes]
        yield from ((name, {"node": name, **_link(kind, robot, name)}) for name in names)
    elif "link" in fields and len(robot.links) > 1:
        yield from ((link, {"link": link}) for link in robot.links)
    else:
        yield "", {}


def _link(kind: FaultKind, robot: AnyRobot, node: str) -> Mapping[str, str]:
    """Return on which link a node is that is on several."""
    on_several = "link" in kind.fault.model_fields and not any(axis.name == node for axis in robot.axes)
    return {"link": next(iter(robot.links))} if on_several and len(robot.links) > 1 else {}
