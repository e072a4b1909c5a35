"""A mission: what an operator does over time, from a TOML file that an engineer writes in five minutes.

A wrong key or value is refused with the file's name and the key's path. Whether the robot allows what a
mission asks is nobody's business here: missions exist to ask for too much.
"""

import math
import tomllib
from difflib import get_close_matches
from enum import StrEnum
from importlib import resources
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import ErrorDetails

from emulators.bench.strays import Stray
from firmware_bridge.robot import Robot

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, le=1)]

_DESCRIPTIVE = frozenset({"at_s", "title", "ramp_mps2"})
_TOLERANCE = 1e-9


class MissionFileError(Exception):
    """A mission that cannot be driven: which file, which key, what is wrong with it."""

    def __init__(self, file: str, key: str, problem: str) -> None:
        super().__init__(file, key, problem)
        self.file = file
        self.key = key
        self.problem = problem

    def __str__(self) -> str:
        """Say it in one line."""
        return f"{self.file}: {self.key}: {self.problem}" if self.key else f"{self.file}: {self.problem}"


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, str_strip_whitespace=True)


class Input(StrEnum):
    """With which message the operator drives."""

    STICK = "stick"
    """MANUAL_CONTROL: speed and steering as shares of the robot's limits; cannot ask for more than those."""
    TWIST = "twist"
    """SET_POSITION_TARGET_LOCAL_NED: speed and yaw rate; asks for anything, steers only while it drives."""


class Button(StrEnum):
    """A button of the stick."""

    DETECTOR = "detector"
    HEADLAMP = "headlamp"
    EMERGENCY_STOP = "emergency_stop"


class Noise(_Table):
    """What a real hand and a real link add; all of it comes from the run's seed."""

    stick: Share = 0.0
    """Standard deviation of the hand's tremor, as a share of full stick."""
    delay_ms: NonNegative = 0.0
    """Of the link, one way."""
    jitter_ms: NonNegative = 0.0
    """Up to this much more, evenly spread."""
    loss: Share = 0.0
    """Share of the datagrams that never arrive."""


class Step(_Table):
    """What the operator does at one instant. Speed, steering and lift rate stay until a later step."""

    at_s: NonNegative
    title: Annotated[str, Field(min_length=1, max_length=100)]
    input: Annotated[Input | None, Field(strict=False)] = None
    speed_mps: Finite | None = None
    """Forward positive; at once, or with `ramp_mps2`."""
    ramp_mps2: Positive | None = None
    steer_deg: Annotated[float, Field(gt=-90, lt=90)] | None = None
    """Inner front wheel, left positive."""
    radius_m: Finite | None = None
    """Of the rear axle's middle, left positive; another way to say `steer_deg`."""
    lift_m: NonNegative | None = None
    """Go to this height above collapsed."""
    lift_rate_mps: Finite | None = None
    """Move the lift by stick, up positive, until a later step says otherwise."""
    arm: Literal[True] | None = None
    disarm: Literal[True] | None = None
    force_disarm: Literal[True] | None = None
    emergency_stop: Literal[True] | None = None
    clear: Literal[True] | None = None
    """Clear the emergency stop."""
    terminate: Literal[True] | None = None
    """Emergency stop for good."""
    headlamp: bool | None = None
    detector: bool | None = None
    press: Annotated[Button | None, Field(strict=False)] = None
    """Tap a button of the stick."""
    silent_s: Positive | None = None
    """Say nothing at all for this long."""
    stray: Annotated[Stray | None, Field(strict=False)] = None
    """Send one thing that no operator should."""

    @model_validator(mode="after")
    def _makes_sense(self) -> Self:
        if not self.model_fields_set - _DESCRIPTIVE:
            raise ValueError("the step does nothing")
        if self.ramp_mps2 is not None and self.speed_mps is None:
            raise ValueError("ramp_mps2 needs speed_mps")
        if self.steer_deg is not None and self.radius_m is not None:
            raise ValueError("steer_deg and radius_m say the same thing: give one of them")
        if self.radius_m == 0:
            raise ValueError("radius_m must not be 0; straight ahead is steer_deg = 0")
        return self


class Mission(_Table):
    """A whole mission, checked."""

    title: str
    source: str = ""
    duration_s: Positive
    send_hz: Annotated[int, Field(ge=1, le=100)] = 20
    """How often the operator sends what the hand does (thesis 4.2: 20 Hz)."""
    input: Annotated[Input, Field(strict=False)] = Input.STICK
    noise: Noise = Noise()
    step: Annotated[tuple[Step, ...], Field(min_length=1, strict=False)]

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
        return self


def parse(text: str, file: str, robot: Robot) -> Mission:
    """Read a mission for a robot from TOML text; `file` names it in a MissionFileError."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise MissionFileError(file, "", f"not valid TOML: {error}") from error
    try:
        mission = Mission.model_validate(table)
    except ValidationError as error:
        first = error.errors()[0]
        raise MissionFileError(file, _path(first["loc"]), _problem(first)) from error
    _fit(mission, robot, file)
    return mission


def load(path: Path, robot: Robot) -> Mission:
    """Read a mission file; MissionFileError where it is missing, unreadable or wrong."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise MissionFileError(str(path), "", f"cannot be read: {error}") from error
    return parse(text, str(path), robot)


def find(name: str, robot: Robot) -> Mission:
    """Read the shipped mission of this name, or one from a path that ends in .toml."""
    if name.endswith(".toml"):
        return load(Path(name), robot)
    for path in shipped():
        if path.stem == name:
            return load(path, robot)
    known = ", ".join(names())
    raise MissionFileError(
        name, "", f"no such mission; there are: {known}. A path to a .toml file works, too"
    )


def shipped() -> list[Path]:
    """Return the paths of the missions in the package, sorted by name."""
    folder = resources.files("emulators.bench") / "missions"
    return sorted(Path(str(entry)) for entry in folder.iterdir() if entry.name.endswith(".toml"))


def names() -> list[str]:
    """Return the names of the shipped missions."""
    return [path.stem for path in shipped()]


def steer_of_radius(robot: Robot, radius_m: float) -> float:
    """Return the inner wheel's angle in rad for a turn, R = a_k / 2 + w cot(theta) (thesis 2.13)."""
    base = robot.base
    inner = math.atan2(base.wheelbase_m, abs(radius_m) - base.kingpin_distance_m / 2.0)
    return math.copysign(inner, radius_m)


def _fit(mission: Mission, robot: Robot, file: str) -> None:
    """Refuse what the input that is in the operator's hand cannot say."""
    limits = robot.limits
    full_lock = math.radians(limits.steer_angle_deg)
    held = mission.input
    for index, step in enumerate(mission.step):
        held = step.input or held
        steer = math.radians(step.steer_deg or 0.0)
        if step.radius_m is not None:
            steer = steer_of_radius(robot, step.radius_m)
        stick_only = {"press": step.press is not None, "lift_rate_mps": bool(step.lift_rate_mps)}
        beyond = {
            "speed_mps": abs(step.speed_mps or 0.0) > limits.speed_mps + _TOLERANCE,
            "steer_deg" if step.radius_m is None else "radius_m": abs(steer) > full_lock + _TOLERANCE,
            "lift_rate_mps": abs(step.lift_rate_mps or 0.0) > limits.lift_rate_mps + _TOLERANCE,
        }
        wrong = beyond if held is Input.STICK else stick_only
        problem = (
            "is beyond full stick; input = 'twist' can say it" if held is Input.STICK else "needs the stick"
        )
        for key, is_wrong in wrong.items():
            if is_wrong:
                raise MissionFileError(file, f"step[{index}].{key}", f"'{step.title}' {problem}")


def _problem(error: ErrorDetails) -> str:
    location = error["loc"]
    if error["type"] == "extra_forbidden":
        inner = {"step": list(Step.model_fields), "noise": list(Noise.model_fields)}
        known = inner[str(location[0])] if len(location) > 1 else list(Mission.model_fields)
        near = get_close_matches(str(location[-1]), known, n=1)
        return f"no such key; perhaps {near[0]}?" if near else f"no such key; there are: {', '.join(known)}"
    problem = error["msg"].removeprefix("Value error, ")
    return problem if isinstance(error["input"], dict | list) else f"{problem}, but it is {error['input']!r}"


def _path(location: tuple[int | str, ...]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).lstrip(".")
