"""Bridge, bench and plants know no robot: none of the words of one of this tree stands outside its folders.

The words come from the robots themselves: axes, roles, groups, fields of motion, state and geometry,
switches, actuators, channels of the hand, keys of a mission's step. Names are split at `_` and at capitals.
The product's robots and those of the examples count, whichever of them are installed.
"""

import ast
import re
import tomllib
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Final

import pytest
from pydantic import BaseModel

from emulators.bench.rehearsal import GROUP as REHEARSALS
from emulators.bench.rehearsal import Rehearsal
from emulators.bench.step import Step
from firmware_bridge import kinds
from firmware_bridge.kind import AnyKind
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.file import robot_of, table_of, text_of

ROOT: Final = Path(__file__).parents[2]
PACKAGES: Final = ("firmware_bridge", "emulators", "fmu")
THEIR_OWN: Final = (
    "firmware_bridge/robots/",
    "firmware_bridge/motion/",
    "emulators/robots/",
    "emulators/starter/",
    "emulators/cli/new",
    "fmu/ar2/",
    "fmu/parts/",
    "fmu/climber/",
    "fmu/rars/",
    "fmu/rome_arm/",
    "fmu/rome_base/",
    "fmu/single_axis/",
)
"""Robots and single plants, kinematics and parts that they share, and what writes a robot with two wheels."""
SHORTEST: Final = 3
"""Shorter words are units and symbols."""

FREE: Final = {
    "acceleration": "the quantity, of any axis",
    "ahead": "before others, in time or on the way",
    "alpha": "how much shines through, as Matplotlib has it",
    "angle": "the quantity, of any shaft",
    "angles": "as above",
    "arm": "what an operator does to a robot before it moves; a robot of joints",
    "axis": "what one motor moves, in every robot file",
    "base": "a base class, the base of a number, SI's base units, CAN's base frame, MAVLink's base_mode",
    "battery": "every robot file knows it",
    "bound": "what nothing may pass",
    "cable": "of any device",
    "carrier": "whoever carries a node; the example's name is no rare word",
    "circle": "the figure",
    "control": "of motion, of a link, of errors; MANUAL_CONTROL",
    "deg": "the unit",
    "diameter": "the quantity, of anything round",
    "distance": "the quantity, and MAVLink's WHEEL_DISTANCE",
    "extended": "CAN's extended identifiers and MAVLink's EXTENDED_SYS_STATE",
    "friction": "in any axis",
    "gravity": "the standard one, and the plants'",
    "half": "a share",
    "heading": "of any robot; of a table",
    "height": "of a picture",
    "highest": "of any numbers",
    "joint": "of any arm, and what its board calls its axes",
    "lamp": "an example of what is switched",
    "least": "of any numbers",
    "left": "what remains, what is left out; the left side of anything",
    "length": "of a frame",
    "limits": "any bounds",
    "line": "a serial line, a line of text",
    "link": "the way to devices, in every robot file",
    "lowest": "of any numbers",
    "margin": "of any bound",
    "mass": "the quantity",
    "mps": "the unit m/s",
    "one": "the number, and anything",
    "path": "of a file; what any guide follows",
    "paths": "as above",
    "per": "one for each",
    "pitch": "of a body's attitude, as MAVLink has it",
    "points": "a verb, and of any curve",
    "pose": "where anything is, and how it is turned",
    "press": "a button of the operator's stick",
    "rad": "the unit",
    "radius": "a rolling axis has one on MAVLink",
    "ramp": "of any speed",
    "rate": "of bits, of samples, of change",
    "rates": "as above",
    "rest": "standing still; what remains",
    "right": "correct; the right side of anything",
    "roll": "of a body's attitude, as MAVLink has it; a verb of wheels",
    "round": "to whole numbers; about something",
    "sensor": "in every robot file",
    "side": "of a link, of anything",
    "sideways": "a direction that some robots cannot go",
    "slow": "of anything that takes its time",
    "speed": "the quantity, and a way to command an axis",
    "stages": "power stages, and the stages of a replay",
    "start": "the begin of a run",
    "three": "the number",
    "track": "of any path: what is across it is cross-track",
    "turn": "one revolution of a shaft; whose turn it is; the stick's turn",
    "turns": "a verb; revolutions of a shaft",
    "tool": "of any arm; a program of this tree",
    "two": "the number",
    "wall": "the clock on it",
    "width": "of a picture, of a pulse",
    "yaw": "MAVLink's yaw rate, of whatever moves on a plane",
}
"""Words that belong to no robot alone, and why."""

STANDARD: Final = {
    "MAVLINK_MSG_ID_WHEEL_DISTANCE": "a message of MAVLink",
    "MAVLink_wheel_distance_message": "a message of MAVLink",
}
"""Names of other people that are used as they are."""

WHOLE: Final = {
    ("firmware_bridge/robot/settings/ar2.py", "ar2"): "the driver of that arm's board, on whatever robot",
    ("emulators/bench/columns.py", "left"): "says which way is positive",
    ("emulators/bench/fault_marks.py", "right"): "Matplotlib's alignment",
    ("emulators/bench/plots.py", "left"): "Matplotlib's side of a plot",
    ("emulators/bench/report.py", "left"): "rich's alignment",
    ("emulators/bench/report.py", "right"): "rich's alignment",
    ("emulators/bench/time_pictures.py", "left"): "Matplotlib's alignment",
    ("emulators/bench/time_pictures.py", "right"): "Matplotlib's side of a plot",
    ("emulators/cli/fmea_work.py", "right"): "rich's alignment",
    ("emulators/documents/object_table.py", "base"): "a key of the object table's JSON",
    ("emulators/progress_bar.py", "left"): "what remains",
    ("emulators/servo/recorder.py", "left"): "a field: what remains",
    ("emulators/wires/disturbance.py", "left"): "a field: what remains",
    ("firmware_bridge/robot/check.py", "one"): "a side of an exclusion in a robot file",
    ("firmware_bridge/dissector/canopen.py", "base"): "CAN's base frame",
}
"""Strings that are wholly a robot's name, where they mean something else: file, string, reason."""

COMMAND: Final = "`firmware-bridge "
"""A help text with commands to copy names a robot that is shipped."""


@dataclass(frozen=True, slots=True)
class Found:
    """A robot's word where none may be."""

    place: str
    word: str
    text: str

    def __str__(self) -> str:
        return f"{self.place}: '{self.word}' in {self.text!r:.80}"


def split(name: str) -> list[str]:
    """Return the words of a name or a text, in lower case."""
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)
    return [part.lower() for part in parts if len(part) >= SHORTEST]


def names_of(kind: AnyKind, robot: AnyRobot, rehearsal: Rehearsal) -> Iterator[str]:
    """Yield every name that the robot gives to something of its own."""
    yield from looked_up(kind, robot)
    yield from (sensor.name for sensor in robot.sensors)
    yield from (field.name for field in fields(kind.rest))
    state = typing.get_type_hints(kind.body(robot).sensed)["return"]
    yield from (field.name for field in fields(state))
    yield from keys_of(kind.geometry)
    yield from (actuator.name for actuator in kind.station.actuators)
    yield from (channel.name for channel in rehearsal.channels)
    yield from set(rehearsal.step.model_fields) - set(Step.model_fields)


def looked_up(kind: AnyKind, robot: AnyRobot) -> Iterator[str]:
    """Yield those by which somebody could look something up: wholly such a name, a string is suspect."""
    yield kind.name
    for axis in robot.axes:
        yield from (axis.name, axis.role)
    yield from (output.name for output in robot.outputs)
    yield from kind.groups
    yield from (switch.name for switch in kind.station.switches)


def keys_of(table: type[BaseModel]) -> Iterator[str]:
    """Yield the keys of a table and of the tables in it."""
    for name, field in table.model_fields.items():
        yield name
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            yield from keys_of(field.annotation)


def of_this_tree() -> Iterator[tuple[AnyKind, AnyRobot, Rehearsal]]:
    """Yield the robots whose entry points stand in the tree: who has installed what must not matter."""
    for project in (ROOT / "pyproject.toml", *sorted(ROOT.glob("examples/*/pyproject.toml"))):
        groups = tomllib.loads(project.read_text(encoding="utf-8"))["project"]["entry-points"]
        for name, value in groups.get(kinds.GROUP, {}).items():
            kind: AnyKind = EntryPoint(name, value, kinds.GROUP).load()
            rehearsal: Rehearsal = EntryPoint(name, groups[REHEARSALS][name], REHEARSALS).load()
            file = str(kind.file)
            yield (
                kind,
                robot_of(table_of(text_of(kind.file), file), file, kind.geometry, kind.groups),
                rehearsal,
            )


ROBOTS: Final = tuple(of_this_tree())
WORDS: Final = frozenset(
    word
    for kind, robot, rehearsal in ROBOTS
    for name in names_of(kind, robot, rehearsal)
    for word in split(name)
)
NAMES: Final = frozenset(name for kind, robot, _ in ROBOTS for name in looked_up(kind, robot))
SHIPPED: Final = frozenset(kind.name for kind, _, _ in ROBOTS)


def texts_of(tree: ast.AST) -> Iterator[tuple[int, str, bool]]:
    """Yield line, text, and whether it is a string, for every name and string of a program."""
    for node in ast.walk(tree):
        line = getattr(node, "lineno", 0)
        match node:
            case ast.Constant(value=str(text)):
                yield line, text, True
            case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name):
                yield line, name, False
            case ast.keyword(arg=str(name)) | ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                yield line, name, False
            case ast.alias(name=name, asname=other):
                yield line, f"{name} {other or ''}".strip(), False
            case _:
                pass


def keys_in(table: Mapping[str, object]) -> Iterator[str]:
    for key, value in table.items():
        yield key
        for inner in value if isinstance(value, list) else [value]:
            if isinstance(inner, dict):
                yield from keys_in(inner)


def texts_in(path: str, source: str) -> Iterator[tuple[int, str, bool]]:
    """Yield the same for any file: a program's names and strings, TOML's keys, everything in C."""
    if path.endswith(".py"):
        yield from texts_of(ast.parse(source))
    elif path.endswith(".toml"):
        yield from ((0, key, False) for key in keys_in(tomllib.loads(source)))
    else:
        yield from ((line, text, False) for line, text in enumerate(source.splitlines(), 1))


def found_in(path: str, source: str) -> Iterator[Found]:
    """Yield the robots' words in a file that are not free in it."""
    for line, text, string in texts_in(path, source):
        if text in STANDARD or (path, text) in WHOLE:
            continue
        place = f"{path}:{line}"
        if string and text in NAMES:
            yield Found(place, text, text)
            continue
        command = string and COMMAND in text
        for word in sorted(set(split(text)) & WORDS - FREE.keys()):
            if not (command and word in SHIPPED):
                yield Found(place, word, text)


def files() -> dict[str, str]:
    """Return the text of every file that must know no robot, by its path."""
    found = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*")):
            name = path.relative_to(ROOT).as_posix()
            if path.suffix in {".py", ".toml", ".c", ".h"} and not name.startswith(THEIR_OWN):
                found[name] = path.read_text(encoding="utf-8")
    return found


FILES: Final = files()


def test_the_words_are_those_of_the_robots_of_this_tree() -> None:
    assert {"ar2", "rars", "carrier", "climber", "rome", "rome_arm"} == SHIPPED
    assert {"rars", "steer", "lift", "headlamp", "pinion", "screw", "wheel", "retracted"} <= WORDS
    assert len(FILES) > 200


def test_nothing_outside_the_robots_folders_has_a_robots_word() -> None:
    found = [str(one) for path, source in FILES.items() for one in found_in(path, source)]
    assert found == []


@pytest.mark.parametrize(
    "planted",
    [
        "lift = 3",
        "class LiftRamp: pass",
        "def raised(lift_m): pass",
        "go(steer_rad=0.1)",
        "import steering",
        "from things import brake as wheel",
        "motion.headlamp = True",
        "robot.axis('left')",
        "groups = {'base'}",
        "text = f'the scissor {1} is out, the pinion too'",
        "{'kingpin_distance_m': 1.0}",
        "def f():\n    'Lower the lift.'",
        "text = 'try rars'",
    ],
)
def test_a_planted_word_is_found(planted: str) -> None:
    assert list(found_in("firmware_bridge/bridge/planted.py", planted))


@pytest.mark.parametrize(
    "innocent",
    [
        "attempts_left = 3",
        "text = 'two are left, turn right'",
        "MAVLINK_MSG_ID_WHEEL_DISTANCE",
        "text = '`firmware-bridge drive rars` drives it'",
        "shiftless = uplifting",
    ],
)
def test_an_innocent_word_is_not(innocent: str) -> None:
    assert list(found_in("firmware_bridge/bridge/planted.py", innocent)) == []


def test_a_planted_key_and_a_planted_word_in_c_are_found() -> None:
    assert list(found_in("emulators/bench/planted.toml", "[limits]\nlift_rate_mps = 1"))
    assert list(found_in("emulators/servo/native/planted.c", "/* one */\nint steer_angle;"))


def test_no_exception_outlives_its_need() -> None:
    texts = [(path, text) for path, source in FILES.items() for _, text, _ in texts_in(path, source)]
    used = {word for _, text in texts for word in split(text)}
    assert {word for word in FREE if word not in used & WORDS} == set()
    assert STANDARD.keys() <= {text for _, text in texts}
    assert WHOLE.keys() <= set(texts)
    assert {text for _, text in WHOLE} <= NAMES


def test_the_folders_that_are_left_out_are_there() -> None:
    assert [start for start in THEIR_OWN if not list(ROOT.glob(f"{start}*"))] == []
