"""`new --kind axis`: the words of the command line to a robot file of one axis."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from firmware_bridge.cli.console import one_message, say, written_by

NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,19}")
UNITS: Final = ("rad", "m")
COMMANDS: Final = ("position", "speed")
NODES: Final = range(1, 128)


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisOptions:
    """The options of an axis, as they were given."""

    name: str
    node: str
    family: str
    command: str
    unit: str
    travel: str | None
    inertia: float | None
    motor: str
    gear: float
    encoder_lines: int
    voltage: float
    speed: float
    acceleration: float
    folder: Path | None


def write_axis(given: AxisOptions) -> None:
    """Write the robot file; an error ends the program with a message."""
    from emulators import motors
    from emulators.family import families
    from emulators.motors import MotorError
    from emulators.robots.servo_axis.starter import AxisSpecification, SpecificationError, robot_file
    from firmware_bridge.robot import RobotFileError
    from firmware_bridge.robot_types import parse

    path = (given.folder or Path()) / f"{given.name}.toml"
    with one_message(SpecificationError, MotorError, RobotFileError):
        if NAME.fullmatch(given.name) is None:
            raise SpecificationError(
                f"NAME: '{given.name}' is no name: small letters, digits and _, a letter first, at most 20"
            )
        able = {name: one for name, one in families().items() if one.axis_table is not None}
        _one_of("--family", given.family, list(able))
        _one_of("--unit", given.unit, UNITS)
        _one_of("--command", given.command, COMMANDS)
        for option, value in (
            ("--gear", given.gear),
            ("--inertia", given.inertia),
            ("--voltage", given.voltage),
            ("--speed", given.speed),
            ("--acceleration", given.acceleration),
        ):
            if value is None or not 0.0 < value < float("inf"):
                raise SpecificationError(f"{option}: an axis needs it, and it must be positive")
        if not given.node.isdecimal() or int(given.node) not in NODES:
            raise SpecificationError(f"--nodes: one CANopen node, 1 to 127, not '{given.node}'")
        by_position = given.command == "position"
        travel = _travel(given.travel)
        if by_position is (travel is None):
            needs = "needs --travel" if by_position else "takes no --travel"
            raise SpecificationError(f"--command {given.command} {needs}: LOW,HIGH in {given.unit}")
        specified = AxisSpecification(
            name=given.name,
            unit=given.unit,
            by_position=by_position,
            node=int(given.node),
            motor=motors.motor(given.motor),
            gear=given.gear,
            encoder_lines=given.encoder_lines,
            load=given.inertia or 0.0,
            voltage_v=given.voltage,
            speed=given.speed,
            acceleration=given.acceleration,
            travel=travel,
        )
        text = robot_file(specified, able[given.family])
        # What does not stand its own check is no file to begin with.
        parse(text, path.name, plant_too=True)
        if path.exists():
            raise SpecificationError(f"{path} is there already; take another NAME or --dir, or remove it")
        with written_by("--dir"):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
    say(f"{path}: check its numbers before the axis moves")
    say(f"next: firmware-bridge bench {path}")
    say(f"then: firmware-bridge emulate {path}, and firmware-bridge drive {path}")


def _one_of(option: str, word: str, known: tuple[str, ...] | list[str]) -> None:
    from emulators.robots.servo_axis.starter import SpecificationError
    from firmware_bridge.robot.problems import near

    if word not in known:
        raise SpecificationError(f"{option}: no '{word}'; {near(word, known)}")


def _travel(words: str | None) -> tuple[float, float] | None:
    from emulators.robots.servo_axis.starter import SpecificationError

    if words is None:
        return None
    try:
        low, high = (float(word) for word in words.split(","))
    except ValueError:
        raise SpecificationError(f"--travel {words}: LOW,HIGH, as -0.8,1.8") from None
    if not low < high:
        raise SpecificationError(f"--travel {words}: the first must be below the second")
    return low, high
