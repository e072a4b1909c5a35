"""Missions that the live page starts on a bench that runs."""

from typing import Final

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.faults import Fault
from emulators.bench.mission import Mission
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds, to_seconds


class PageMissions:
    """The shipped missions that this bench can drive: an operator's, on its floor, by its agreed delay.

    The link stays as it is.
    """

    def __init__(self, rig: Rig, mission: Mission) -> None:
        """Take the bench, and its mission."""
        self._rig: Final = rig
        self._setup: Final = bench_setup_of(rig.robot)
        self._known: Final = {
            name: one
            for name in self._setup.shipped()
            for one in (missions.find(name, rig.robot, self._setup),)
            if one.pilot is None
            and one.survey is None
            and (one.plant, one.max_delay_s) == (mission.plant, mission.max_delay_s)
        }

    @property
    def names(self) -> tuple[str, ...]:
        """Their names, in alphabetical order."""
        return tuple(self._known)

    def start(self, name: str) -> Nanoseconds:
        """Begin a mission at the world's next whole second, and return its end; KeyError, FaultError."""
        mission, now = self._known[name], self._rig.world.now
        # A script's messages and the bridge's cycles keep their places within a second.
        begins = -(-now // SECOND) * SECOND
        self._rig.faults.plan([_later(one, to_seconds(begins)) for one in mission.fault])
        tremor = np.random.default_rng(begins)
        self._rig.hand_over_to(ScriptedOperator(self._rig.robot, self._setup, mission, tremor, begins=begins))
        return begins + from_seconds(mission.duration_s)


def _later(fault: Fault, seconds: float) -> Fault:
    """Return a fault at a later time."""
    until: float | None = getattr(fault, "until_s", None)
    moved = {} if until is None else {"until_s": until + seconds}
    return fault.model_copy(update={"at_s": fault.at_s + seconds, **moved})
