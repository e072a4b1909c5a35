"""Armed robots that a session of tests has ready: each test begins with one as it was at that instant."""

from collections import OrderedDict
from collections.abc import Callable
from typing import Final

from emulators.testing.rig import VirtualRig
from firmware_bridge.robot_types import find

MOST: Final = 16
"""Limit of those kept at once; the least recently used one goes."""


class Kept:
    """Robots by their names and seeds."""

    def __init__(self) -> None:
        self._rigs: Final[OrderedDict[tuple[str, int], tuple[VirtualRig, Callable[[], None]]]] = OrderedDict()

    def armed(self, robot: str, seed: int) -> VirtualRig:
        """Return a robot armed and at standstill, for one test at a time; RobotFileError: there is none."""
        name = (robot, seed)
        known = self._rigs.pop(name, None)
        # A run that broke off within an instant has no valid state to go back from.
        if known is not None and not known[0].whole:
            known[0].finish()
            known = None
        rig, back = known or self._new(robot, seed)
        back()
        self._rigs[name] = rig, back
        if len(self._rigs) > MOST:
            oldest, _ = self._rigs.popitem(last=False)[1]
            oldest.finish()
        return rig

    def finish(self) -> None:
        """Let go of all of them."""
        for rig, _ in self._rigs.values():
            rig.finish()
        self._rigs.clear()

    @staticmethod
    def _new(robot: str, seed: int) -> tuple[VirtualRig, Callable[[], None]]:
        rig = VirtualRig(find(robot, plant_too=True), seed)
        rig.arms()
        return rig, rig.keep()
