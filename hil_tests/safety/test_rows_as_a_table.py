"""The rows that every robot has, as a table: how bad each is, what it takes, and how long it stays."""

from typing import Any

from firmware_bridge.robot_types import find
from firmware_bridge.safety.common import (
    AXIS_INTERLOCKS,
    AXIS_RESTARTED,
    EXCLUDED_AXIS,
    LATE_ANSWER,
    NO_FEEDBACK,
    whole_robot_interlocks,
)

ROBOT = find("rome_arm")
TABLE = """
emergency stop            critical   0     disarms   blocks arming
bridge stalled            critical   0     disarms   blocks arming
link lost: board          critical   200   disarms   blocks arming
link lost: arm            critical   200             blocks arming  stops arm
second controller: board  critical   200   disarms   blocks arming
second controller: arm    critical   200             blocks arming  stops arm
battery low               critical   5000  disarms   blocks arming
not armed                 notice     0
operator link timeout     warning    200
command stale             warning    200             blocks arming
command not timestamped   warning    200
operator link lost        warning    0     disarms   blocks arming
stick not neutral         warning    0
operation paused          notice     0
command unusable          warning    0               blocks arming
axis timeout              critical   200   disarms   blocks arming
axis fault                critical   0     disarms   blocks arming
axis reconfigured         critical   0     disarms   blocks arming  takes power
axis not enabled          warning    0     disarms   blocks arming
reference lost            critical   0     disarms   blocks arming
tracking error            critical   200   disarms   blocks arming
uncommanded motion        critical   200   disarms   blocks arming  takes power
position not changing     critical   200   disarms   blocks arming  takes power
axis restarted            critical   0     disarms   blocks arming
axis excluded             warning    0     disarms   blocks arming
no feedback               warning    200   disarms   blocks arming
late answer               warning    200   disarms   blocks arming
"""


def reported(row: Any) -> list[str]:
    words = [row.name, row.severity.name.lower(), str(row.clear_after // 10**6)]
    words += ["disarms"] * row.disarms + ["blocks arming"] * row.blocks_arming
    words += ["takes power"] * row.disables_power
    return words + ([] if row.stops is None else [f"stops {' '.join(sorted(row.stops))}"])


def test_each_row_is_as_bad_as_the_table_states() -> None:
    """One link stops everything, the other one its own group."""
    links = {**ROBOT.links, "arm": ROBOT.links["arm"].model_copy(update={"stops": ("arm",)})}
    common: Any = whole_robot_interlocks({}, links)
    rows = [*common, *AXIS_INTERLOCKS, AXIS_RESTARTED, EXCLUDED_AXIS, NO_FEEDBACK, LATE_ANSWER]
    wanted = [
        [word.strip() for word in line.split("  ") if word.strip()] for line in TABLE.strip().split("\n")
    ]
    assert [reported(row) for row in rows] == wanted
