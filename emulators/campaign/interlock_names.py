"""Names of the interlocks that can become active on a robot: no other name may stand in a requirement."""

from collections.abc import Iterator
from itertools import chain

from firmware_bridge.bridge import bridge, homing, power_down, stops
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.safety.common import AXIS_INTERLOCKS, EXCLUDED_AXIS, whole_robot_interlocks
from firmware_bridge.safety.interlock import AxisInterlock

_BRIDGES = (bridge.STARTING, bridge.ENDS, power_down.HELD, power_down.STAYS)


def interlock_names(robot: AnyRobot) -> frozenset[str]:
    """Return the names, those of an axis with the axis's."""
    rules = robot_type_of(robot).rules(robot)[""]
    rows = chain(whole_robot_interlocks(rules.numbers, robot.links), rules.interlocks, rules.after_limits)
    names = {row.name for row in chain(rows, rules.limits, _BRIDGES)}
    of_axes = {row.name for row in chain(_axis_rows(), (homing.UNDER_WAY, homing.FAILED))}
    of_axes.add(stops.NOT_ACKNOWLEDGED)
    return frozenset(names | {f"{name}: {axis.name}" for name in of_axes for axis in robot.axes})


def _axis_rows() -> Iterator[AxisInterlock]:
    for row in (*AXIS_INTERLOCKS, EXCLUDED_AXIS):
        standing: AxisInterlock | None = row
        while standing is not None:
            yield standing
            standing = standing.replacement
