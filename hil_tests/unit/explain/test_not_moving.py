"""Mistakes that no device reports: a drive that is commanded and stands still, each with its reason."""

from collections.abc import Callable
from pathlib import Path

import pytest

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.explain.explainer import Setup
from firmware_bridge.explain.reasons import REASONS
from hil_tests.rows import every
from hil_tests.unit.explain.bus_log import (
    CONTROLWORD,
    ENABLED,
    FAULT,
    MODE,
    MODE_DISPLAY,
    OFF,
    ON,
    POSITION,
    READY,
    STATUSWORD,
    STOPPED,
    TARGET_POSITION,
    TARGET_VELOCITY,
    VELOCITY,
    BusLog,
)
from hil_tests.unit.explain.explained import explained, named

PROFILE_VELOCITY, MAX_PROFILE_VELOCITY = Address(0x6081), Address(0x607F)
Write = Callable[[BusLog], object]


def at_once(log: BusLog) -> object:
    """The most common one: enable operation without the two steps before it."""
    log.started().write(MODE, 3).write(TARGET_VELOCITY, 500)
    return log.write(CONTROLWORD, 0x0F).shows(STATUSWORD, OFF).stands()


def switched_on_only(log: BusLog) -> object:
    log.started().write(MODE, 3).write(CONTROLWORD, 0x06).shows(STATUSWORD, READY)
    return log.write(CONTROLWORD, 0x07).shows(STATUSWORD, ON).write(TARGET_VELOCITY, 500).stands()


def pre_operational(log: BusLog) -> object:
    log.boot().shows(STATUSWORD, 0x0540).write(MODE, 3)
    for word in (0x06, 0x07, 0x0F):
        log.frame(0x201, f"{word:02X}00").wait(0.01)
    for _ in range(40):
        log.frame(0x501, "0F00F4010000").wait(0.05).status(0x0540)
    return log


def switched_off_pdo(log: BusLog) -> object:
    log.started().write(MODE, 3).write(Address(0x1403, 1), 0x501 | cia301.COB_ID_INVALID).enabled()
    for _ in range(40):
        log.frame(0x501, "0F00F4010000").wait(0.05).status(ENABLED)
    return log


def in_fault(log: BusLog) -> object:
    log.started().write(MODE, 3).write(TARGET_VELOCITY, 500).shows(STATUSWORD, FAULT)
    return log.write(CONTROLWORD, 0x06).write(CONTROLWORD, 0x0F).shows(STATUSWORD, FAULT).stands()


def quick_stopped(log: BusLog) -> object:
    log.started().write(MODE, 3).enabled().write(CONTROLWORD, 0x02).shows(STATUSWORD, STOPPED)
    return log.write(CONTROLWORD, 0x0F).write(TARGET_VELOCITY, 500).shows(STATUSWORD, STOPPED).stands()


def not_remote(log: BusLog) -> object:
    log.shows(STATUSWORD, 0x0540).write(MODE, 3)
    log.write(CONTROLWORD, 0x06).write(CONTROLWORD, 0x07).write(CONTROLWORD, 0x0F)
    return log.shows(STATUSWORD, 0x0537).write(TARGET_VELOCITY, 500).stands()


def halted(log: BusLog) -> object:
    log.started().write(MODE, 3).enabled().write(TARGET_VELOCITY, 500).write(CONTROLWORD, 0x010F)
    return log.shows(STATUSWORD, ENABLED).stands()


def another_mode(log: BusLog) -> object:
    log.started().write(MODE, 8).shows(MODE_DISPLAY, 1).enabled()
    return log.write(TARGET_POSITION, 20_000).stands()


def without_mode(log: BusLog) -> object:
    return log.started().enabled().write(TARGET_VELOCITY, 500).stands()


def target_of_another_mode(log: BusLog) -> object:
    log.started().write(MODE, 3).map_rpdo(3, 0x401, 255, 0x6040_0010, 0x607A_0020).enabled()
    for _ in range(40):
        log.frame(0x401, "0F00204E0000").wait(0.05).shows(VELOCITY, 0)
    return log


def without_target(log: BusLog) -> object:
    return log.started().write(MODE, 3).enabled().stands()


def without_new_set_point(log: BusLog) -> object:
    return log.started().write(MODE, 1).enabled().write(TARGET_POSITION, 20_000).stands()


def set_point_before_power(log: BusLog) -> object:
    log.started().write(MODE, 1).write(TARGET_POSITION, 20_000)
    for word, status in ((0x06, READY), (0x07, ON), (0x1F, ENABLED)):
        log.write(CONTROLWORD, word).shows(STATUSWORD, status)
    return log.stands()


def set_point_without_edge(log: BusLog) -> object:
    """The first target is reached; for the second one bit 4 was never 0."""
    log.started().write(MODE, 1).enabled().write(TARGET_POSITION, 1000).write(CONTROLWORD, 0x1F)
    for place in range(0, 1001, 100):
        log.shows(POSITION, place).wait(0.05)
    log.write(TARGET_POSITION, 5000).write(CONTROLWORD, 0x1F)
    for _ in range(30):
        log.shows(POSITION, 1000).wait(0.1)
    return log


def homing_without_start(log: BusLog) -> object:
    log.started().write(MODE, 6).write(Address(0x6098), 35).enabled()
    return log.stands()


def no_velocity(log: BusLog) -> object:
    log.started().write(MODE, 1).write(PROFILE_VELOCITY, 0).enabled().write(TARGET_POSITION, 20_000)
    return log.write(CONTROLWORD, 0x1F).shows(STATUSWORD, ENABLED).stands()


def velocity_limit(log: BusLog) -> object:
    log.started().write(MODE, 3).write(MAX_PROFILE_VELOCITY, 0).enabled().write(TARGET_VELOCITY, 500)
    return log.stands()


def no_acceleration(log: BusLog) -> object:
    log.started().write(MODE, 3).write(Address(0x6083), 0).enabled().write(TARGET_VELOCITY, 500)
    return log.stands()


def beyond_limits(log: BusLog) -> object:
    log.started().write(MODE, 1).write(Address(0x607D, 1), -1000).write(Address(0x607D, 2), 1000).enabled()
    return log.write(TARGET_POSITION, 20_000).write(CONTROLWORD, 0x1F).stands()


def without_sync(log: BusLog) -> object:
    log.started().write(MODE, 3).map_rpdo(4, 0x501, 1, 0x6040_0010, 0x60FF_0020).enabled()
    for _ in range(40):
        log.frame(0x501, "0F00F4010000").wait(0.05).shows(VELOCITY, 0)
    return log


def blocked(log: BusLog) -> object:
    log.started().write(MODE, 1).enabled().write(TARGET_POSITION, 20_000).write(CONTROLWORD, 0x1F)
    return log.shows(STATUSWORD, ENABLED | 1 << 13).stands()


def limited(log: BusLog) -> object:
    log.started().write(MODE, 3).enabled().write(TARGET_VELOCITY, 500)
    return log.shows(STATUSWORD, ENABLED | 1 << 11).stands()


MISTAKES: dict[str, tuple[Write, str]] = {
    "no_transition": (
        at_once,
        "controlword 0x000F in switch on disabled has no transition: write 0x0006 first",
    ),
    "not_enabled": (switched_on_only, "not enabled: switched on; next: controlword 0x000F"),
    "not_operational": (pre_operational, "NMT state is pre-operational: PDOs are ignored"),
    "pdo_invalid": (switched_off_pdo, "RPDO 4 is switched off (bit 31 of 0x1403:01)"),
    "fault": (in_fault, "it is in fault"),
    "quick_stop": (quick_stopped, "quick stop is active"),
    "not_remote": (not_remote, "statusword bit 9 (remote) is 0"),
    "halt": (halted, "controlword bit 8 (halt) is set"),
    "mode_not_confirmed": (another_mode, "mode 8 was written to 0x6060, but 0x6061 shows 1"),
    "no_mode": (without_mode, "no mode of operation was set"),
    "wrong_target": (target_of_another_mode, "0x607A was written, but mode 3 takes its target from 0x60FF"),
    "no_target": (without_target, "no target was written: mode 3 takes it from 0x60FF"),
    "no_set_point": (without_new_set_point, "bit 4 of the controlword (new set-point) was not set after it"),
    "no_edge": (set_point_before_power, "was set before it was enabled"),
    "no_edge, second target": (set_point_without_edge, "was set before the target was written"),
    "homing_not_started": (homing_without_start, "bit 4 of the controlword (start) is 0"),
    "zero_velocity": (no_velocity, "0x6081 is 0"),
    "zero_velocity, limit": (velocity_limit, "0x607F is 0"),
    "zero_acceleration": (no_acceleration, "0x6083 is 0"),
    "beyond_limits": (beyond_limits, "target 20000 is beyond the limits 0x607D: -1000 to 1000"),
    "no_sync": (without_sync, "RPDO 4 waits for SYNC, and no SYNC (080#) came"),
    "following_error": (blocked, "following error, statusword bit 13"),
    "internal_limit": (limited, "internal limit active, statusword bit 11"),
}
"""By the name of the reason: frames, and the first cause."""
NOT_TRIED = {"at_target"}
"""No incident by itself: a remark."""


@every("name", MISTAKES)
def test_the_reason_is_the_first_cause(name: str, tmp_path: Path) -> None:
    write, cause = MISTAKES[name]
    log = BusLog()
    write(log)
    found = named(explained(log, tmp_path, Setup(device="epos2")), "not_moving")
    assert [one.node for one in found] == [1]
    assert cause in found[0].causes[0]
    assert cause in found[0].what
    assert found[0].check
    assert found[0].evidence is not None


def test_every_reason_has_its_mistake() -> None:
    tried = {name.partition(",")[0] for name in MISTAKES}
    assert {reason.name for reason in REASONS} == tried | NOT_TRIED


def test_a_drive_that_moves_has_no_incident(tmp_path: Path) -> None:
    log = BusLog().started().write(MODE, 3).enabled().write(TARGET_VELOCITY, 500)
    for place in range(0, 30_000, 1000):
        log.shows(POSITION, place).wait(0.1)
    log.write(TARGET_VELOCITY, 0).write(CONTROLWORD, 0x06).shows(STATUSWORD, READY)
    assert explained(log, tmp_path).incidents == ()


def test_a_drive_at_its_target_has_no_incident_but_a_remark(tmp_path: Path) -> None:
    log = BusLog().started().write(MODE, 1).shows(POSITION, 700).enabled().write(TARGET_POSITION, 700)
    log.write(CONTROLWORD, 0x1F).wait(3.0).shows(POSITION, 700)
    found = explained(log, tmp_path)
    assert found.incidents == ()
    assert found.remarks == ("node 1 was enabled and never moved: its target 0x607A is 700",)


def test_a_drive_that_moves_no_more_is_named_with_its_reason(tmp_path: Path) -> None:
    log = BusLog().started().write(MODE, 3).enabled().write(TARGET_VELOCITY, 500)
    for place in range(0, 5000, 500):
        log.shows(POSITION, place).wait(0.1)
    log.write(CONTROLWORD, 0x010F).wait(0.1)
    for _ in range(30):
        log.shows(POSITION, 4500).wait(0.1)
    (one,) = named(explained(log, tmp_path), "not_moving")
    assert "does not move any more" in one.what
    assert "halt" in one.causes[0]


def test_a_command_that_is_withdrawn_counts_all_the_same(tmp_path: Path) -> None:
    """As a script that gives up: it disables the drive before the recording ends."""
    log = BusLog().started().write(MODE, 1).enabled().write(TARGET_POSITION, 20_000).stands()
    log.write(CONTROLWORD, 0x00).shows(STATUSWORD, OFF).wait(5.0).shows(STATUSWORD, OFF)
    (one,) = named(explained(log, tmp_path), "not_moving")
    assert "bit 4" in one.causes[0]


def test_a_node_that_is_not_there_is_named(tmp_path: Path) -> None:
    log = BusLog(5)
    for _ in range(3):
        log.request(CONTROLWORD, 0x06).wait(0.5)
    (one,) = explained(log, tmp_path).incidents
    assert one.kind.name == "no_node"
    assert one.where == "node 5"
    assert "no node with this number" in one.causes[0]


@pytest.mark.parametrize("stopped", [True, False])
def test_a_stopped_node_takes_no_set_point(tmp_path: Path, *, stopped: bool) -> None:
    log = BusLog().started().write(MODE, 3).enabled()
    if stopped:
        log.nmt(NmtCommand.STOP)
    for place in range(0, 4000, 100):
        log.frame(0x501, "0F00F4010000").wait(0.05)
        if not stopped:
            log.shows(POSITION, place)
    texts = [one.causes[0] for one in named(explained(log, tmp_path, Setup(device="epos2")), "not_moving")]
    assert texts == (["its NMT state is stopped: PDOs are ignored"] if stopped else [])


def test_the_page_lists_every_reason() -> None:
    page = (Path(__file__).parents[3] / "docs/explain.md").read_text(encoding="utf-8")
    rows = [(f"| `{reason.name}` | ", f" | {reason.remedy} |") for reason in REASONS]
    lines = page.splitlines()
    assert [
        row for row in rows if not any(it.startswith(row[0]) and it.endswith(row[1]) for it in lines)
    ] == []
