"""The matrix of a robot: every failure in every state, driven from an instant that was kept."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from emulators.bench.faults.failures import Failure, failures_of
from emulators.campaign.spread import in_order
from emulators.fmea.effect import LASTS_S, Assessment, Effect, effect, watched
from emulators.fmea.reasons import ALONE, reason
from emulators.fmea.states import states_of
from emulators.testing.rig import VirtualRig
from firmware_bridge.robot import AnyRobot


@dataclass(frozen=True, slots=True)
class Cell:
    """One failure in one state."""

    state: str
    failure: Failure
    effect: Effect
    why: str = ""
    """Reason why the failure need not be noticed."""

    @property
    def late(self) -> bool:
        """True if its motion is uncommanded, and is not noticed in time."""
        return self.effect.verdict in {Assessment.NOT_NOTICED, Assessment.LATE}

    @property
    def wrong(self) -> bool:
        """True if it is late, and no reason is known."""
        return self.late and not self.why


Progress = Callable[[Sequence[Cell]], None]
"""Callback with the cells of each state that is done."""


def state_names(robot: AnyRobot) -> tuple[str, ...]:
    """Return the states in which failures are tried; LookupError and PlantError as of the rig."""
    rig = VirtualRig(robot)
    names = tuple(state.name for state in states_of(rig))
    rig.finish()
    return names


def matrix(
    made: Callable[[], AnyRobot],
    states: Sequence[str],
    failures: Sequence[Failure],
    jobs: int,
    progress: Progress,
) -> list[Cell]:
    """Return the cells, state by state; they do not depend on how many processes share the work.

    `made` makes the robot: each process has its own, so it must be a function that can be sent there.
    RigError where the robot cannot be armed; SpreadError where a process dies again and again.
    """
    row = partial(of_state, made, failures)
    found: list[Cell] = []
    for cells in in_order(row, states, jobs):
        found += cells
        progress(cells)
    return found


def of_state(made: Callable[[], AnyRobot], failures: Sequence[Failure], name: str) -> list[Cell]:
    """Return the cells of one state."""
    rig = VirtualRig(made())
    rig.arms()
    next(state for state in states_of(rig) if state.name == name).enter(rig)
    # Brought into the state once: every failure begins at the same checkpoint, bit for bit.
    back = rig.keep()
    well = watched(rig)
    cells = []
    for failure in failures:
        back()
        lasts_s = LASTS_S if failure.lasts and failure.kind not in ALONE else None
        rig.fault(failure.kind, **failure.keys, **({} if lasts_s is None else {"for_s": lasts_s}))
        found = effect(well, watched(rig, lasts_s))
        cells.append(Cell(name, failure, found, reason(rig.robot, failure, name, found)))
    rig.finish()
    return cells


def all_failures(robot: AnyRobot, kinds: Sequence[str] = ()) -> tuple[Failure, ...]:
    """Return the failures of these kinds, or all that the robot can have."""
    return tuple(failure for failure in failures_of(robot) if not kinds or failure.kind in kinds)
