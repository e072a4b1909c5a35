"""A robot in virtual time as a test sees it: its operator, motion, interlock events and faults."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Final

import numpy as np
from pydantic import ValidationError

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import Samples
from emulators.bench.faults import FaultError, kinds, read
from emulators.bench.mission import Mission
from emulators.bench.operator import ScriptedOperator
from emulators.bench.records import FaultRecord, InterlockEvent
from emulators.rig import Rig
from emulators.run import HAND_STREAM
from emulators.testing.errors import RigError
from emulators.testing.hand import FOR_GOOD_S, TestOperator
from emulators.testing.recording import Recording
from firmware_bridge import renamed
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.problems import problems_of
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds, to_seconds

ARM_S: Final = 3.0
"""Time by which the drives of every robot here are set up, and the operator may arm."""
ARMED_BY_S: Final = 20.0
"""Assumed: a robot that is not armed by then will not be; those of this tree are armed at 3.01 s."""
STEP_S: Final = 0.01
"""Interval at which a condition is checked: that of the samples."""
UNIT_WORDS: Final = {"m/s": "mps", "rad/s": "rad_s"}
"""Spelling of a unit in a column's name, where that is not the unit in small letters."""


class LatestSample:
    """The newest sample of the robot, every 10 ms: `body.speed_mps`, or without the unit, `body.speed`."""

    def __init__(self, robot: str, samples: Samples) -> None:
        self._robot: Final = robot
        self._samples: Final = samples
        self._names: Final = {column.name: column.name for column in samples.columns}
        for column in samples.columns:
            word = UNIT_WORDS.get(column.unit, column.unit.lower())
            self._names.setdefault(column.name.removesuffix(f"_{word}"), column.name)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns, each with its unit."""
        return tuple(column.name for column in self._samples.columns)

    def __getattr__(self, name: str) -> float:
        """Return a column of the newest sample, in the unit of its name; RigError for one there is not."""
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in self._names:
            raise RigError(f"{self._robot} has no '{name}'; it has {', '.join(self.columns)}")
        return float(self._samples[-1][self._names[name]])


class VirtualRig:
    """One robot with its operator, in virtual time, on a link without noise; the seed decides all."""

    def __init__(self, robot: AnyRobot, seed: int = 0) -> None:
        """Build it, switched off; LookupError where the robot has no bench setup, PlantError for no plant."""
        self.robot: Final = robot
        self.seed: Final = seed
        self.bench_setup: Final = bench_setup_of(robot)
        step = self.bench_setup.step
        arms = step(at_s=ARM_S, title="arms", arm=True)
        start_positions = self.bench_setup.start_positions
        # Without them the robot is not armed: these positions are read off the robot by a person.
        zero = {
            axis.role: start_positions.get(axis.role, 0.0) for axis in robot.axes if axis.needs_confirmation
        }
        confirmed = (step(at_s=0.0, title="confirms where it stands", zero=zero),) if zero else ()
        story = Mission(title=f"a test of {robot.name}", duration_s=FOR_GOOD_S, step=(*confirmed, arms))
        hand = np.random.default_rng([seed, HAND_STREAM])
        station = ScriptedOperator(robot, self.bench_setup, story, hand)
        self.bench: Final = Rig(robot, self.bench_setup, station, seed=seed)
        """The bench below, for its other attributes."""
        self.recording: Final = Recording(self.bench)
        self.operator: Final = TestOperator(
            robot, self.bench_setup, station, story, lambda: self.bench.world.now
        )
        self.body: Final = LatestSample(robot.name, self.bench.samples)
        self.began: Nanoseconds = 0
        """Time at which the robot was armed, and a test's own story begins."""
        self.whole = True
        """False where a run was broken off amid an instant: such a rig has no valid state."""

    @property
    def now(self) -> float:
        """The virtual time, s; the story of a test begins at about 3 s, when the robot is armed."""
        return to_seconds(self.bench.world.now)

    @property
    def interlock_events(self) -> Mapping[str, str]:
        """The interlocks that are active now, by name, with their reasons."""
        return self._active("rig.interlock_events", str)

    @property
    def interlock_history(self) -> tuple[InterlockEvent, ...]:
        """All interlock events so far, the oldest first: `began_s` and `ended_s` are s of virtual time."""
        return tuple(self.bench.interlock_events)

    @property
    def holds(self) -> Mapping[str, str]:
        """The same as `interlock_events`, with the names of the release before."""
        renamed.warn("holds", "interlock_events", "rig")
        return self._active("rig.holds", renamed.old_interlock)

    @property
    def held(self) -> tuple[InterlockEvent, ...]:
        """The same as `interlock_history`, with the names of the release before."""
        renamed.warn("held", "interlock_history", "rig")
        return tuple(
            replace(one, name=renamed.old_interlock(one.name)) for one in self.bench.interlock_events
        )

    def _active(self, where: str, shown: Callable[[str], str]) -> Mapping[str, str]:
        reasons = {one.name: one.reason for one in self.bench.interlock_events if one.ended is None}
        return renamed.Interlocks(reasons, where, shown)

    @property
    def faults(self) -> tuple[FaultRecord, ...]:
        """All faults so far, the oldest first."""
        return tuple(self.bench.faults.records)

    def runs(self, seconds: float) -> None:
        """Let so much virtual time pass."""
        # An exception while time runs leaves it so: such an instant cannot be gone back from.
        self.whole = False
        self.bench.run(self.bench.world.now + from_seconds(seconds))
        self.whole = True

    def runs_until(self, what: Callable[[], object], within: float) -> float:
        """Run until something is so, looked at every 10 ms; return after how many seconds it was.

        AssertionError where it is not so within that many seconds.
        """
        began = self.bench.world.now
        # Checked at 10 ms, the interval of the samples.
        while not what():
            if self.bench.world.now - began >= from_seconds(within):
                raise AssertionError(f"not so within {within:g} s of virtual time, at {self.now:.2f} s")
            self.runs(STEP_S)
        return to_seconds(self.bench.world.now - began)

    def arms(self) -> None:
        """Run until the operator is informed that the robot is armed; RigError where he is not."""
        while not self.operator.armed:
            if self.bench.world.now >= ARMED_BY_S * SECOND:
                holds = "; ".join(f"{name}: {reason}" for name, reason in self.interlock_events.items())
                confirmed = " / ".join(self.operator.texts[-3:])
                raise RigError(f"{self.robot.name} is not armed by {ARMED_BY_S:g} s: {holds or confirmed}")
            self.runs(STEP_S)
        self.began = self.bench.world.now

    def fault(self, kind: str, **keys: object) -> None:
        """Let a fault happen from now on: `fault("supply_sag", to_v=9, for_s=0.5)`."""
        table = {"kind": kind, "at_s": self.now, **keys}
        try:
            fault = read(table, self.robot)
            self.bench.faults.plan([fault])
        except ValidationError as error:
            if kind not in kinds():
                raise RigError(error.errors()[0]["msg"]) from error
            stated = "; ".join(
                f"{key}: {problem}" for key, problem in problems_of(error, kinds()[kind].fault)
            )
            raise RigError(f"{self.robot.name} cannot have the fault '{kind}': {stated}") from error
        except FaultError as error:
            message = "; ".join(f"{key.partition('.')[2] or key}: {what}" for key, what in error.problems)
            raise RigError(f"{self.robot.name} cannot have the fault '{kind}': {message}") from error

    @contextmanager
    def branch(self) -> Iterator["VirtualRig"]:
        """Return to this instant at the end: events in the meantime are undone.

        Where an exception ends it, nothing goes back, so that a failing test's report shows them.
        """
        back = self.keep()
        yield self
        back()

    def keep(self) -> Callable[[], None]:
        """Keep this instant; return what goes back to it, as often as one likes."""
        moment, story, mark = self.bench.snapshot(), self.operator.story, self.recording.mark()

        def back() -> None:
            self.bench.restore(moment)
            self.operator.takes_over(story)
            self.recording.cut(mark)
            self.whole = True

        return back

    def finish(self) -> None:
        """Let go of the plant."""
        self.bench.finish()


__getattr__ = renamed.module(__name__, __name__, Body="LatestSample")
