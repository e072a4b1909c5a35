"""One short ride for each kind of fault, its recording explained, compared with the ride without the fault.

Run as a program it writes the table that the page of `docs/explained-faults.md` shows.
"""

import csv
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from emulators.bench.faults.failures import Failure, failures_of
from emulators.testing.rig import VirtualRig
from firmware_bridge.cli.fitted import driven
from firmware_bridge.explain.explainer import Setup, explain
from firmware_bridge.explain.incident import Incident
from firmware_bridge.explain.line_explainer import Lines, explain_lines
from firmware_bridge.explain.line_source import chunks
from firmware_bridge.explain.report import grouped
from firmware_bridge.explain.source import frames
from firmware_bridge.family import LinkOptions
from firmware_bridge.robot_types import find

TABLE: Final = Path(__file__).with_suffix(".csv")
BEFORE_S: Final = 3.0
"""Time of driving before the fault: what watches a line learns what is usual."""
FOR_S: Final = 1.5
AFTER_S: Final = 4.0
FIRST: Final = 3
"""The cause has to be in the first incidents of the story: a reader begins there."""
NAMED, CANDIDATE, SEEN, NOTHING, SAME = "named", "candidate", "seen", "no incident", "same"
ORDER: Final = (NAMED, CANDIDATE, SEEN, NOTHING, SAME)
AS_IT_IS: Final = LinkOptions()
CAMERAS: Final = ("body_hidden", "body_shakes", "markers_swapped", "capture_late", "capture_loss")
OF_IMU: Final = ("imu_frozen", "imu_axes_swapped", "imu_silent")
TURNING: Final = {"forward": 0.1, "turn_deg_s": 50.0}
"""All three wheels turn."""


@dataclass(frozen=True, slots=True)
class Story:
    """A robot on its links, and how it drives."""

    column: str
    robot: str
    drives: Mapping[str, float]
    options: LinkOptions = AS_IT_IS
    only: tuple[str, ...] = ()
    """Kinds that no robot before it can have; empty: all."""


STORIES: Final = (
    Story("CAN", "rars", {"forward": 0.2}),
    Story("CAN", "rars+cameras", {"forward": 0.2}, only=CAMERAS),
    Story("CAN", "rars+imu", {"forward": 0.2}, only=OF_IMU),
    Story("CAN", "climber", {"forward": 0.05}, only=("grip_lost",)),
    Story("CAN", "servo_axis", {"forward": 0.1}, only=("drive_variation",)),
    Story("EPOS2 over serial", "rars", {"forward": 0.2}, LinkOptions("v2", lines=("drives",))),
    Story("board", "rome", TURNING, LinkOptions("mw", encoders=3)),
    Story("board", "rome", TURNING, LinkOptions("ros-arduino-bridge", encoders=3)),
    Story("board", "rome+cameras", TURNING, LinkOptions("mw", encoders=3), CAMERAS),
)
"""Of several stories of a column the one that shows a fault best counts."""

CAUSES: Final[Mapping[str, str]] = {
    "frame_error": r"termination|bad plug|cut or disturbed",
    "reception_error": r"termination|bad plug|cut or disturbed",
    "frame_loss": r"drops (?:its )?frames",
    "receive_overrun": r"0x8110|overrun",
    "bus_off": r"[Bb]us off|off the bus|left the bus|0x81FD",
    "can_cut": r"cable is cut|cut cable|CAN plug is out|plug or its supply is out",
    "can_swapped": r"exchanged|cut or disturbed",
    "babbling_node": r"sends without end",
    "nmt_foreign_node": r"second controller",
    "stray_frames": r"second controller",
    "node_silent": r"plug",
    "drive_restart": r"supply",
    "set_points_ignored": r"does not take its set-points",
    "supply_sag": r"0x3220|weak battery",
    "supply_surge": r"0x3210",
    "logic_supply_sag": r"0x5113",
    "gate_supply_sag": r"0x5114",
    "overheating": r"0x4210",
    "encoder_cut": r"[Ee]ncoder cable|encoder's cable",
    "encoder_swapped": r"[Cc]hannels",
    "encoder_counts_lost": r"counts? .*lost|[Ll]ost or additional counts",
    "encoder_frozen": r"coupling",
    "index_missing": r"index line",
    "index_spurious": r"index line",
    "board_silent": r"cable or plug",
    "board_reset": r"reset",
    "board_brown_out": r"supply (?:was out|dipped|is out)",
    "board_unpowered": r"supply (?:was out|dipped|is out)",
    "current_limit": r"limits its current",
    "over_temperature": r"is hot",
    "board_chatters": r"debug print",
    "shield_absent": r"motor driver",
    "i2c_stuck": r"I2C",
    "line_garbage": r"disturb",
    "board_hangs": r"its program (?:hung until a reset|hangs, as on|has waited)",
    "shaft_blocked": r"blocked",
    "load_lifted": r"load is off",
    "motor_supply_sag": r"motors' supply",
    "motor_cable_off": r"motor's cable",
    "motor_leads_swapped": r"leads",
    "encoder_cable_off": r"encoder's cable",
    "serial_unplugged": r"unplugged|cable or plug",
    "bridge_ends": r"has ended|program ends",
    "bridge_suspended": r"suspended",
    "second_bridge": r"second controller",
}
"""A pattern that a cause, or the incident itself, has to have; a kind without one is not named."""


@dataclass(frozen=True, slots=True, order=True)
class Row:
    """One fault of one story, and what was found."""

    column: str
    kind: str
    title: str
    robot: str
    verdict: str
    shown: str
    """The incident that names it, or the first one."""


class Ready:
    """One robot at the instant before its fault, to which each story goes back."""

    def __init__(self, story: Story) -> None:
        robot = find(story.robot)
        self._story = story
        self._logs = ("serial.log",) if story.options.lines else ("can.log", "serial.log")
        self.robot = driven(robot, story.options) if story.options.given else robot
        self._rig = VirtualRig(self.robot)
        self._rig.arms()
        self._rig.operator.drives(**story.drives)
        self._rig.runs(BEFORE_S)
        back = self._back = self._rig.keep()
        self._rig.runs(AFTER_S)
        self._bytes, self._usual = self._explained()
        back()

    def row(self, failure: Failure) -> Row:
        """Let it happen, and return what its recording shows."""
        lasts = {"for_s": FOR_S} if failure.lasts else {}
        self._rig.fault(failure.kind, **failure.keys, **lasts)
        self._rig.runs(AFTER_S)
        recorded, found = self._explained()
        self._back()
        usual = {(one.kind.name, one.at) for one in self._usual}
        new = [one for one in found if (one.kind.name, one.at) not in usual]
        verdict, shown = verdict_of(failure.kind, new)
        if verdict == NOTHING and recorded == self._bytes:
            verdict = SAME
        story = self._story
        return Row(story.column, failure.kind, failure.title, story.robot, verdict, shown)

    def _explained(self) -> tuple[tuple[bytes, ...], tuple[Incident, ...]]:
        with TemporaryDirectory() as name:
            folder = Path(name)
            kept = {path.name: path for path in self._rig.recording.keep(folder)}
            found: tuple[Incident, ...] = ()
            # The bus behind a serial port is not seen from the line.
            if "can.log" in kept and "can.log" in self._logs:
                found += explain(frames(kept["can.log"], lambda _: None), Setup()).incidents
            if "serial.log" in kept:
                log = chunks(kept["serial.log"], lambda _: None)
                found += explain_lines(log, Lines({}, Setup())).incidents
            recorded = tuple(kept[log].read_bytes() for log in self._logs if log in kept)
            return recorded, found


def verdict_of(kind: str, found: list[Incident]) -> tuple[str, str]:
    """Return how well incidents name a fault, and the one that does it best."""
    pattern = CAUSES.get(kind)
    first = [group[0] for group in grouped(sorted(found, key=lambda one: one.at))[:FIRST]]
    if not first:
        return NOTHING, ""
    for one in first if pattern is not None else ():
        for text in (one.what, *one.causes[:1]):
            if re.search(pattern or "", text):
                return NAMED, f"{one.kind.title}: {text}"
    for one in first if pattern is not None else ():
        for cause in one.causes[1:3]:
            if re.search(pattern or "", cause):
                return CANDIDATE, f"{one.kind.title}: {cause}"
    return SEEN, first[0].kind.title


def places_of(ready: Ready) -> Iterator[Failure]:
    """Yield each kind with each of its severities, at the first axis or place that can have it."""
    known: set[str] = set()
    failures = failures_of(ready.robot)
    axes = {axis.name for axis in ready.robot.axes}
    for failure in sorted(failures, key=lambda one: one.place not in axes):
        if failure.title not in known and not failure.place.startswith("bridge /"):
            known.add(failure.title)
            yield failure


def rows(story: Story, *kinds: str) -> list[Row]:
    """Return the rows of one story; `kinds` are only these."""
    ready, wanted = Ready(story), kinds or story.only
    return [ready.row(one) for one in places_of(ready) if not wanted or one.kind in wanted]


def written(found: list[Row]) -> None:
    """Write the table."""
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(Row.__slots__)
        table.writerows([getattr(row, name) for name in Row.__slots__] for row in found)


if __name__ == "__main__":
    everything = [row for story in STORIES for row in rows(story)]
    written(everything)
    sys.stdout.write(f"{len(everything)} rows\n")
