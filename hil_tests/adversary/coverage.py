"""Coverage of a search: in which joint states of the bridge each kind of fault was on."""

from dataclasses import dataclass, field
from itertools import product
from typing import Final, TypeAlias

from emulators.rig import Rig
from firmware_bridge.bridge.joint_state import Life, Motion, forbidden
from firmware_bridge.units import Nanoseconds

Met: TypeAlias = tuple[Life, Motion, str]
JOINT_STATES: Final = tuple(pair for pair in product(Life, Motion) if forbidden(*pair) is None)
"""Those that may exist."""


@dataclass(frozen=True, slots=True)
class Coverage:
    """What was met so far; a run that is taken back has met it all the same."""

    met: set[Met] = field(default_factory=set)

    def look(self, rig: Rig, since: Nanoseconds) -> None:
        """Note the joint state of the bridge with each fault that is on, or was after `since`."""
        bridge = rig.bridge
        for record in rig.faults.records:
            if record.ended is None or record.ended > since:
                self.met.add((bridge.phase, bridge.motion, record.kind))

    def share(self, drawn: frozenset[str]) -> str:
        """Return the figure of a search that draws these kinds."""
        return f"{len(self.met)} of {len(JOINT_STATES) * len(drawn)} joint states x fault kinds"

    @property
    def never(self) -> tuple[str, ...]:
        """The joint states in which no fault was on."""
        states = {(life, motion) for life, motion, _ in self.met}
        return tuple(f"{one[0].value}: {one[1].value}" for one in JOINT_STATES if one not in states)
