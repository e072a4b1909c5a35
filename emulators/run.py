"""Run of a mission on the rig, with all its results in one folder."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final, TypeAlias

import numpy as np

from emulators.bench.bench_setup import BenchSetup
from emulators.bench.columns import Samples, electric
from emulators.bench.mission import Mission, MissionFileError
from emulators.bench.operator import ScriptedOperator
from emulators.bench.page import page
from emulators.bench.path_error import Followed, path_error
from emulators.bench.piloted import HandedOver, PilotedMission
from emulators.bench.radial_error import radial_error
from emulators.bench.summary import RunFigures, Summary, as_json, summarize
from emulators.bench.survey_map import mapped
from emulators.bench.survey_table import SurveyMission
from emulators.recorded import frames_recorded, recorded
from emulators.rig import Rig
from emulators.rig_mcap import Unrecorded, in_mcap
from firmware_bridge import renamed
from firmware_bridge.extras import installed
from firmware_bridge.node import Node
from firmware_bridge.robot import AnyRobot, Problem
from firmware_bridge.runtime.run_file import AsRun, run_file
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds

HAND_STREAM: Final = 0
"""The operator's hand draws from this stream of the seed; the link has one of its own."""
SLICE: Final[Nanoseconds] = 250 * MILLISECOND
"""Simulated time between two looks at the progress bar."""

Progress: TypeAlias = Callable[[Nanoseconds], None]
"""Callback with the progress of the run."""
Carry: TypeAlias = Callable[[Rig, Nanoseconds, Progress], None]
"""What lets a rig's time pass up to an instant, or to an earlier one."""


@dataclass(frozen=True, slots=True)
class RunOrder:
    """The mission to drive, and the place of the results."""

    robot: AnyRobot
    bench_setup: BenchSetup
    mission_name: str
    mission: Mission
    seed: int
    folder: Path
    plant: Path | None = None
    again: str = ""
    """The line that drives it again, for its page."""
    operator: Node | None = None
    """Operator in place of the mission's; with it stations may inject failures of the devices."""
    record: Path | None = None
    """File in MCAP, or of CAN frames for another tool, beside the folder."""

    @property
    def duration(self) -> Nanoseconds:
        """Simulated time of the run."""
        return from_seconds(self.mission.duration_s)


def in_virtual_time(rig: Rig, end: Nanoseconds, progress: Progress) -> None:
    """Let time pass as fast as the machine can."""
    until = 0
    while until < end:
        until = min(until + SLICE, end)
        rig.run(until)
        progress(until)


def drive(order: RunOrder, progress: Progress, carry: Carry = in_virtual_time) -> Summary:
    """Drive a mission and leave summary, recordings, pictures and a page in the folder.

    PlantError where the plant cannot be used; OSError where the folder cannot be written; ExtraMissingError
    where a file in MCAP needs its extra.
    """
    about = {"robot": order.robot.name, "mission": order.mission_name, "seed": str(order.seed)}
    with in_mcap(order.record, {**about, "link": order.mission.link}) as mcap:
        return _driven(order, progress, carry, mcap)


def measure(order: RunOrder) -> Summary:
    """Drive a mission in virtual time, write nothing; PlantError, and MissionFileError, as `drive`."""
    operator = operator_of(order)
    rig, begun = _rig(order, operator), time.perf_counter()
    in_virtual_time(rig, order.duration, lambda _: None)
    return _summary(order, rig, operator, time.perf_counter() - begun)


def _rig(order: RunOrder, operator: Node) -> Rig:
    return Rig(
        order.mission.on(order.robot),
        order.bench_setup,
        operator,
        plant_path=order.plant,
        seed=order.seed,
        noise=order.mission.noise,
        link=order.mission.conditions,
        faults=order.mission.fault,
        injects=order.operator is not None,
    )


def _summary(order: RunOrder, rig: Rig, operator: Node, wall_s: float) -> Summary:
    """End a run, and return its numbers; MissionFileError where its pilot's path was refused."""
    reached = rig.world.now
    rig.finish()
    pilot = operator.pilot if isinstance(operator, HandedOver) else operator
    if isinstance(pilot, PilotedMission) and (refused := pilot.follower.refused):
        raise MissionFileError(order.mission_name, Problem("pilot", refused))
    run = RunFigures(
        robot=order.robot.name,
        mission=order.mission_name,
        seed=order.seed,
        simulated=reached,
        wall_s=wall_s,
        frames=sum(wire.frames for wire in rig.can_wires.values()),
        bus_load_percent=max((wire.load_percent() for wire in rig.can_wires.values()), default=0.0),
        trace_sha256=rig.world.trace_sha256,
        links_sha256=rig.world.links_sha256,
        guard_refusals=rig.guard.refused,
        cycle=order.robot.cycle,
        lines=tuple(line.carried(order.robot, reached, rig.devices) for line in rig.lines.values()),
    )
    return summarize(
        run,
        electric(order.robot),
        rig.samples,
        rig.interlock_events,
        rig.faults.records,
        path=path_error(rig.samples, followed(order), order.mission.settled_after_s),
        radial_error_m=swings(order, rig.samples),
        figures={**order.bench_setup.figures, **_by_file(order)},
    )


def _driven(order: RunOrder, progress: Progress, carry: Carry, mcap: Unrecorded) -> Summary:
    order.folder.mkdir(parents=True, exist_ok=True)
    operator = operator_of(order)
    rig = _rig(order, operator)
    mcap.observe(rig)
    begun = time.perf_counter()
    with recorded(rig, order.folder), frames_recorded(rig, order.record):
        carry(rig, order.duration, progress)
    # Of the run alone: pictures and files come behind.
    summary = _summary(order, rig, operator, time.perf_counter() - begun)
    faults = rig.faults.records
    as_run = run_file(AsRun(order.mission.on(order.robot)))
    for name, text in as_run.items():
        (order.folder / name).write_text(text, encoding="utf-8")
    mcap.end(summary, {**as_run, "mission.toml": order.mission.text})
    (order.folder / "summary.json").write_text(as_json(summary), encoding="utf-8")
    (order.folder / "samples.csv").write_text(rig.samples.csv(), encoding="ascii")
    title, pictures = f"{order.robot.name} · {order.mission_name} · seed {order.seed}", list[Path]()
    if installed("plots"):
        # Half a second for Matplotlib, which no one needs before the run is over.
        from emulators.bench.plots import draw  # noqa: PLC0415 - see above

        pictures = draw(
            order.folder,
            title,
            order.robot,
            order.bench_setup.panels,
            rig.samples,
            events=rig.interlock_events,
            faults=faults,
            more=order.bench_setup.pictures,
        )
    pictures += mapped(operator, rig.samples, order.seed, order.folder)
    shown = page(summary, order.bench_setup.remarks(order.robot), pictures, order.again)
    (order.folder / "report.html").write_text(shown, encoding="utf-8")
    return summary


def operator_of(order: RunOrder) -> Node:
    """Return the driver of the mission: its operator with a stick, its pilot, or one after the other."""
    if order.operator is not None:
        return order.operator
    mission, tremor = order.mission, np.random.default_rng([order.seed, HAND_STREAM])
    hand = ScriptedOperator(order.robot, order.bench_setup, mission, tremor)
    if mission.survey is not None:
        return SurveyMission(mission.on(order.robot), mission.step, mission.survey, order.bench_setup.step)
    if mission.pilot is None:
        return hand
    pilot = PilotedMission(mission.on(order.robot), mission.step, mission.pilot)
    begins_s = mission.pilot.begins_s
    return HandedOver(hand, pilot, from_seconds(begins_s)) if begins_s else pilot


def _by_file(order: RunOrder) -> dict[str, Callable[[Samples], float | None]]:
    by_file = order.bench_setup.figures_by_file
    return {name: partial(_figure, figure, order.robot) for name, figure in by_file.items()}


def _figure(
    figure: Callable[[Samples, AnyRobot], float | None], robot: AnyRobot, samples: Samples
) -> float | None:
    return figure(samples, robot)


def swings(order: RunOrder, samples: Samples) -> float | None:
    """Return how far the robot swung about its pilot's path; None where it has none."""
    mission = order.mission
    if mission.pilot is None or mission.pilot.goal_m is not None:
        return None
    return radial_error(samples, mission.pilot.placed, mission.settled_after_s)


def followed(order: RunOrder) -> list[Followed]:
    """Return which paths a mission has path followers follow, and from when on."""
    paths = order.bench_setup.paths
    return [
        Followed(step.at_s, paths[step.path_follower](order.robot) if step.path_follower in paths else None)
        for step in order.mission.step
        if step.path_follower is not None and paths
    ]


__getattr__ = renamed.module(__name__, __name__, Order="RunOrder")
