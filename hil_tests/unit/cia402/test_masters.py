"""Start sequences of masters in the field against each variation: who passes, and what the others report."""

import pytest

from emulators.cia402.variations import VARIATIONS
from validation.masters.starts import MASTERS, outcome

NOT_ENABLED = "could not enable the motor within 5 s"
TIMED_OUT = "mode switch timed out"
NO_MODES = "0x6502 refused with 0x06020000"
BY_EVENT = "configuration failed: 0x1800:02 refused with 0x06090030"
NO_REMOTE = "configuration failed: 0x1800:01 refused with 0x06090030"
FAIL = {
    ("late-boot-up", "ros2_canopen"): "no boot-up message within 1 s",
    ("period-first", "ros2_canopen"): NOT_ENABLED,
    ("period-first", "ros_canopen"): NOT_ENABLED,
    ("period-first", "python-canopen"): "it stayed in 'switched on' for 0.8 s",
    ("mode-first", "ros2_canopen"): NOT_ENABLED,
    ("mode-first", "ros_canopen"): NOT_ENABLED,
    ("no-mode-while-halted", "ros2_canopen"): TIMED_OUT,
    ("no-mode-while-halted", "ros_canopen"): TIMED_OUT,
    ("mode-without-power", "ros2_canopen"): TIMED_OUT,
    ("mode-without-power", "ros_canopen"): TIMED_OUT,
    ("mode-synchronizes", "python-canopen"): "it does not turn: 0 rpm where 300 are commanded",
    ("no-supported-modes", "ros2_canopen"): f"no mode is supported: {NO_MODES}",
    ("no-supported-modes", "ros_canopen"): f"no mode is supported: {NO_MODES}",
    ("no-supported-modes", "python-canopen"): NO_MODES,
    **dict.fromkeys(
        (("statusword-by-event", name) for name in ("ros2_canopen", "ros_canopen", "Lely")), BY_EVENT
    ),
    **dict.fromkeys((("keeps-no-remote", name) for name in ("ros2_canopen", "Lely")), NO_REMOTE),
}
"""By variation and master: what the field has reported of such drives, but for the last five rows' codes."""


@pytest.mark.parametrize("master", MASTERS)
def test_each_starts_the_plain_servo(master: str) -> None:
    assert outcome(master) == "passes"


@pytest.mark.parametrize("master", MASTERS)
@pytest.mark.parametrize("variation", VARIATIONS)
def test_who_passes_and_what_the_others_report(variation: str, master: str) -> None:
    assert outcome(master, variation) == FAIL.get((variation, master), "passes")
