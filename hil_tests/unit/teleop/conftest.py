"""RARS and its operator, joined to a ground station."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from hil_tests.unit.teleop.bench import RarsBench, rars

if TYPE_CHECKING:
    from collections.abc import Callable


@pytest.fixture
def bench() -> RarsBench:
    return rars()


@pytest.fixture
def make_bench() -> Callable[[], RarsBench]:
    return rars
