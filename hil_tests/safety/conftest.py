"""A robot that is well in every respect, to be made unwell in one."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeAlias

import pytest

from firmware_bridge.intent import Intent
from firmware_bridge.motion.odometry import Pose
from firmware_bridge.robot import Robot, find
from firmware_bridge.safety.snapshot import DriveSnapshot, Snapshot
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.cia402 import State
from hil_tests.safety.guard_bench import Bench

Well: TypeAlias = Callable[..., Snapshot]


@pytest.fixture(scope="session")
def robot() -> Robot:
    return find("rars")


@pytest.fixture
def bench(robot: Robot) -> Bench:
    return Bench(robot)


@pytest.fixture(scope="session")
def well(robot: Robot) -> Well:
    """Make a healthy snapshot; `intent` and one drive's fields are given as dictionaries."""

    def made(
        now: Nanoseconds,
        *,
        intent: dict[str, Any] | None = None,
        drives: dict[str, dict[str, Any]] | None = None,
        **changes: Any,
    ) -> Snapshot:
        told = drives or {}
        snapshot = Snapshot(
            now=now,
            intent=replace(Intent(heard_at=now), **(intent or {})),
            armed=True,
            emergency_stopped=False,
            drives=tuple(
                replace(
                    DriveSnapshot(axis.name, axis.node, State.OPERATION_ENABLED, now, 0, 0.0, 0, 0),
                    **told.get(axis.name, {}),
                )
                for axis in robot.axes
            ),
            steer_rad=0.0,
            lift_m=0.0,
            speed_mps=0.0,
            yaw_rate_rad_s=0.0,
            pose=Pose(),
            demanded_speed_mps=0.0,
            battery_v=24.0,
        )
        return replace(snapshot, **changes)

    return made
