"""A robot whose set-points never settle: the inherited test names active interlocks and each axis's speed."""

from itertools import cycle
from typing import Any

import pytest
from diff_drive.motion import Motion

from emulators.testing.inherited.fake_driver import FakeDriver
from emulators.testing.inherited.test_robot import settled
from firmware_bridge.robot_types import find


def test_it_is_reported_by_which_interlock_and_at_which_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = FakeDriver(find("diff_drive"))
    one_cycle, sides = robot.cycle, cycle((1.0, -1.0))

    def swings(command: Motion, **facts: Any) -> Any:
        return one_cycle(Motion(command.speed_mps * next(sides), 0.0), **facts)

    monkeypatch.setattr(robot, "cycle", swings)
    too_fast = 2.0 * robot.robot.geometry.limits.speed_mps
    with pytest.raises(AssertionError, match=r"never settles: speed limit: .+, with left \S+, right \S+$"):
        settled(robot, Motion(too_fast, 0.0))
