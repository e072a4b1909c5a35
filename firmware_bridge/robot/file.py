"""Robot files: one TOML file for each robot, found, read and checked.

A wrong key or value is refused with the file's name and the key's path; nothing is guessed, and nothing is
ignored.
"""

import tomllib
from collections.abc import Iterable
from importlib import resources
from pathlib import Path

from pydantic import ValidationError

from firmware_bridge.robot.model import Robot


class RobotFileError(Exception):
    """A robot file that cannot be used: which file, which key, what is wrong with it."""

    def __init__(self, file: str, key: str, problem: str) -> None:
        super().__init__(file, key, problem)
        self.file = file
        self.key = key
        self.problem = problem

    def __str__(self) -> str:
        """Say it in one line."""
        return f"{self.file}: {self.key}: {self.problem}" if self.key else f"{self.file}: {self.problem}"


def parse(text: str, file: str) -> Robot:
    """Read a robot from TOML text; `file` names it in a RobotFileError."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise RobotFileError(file, "", f"not valid TOML: {error}") from error
    try:
        return Robot.model_validate(table)
    except ValidationError as error:
        first = error.errors()[0]
        key = _path(first["loc"])
        problem = first["msg"].removeprefix("Value error, ")
        given = "" if isinstance(first["input"], dict | list) else f", but it is {first['input']!r}"
        raise RobotFileError(file, key, f"{problem}{given}") from error


def load(path: Path) -> Robot:
    """Read a robot file; RobotFileError where it is missing, unreadable or wrong."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise RobotFileError(str(path), "", f"cannot be read: {error}") from error
    return parse(text, str(path))


def find(name: str) -> Robot:
    """Read the robot of this name from the package, or from a path that ends in .toml."""
    if name.endswith(".toml"):
        return load(Path(name))
    for path in shipped():
        if path.stem == name:
            return load(path)
    known = ", ".join(path.stem for path in shipped())
    raise RobotFileError(name, "", f"no such robot; there are: {known}. A path to a .toml file works, too")


def shipped() -> list[Path]:
    """Return the paths of the robot files in the package, sorted by name."""
    folder = resources.files("firmware_bridge") / "robots"
    return sorted(Path(str(entry)) for entry in folder.iterdir() if entry.name.endswith(".toml"))


def _path(location: Iterable[int | str]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).lstrip(".")
