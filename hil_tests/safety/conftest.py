"""RARS from its file, and a healthy snapshot of it."""

from collections.abc import Callable
from functools import partial
from typing import TypeAlias

import pytest

from firmware_bridge.robot_types import find
from hil_tests.safety import gate_bench
from hil_tests.safety.gate_bench import Rars, Snapshot
from hil_tests.safety.guard_bench import Bench

Well: TypeAlias = Callable[..., Snapshot]


@pytest.fixture(scope="session")
def robot() -> Rars:
    return find("rars")


@pytest.fixture
def bench(robot: Rars) -> Bench:
    return Bench(robot)


@pytest.fixture(scope="session")
def well(robot: Rars) -> Well:
    """Make a healthy snapshot; `intent` and one axis's fields are given as dictionaries."""
    return partial(gate_bench.well, robot)
