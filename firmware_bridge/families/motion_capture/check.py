"""Consistency of a robot file's captured bodies: one of them alone locates the robot."""

from collections.abc import Iterator

from firmware_bridge.robot import Problem, raw
from firmware_bridge.robot.raw import Raw


def check(table: Raw) -> Iterator[Problem]:
    """Yield each further body that would locate the robot."""
    sensors = raw.rows(table, "sensors")
    joined = [index for index, row in enumerate(sensors) if "odometry" in raw.within(row, "settings")]
    for index in joined[1:]:
        problem = f"the robot is located by sensors[{joined[0]}] already; leave odometry out here"
        yield Problem(f"sensors[{index}].settings.odometry", problem)
