"""What looks like an incident and is none, and what must not be taken for another one."""

from pathlib import Path

import pytest

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.explain import report
from firmware_bridge.explain.explainer import Explained, Setup
from hil_tests.unit.explain.bus_log import (
    CONTROLWORD,
    ENABLED,
    FAULT,
    MODE,
    POSITION,
    STATUSWORD,
    TARGET_POSITION,
    TARGET_VELOCITY,
    VELOCITY,
    BusLog,
)
from hil_tests.unit.explain.explained import explained, named

EPOS2 = Setup(device="epos2")
REACHED = ENABLED
ON_THE_WAY = ENABLED & ~0x0400
SAVE = Address(0x1010, 1)


def kinds(found: Explained) -> list[str]:
    return [one.kind.name for one in found.incidents]


def enabled(mode: int = 3) -> BusLog:
    return BusLog().started().write(MODE, mode).enabled()


def moved(log: BusLog, count: int = 10, step: int = 500) -> BusLog:
    for place in range(count):
        log.shows(POSITION, step * place).wait(0.1)
    return log


def test_nmt_start_while_enabled_changes_nothing(tmp_path: Path) -> None:
    log = moved(moved(enabled().write(TARGET_VELOCITY, 500)).nmt(NmtCommand.START))
    assert kinds(explained(log, tmp_path)) == []


def test_a_controller_that_takes_its_consumers_off_ends_in_order(tmp_path: Path) -> None:
    def log(last: int) -> BusLog:
        made = BusLog().started().write(Address(0x1016, 1), 100 << 16 | 200)
        for _ in range(20):
            made.beat(node=100).beat().wait(0.098)
        return made.write(Address(0x1016, 1), last).beats(20)

    assert kinds(explained(log(0), tmp_path)) == []
    assert kinds(explained(log(100 << 16 | 200), tmp_path)) == ["controller_silent"]


@pytest.mark.parametrize("power", [False, True])
@pytest.mark.parametrize("requests", [False, True])
def test_a_controller_that_proves_the_supervision_withholds_its_heartbeat(
    tmp_path: Path, *, power: bool, requests: bool
) -> None:
    """It lives, as its requests show, and no drive has power; else it hangs, or worse."""
    log = enabled() if power else BusLog().started()
    log.write(Address(0x1016, 1), 100 << 16 | 200)
    for count in range(20):
        log.beat().wait(0.048)
        if count < 10:
            log.beat(node=100)
        if count < 10 or requests:
            log.shows(POSITION, 500 * count)
    (found,) = explained(log, tmp_path).incidents
    assert found.kind.name == "controller_silent"
    assert ("on purpose" in found.causes[0]) == (requests and not power)


@pytest.mark.parametrize("state", [ENABLED, None])
def test_a_silence_is_not_on_purpose_while_another_drive_may_have_power(
    state: int | None, tmp_path: Path
) -> None:
    """Drive 2 has power, or its state was never seen."""
    log = BusLog().started().write(Address(0x1016, 1), 100 << 16 | 200)
    log.frame(0x702, b"\x05")
    if state is not None:
        log.node = 2
        log.shows(STATUSWORD, state)
        log.node = 1
    for count in range(20):
        log.beat().wait(0.048)
        if count < 10:
            log.beat(node=100)
        log.shows(POSITION, 500 * count)
    found = [one for one in explained(log, tmp_path).incidents if one.kind.name == "controller_silent"]
    assert len(found) == 1
    assert "on purpose" not in found[0].causes[0]


def beats(log: BusLog, count: int, *, controller: bool = True) -> None:
    for _ in range(count):
        log.beat().wait(0.05)
        if controller:
            log.beat(node=100)


def emergencies(log: BusLog, nodes: tuple[int, ...], payload: bytes) -> None:
    for node in nodes if payload else ():
        log.frame(0x80 + node, payload)


@pytest.mark.parametrize(
    ("case", "incidents"),
    [
        ("well", set()),
        ("power", {"controller_silent", "emergency"}),
        ("power before", {"controller_silent", "emergency"}),
        ("state unknown", {"controller_silent", "emergency"}),
        ("not reset", {"controller_silent", "emergency"}),
        ("not noticed", {"controller_silent"}),
        ("not back", {"controller_silent", "emergency"}),
        ("another error", {"controller_silent", "emergency"}),
        ("power of a drive that does not wait", {"controller_silent", "emergency"}),
        ("2 s", {"controller_silent", "emergency"}),
    ],
)
def test_a_silence_that_every_drive_without_power_notices_and_survives_is_a_proof(
    case: str, incidents: set[str], tmp_path: Path
) -> None:
    log = enabled() if case in {"power", "power before"} else BusLog().started()
    if case == "power of a drive that does not wait":
        log.node = 2
        log.shows(STATUSWORD, ENABLED)
        log.node = 1
    if case == "power before":
        log.shows(STATUSWORD, 0x0240)
    nodes = (1, 2) if case == "state unknown" else (1,)
    for node in nodes:
        log.node = node
        log.write(Address(0x1016, 1), 100 << 16 | 200)
    log.node = 1
    code = {"another error": b"\x10\x43", "not noticed": b""}.get(case, b"\x30\x81")
    beats(log, 10)
    beats(log, 4, controller=False)
    emergencies(log, nodes, code and code + b"\x11" + bytes(5))
    beats(log, 36 if case == "2 s" else 1, controller=False)
    beats(log, 4, controller=case != "not back")
    emergencies(log, nodes, b"" if case in {"not reset", "not noticed"} else bytes(8))
    beats(log, 16, controller=case != "not back")
    found = explained(log, tmp_path)
    seen = {one.kind.name for one in found.incidents}
    # A drive with power that stops has more to show.
    assert seen >= incidents
    assert bool(seen) == bool(incidents)
    assert any("as in a proof" in text for text in found.remarks) == (not incidents)


def test_a_client_that_gives_up_waiting_is_a_time_out(tmp_path: Path) -> None:
    log = BusLog().started().request(MODE, 3).wait(0.3).frame(0x601, "8060600000000405").beat()
    assert kinds(explained(log, tmp_path)) == ["sdo_timeout"]


def test_storing_parameters_takes_its_time(tmp_path: Path) -> None:
    log = BusLog().started().request(SAVE, 0x6576_6173).beats(30).frame(0x581, "6010100100000000")
    assert kinds(explained(log, tmp_path)) == []


def test_an_answer_that_comes_late_has_been_missed(tmp_path: Path) -> None:
    log = BusLog().started().request(MODE, 3).beats(20).frame(0x581, "6060600000000000")
    assert kinds(explained(log, tmp_path)) == ["sdo_timeout"]


def test_an_answer_to_another_request_is_none_to_this_one(tmp_path: Path) -> None:
    log = BusLog().started().request(MODE, 3)
    log.frame(0x581, "4B41600040020000").frame(0x581, "6060600000000000").beat()
    assert kinds(explained(log, tmp_path)) == []


def test_an_answer_whose_request_is_not_in_the_recording_is_of_one_node(tmp_path: Path) -> None:
    log = BusLog().started().beats(10).frame(0x581, "4B41600040070000")
    assert kinds(explained(log, tmp_path)) == []


def test_controlwords_that_contradict_each_other_are_of_two_senders(tmp_path: Path) -> None:
    log = enabled()
    for place in range(10):
        log.frame(0x501, "0F00F4010000").frame(0x501, "0600F4010000").shows(POSITION, 100 * place)
    assert "second_producer" in kinds(explained(log, tmp_path, EPOS2))


def test_small_set_points_around_zero_are_of_one_sender(tmp_path: Path) -> None:
    log = enabled()
    for place in range(10):
        log.frame(0x501, "0F0002000000").frame(0x501, "0F00FEFFFFFF").shows(POSITION, 100 * place)
    assert kinds(explained(log, tmp_path, EPOS2)) == []


def test_a_fault_reset_that_is_tried_again_and_again_is_of_one_sender(tmp_path: Path) -> None:
    log = BusLog().started().status(FAULT)
    for _ in range(20):
        log.frame(0x201, "0000").frame(0x201, "8000")
    assert kinds(explained(log, tmp_path, EPOS2)) == ["fault"]


def test_a_fault_after_movement_needs_no_second_explanation(tmp_path: Path) -> None:
    log = moved(enabled().write(TARGET_VELOCITY, 500)).shows(STATUSWORD, FAULT)
    for _ in range(30):
        log.shows(POSITION, 4500).wait(0.1)
    assert kinds(explained(log, tmp_path)) == ["fault"]


def test_a_fault_after_a_long_ramp_belongs_to_its_emergency(tmp_path: Path) -> None:
    log = moved(enabled().write(TARGET_VELOCITY, 500)).frame(0x081, "1186200000000000").beats(8).status(FAULT)
    assert kinds(explained(log.beats(20), tmp_path, EPOS2)) == ["emergency"]


def test_a_fault_long_before_an_emergency_is_an_incident_of_its_own(tmp_path: Path) -> None:
    log = (
        moved(enabled().write(TARGET_VELOCITY, 500)).status(FAULT).beats(10).frame(0x081, "1186200000000000")
    )
    assert kinds(explained(log.beats(5), tmp_path, EPOS2)) == ["fault", "emergency"]


def test_a_drive_whose_position_is_nowhere_needs_a_reason(tmp_path: Path) -> None:
    log = enabled().write(TARGET_VELOCITY, 500).beats(30)
    assert kinds(explained(log, tmp_path)) == []


def test_a_target_that_the_drive_reports_as_reached_is_reached(tmp_path: Path) -> None:
    log = enabled(1).write(TARGET_POSITION, 20_000).write(CONTROLWORD, 0x1F).shows(STATUSWORD, ON_THE_WAY)
    for speed in (100, 200, 100, 0):
        log.shows(VELOCITY, speed).wait(0.1)
    log.shows(STATUSWORD, REACHED).write(CONTROLWORD, 0x010F)
    assert kinds(explained(log.beats(30), tmp_path)) == []


def test_a_target_that_is_written_again_is_no_new_one(tmp_path: Path) -> None:
    log = enabled(1).write(TARGET_POSITION, 20_000).write(CONTROLWORD, 0x1F)
    for _ in range(30):
        log.write(TARGET_POSITION, 20_000).shows(POSITION, 0).wait(0.1)
    (one,) = explained(log, tmp_path).incidents
    assert one.causes[0].startswith("no reason is in the frames")


def test_an_identifier_of_another_node_s_set_is_whose_it_was_made(tmp_path: Path) -> None:
    log = BusLog(2).started().write(MODE, 3).map_rpdo(4, 0x201, 255, 0x6040_0010, 0x60FF_0020).enabled()
    for place in range(30):
        log.frame(0x201, "0F00F4010000").wait(0.05).shows(POSITION, 100 * place)
    assert kinds(explained(log, tmp_path, EPOS2)) == []


def test_an_identifier_belongs_to_the_pdo_that_is_switched_on(tmp_path: Path) -> None:
    log = BusLog().started().write(MODE, 3).write(Address(0x1403, 1), 0x8000_0501)
    log.map_rpdo(1, 0x501, 255, 0x6040_0010, 0x60FF_0020).enabled()
    for place in range(30):
        log.frame(0x501, "0F00F4010000").wait(0.05).shows(POSITION, 100 * place)
    assert kinds(explained(log, tmp_path, EPOS2)) == []


def test_pdos_without_a_mapping_are_remarked(tmp_path: Path) -> None:
    log = BusLog(7)
    for _ in range(5):
        log.frame(0x187, "3707").frame(0x407, "0F0000000000")
    (remark,) = explained(log, tmp_path).remarks
    assert remark.startswith("PDOs of node 7 are not decoded")
    assert explained(log, tmp_path, EPOS2).remarks == ()


def test_the_same_incident_at_several_nodes_is_one_block(tmp_path: Path) -> None:
    log = BusLog()
    for node in (1, 2):
        log.frame(0x080 + node, "2032040000000000")
    log.wait(5.0).frame(0x083, "2032040000000000")
    found = explained(log, tmp_path)
    assert [[one.node for one in group] for group in report.grouped(found.incidents)] == [[1, 2], [3]]


def test_an_emergency_states_what_followed_it(tmp_path: Path) -> None:
    log = moved(enabled().write(TARGET_VELOCITY, 500)).frame(0x081, "1186200000000000").status(FAULT)
    (one,) = named(explained(log, tmp_path, EPOS2), "emergency")
    assert one.consequence.startswith("it was enabled, and went to fault 1.0 ms later")
    log = moved(enabled().write(TARGET_VELOCITY, 500)).frame(0x081, "5081100000000000")
    (one,) = named(explained(moved(log), tmp_path, EPOS2), "emergency")
    assert one.consequence == "it was enabled, and no change of its state was seen after it"
