"""A mission: what an operator does over time, from a TOML file that an engineer writes in five minutes.

Wrong keys and values are refused with the file's name and each key's path, all of them at once. The robot's
limits are not checked here: a mission may well command too much.
"""

import math
import tomllib
from collections.abc import Iterator
from itertools import pairwise, starmap
from pathlib import Path
from typing import Annotated, Self

from pydantic import AfterValidator, Field, PrivateAttr, ValidationError, create_model, model_validator

from emulators.bench.bench_setup import BenchSetup
from emulators.bench.faults import ROBOT, FaultTable, misfits
from emulators.bench.piloted import Pilot, by_hand
from emulators.bench.step import (
    Finite,
    Holds,
    Input,
    NonNegative,
    Positive,
    Presses,
    Share,
    Step,
    inputs,
    path_followers,
)
from emulators.bench.survey_table import Survey
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.problems import FileError, Problem, near, problems_of
from firmware_bridge.robot.table import Table
from firmware_bridge.slow_link.conditions import Conditions, conditions

_TOLERANCE = 1e-9


class MissionFileError(FileError):
    """A mission that cannot be driven."""


class Noise(Table):
    """Imperfections of a real hand and a real link; all of them come from the run's seed."""

    stick: Share = 0.0
    """Standard deviation of the hand's tremor, as a share of full stick."""
    delay_ms: NonNegative = 0.0
    """Delay of the link, one way."""
    jitter_ms: NonNegative = 0.0
    """Additional delay, evenly spread up to this."""
    loss: Share = 0.0
    """Share of the datagrams that never arrive."""


def _is_a_link(text: str) -> str:
    if text:
        conditions(text)
    return text


class Mission(Table):
    """A whole mission, checked."""

    title: str
    source: str = ""
    duration_s: Positive
    send_hz: Annotated[int, Field(ge=1, le=100)] = 20
    """Rate at which the operator sends the controls."""
    input: Annotated[Input, Field(strict=False)] = Input.STICK
    noise: Noise = Noise()
    link: Annotated[str, AfterValidator(_is_a_link)] = ""
    """Delay and loss of the link, as for `bench --link`: "delay=0.5,up.loss=0.02"."""
    max_delay_s: Positive | None = None
    """Greatest age of a command that is obeyed, agreed on for this session: the robot is slower then."""
    pilot: Pilot | None = None
    """Automatic pilot that follows a path in the operator's place."""
    survey: Survey | None = None
    """Readings of a detector at points that are driven to one after the other, in the pilot's place."""
    step: Annotated[tuple[Step, ...], Field(min_length=1, strict=False)]
    settled_after_s: NonNegative = 10.0
    """Time after a path follower's begin from which its distance from the path counts in the summary."""
    plant: dict[str, Finite] = Field(default_factory=dict)
    """Parameters of the plant beside those of the robot file: its slope, its floor."""
    fault: Annotated[tuple[FaultTable, ...], Field(strict=False)] = ()
    """Faults in the meantime: `docs/faults.md`."""
    _text: str = PrivateAttr(default="")

    @property
    def text(self) -> str:
        """The TOML text that it was read from, without the changes by options."""
        return self._text

    def read_from(self, text: str) -> Self:
        """Return the mission with its text."""
        mission = self.model_copy()
        mission._text = text  # noqa: SLF001 - its own
        return mission

    def on(self, robot: AnyRobot) -> AnyRobot:
        """Return the robot on this mission's floor, and with the delay that it agrees on; RobotFileError."""
        plant = robot.plant.model_copy(update={"parameters": robot.plant.parameters | self.plant})
        return robot.model_copy(update={"plant": plant}).agreed_on(self.max_delay_s)

    @property
    def conditions(self) -> Conditions:
        """Delay and loss of the link."""
        return conditions(self.link) if self.link else Conditions()

    def predicted(self) -> Self:
        """Return the mission with its pilot behind a predictor; MissionFileError where it has none."""
        if self.pilot is None:
            raise MissionFileError(self.title, Problem("pilot", "no one follows a path, who could predict?"))
        return self.model_copy(update={"pilot": self.pilot.model_copy(update={"predictor": True})})

    def driven_by_stations(self) -> Self:
        """Return the mission with its faults and conditions; who drives is outside."""
        return self.model_copy(update={"pilot": None, "survey": None, "step": self.step[:1]})

    def over(self, link: str | None, max_delay_s: float | None) -> Self:
        """Return the mission over another link, and with another agreed delay; None: its own.

        ConditionsError where `link` cannot be read as one.
        """
        if link is not None:
            _is_a_link(link)
        changed = {"link": link, "max_delay_s": max_delay_s}
        return self.model_copy(update={key: value for key, value in changed.items() if value is not None})

    @model_validator(mode="after")
    def _steps_are_in_order(self) -> Self:
        for earlier, later in pairwise(self.step):
            if later.at_s < earlier.at_s:
                raise ValueError(
                    f"step '{later.title}' at {later.at_s:g} s stands behind one at {earlier.at_s:g} s"
                )
        if self.step[-1].at_s >= self.duration_s:
            raise ValueError(
                f"step '{self.step[-1].title}' is not before the end, duration_s = {self.duration_s:g}"
            )
        if self.pilot is not None and self.survey is not None:
            raise ValueError("a mission has a pilot or a survey, not both")
        if self.pilot is not None and self.pilot.begins_s >= self.duration_s:
            raise ValueError(
                f"pilot.begins_s = {self.pilot.begins_s:g} is not before the end,"
                f" duration_s = {self.duration_s:g}"
            )
        for fault in self.fault:
            if fault.at_s >= self.duration_s:
                raise ValueError(
                    f"fault '{fault.kind}' at {fault.at_s:g} s is not before the end,"
                    f" duration_s = {self.duration_s:g}"
                )
        return self


def parse(text: str, file: str, robot: AnyRobot, bench_setup: BenchSetup) -> Mission:
    """Read a mission for a robot from TOML text; `file` names it in a MissionFileError."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise MissionFileError(file, Problem("", f"not valid TOML: {error}")) from error
    steps = Annotated[tuple[bench_setup.step, ...], Field(min_length=1, strict=False)]  # type: ignore[name-defined] # mypy takes no class from a variable, pydantic does
    # With the robot's own step, so that a wrong key is reported with its near names.
    model = create_model("Mission", __base__=Mission, step=(steps, ...))
    try:
        mission = model.model_validate(table, context={ROBOT: robot})
    except ValidationError as error:
        raise MissionFileError(file, *problems_of(error, model)) from error
    mission = mission.model_copy(
        update={"step": tuple(_confirmed(step, robot, bench_setup) for step in mission.step)}
    )
    problems = (*cannot_say(mission, robot, bench_setup), *starmap(Problem, misfits(mission.fault, robot)))
    if problems:
        raise MissionFileError(file, *problems)
    return mission.read_from(text)


def _confirmed(step: Step, robot: AnyRobot, bench_setup: BenchSetup) -> Step:
    """Return a step that confirms with the positions of the axes that need it; other steps as they are."""
    if step.confirm is None:
        return step
    places = bench_setup.start_positions
    known = {axis.role: places.get(axis.role, 0.0) for axis in robot.axes if axis.needs_confirmation}
    return step.model_copy(update={"zero": (known | (step.zero or {})) or None})


def load(path: Path, robot: AnyRobot, bench_setup: BenchSetup) -> Mission:
    """Read a mission file; MissionFileError where it is missing, unreadable or wrong."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise MissionFileError(str(path), Problem("", f"cannot be read: {error}")) from error
    return parse(text, str(path), robot, bench_setup)


def find(name: str, robot: AnyRobot, bench_setup: BenchSetup) -> Mission:
    """Read the robot's shipped mission of this name, or one from a path that ends in .toml."""
    if name.endswith(".toml"):
        return load(Path(name), robot, bench_setup)
    shipped = bench_setup.shipped()
    if name in shipped:
        return load(shipped[name], robot, bench_setup)
    problem = f"no such mission of {robot.name}; {near(name, shipped)} (a path to a .toml file works, too)"
    raise MissionFileError(name, Problem("", problem))


def cannot_say(mission: Mission, robot: AnyRobot, bench_setup: BenchSetup) -> Iterator[Problem]:
    """Yield what the input that is in the operator's hand cannot say."""
    channels = {channel.name: channel for channel in bench_setup.channels}
    held = mission.input
    yield from _without_a_detector(mission, robot, bench_setup)
    for index, step in enumerate(mission.step):
        # The input stays in the hand until a later step names another one.
        held = step.input or held
        if step.path_follower is not None and step.path_follower not in path_followers(robot):
            known = near(step.path_follower, [name for name in path_followers(robot) if name])
            yield Problem(
                f"step[{index}].path_follower",
                f"{robot.name} has no path follower '{step.path_follower}'; {known}",
            )
        yield from _unconfirmed(index, step, robot)
        yield from _beside_a_pilot(index, step, mission)
        for key, row in inputs(type(step)).items():
            value = getattr(step, key)
            if value is None:
                continue
            where = f"step[{index}].{key}"
            # The stick sends shares of the limits: it cannot command more than those.
            if held is Input.STICK and isinstance(row, Holds):
                full = channels[row.channel].full(robot)
                if abs(row.into(value, robot)) > full + _TOLERANCE:
                    yield Problem(where, f"'{step.title}' is beyond full stick; input = 'twist' can say it")
            elif held is Input.TWIST and value and _needs_stick(row, bench_setup):
                yield Problem(where, f"'{step.title}' needs the stick")


def _without_a_detector(mission: Mission, robot: AnyRobot, bench_setup: BenchSetup) -> Iterator[Problem]:
    if mission.survey is not None and (lacks := mission.survey.lacks(robot, bench_setup.step)):
        yield Problem("survey", lacks)


def _beside_a_pilot(index: int, step: Step, mission: Mission) -> Iterator[Problem]:
    """Yield the inputs of a step that need a hand, where a pilot drives."""
    begins_s = math.inf if mission.pilot is None else mission.pilot.begins_s
    begins_s = begins_s if mission.survey is None else 0.0
    for key in () if step.at_s < begins_s else by_hand(step):
        yield Problem(f"step[{index}].{key}", "a pilot drives, who does nothing of the kind")


def _unconfirmed(index: int, step: Step, robot: AnyRobot) -> Iterator[Problem]:
    """Yield the roles whose position the operator does not confirm on this robot."""
    known = [axis.role for axis in robot.axes if axis.needs_confirmation]
    for role in step.zero or ():
        if role not in known:
            problem = f"{robot.name} has no such axis to confirm; {near(role, known)}"
            yield Problem(f"step[{index}].zero.{role}", problem)
    homed = [axis.role for axis in robot.axes if axis.zero.homing is not None]
    for place, role in enumerate(step.home or ()):
        if role not in homed:
            problem = f"{robot.name} does not home '{role}'; {near(role, homed)}"
            yield Problem(f"step[{index}].home[{place}]", problem)


def _needs_stick(row: object, bench_setup: BenchSetup) -> bool:
    only = {channel.name for channel in bench_setup.channels if channel.stick_only}
    return isinstance(row, Presses) or (isinstance(row, Holds) and row.channel in only)
