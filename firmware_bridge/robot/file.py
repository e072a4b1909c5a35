"""Robot files: one TOML file for each robot, read and checked.

A wrong key or value is refused with the file's name and the key's path, all of them at once; nothing is
guessed, and nothing is ignored.
"""

import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from firmware_bridge.renamed import with_new_keys
from firmware_bridge.robot.check import cross_checked, sensors_named
from firmware_bridge.robot.model import Robot
from firmware_bridge.robot.problems import Problem, RobotFileError, problems_of
from firmware_bridge.robot.table import Table

G = TypeVar("G", bound=Table)


def text_of(path: Path) -> str:
    """Read a robot file's text; RobotFileError where it is missing or unreadable."""
    if path.is_dir():
        raise RobotFileError(str(path), Problem("", "is a folder; name the robot file (.toml) in it"))
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise RobotFileError(str(path), Problem("", f"cannot be read: {error.strerror}")) from error
    except UnicodeDecodeError as error:
        problem = f"is no text in UTF-8: byte {error.start} is 0x{error.object[error.start]:02X}"
        raise RobotFileError(str(path), Problem("", problem)) from error


def table_of(text: str, file: str) -> dict[str, object]:
    """Read TOML; `file` names it in a RobotFileError. The kind's name is the robot's where none is given."""
    try:
        table = tomllib.loads(text)
    except ValueError as error:
        # Beside its own error: an integer with more digits than Python reads.
        raise RobotFileError(file, Problem("", f"not valid TOML: {error}")) from error
    except RecursionError as error:
        raise RobotFileError(file, Problem("", "not valid TOML: nested too deeply")) from error
    return {"kind": table["name"], **table} if "name" in table else table


def robot_of(
    table: Mapping[str, object],
    file: str,
    geometry: type[G],
    groups: Mapping[str, frozenset[str]],
    more: Iterable[Problem] = (),
) -> Robot[G]:
    """Check a robot's table against its kind's geometry and groups of roles; RobotFileError.

    `more` are mistakes that the caller has found in it; they are reported with the others.
    """
    table = with_new_keys(table, file, geometry.model_fields)
    roles = {role: group for group, members in groups.items() for role in sorted(members)}
    model = Robot[geometry]  # type: ignore[valid-type] # mypy takes no class from a variable, pydantic does
    problems = [*cross_checked(table, roles), *sensors_named(geometry, table), *more]
    try:
        robot: Robot[G] = model.model_validate(table)
    except ValidationError as error:
        problems = [*problems_of(error, model), *problems]
    if problems:
        raise RobotFileError(file, *problems)
    return robot


def schema(geometry: type[Table]) -> dict[str, object]:
    """Return the JSON schema of the robot files of a kind with this geometry."""
    model = Robot[geometry]  # type: ignore[valid-type] # as above
    made: dict[str, Any] = model.model_json_schema()
    # Their default is another key's value, which a schema cannot express.
    made["required"].remove("kind")
    made["$defs"]["Axis"]["required"].remove("role")
    return made
