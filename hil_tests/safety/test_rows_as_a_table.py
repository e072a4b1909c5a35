"""The rows that every robot has, as a table: how bad each is, what it takes, and how long it stays."""

from typing import Any

from firmware_bridge.kinds import find
from firmware_bridge.safety.common import (
    AXIS_ANSWERS,
    AXIS_RESTARTED,
    AXIS_ROWS,
    AXIS_UNMEASURED,
    LEFT_OUT_ROW,
    whole_robot_rows,
)

ROBOT = find("rome_arm")
TABLE = """
emergency stop         critical   0     disarms   blocks arming
bridge stood still     critical   0     disarms   blocks arming
link lost: board       critical   200   disarms   blocks arming
link lost: arm         critical   200             blocks arming  stops arm
another master: board  critical   200   disarms   blocks arming
another master: arm    critical   200             blocks arming  stops arm
battery low            critical   5000  disarms   blocks arming
not armed              notice     0
operator silent        warning    200
word too old           warning    200             blocks arming
word undated           warning    200
operator gone          warning    0     disarms   blocks arming
controls deflected     warning    0
paused                 notice     0
wish unusable          warning    0               blocks arming
axis silent            critical   200   disarms   blocks arming
axis fault             critical   0     disarms   blocks arming
axis rewritten         critical   0     disarms   blocks arming  takes power
axis not enabled       warning    0     disarms   blocks arming
axis zero lost         critical   0     disarms   blocks arming
axis does not follow   critical   200   disarms   blocks arming
axis moves unasked     critical   200   disarms   blocks arming  takes power
axis position repeats  critical   200   disarms   blocks arming  takes power
axis restarted         critical   0     disarms   blocks arming
axis left out          warning    0     disarms   blocks arming
axis unmeasured        warning    200   disarms   blocks arming
axis answers late      warning    200   disarms   blocks arming
"""


def reported(row: Any) -> list[str]:
    words = [row.name, row.severity.name.lower(), str(row.clear_after // 10**6)]
    words += ["disarms"] * row.disarms + ["blocks arming"] * row.blocks_arming
    words += ["takes power"] * row.takes_power
    return words + ([] if row.stops is None else [f"stops {' '.join(sorted(row.stops))}"])


def test_each_row_is_as_bad_as_the_table_states() -> None:
    """One link stops everything, the other one its own group."""
    links = {**ROBOT.links, "arm": ROBOT.links["arm"].model_copy(update={"stops": ("arm",)})}
    common: Any = whole_robot_rows({}, links)
    rows = [*common, *AXIS_ROWS, AXIS_RESTARTED, LEFT_OUT_ROW, AXIS_UNMEASURED, AXIS_ANSWERS]
    wanted = [
        [word.strip() for word in line.split("  ") if word.strip()] for line in TABLE.strip().split("\n")
    ]
    assert [reported(row) for row in rows] == wanted
