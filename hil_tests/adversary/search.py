"""The search: random runs are driven, branched from their worst moments and judged; findings are shrunk."""

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.random import Generator

from emulators.bench.bench_setup import BenchSetup
from emulators.bench.faults import Fault
from emulators.bench.log import Subject
from emulators.bench.mission import Mission
from emulators.bench.operator import ScriptedOperator
from emulators.bench.step import Step
from emulators.rewind import Checkpoint
from emulators.rig import Rig
from emulators.run import HAND_STREAM
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds
from hil_tests.adversary.coverage import Coverage
from hil_tests.adversary.draw import READY_S, Draw
from hil_tests.adversary.failing import FAILING, FaultProfile, disables_power
from hil_tests.adversary.truth import Invariant, Judge, Truth, Violation

LOOK_EVERY: Final = 0.01
RUN_S: Final = 24.0
BRANCH_S: Final = 8.0
BRANCHES: Final = 3
KEPT_EVERY_S: Final = 1.0
AFTER_S: Final = 1.0
"""Limit after the first violation of a rule, beyond which a later step did not cause it."""
GOES: Final = "arm: accepted"
FORCED: Final = "force disarm: accepted"
STOPPED: Final = "emergency stop: accepted"
CLEARED: Final = "clear: accepted"
STOPS: Final = {"disarm: accepted", FORCED, STOPPED, "hold: accepted"}
WORDS: Final = {GOES, CLEARED, *STOPS}


@dataclass(frozen=True, slots=True)
class Found:
    """A mission that breaks a rule."""

    mission: Mission
    violation: Violation
    seed: int

    def __str__(self) -> str:
        """Return it in one line."""
        broken = self.violation
        return f"{broken.name}: {broken.ratio:.2f} times its bound from {to_seconds(broken.since):.2f} s on"


@dataclass(frozen=True, slots=True)
class _Kept:
    """A moment to go back to, what the judge had in mind then, and how near to a bound it came next."""

    at: Nanoseconds
    moment: Checkpoint
    since: dict[str, Nanoseconds]
    let_go_at: tuple[float, float] | None
    nearest: float


class Life:
    """One rig with a mission on it, and its judge."""

    def __init__(
        self,
        robot: AnyRobot,
        bench_setup: BenchSetup,
        mission: Mission,
        seed: int,
        rows: tuple[Invariant, ...],
        *,
        coverage: Coverage | None = None,
    ) -> None:
        self.mission = mission
        self._coverage: Final = Coverage() if coverage is None else coverage
        robot = mission.on(robot)
        hand = np.random.default_rng([seed, HAND_STREAM])
        self._operator: Final = ScriptedOperator(robot, bench_setup, mission, hand)
        self.rig: Final = Rig(
            robot, bench_setup, self._operator, seed=seed, noise=mission.noise, faults=mission.fault
        )
        self._truth: Final = Truth(robot)
        self.judge: Final = Judge(rows, lying(mission.fault))

    def run(self, until: Nanoseconds) -> Violation | None:
        """Run on to an instant; return the first rule that is broken."""
        step = from_seconds(LOOK_EVERY)
        while self.rig.world.now < until:
            begun = self.rig.world.now
            try:
                self.rig.run(begun + step)
            except Exception as error:  # noqa: BLE001 - on a robot the bridge would be dead
                return Violation(f"{type(error).__name__}: {error}", begun, math.inf)
            self._coverage.look(self.rig, begun)
            if self.rig.world.now < from_seconds(READY_S):
                continue
            words = self._accepted()
            look = self._truth.look(
                self.rig,
                reported_to_stop=next((word for word in words if word != CLEARED), STOPPED) != GOES,
                stopped=words[0] == STOPPED and "slope" not in self.mission.plant,
                let_go=FORCED not in words and not any(map(disables_power, self.mission.fault)),
            )
            broken = self.judge.look(self.rig.world.now, look)
            if broken is not None:
                return broken
        return None

    def _accepted(self) -> list[str]:
        """Return the orders to go or to stop that were accepted, of anybody, the newest first."""
        answers = [
            (entry.at, entry.text)
            for entry in self._operator.diary.entries
            if entry.kind is Subject.ANSWERED and entry.text in WORDS
        ]
        answers += [
            (at, f"{order}: accepted") for station in self.rig.stations for at, order in station.accepted
        ]
        answers.sort(key=lambda answer: answer[0])  # what came at one instant stays in its order
        known = [text for _, text in reversed(answers) if text in WORDS]
        return known or ["disarm: accepted"]

    def kept(self, until: Nanoseconds) -> Iterator[_Kept | Violation]:
        """Run on, and yield a moment for each second of it, or what was broken."""
        while self.rig.world.now < until:
            at, moment, since = self.rig.world.now, self.rig.snapshot(), dict(self.judge.since)
            let_go_at = self._truth.let_go_at
            self.judge.nearest = 0.0
            broken = self.run(min(until, at + from_seconds(KEPT_EVERY_S)))
            yield _Kept(at, moment, since, let_go_at, self.judge.nearest) if broken is None else broken
            if broken is not None:
                return

    def branch(self, kept: _Kept, steps: tuple[Step, ...], faults: tuple[Fault, ...]) -> None:
        """Go back to a moment, and on from there with other steps and more faults."""
        self.rig.restore(kept.moment)
        self.judge.since, self._truth.let_go_at = dict(kept.since), kept.let_go_at
        before = tuple(step for step in self.mission.step if from_seconds(step.at_s) <= kept.at)
        spoken = self.mission.model_copy(update={"step": (*before, *steps)})
        self._operator.take_over(spoken)
        self.mission = spoken.model_copy(update={"fault": (*spoken.fault, *faults)})
        self.rig.faults.plan(faults)
        self.judge.lying = lying(self.mission.fault)


def lying(faults: tuple[Fault, ...]) -> bool:
    """Return whether someone is not to be believed when these are on."""
    return any(FAILING[fault.kind].fault_profile is not FaultProfile.HONEST for fault in faults)


@dataclass(frozen=True, slots=True)
class Search:
    """A search over seeds for one robot."""

    robot: AnyRobot
    bench_setup: BenchSetup
    rows: tuple[Invariant, ...]
    natures: frozenset[FaultProfile]
    say: Callable[[str], None] = lambda _: None
    seen: Callable[[Rig], None] = lambda _: None
    """Callback with the rig when a run has been driven to its end, before its branches."""
    coverage: Coverage = field(default_factory=Coverage)

    def random_run(self, seed: int) -> tuple[Found | None, float]:
        """Drive one random run and its branches; return the finding, shrunk, and the seconds driven."""
        found, driven = self.looked(seed)
        return (None if found is None else self.shrunk(found)), driven

    def looked(self, seed: int) -> tuple[Found | None, float]:
        """Drive one random run and its branches; return the finding, and the seconds driven."""
        chance = np.random.default_rng([seed, 7])
        draw = Draw(self.robot, self.bench_setup, chance, self.natures)
        whole = draw.mission(RUN_S)
        life = Life(self.robot, self.bench_setup, whole, seed, self.rows, coverage=self.coverage)
        try:
            return self._lived(life, draw, chance, seed)
        finally:
            life.rig.finish()

    def _lived(self, life: Life, draw: Draw, chance: Generator, seed: int) -> tuple[Found | None, float]:
        whole, kept, end = life.mission, list[_Kept](), from_seconds(RUN_S)
        for one in life.kept(end):
            if isinstance(one, Violation):
                return Found(life.mission, one, seed), to_seconds(life.rig.world.now)
            kept.append(one)
        self.seen(life.rig)
        driven = RUN_S
        ready = [one for one in kept if one.at > from_seconds(READY_S)]
        worst = sorted(ready, key=lambda one: -one.nearest)[: 2 * BRANCHES]
        for place in chance.permutation(len(worst))[:BRANCHES]:
            one = worst[int(place)]
            life.mission = whole
            begin = to_seconds(one.at) + 2.0 / whole.send_hz
            until = begin + BRANCH_S
            more = draw.faults(begin, until - 1.0, whole.fault)
            life.branch(one, draw.steps(begin, min(until, RUN_S)), more)
            broken = life.run(from_seconds(until))
            driven += BRANCH_S
            if broken is not None:
                return Found(life.mission, broken, seed), driven
        return None, driven

    def again(self, mission: Mission, seed: int, name: str) -> Violation | None:
        """Drive a mission from its beginning; return the violation of this name."""
        broken = self.breaks(mission, seed)
        return broken if broken is not None and broken.name == name else None

    def breaks(self, mission: Mission, seed: int) -> Violation | None:
        """Drive a mission from its beginning; return the first rule that it breaks."""
        life = Life(self.robot, self.bench_setup, mission, seed, self.rows, coverage=self.coverage)
        try:
            return life.run(from_seconds(mission.duration_s + BRANCH_S))
        finally:
            life.rig.finish()

    def shrunk(self, found: Found) -> Found:
        """Leave out what comes later, all noise, and each fault and step without which the same is broken."""
        end = round(to_seconds(found.violation.since) + AFTER_S, 3)
        best = self._smaller(found, _until(found.mission, end))
        best = self._smaller(best, {"noise": type(found.mission.noise)()})
        before = None
        while best is not before:
            before = best
            for key in ("fault", "step"):
                for one in getattr(before.mission, key):
                    rest = tuple(other for other in getattr(best.mission, key) if other is not one)
                    if rest or key == "fault":
                        best = self._smaller(best, {key: rest})
        return best

    def _smaller(self, best: Found, change: dict[str, Any]) -> Found:
        """Return the find with this change where it breaks the same rule, else as it is."""
        mission = best.mission.model_copy(update=change)
        broken = self.again(mission, best.seed, best.violation.name)
        if broken is None:
            return best
        self.say(f"shrunk to {len(mission.step)} steps and {len(mission.fault)} faults")
        return Found(mission, broken, best.seed)


def _until(mission: Mission, end: float) -> dict[str, Any]:
    """Return what of a mission is before a second."""
    steps = tuple(step for step in mission.step if step.at_s < end)
    faults = tuple(fault for fault in mission.fault if fault.at_s < end)
    return {"duration_s": min(end, mission.duration_s), "step": steps, "fault": faults}


def as_toml(found: Found, line: str) -> str:
    """Return the mission as a file that `bench` drives, with what it breaks above it; `line` is the robot."""
    mission = found.mission
    lines = [f"# {found}", f"# firmware-bridge bench {line} --mission THIS --seed {found.seed}", ""]
    lines += [f"title = {json.dumps(mission.title)}", f"duration_s = {mission.duration_s + BRANCH_S}"]
    noise = mission.noise.model_dump(exclude_defaults=True)
    lines += ["", "[noise]", *(f"{key} = {_toml(value)}" for key, value in noise.items())] if noise else []
    if mission.plant:
        lines += ["", "[plant]", *(f"{key} = {_toml(value)}" for key, value in mission.plant.items())]
    for table, rows in (("step", mission.step), ("fault", mission.fault)):
        for row in rows:
            stated = row.model_dump(exclude_none=True, exclude_unset=True)
            kind = {"kind": row.kind} if isinstance(row, Fault) else {}
            lines += [
                "",
                f"[[{table}]]",
                *(f"{key} = {_toml(value)}" for key, value in {**kind, **stated}.items()),
            ]
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(one)}" for key, one in value.items()) + " }"
    return json.dumps(value)
