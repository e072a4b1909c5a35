"""Tests that the product brings for every installed robot."""

from typing import Final

import pytest

from emulators.testing.inherited import test_robot as inherited
from firmware_bridge.robot_types import names

LONG: Final = {"rars": ("line",), "climber": ("vertical",)}
"""Missions driven here of robots with long ones; the others are in hil_tests/scenarios."""
KEPT: Final = {
    "test_the_common_interlocks_stop_all_of_it_whatever_it_is_requested": [
        "ar2",
        "diff_drive",
        "rars",
        "rome",
    ],
    "test_its_missions_drive_without_a_refusal_and_it_ends_without_power": ["diff_drive-line"],
}
"""Tests that have no time in the first lane, and the cases that it keeps of them."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    inherited.generate(metafunc, names(), LONG)


for name, test in vars(inherited).items():
    if name.startswith("test_"):
        globals()[name] = pytest.mark.long(keeps=KEPT[name])(test) if name in KEPT else test
