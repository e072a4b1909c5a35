"""`run.json` of a recording: the robot as it was driven, and its axes' confirmed positions.

Options, links and paths are in it, so a reader of the recording needs none of the command line.
"""

import json
import math
from pathlib import Path
from typing import Final, NamedTuple

from pydantic import ValidationError

from firmware_bridge.intent import ConfirmPosition
from firmware_bridge.renamed import with_new_keys
from firmware_bridge.robot import AnyRobot, Problem, Robot, RobotFileError
from firmware_bridge.robot.problems import problems_of
from firmware_bridge.robot_types import robot_type_named
from firmware_bridge.units import MILLISECOND, to_seconds

RUN_FILE: Final = "run.json"


class AsRun(NamedTuple):
    """The settings that a bridge was started with."""

    robot: AnyRobot
    confirmed: tuple[ConfirmPosition, ...] = ()
    mode: str = ""


def run_file(run: AsRun) -> dict[str, str]:
    """Return the file's text by its name; `read_run` reads it."""
    robot = run.robot.model_dump(mode="json", exclude_none=True)
    # A robot file must not have this key: it is agreed for one session, and is put back when it is read.
    agreed_ms = robot["operator"].pop("agreed_ms", None)
    # JSON has no NaN.
    confirmed = {it.axis: None if math.isnan(it.value) else it.value for it in run.confirmed}
    content = {"robot": robot, "agreed_ms": agreed_ms, "confirmed": confirmed, "mode": run.mode}
    return {RUN_FILE: json.dumps(content, indent=1) + "\n"}


def read_run(folder: Path) -> AsRun | None:
    """Read a recording's file; None where it has none. RobotFileError, naming the file and what is wrong."""
    path = folder / RUN_FILE
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        table, agreed_ms, confirmed, mode = (
            content["robot"],
            content["agreed_ms"],
            dict(content["confirmed"] if "confirmed" in content else content["stands"]),
            str(content["mode"]),
        )
        robot_type = robot_type_named(table["kind"])
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError) as error:
        problem = f"cannot be read ({type(error).__name__}: {error}); name the robot behind the folder"
        raise RobotFileError(str(path), Problem("", problem)) from error
    model = Robot[robot_type.geometry]  # type: ignore[name-defined] # a class from a variable, for pydantic
    table = with_new_keys(table, str(path), robot_type.geometry.model_fields)
    try:
        robot: AnyRobot = model.model_validate_json(json.dumps(table))
    except ValidationError as error:
        raise RobotFileError(str(path), *problems_of(error, model)) from error
    agreed = None if agreed_ms is None else to_seconds(agreed_ms * MILLISECOND)
    zeros = (
        ConfirmPosition(axis, math.nan if value is None else float(value))
        for axis, value in confirmed.items()
    )
    return AsRun(robot.agreed_on(agreed), tuple(zeros), mode)
