"""Requests and answers on a serial line: what was not answered, late, damaged, or printed by itself."""

from pathlib import Path

import pytest

from firmware_bridge.explain.line_kinds import LINE_KINDS
from hil_tests.unit.explain.line_log import LineLog, kinds_of

ROS = "ros-arduino-bridge"
FREE, ROOM = bytes.fromhex("5A 03 00 01 03 F9"), bytes.fromhex("A5 00 00 04 03 02 00 F7")
"""MWProtocol: how much memory is free, and its answer."""
READ, COUNTS = b"e\r", b"10 20 30\r\n"


def regular(log: LineLog, cycles: int = 30) -> LineLog:
    for _ in range(cycles):
        log.exchanges(READ, COUNTS)
    return log


def test_answers_in_time_are_no_incident(tmp_path: Path) -> None:
    found = regular(LineLog()).explained(tmp_path, ROS)
    assert found.incidents == ()
    assert found.remarks == ()
    assert (found.frames, found.lines) == (60, "1 line")


def test_one_request_without_answer(tmp_path: Path) -> None:
    found = regular(regular(LineLog()).exchanges(READ)).explained(tmp_path, ROS)
    assert kinds_of(found) == ["answer_lost"]
    (one,) = found.incidents
    assert one.where == "line board"
    assert one.what == "no answer to read encoders"
    assert one.evidence is not None
    assert one.evidence.frame == "65 0D"


def test_a_device_that_no_more_answers_until_it_does(tmp_path: Path) -> None:
    log = regular(LineLog())
    for _ in range(30):
        log.exchanges(READ)
    found = regular(log).explained(tmp_path, ROS)
    (one,) = found.incidents
    assert one.kind.name == "line_silent"
    assert one.causes[0] == "its cable or plug is out"
    assert len(one.causes) == 3
    assert one.recovery == "it answers again"
    assert one.at == 1_500_000_000
    assert one.recovered_at == 3_005_000_000


def test_a_device_that_is_silent_at_the_end(tmp_path: Path) -> None:
    log = regular(LineLog())
    for _ in range(30):
        log.exchanges(READ)
    (one,) = log.explained(tmp_path, ROS).incidents
    assert one.kind.name == "line_silent"
    assert one.recovered_at is None


def test_a_silence_that_ends_with_a_banner_was_a_supply_or_a_reset(tmp_path: Path) -> None:
    log = LineLog().received(b"MWProtocol").wait(100)
    for _ in range(20):
        log.exchanges(FREE, ROOM)
    for _ in range(20):
        log.exchanges(FREE)
    log.received(b"MWProtocol").wait(100)
    for _ in range(20):
        log.exchanges(FREE, ROOM)
    silence, restart = log.explained(tmp_path, "mw").incidents
    assert (silence.kind.name, restart.kind.name) == ("line_silent", "line_restart")
    assert "supply" in silence.causes[0]
    assert "reset" in silence.causes[1]
    assert restart.recovery == "it answers again"


def test_a_late_answer(tmp_path: Path) -> None:
    log = regular(LineLog()).exchanges(READ, COUNTS, within=120, cycle=150)
    (one,) = regular(log).explained(tmp_path, ROS).incidents
    assert one.kind.name == "answer_late"
    assert one.what == "the answer to read encoders came after 120 ms, usually 5 ms"


@pytest.mark.parametrize(
    ("answer", "kind"),
    [
        (b"10 2\xff\x81 30\r\n", "line_garbage"),
        (b"10 20\r\n", "line_garbage"),
        (b"Invalid Command\r\n", "line_refused"),
        (b"heap 312\r\n", "line_chatter"),
    ],
)
def test_what_is_no_answer(answer: bytes, kind: str, tmp_path: Path) -> None:
    found = regular(regular(LineLog()).exchanges(READ, answer)).explained(tmp_path, ROS)
    assert kind in kinds_of(found)
    assert set(kinds_of(found)) <= {kind, "answer_lost"}


def test_a_text_between_answers_is_chatter(tmp_path: Path) -> None:
    log = regular(LineLog()).received(b"loop 17 ms\r\n")
    (one,) = regular(log).explained(tmp_path, ROS).incidents
    assert one.kind.name == "line_chatter"
    assert "loop 17 ms" in one.what
    assert one.causes[0].startswith("a debug print")


def test_a_frame_with_a_wrong_check_sum_is_garbage(tmp_path: Path) -> None:
    log = LineLog()
    for _ in range(20):
        log.exchanges(FREE, ROOM)
    log.exchanges(FREE, ROOM[:-1] + b"\x00")
    for _ in range(20):
        log.exchanges(FREE, ROOM)
    assert "line_garbage" in kinds_of(log.explained(tmp_path, "mw"))


def test_requests_that_stop(tmp_path: Path) -> None:
    log = regular(LineLog()).wait(2_000)
    (one,) = regular(log).explained(tmp_path, ROS).incidents
    assert one.kind.name == "requests_stopped"
    assert one.recovery == "requests come again"
    assert one.causes[0].startswith("its program hangs")


def test_requests_without_any_answer_are_remarked(tmp_path: Path) -> None:
    log = LineLog()
    for _ in range(30):
        log.exchanges(READ)
    found = log.explained(tmp_path, ROS)
    assert found.incidents == ()
    assert "30 requests and no answer that is known" in found.remarks[0]


def test_another_protocol_than_stated_is_remarked(tmp_path: Path) -> None:
    found = regular(LineLog()).explained(tmp_path, "mw")
    assert any("use --protocol ros-arduino-bridge" in remark for remark in found.remarks)


def test_the_protocol_is_found_where_nothing_states_it(tmp_path: Path) -> None:
    found = regular(LineLog()).explained(tmp_path, "")
    assert found.incidents == ()
    assert found.remarks == ()


def test_bytes_of_no_protocol_are_remarked(tmp_path: Path) -> None:
    log = LineLog()
    for _ in range(30):
        log.exchanges(b"\x01\x02", b"\x03\x04")
    found = log.explained(tmp_path, "")
    assert found.incidents == ()
    assert "its protocol is not known" in found.remarks[0]


def test_each_kind_has_a_row_on_the_page() -> None:
    page = (Path(__file__).parents[3] / "docs/explain.md").read_text(encoding="utf-8")
    rows = [f"| `{kind.name}` | {kind.title} | {kind.causes[0]} | {kind.check} |" for kind in LINE_KINDS]
    assert [row for row in rows if row not in page] == []


def test_the_log_of_a_device_states_what_it_speaks(tmp_path: Path) -> None:
    log, link = LineLog(), f"board~{ROS}"
    for cycle in range(60):
        # In a device's own log R and T are its own.
        log.received(READ, link).wait(5)
        if not 30 <= cycle < 45:
            log.sent(COUNTS, link)
        log.wait(45)
    found = log.explained(tmp_path, "")
    assert kinds_of(found) == ["line_silent"]
    assert found.incidents[0].where == "line board"
