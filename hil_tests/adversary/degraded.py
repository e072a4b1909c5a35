"""An actuator that dies for good, and an operator who orders the mode that goes without it."""

from collections.abc import Iterator
from typing import Any, Final

from numpy.random import Generator

from emulators.bench.faults import Fault, read
from emulators.bench.step import modes
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import robot_type_of

LIMPS: Final = 0.4
"""Share of random runs in one of the modes after a failure, of a robot that has them."""
HEALTHY: Final = 0.25
"""Share of those without a failure: the mode ordered for a sound axis loses that axis, and no more."""
FIRST_S: Final = 3.6
LAST_S: Final = 7.0
"""The actuator dies between these."""
LOOKS_S: Final = 3.0
"""Time after that at which the mode is ordered: the robot rests by then, and a silent axis is known."""
DRIVES: Final = 5
"""Number of times that the stick is pushed then, besides the usual steps: else it seldom drives."""
DEAD: Final[tuple[dict[str, Any], ...]] = ({"kind": "gate_supply_sag", "to_v": 0.0}, {"kind": "node_silent"})
"""A motor that cannot be switched on, reported; or a drive of which nothing is received any more."""


class Degraded:
    """The failure of one random run, if it has one, and the mode that goes with it; nothing for other robots.

    On a slope nothing dies: a robot whose drives lose their power there is not held.
    """

    def __init__(self, robot: AnyRobot, chance: Generator, *, sloped: bool) -> None:
        names = modes(robot)[1:]
        self.mode: Final = str(chance.choice(names)) if names and chance.random() < LIMPS else ""
        """The mode; empty for none."""
        self._dies_s: Final = round(float(chance.uniform(FIRST_S, LAST_S)), 3) if self.mode else 0.0
        dies = self.mode and not sloped and chance.random() >= HEALTHY
        self.faults: Final = tuple(self._dead(robot, chance)) if dies else ()

    def _dead(self, robot: AnyRobot, chance: Generator) -> Iterator[Fault]:
        how = DEAD[int(chance.integers(len(DEAD)))]
        for axis in robot_type_of(robot).rules(robot)[self.mode].without:
            yield read({**how, "at_s": self._dies_s, "node": axis})

    def steps(
        self, lets_go: dict[str, Any], goes: Iterator[dict[str, Any]]
    ) -> Iterator[tuple[float, dict[str, Any]]]:
        """Yield what the operator does about it, and when: he lets go, orders the mode, arms, drives on."""
        if self.mode:
            rests = round(self._dies_s + LOOKS_S, 3)
            yield round(self._dies_s + 0.5, 3), {**lets_go, "disarm": True}
            yield rests, {"mode": self.mode}
            yield round(rests + 0.5, 3), {"arm": True}
            for number in range(DRIVES):
                yield round(rests + 1.5 + 0.8 * number, 3), next(goes)

    def again(self, now: float) -> dict[str, Any]:
        """Return what he adds where he recovers: the mode, as a bridge that was restarted has none."""
        return {"mode": self.mode} if self.mode and now > self._dies_s + LOOKS_S else {}
