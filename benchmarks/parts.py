"""Processor time of a simulated second of each robot, by part, in ms; scaled by the loop of `reference`.

Usage: python -m benchmarks.parts [SECONDS] [--page]    simulated time; 20 by default.

Robots and the loop take turns. The whole, recording and report are differences of runs without watches; plant
and kernel are a stop-watch's around the physics, less what that costs; bridge, drives and operator are the
shares of one more watched run. With `--page` docs/where-the-time-goes.md is written.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks.figure import Figure
from benchmarks.measure import processor_seconds, show
from benchmarks.reference import KEPT_MS, loop_ms
from benchmarks.watches import COMPILED, SEED, StopWatches, split
from emulators.bench import mission
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.operator import ScriptedOperator
from emulators.recorded import recorded
from emulators.rig import BRIDGE, OPERATOR_STATION, Rig
from emulators.run import HAND_STREAM, RunOrder, drive
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds

REPEATS: Final = 3
PHYSICS: Final = "servo"
PAGE: Final = Path(__file__).parents[1] / "docs" / "where-the-time-goes.md"


@dataclass(frozen=True, slots=True)
class Driven:
    """A robot and its mission."""

    title: str
    robot: str
    mission: str


@dataclass(frozen=True, slots=True)
class Subject(Driven):
    """A mission, and the goals in ms of a simulated second on the machine of `KEPT_MS`."""

    physics_goal: float
    rest_goal: float


@dataclass(frozen=True, slots=True)
class Factor(Driven):
    """A mission, and how many times real time it is driven at least, by the core compiled or interpreted."""

    compiled: float
    interpreted: float | None


SUBJECTS: Final = (
    Subject("RARS, circles", "rars", "circles", 10.0, 5.0),
    Subject("ROME, circle", "rome", "circle", 6.7, 6.0),
    Subject("climber, square", "climber", "square", 12.5, 5.0),
    Subject("rome_arm, orbit", "rome_arm", "orbit", 25.0, 15.0),
)
FACTORS: Final = (
    Factor("ROME, circle, cameras at 240 Hz", "rome+cameras", "circle", 100.0, 30.0),
    Factor("climber, square", "climber", "square", 20.0, 20.0),
    Factor("climber, square, cameras at 240 Hz", "climber+cameras", "square", 20.0, None),
)
FIGURES_S: Final = 10.0
"""Simulated time of a run for `figures`."""
INTERPRETED_GOAL: Final = 2.5
HOURS_GOAL: Final = 42.0
HOUR_ROBOTS: Final = ("rars", "rome")


@dataclass(frozen=True, slots=True)
class Figures:
    """ms of the processor in a simulated second."""

    whole: float
    physics: float
    bridge: float
    drives: float
    operator: float
    recording: float
    report: float

    @property
    def rest(self) -> float:
        """All but plant and kernel, without recording and report."""
        return self.whole - self.physics

    @property
    def others(self) -> float:
        """Bus, links and the world: what has no watch."""
        return max(self.rest - self.bridge - self.drives - self.operator, 0.0)


def rig_of(subject: Driven, seed: int = SEED) -> Rig:
    """Build the robot with its operator, at the start of the mission."""
    robot = find(subject.robot)
    setup = bench_setup_of(robot)
    script = mission.find(subject.mission, robot, setup)
    operator = ScriptedOperator(robot, setup, script, np.random.default_rng([seed, HAND_STREAM]))
    return Rig(script.on(robot), setup, operator, seed=seed, noise=script.noise)


def plain(subject: Driven, simulated_s: float) -> float:
    """Return the seconds of a run without recording."""
    one = rig_of(subject)
    taken = processor_seconds(lambda: one.run(from_seconds(simulated_s)))
    one.finish()
    return taken


def with_recording(subject: Subject, simulated_s: float) -> float:
    """Return the seconds of a run whose packets are recorded."""
    one = rig_of(subject)
    with tempfile.TemporaryDirectory() as folder, recorded(one, Path(folder)):
        taken = processor_seconds(lambda: one.run(from_seconds(simulated_s)))
    one.finish()
    return taken


def with_report(subject: Subject, simulated_s: float) -> float:
    """Return the seconds of a run with all that `bench` leaves."""
    robot = find(subject.robot)
    setup = bench_setup_of(robot)
    script = mission.find(subject.mission, robot, setup)
    steps = tuple(step for step in script.step if step.at_s < simulated_s)
    script = script.model_copy(update={"duration_s": simulated_s, "step": steps})
    with tempfile.TemporaryDirectory() as folder:
        order = RunOrder(robot, setup, subject.mission, script, SEED, Path(folder))
        return processor_seconds(lambda: drive(order, lambda _: None))


def watched(subject: Subject, simulated_s: float) -> tuple[float, StopWatches]:
    """Return the seconds of a watched run, and its watches."""
    one = rig_of(subject)
    whole, watches = split(one, simulated_s, {BRIDGE: "bridge", OPERATOR_STATION: "operator"})
    one.finish()
    return whole, watches


def watch_seconds() -> float:
    """Return what a stop-watch adds to what it measures, for each call."""
    watches, calls = StopWatches(), 20_000
    timed = watches.around("nothing", lambda: None)
    for _ in range(calls):
        timed()
    return watches.seconds["nothing"] / calls


def figures_of(subject: Subject, simulated_s: float) -> Figures:
    """Return the figures of one robot, each the shortest of some runs."""
    least: dict[str, float] = {}
    runs = (("plain", plain), ("recording", with_recording), ("report", with_report))
    watches = []
    for _ in range(REPEATS):
        for name, run in runs:
            least[name] = min(least.get(name, np.inf), run(subject, simulated_s))
        watches.append(watched(subject, simulated_s)[1])
    best = min(watches, key=lambda one: one.seconds[PHYSICS])
    cost = watch_seconds()
    each = {part: taken - cost * best.calls[part] for part, taken in best.seconds.items()}
    per_s = 1e3 / simulated_s
    return Figures(
        whole=per_s * least["plain"],
        physics=per_s * each[PHYSICS],
        bridge=per_s * each.get("bridge", 0.0),
        drives=per_s * sum(taken for part, taken in each.items() if part == "drives"),
        operator=per_s * each.get("operator", 0.0),
        recording=per_s * max(least["recording"] - least["plain"], 0.0),
        report=per_s * max(least["report"] - least["recording"], 0.0),
    )


HEAD: Final = (
    *("mission", "whole", "plant, kernel", "goal", "the rest", "goal"),
    *("bridge", "devices", "operator", "bus, world", "recording", "report"),
)


def whole_and_physics(subject: Subject, simulated_s: float, repeats: int = REPEATS) -> tuple[float, float]:
    """Return ms of a simulated second: all without recording and report, and plant and kernel alone."""
    whole, physics = [], []
    for _ in range(repeats):
        whole.append(plain(subject, simulated_s))
        watches = watched(subject, simulated_s)[1]
        physics.append(watches.seconds[PHYSICS] - watch_seconds() * watches.calls[PHYSICS])
    return 1e3 * min(whole) / simulated_s, 1e3 * min(physics) / simulated_s


def figures() -> Iterator[Figure]:
    """Measure each robot against the loop, an hour of a core, and real time."""
    loop, ratios = loop_ms(), list[tuple[str, float, float]]()
    for subject in SUBJECTS:
        whole, physics = whole_and_physics(subject, FIGURES_S)
        ratios.append((f"{subject.title}: plant, kernel", physics, subject.physics_goal))
        ratios.append((f"{subject.title}: the rest", whole - physics, subject.rest_goal))
        if subject.robot in HOUR_ROBOTS:
            yield Figure(
                name=f"{subject.title}: simulated hours",
                value=1e3 / whole,
                unit="h",
                against="an hour of a core",
                reference=1.0,
                goal=HOURS_GOAL,
                at_least=True,
            )
        if subject is SUBJECTS[0] and COMPILED:
            call = "a, b = whole_and_physics(SUBJECTS[0], FIGURES_S, 2); print(a - b)"
            yield Figure(
                name=f"{subject.title}: the rest, interpreted",
                value=interpreted(call),
                unit="ms/s",
                against="compiled",
                reference=whole - physics,
                goal=INTERPRETED_GOAL,
            )
    # Before and behind: a processor that has rested begins slowly.
    loop = min(loop, loop_ms())
    for name, value, goal in ratios:
        limit = goal / KEPT_MS
        yield Figure(name=name, value=value, unit="ms/s", against="loop, ms", reference=loop, goal=limit)
    yield from _factors()


def _factors() -> Iterator[Figure]:
    """Measure against real time, by an interpreter, too, where that has a goal."""
    for place, one in enumerate(FACTORS):
        core = one.compiled if COMPILED else one.interpreted
        yield _factor(one.title, simulated_a_second(one), core)
        if COMPILED and one.interpreted is not None:
            times = interpreted(f"print(simulated_a_second(FACTORS[{place}]))")
            yield _factor(f"{one.title}, interpreted", times, one.interpreted)


def _factor(name: str, times: float, goal: float | None) -> Figure:
    """Give how many times real time a robot is driven."""
    return Figure(
        name=name, value=times, unit="s", against="a second", reference=1.0, goal=goal, at_least=True
    )


def simulated_a_second(one: Driven) -> float:
    """Return the simulated seconds of a second of the processor, without recording."""
    return FIGURES_S / min(plain(one, FIGURES_S) for _ in range(REPEATS))


def interpreted(call: str) -> float:
    """Return the number that a call prints, by the same Python without the compiled core."""
    printed = subprocess.run(  # noqa: S603 - this file, by this interpreter
        [sys.executable, "-c", f"from benchmarks.parts import *; {call}"],
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])},
        capture_output=True,
        text=True,
        check=True,
    )
    return float(printed.stdout)


def rows(found: dict[Subject, Figures], scale: float) -> list[tuple[str, ...]]:
    """Return a line for each robot; goals are scaled to this machine."""
    return [
        (
            subject.title,
            f"{one.whole:.1f}",
            f"{one.physics:.1f}",
            f"{scale * subject.physics_goal:.1f}",
            f"{one.rest:.1f}",
            f"{scale * subject.rest_goal:.1f}",
            *(f"{it:.1f}" for it in (one.bridge, one.drives, one.operator, one.others)),
            *(f"{it:.1f}" for it in (one.recording, one.report)),
        )
        for subject, one in found.items()
    ]


def main() -> int:
    """Measure and print; exit status 1 where a goal is missed."""
    words = argparse.ArgumentParser(prog="parts", description=__doc__)
    words.add_argument("seconds", nargs="?", type=float, default=20.0)
    words.add_argument("--page", action="store_true", help="write docs/where-the-time-goes.md")
    given = words.parse_args()
    begun = loop_ms()
    found = {subject: figures_of(subject, given.seconds) for subject in SUBJECTS}
    loop = min(begun, loop_ms())
    lines = rows(found, loop / KEPT_MS)
    core = "compiled" if COMPILED else "interpreted"
    note = f"loop {loop:.1f} ms, {KEPT_MS:g} ms where the goals were set; core {core}"
    show("where the time goes, ms of a simulated second", HEAD, lines, note)
    if given.page:
        PAGE.write_text(page(lines, note), encoding="utf-8")
    missed = [
        subject.title
        for subject, one in found.items()
        if one.physics > subject.physics_goal * loop / KEPT_MS
        or one.rest > subject.rest_goal * loop / KEPT_MS
    ]
    if missed:
        print(f"a goal is missed: {', '.join(missed)}", file=sys.stderr)
    return 1 if missed else 0


def page(lines: list[tuple[str, ...]], note: str) -> str:
    """Return the page."""
    table = "\n".join(f"| {' | '.join(line)} |" for line in (HEAD, ("---",) * len(HEAD), *lines))
    day = time.strftime("%Y-%m-%d")
    return f"{TEXT.format(day=day, note=note)}\n{table}\n{MEANING}"


TEXT: Final = """# Where the time goes

Processor time of a simulated second, in ms, by part. `python -m benchmarks.parts --page` measures it with the
core that it runs on and writes this page; measured on {day}:

{note}.

The loop, `benchmarks/reference.py`, is the measure of a machine: goals are scaled by it.
"""

MEANING: Final = """
| part | what it is |
|---|---|
| plant, kernel | the FMU's steps, and the regulators of the drives in C |
| bridge | reports in, interlocks, kinematics, commands out |
| devices | emulated drives and boards: protocol, states, requests |
| operator | stick or pilot, MAVLink |
| bus, world | arbitration, lines, the queue of events, samples |
| recording | `can.log`, `serial.log`, `operator.tlog` |
| report | summary, table, pictures, page |

A watch costs time itself: that is taken off by calls, so the parts add up to the whole within some per cent.
Recording and report are differences of whole runs.
"""


if __name__ == "__main__":
    sys.exit(main())
