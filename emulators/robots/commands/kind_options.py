"""What the options of every kind of a new robot have: a name, a folder, and what they write."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class KindOptions(ABC):
    """The options of one kind; a field without a default is one that it needs."""

    name: str
    folder: Path | None = None

    @abstractmethod
    def write(self) -> None:
        """Write the robot; SpecificationError, MotorError, RobotFileError."""


def write_file(options: KindOptions, text: str) -> None:
    """Write NAME.toml, which has to stand its own check; SpecificationError, RobotFileError."""
    from emulators.specification import SpecificationError
    from firmware_bridge.cli.console import say, written_by
    from firmware_bridge.robot_types import parse

    path = (options.folder or Path()) / f"{options.name}.toml"
    # What does not stand its own check is no file to begin with.
    parse(text, path.name, plant_too=True)
    if path.exists():
        raise SpecificationError(f"{path} is there already; take another NAME or --dir, or remove it")
    with written_by("--dir"):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    say(f"{path}: check its numbers before the robot moves")
    say(f"next: firmware-bridge bench {path}")
    say(f"then: firmware-bridge emulate {path}, and firmware-bridge drive {path}")
