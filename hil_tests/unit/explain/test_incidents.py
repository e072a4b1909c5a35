"""Incidents on a bus: one recording for each kind, with its evidence, its cause and its recovery."""

from collections.abc import Callable
from pathlib import Path

from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.dissector.expected import Expected
from firmware_bridge.explain.explainer import Setup
from firmware_bridge.explain.kinds import KINDS
from hil_tests.rows import every
from hil_tests.unit.explain.bus_log import (
    CONTROLWORD,
    ENABLED,
    FAULT,
    MODE,
    OFF,
    POSITION,
    STATUSWORD,
    STOPPED,
    TARGET_VELOCITY,
    BusLog,
)
from hil_tests.unit.explain.explained import explained, named

Write = Callable[[BusLog], object]
CONTROLLER = 100
SETUP = Setup(device="epos2", expected=(Expected(1, "left wheel", ((Address(0x6065), bytes(4)),)),))


def driving(log: BusLog, mode: int = 3) -> BusLog:
    """An enabled drive that turns; the controller's heartbeat is consumed, and its SYNC comes."""
    log.started().write(Address(0x1016, 1), CONTROLLER << 16 | 200).write(MODE, mode)
    return turning(log.enabled().write(TARGET_VELOCITY, 500), 10)


def turning(
    log: BusLog, times: int, *, heartbeat: bool = True, beat: bool = True, sync: bool = True
) -> BusLog:
    for count in range(times):
        if heartbeat:
            log.beat(node=CONTROLLER)
        if beat:
            log.beat()
        if sync:
            log.frame(0x080)
        log.shows(POSITION, 1000 * (len(log.lines) + count))
        log.at = -(-log.at // 50_000_000) * 50_000_000
    return log


def emergency(log: BusLog) -> object:
    driving(log).frame(0x081, "2032040000000000").status(FAULT)
    turning(log, 5)
    return log.frame(0x081, "0000000000000000").status(OFF)


def restart(log: BusLog) -> object:
    driving(log)
    turning(log, 2, beat=False).boot()
    return turning(log.nmt(NmtCommand.START), 10)


def silent(log: BusLog) -> object:
    turning(driving(log), 12, beat=False)
    return turning(log, 5)


def controller_silent(log: BusLog) -> object:
    turning(driving(log), 6, heartbeat=False)
    return turning(log, 5)


def second_sync(log: BusLog) -> object:
    driving(log)
    for _ in range(20):
        turning(log, 1).at -= 25_000_000
        log.frame(0x080).at += 24_000_000
    return turning(log, 60)


def network_command(log: BusLog) -> object:
    return driving(log).nmt(NmtCommand.ENTER_PRE_OPERATIONAL)


def fault(log: BusLog) -> object:
    return turning(driving(log).status(FAULT), 10)


def quick_stop(log: BusLog) -> object:
    driving(log).status(STOPPED)
    return turning(log, 10).write(CONTROLWORD, 0x00).status(OFF)


def lost_enable(log: BusLog) -> object:
    driving(log).status(OFF)
    return turning(log, 10).write(CONTROLWORD, 0x00)


def refused(log: BusLog) -> object:
    return log.started().refused(Address(0x6060), 99, AbortCode.RANGE)


def unanswered(log: BusLog) -> object:
    return log.started().request(MODE, 3).wait(1.0).request(MODE, 3).wait(2.0).beat()


def absent(log: BusLog) -> object:
    return log.request(MODE, 3).wait(1.0).request(MODE, 3)


def sync_gap(log: BusLog) -> object:
    turning(driving(log), 10, sync=False)
    return turning(log, 4)


def following_error(log: BusLog) -> object:
    driving(log, mode=1).status(ENABLED | 1 << 13)
    return log.status(ENABLED)


def internal_limit(log: BusLog) -> object:
    return driving(log).status(ENABLED | 1 << 11).status(ENABLED)


def error_frames(log: BusLog) -> object:
    for _ in range(5):
        log.frame(0x20000088, "0000000000000000")
    return log


def bus_off(log: BusLog) -> object:
    return log.frame(0x20000040, "0000000000000000").wait(0.5).frame(0x20000100, "0000000000000000")


def babbling(log: BusLog) -> object:
    driving(log)
    for _ in range(8):
        turning(log, 1).at -= 40_000_000
        for _ in range(200):
            log.frame(0x001, "0000000000000000").at -= 800_000
    return turning(log, 20)


def full(log: BusLog) -> object:
    for count in range(3000):
        log.frame(0x101 + count % 3, bytes(8)).at -= 880_000
    return log


def short_pdo(log: BusLog) -> object:
    return log.started().frame(0x401, "0F0000").beat()


def stuck(log: BusLog) -> object:
    return log.started().write(MODE, 3).enabled().stands()


INCIDENTS: dict[str, tuple[Write, str, str, str]] = {
    "emergency": (emergency, "0x3220, under-voltage", "081#2032040000000000", "no error is left"),
    "restart": (restart, "it has started again while it was enabled", "701#00", "operational again"),
    "silent_node": (silent, "its period was 50 ms", "701#05", "its heartbeat is back after 0.65 s"),
    "controller_silent": (
        controller_silent,
        "its period was 50 ms",
        "764#05",
        "heartbeat is back after 0.35 s",
    ),
    "second_producer": (
        second_sync,
        "SYNC comes every 25.0 ms, not every 50.0 ms",
        "080#",
        "it has its usual rate again",
    ),
    "nmt_while_enabled": (network_command, "NMT enter pre operational while it is enabled", "000#8001", ""),
    "fault": (fault, "it went to fault", "181#0807", ""),
    "quick_stop": (quick_stop, "it went to quick stop active", "181#1707", ""),
    "lost_enable": (lost_enable, "it went to switch on disabled", "181#4007", ""),
    "sdo_abort": (refused, "0x6060 Modes of Operation: 0x06090030", "581#8060600030000906", ""),
    "sdo_timeout": (unanswered, "no answer to a request for 0x6060", "601#2F60600003000000", ""),
    "no_node": (absent, "2 frames to it, and none of it", "601#2F60600003000000", ""),
    "sync_gap": (sync_gap, "no SYNC, whose period was 50.0 ms", "080#", "SYNC is back after 0.55 s"),
    "following_error": (following_error, "statusword 0x2737", "181#3727", "the bit is 0 again"),
    "internal_limit": (internal_limit, "statusword 0x0F37", "181#370F", "the bit is 0 again"),
    "error_frames": (error_frames, "error report: protocol violation, bus error", "20000088#", ""),
    "bus_off": (bus_off, "bus off", "20000040#0000000000000000", "the interface was restarted"),
    "babbling": (babbling, "001 comes 4000 times a second", "001#0000000000000000", "its usual rate again"),
    "bus_load": (full, "% of the bus at 1000000 bit/s", "", ""),
    "pdo_length": (short_pdo, "RPDO 3 has 3 bytes, its mapping 6", "401#0F0000", ""),
    "not_moving": (stuck, "does not move for 2.9 s", "601#2B4060000F000000", ""),
}
"""By its kind: the frames, its text, its evidence, its recovery."""


@every("kind", INCIDENTS)
def test_the_incident_is_found_with_its_evidence_and_its_recovery(kind: str, tmp_path: Path) -> None:
    write, what, frame, recovery = INCIDENTS[kind]
    log = BusLog()
    write(log)
    found = explained(log, tmp_path, SETUP)
    first, *more = named(found, kind)
    assert not more
    assert what in first.what
    assert first.causes
    assert first.consequence
    assert first.check
    assert (first.evidence is None) == (not frame)
    assert first.evidence is None or first.evidence.frame.startswith(frame)
    assert recovery in first.recovery
    assert (first.recovered_at is None) == (not recovery)


@every("kind", INCIDENTS)
def test_it_is_the_only_one(kind: str, tmp_path: Path) -> None:
    log = BusLog()
    INCIDENTS[kind][0](log)
    assert {one.kind.name for one in explained(log, tmp_path, SETUP).incidents} == {kind}


def test_every_kind_has_its_recording() -> None:
    assert {kind.name for kind in KINDS} == set(INCIDENTS)


def test_a_bus_in_good_order_has_none(tmp_path: Path) -> None:
    log = turning(driving(BusLog()), 100)
    log.write(TARGET_VELOCITY, 0).write(CONTROLWORD, 0x00).status(OFF)
    assert explained(log, tmp_path, SETUP).incidents == ()


def test_a_node_is_named_by_its_title(tmp_path: Path) -> None:
    log = BusLog()
    emergency(log)
    assert explained(log, tmp_path, SETUP).incidents[0].where == "node 1 (left wheel)"


def test_a_restart_by_command_is_none(tmp_path: Path) -> None:
    log = BusLog().started().beats(10).nmt(NmtCommand.RESET_NODE).wait(0.3).boot()
    assert explained(log, tmp_path).incidents == ()


def test_a_fault_that_an_emergency_explains_is_not_reported_twice(tmp_path: Path) -> None:
    log = driving(BusLog()).status(FAULT).frame(0x081, "1186200000000000")
    turning(log, 20)
    assert [one.kind.name for one in explained(log, tmp_path, SETUP).incidents] == ["emergency"]


def test_a_lost_connection_names_the_heartbeat_that_was_missing(tmp_path: Path) -> None:
    log = turning(driving(BusLog()), 5, heartbeat=False).frame(0x081, "3081100000000000")
    (one,) = named(explained(log, tmp_path), "emergency")
    assert one.causes[0] == "the heartbeat of node 100 had stopped 0.30 s before"


def test_a_lost_connection_names_the_cable_where_the_heartbeat_was_there(tmp_path: Path) -> None:
    log = turning(driving(BusLog()), 5).frame(0x081, "3081100000000000")
    (one,) = named(explained(log, tmp_path), "emergency")
    assert "cut cable" in one.causes[0]


def test_nodes_that_fall_silent_together_name_each_other(tmp_path: Path) -> None:
    log = BusLog()
    for node in (1, 2):
        log.node = node
        log.boot()
    for _ in range(20):
        log.beat(node=1).beat(node=2).beat(node=3).wait(0.097)
    for _ in range(10):
        log.beat(node=3).wait(0.099)
    found = named(explained(log, tmp_path), "silent_node")
    assert [one.causes[0] for one in found] == [
        "the cable is cut or disturbed: node 2 went silent at the same time",
        "the cable is cut or disturbed: node 1 went silent at the same time",
    ]


def test_frames_that_have_waited_are_of_one_sender(tmp_path: Path) -> None:
    """After bus-off a controller sends at once what has waited."""
    log = BusLog().beats(20)
    log.wait(1.0)
    for _ in range(10):
        log.beat().wait(0.0005)
    log.beats(20)
    assert {one.kind.name for one in explained(log, tmp_path).incidents} == {"silent_node"}


def test_two_answers_to_one_request_are_of_two_nodes(tmp_path: Path) -> None:
    log = BusLog().started().shows(STATUSWORD, OFF)
    log.frame(0x581, "4B41600040050000")
    (one,) = explained(log, tmp_path).incidents
    assert one.kind.name == "second_producer"
    assert one.causes == ("two nodes have this node number",)


def test_set_points_of_two_senders_alternate(tmp_path: Path) -> None:
    log = driving(BusLog())
    for _ in range(10):
        log.frame(0x501, "0F00F4010000").frame(0x501, "0F00000000FF").shows(POSITION, len(log.lines))
    (one,) = named(explained(log, tmp_path, SETUP), "second_producer")
    assert one.node == 1
    assert "RPDO 4 of node 1 alternates" in one.what


def test_a_regulator_s_set_points_are_of_one_sender(tmp_path: Path) -> None:
    log = driving(BusLog())
    for _ in range(10):
        log.frame(0x501, "0F00F4010000").frame(0x501, "0F00F5010000").shows(POSITION, 100 * len(log.lines))
    assert explained(log, tmp_path, SETUP).incidents == ()


def test_a_search_for_nodes_is_no_incident(tmp_path: Path) -> None:
    log = BusLog()
    for node in range(1, 128):
        log.node = node
        log.frame(0x600 + node, "4000100000000000")
    assert explained(log, tmp_path).incidents == ()


def test_a_stopped_node_has_no_sdo(tmp_path: Path) -> None:
    log = BusLog().started().beats(3).nmt(NmtCommand.STOP).request(MODE, 3).wait(2.0)
    log.beat(NmtState.STOPPED)
    (one,) = named(explained(log, tmp_path), "sdo_timeout")
    assert one.causes[0] == "its NMT state is stopped: there it has no SDO"


def test_the_page_lists_every_kind() -> None:
    page = (Path(__file__).parents[3] / "docs/explain.md").read_text(encoding="utf-8")
    rows = [f"| `{kind.name}` | {kind.title} | {kind.causes[0]} | {kind.check} |" for kind in KINDS]
    assert [row for row in rows if row not in page] == []
