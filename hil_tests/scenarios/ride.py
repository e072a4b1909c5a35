"""A ride: a short mission on the whole bench, written inside a test, and what became of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from emulators.bench.columns import Sample
from emulators.bench.faults import Fault, read
from emulators.bench.mission import Mission, Noise
from emulators.bench.operator import ScriptedOperator
from emulators.bench.step import Input
from emulators.bench.summary import mean_acceleration
from emulators.rig import BRIDGE, Rig
from emulators.robots.rars import BENCH_SETUP
from emulators.robots.rars import RarsStep as Step
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds, to_seconds

READY_S: Final = 3.0
"""Time by which the drives are set up, and the operator may arm."""
SETTLED_S: Final = 3.9
FIRST_S: Final = 4.0
"""The first step of a story that goes on from the armed robot; the operator has spoken once since then."""
STANDS: Final = Step(at_s=0.0, title="where it stands", zero={"steering": 0.0, "lift": 0.0})
"""Every story begins so, but those that are about it."""
ARMED: Final = Step(at_s=READY_S, title="arm", arm=True)


@dataclass(slots=True)
class Ride:
    """A rig, and short ways to ask what happened on it."""

    rig: Rig
    operator: ScriptedOperator

    def runs(self, seconds: float) -> None:
        self.rig.runs(seconds)

    def runs_until(self, second: float) -> None:
        self.rig.run(from_seconds(second))

    def ends(self) -> None:
        """Request the bridge to end in good order, as Ctrl-C does."""
        self.rig.world.stop(BRIDGE)

    @property
    def now(self) -> Sample:
        newest: Sample = self.rig.samples[-1]
        return newest

    @property
    def holding(self) -> set[str]:
        return {event.name for event in self.rig.interlock_events if event.ended is None}

    def held(self, name: str) -> list[str]:
        """The reasons of all holds whose name begins so, over and standing ones."""
        return [event.reason for event in self.rig.interlock_events if event.name.startswith(name)]

    def held_between(self, began: float, ended: float) -> set[str]:
        """Names of holds that began in this time, in seconds."""
        return {
            h.name for h in self.rig.interlock_events if from_seconds(began) <= h.began <= from_seconds(ended)
        }

    def rows(self, began: float, ended: float) -> list[Sample]:
        return [row for row in self.rig.samples if from_seconds(began) <= row.at <= from_seconds(ended)]

    def fastest(self, began: float = 0.0, ended: float = 1e6) -> float:
        return max(abs(row["speed_mps"]) for row in self.rows(began, ended))

    def hardest(self, began: float = 0.0, ended: float = 1e6) -> float:
        speed = np.array([row["speed_mps"] for row in self.rows(began, ended)])
        return float(np.abs(mean_acceleration(speed)).max())

    def stands_from(self, began: float, slower_than: float = 0.002) -> float:
        """The second from which the base stands for good, counted from the first row at or after `began`."""
        moving = [row.at for row in self.rows(began, 1e6) if abs(row["speed_mps"]) >= slower_than]
        return to_seconds(max(moving)) if moving else began


Ridden = Callable[..., Ride]


def ride(
    *steps: Step,
    seconds: float,
    robot: AnyRobot | None = None,
    noise: Noise | None = None,
    seed: int = 0,
    faults: Sequence[Fault] = (),
    stands: bool = True,
) -> Ride:
    """Build the bench with an operator who does these steps; nothing has run yet.

    `stands`: he begins with where it stands.
    """
    machine = find("rars") if robot is None else robot
    known = (STANDS,) if stands else ()
    mission = story(*known, *steps, seconds=seconds, noise=noise)
    operator = ScriptedOperator(machine, BENCH_SETUP, mission, np.random.default_rng(seed))
    rig = Rig(machine, BENCH_SETUP, operator, seed=seed, noise=mission.noise, faults=faults)
    return Ride(rig, operator)


def story(*steps: Step, seconds: float, noise: Noise | None = None) -> Mission:
    """A mission of these steps."""
    return Mission(
        title="a story",
        duration_s=seconds,
        input=Input.STICK,
        noise=noise or Noise(),
        step=tuple(sorted(steps, key=lambda step: step.at_s)),
    )


def step(at_s: float, **does: object) -> Step:
    """One step of the operator."""
    return Step.model_validate({"at_s": at_s, "title": f"at {at_s:g} s", **does})


def fault(kind: str, at_s: float, **how: object) -> Fault:
    """One fault, as a mission file names it."""
    return read({"kind": kind, "at_s": at_s, **how})


class Armed:
    """A quiet bench whose robot has just been armed: a story that begins so may go on from there."""

    def __init__(self, robot: AnyRobot) -> None:
        self.robot: Final = robot
        self._ride = ride(ARMED, seconds=2 * SETTLED_S, robot=robot)
        self._ride.runs_until(SETTLED_S)
        self._moment = self._ride.rig.snapshot()

    @staticmethod
    def suits(steps: tuple[Step, ...], how: Mapping[str, object]) -> bool:
        """Return True if a ride with these steps and options is the same until then."""
        faults = how.get("faults", ())
        assert isinstance(faults, Sequence)
        later = [*(step for step in steps if step is not ARMED), *faults]
        known = {"seconds"} <= set(how) <= {"seconds", "faults", "robot"}
        return ARMED in steps and known and all(each.at_s >= FIRST_S for each in later)

    def fork(self, *steps: Step, seconds: float, faults: Sequence[Fault] = ()) -> Ride:
        """Go back to the settled robot, and on with these steps and faults; the ride before ends."""
        one = self._ride
        one.rig.restore(self._moment)
        lines = [line.wire for line in one.rig.lines.values()]
        for wire in (*one.rig.can_wires.values(), *lines, one.rig.operator_wire):
            wire.unobserved()
        one.operator.take_over(story(STANDS, *steps, seconds=seconds))
        one.rig.faults.plan(faults)
        return Ride(one.rig, one.operator)

    def finish(self) -> None:
        """Let go of the plant."""
        self._ride.rig.finish()
