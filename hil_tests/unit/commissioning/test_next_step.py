"""What brings a drive nearer to motion: each step does, on a drive, until it moves."""

import re

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState, Status
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.next_step import BY_EDGE, BY_MODE, BY_STATE, next_step
from firmware_bridge.families.epos2.commissioning.overview import Overview
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.commissioning.rig import NEAR, Rig
from hil_tests.unit.commissioning.test_state_and_network import TO, brought, power, written

TARGET = 0x4000
AGAIN = "bit 4 was set already; it needs a 0 -> 1 change"
ENABLED = PowerState.OPERATION_ENABLED


def suggested(rig: Rig) -> str:
    overview = Overview(alone=False)
    rig.does(CanAccess(NEAR), overview.script())
    return overview.next_step


def followed(rig: Rig) -> str:
    """Write the Controlword that is suggested; return the suggestion."""
    text = suggested(rig)
    word = re.search(r"0x([0-9A-F]{4}) to 0x6040", text)
    assert word is not None, text
    rig.does(CanAccess(NEAR), written(od.CONTROLWORD, int(word[1], 16), 2))
    rig.waits(50 * MILLISECOND)
    return text


@pytest.mark.parametrize("begin", TO)
def test_step_by_step_the_drive_is_enabled(begin: PowerState) -> None:
    rig = brought(Rig(), begin)
    for _ in range(3):
        if power(rig) is not ENABLED:
            followed(rig)
    assert power(rig) is ENABLED


@pytest.mark.parametrize("enabled_by", [0x000F, 0x001F], ids=["bit 4 down", "bit 4 set before enabling"])
def test_step_by_step_a_position_move_begins(enabled_by: int) -> None:
    rig = brought(Rig(), PowerState.SWITCHED_ON)
    rig.does(CanAccess(NEAR), written(od.MODE, Mode.PROFILE_POSITION, 1))
    rig.does(CanAccess(NEAR), written(od.CONTROLWORD, enabled_by, 2))
    rig.waits(50 * MILLISECOND)
    if enabled_by == 0x001F:
        # The drive takes a set-point that is commanded while it enables; bit 4 has to fall then.
        assert "bit 4" in followed(rig)
    rig.does(CanAccess(NEAR), written(od.TARGET_POSITION, TARGET, 4))
    assert followed(rig).endswith("bit 4 needs a 0 -> 1 change")
    rig.waits(200 * MILLISECOND)
    status = rig.value(NEAR, od.STATUSWORD)
    assert isinstance(status, int)
    assert status & Status.SETPOINT_ACKNOWLEDGED
    assert "has to fall before the next one" in suggested(rig)


def test_every_state_and_mode_has_its_step() -> None:
    assert BY_STATE.keys() == set(PowerState) - {ENABLED}
    assert BY_MODE.keys() | BY_EDGE.keys() | {Mode.DIAGNOSTIC} == set(Mode)


@pytest.mark.parametrize(
    ("mode", "controlword", "statusword", "step"),
    [
        (Mode.PROFILE_VELOCITY, 0x010F, 0, "0x000F to 0x6040: halt, bit 8, holds it"),
        (Mode.PROFILE_VELOCITY, 0x000F, 0, "a target velocity to 0x60FF, then 0x000F to 0x6040"),
        (Mode.HOMING, 0x000F, 0, "a method to 0x6098, then 0x001F to 0x6040: bit 4 needs a 0 -> 1 change"),
        (
            Mode.HOMING,
            0x001F,
            Status.HOMING_ATTAINED,
            "0x000F to 0x6040, a method to 0x6098, then 0x001F: " + AGAIN,
        ),
        (Mode.DIAGNOSTIC, 0x000F, 0, ""),
        (None, 0x000F, 0, ""),
        (Mode.HOMING, None, 0, ""),
    ],
)
def test_the_step_of_an_enabled_drive(
    mode: Mode | None, controlword: int | None, statusword: int, step: str
) -> None:
    assert next_step(ENABLED, mode, controlword, statusword) == step


def test_of_an_unknown_state_nothing_is_suggested() -> None:
    assert next_step(None, Mode.HOMING, 0x000F, 0) == ""
