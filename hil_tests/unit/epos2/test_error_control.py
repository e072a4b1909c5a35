"""Heartbeats produced and watched, node guarding (CiA 301 v4.02; EPOS2 Application Notes, p. 158)."""

from dataclasses import replace

import pytest

from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.units import MILLISECOND, NEVER
from hil_tests.unit.epos2.quiet_motion import Desk, powered

LOST = "081#3081100000000000"
BRIDGE = 100


def watching(time_ms: int = 200, place: int = 1, node: int = BRIDGE) -> Desk:
    desk = powered()
    assert desk.writes(0x1016, place, (node << 16 | time_ms).to_bytes(4, "little")) == "ok"
    return desk


def producing(period_ms: int) -> Desk:
    desk = powered()
    word = period_ms.to_bytes(2, "little").hex().upper()
    assert desk.receives(f"601#2B171000{word}0000") == ["581#6017100000000000", "701#7F"]
    return desk


def test_a_heartbeat_starts_at_once_and_keeps_its_grid() -> None:
    desk = producing(100)
    assert desk.waits(100 * MILLISECOND - 1) == []
    assert desk.waits(1) == ["701#7F"]
    desk.receives("000#0101")
    assert desk.waits(1000 * MILLISECOND) == ["701#05"] * 10
    desk.receives("000#0201")
    assert desk.waits(100 * MILLISECOND) == ["701#04"]


def test_a_late_wake_sends_one_heartbeat_and_returns_to_the_grid() -> None:
    desk = producing(100)
    start = desk.now
    desk.now += 250 * MILLISECOND
    reaction = desk.drive.wake(desk.now)
    assert [packet.payload for packet in reaction.sent] == [b"\x7f"]
    assert reaction.wake_at == start + 300 * MILLISECOND


def test_a_period_of_zero_ends_the_heartbeat() -> None:
    desk = producing(100)
    desk.writes(0x1017, 0, b"\0\0")
    assert desk.due == NEVER


def test_a_saved_heartbeat_counts_from_the_boot_up() -> None:
    desk = producing(100)
    desk.writes(0x1010, 1, b"save")
    desk.waits(30 * MILLISECOND)
    assert desk.receives("000#8101") == ["701#00"]
    assert desk.waits(99 * MILLISECOND) == []
    assert desk.waits(MILLISECOND) == ["701#7F"]


def test_the_heartbeat_can_be_made_to_toggle() -> None:
    desk = powered(replace(EPOS2_70_10, heartbeat_toggles=True))
    desk.receives("601#2B17100064000000")
    assert desk.waits(300 * MILLISECOND) == ["701#FF", "701#7F", "701#FF"]


def test_the_watch_starts_with_the_first_heartbeat() -> None:
    desk = watching()
    assert desk.waits(10_000 * MILLISECOND) == []
    desk.receives("764#05")
    assert desk.waits(200 * MILLISECOND - 1) == []
    assert desk.waits(1) == [LOST]


def test_a_heartbeat_in_time_moves_the_watch_on() -> None:
    desk = watching()
    for _ in range(20):
        assert desk.receives("764#05") == []
        assert desk.waits(199 * MILLISECOND) == []


def test_silence_is_reported_once_and_the_next_heartbeat_starts_again() -> None:
    desk = watching()
    desk.receives("764#05")
    assert desk.waits(5000 * MILLISECOND) == [LOST]
    desk.receives("764#7F")
    assert desk.waits(200 * MILLISECOND) == [LOST]


@pytest.mark.parametrize(("late", "answer"), [(0, []), (1, [LOST])])
def test_a_heartbeat_after_its_deadline_does_not_hide_the_silence(late: int, answer: list[str]) -> None:
    desk = watching()
    desk.receives("764#05")
    desk.now += 200 * MILLISECOND + late
    assert desk.receives("764#05") == answer
    assert desk.waits(200 * MILLISECOND) == [LOST]


@pytest.mark.parametrize("frame", ["764#00", "764#", "764#33", "765#05"])
def test_what_is_no_heartbeat_of_the_watched_node(frame: str) -> None:
    desk = watching()
    desk.receives(frame)
    assert desk.waits(1000 * MILLISECOND) == []


@pytest.mark.parametrize("word", [0, BRIDGE << 16, 200])
def test_without_node_or_time_nothing_is_watched(word: int) -> None:
    desk = watching()
    desk.receives("764#05")
    assert desk.writes(0x1016, 1, word.to_bytes(4, "little")) == "ok"
    desk.receives("764#05")
    assert desk.waits(1000 * MILLISECOND) == []


def test_both_consumers_watch() -> None:
    desk = watching(200)
    assert desk.writes(0x1016, 2, (101 << 16 | 300).to_bytes(4, "little")) == "ok"
    desk.receives("764#05")
    desk.receives("765#05")
    assert desk.waits(200 * MILLISECOND) == [LOST]
    assert desk.waits(100 * MILLISECOND) == [LOST]


def test_two_consumers_do_not_watch_one_node() -> None:
    desk = watching()
    assert desk.writes(0x1016, 2, (BRIDGE << 16 | 300).to_bytes(4, "little")) == "06040043"
    assert desk.writes(0x1016, 2, (128 << 16 | 300).to_bytes(4, "little")) == "06090030"


def test_guarding_answers_with_a_toggling_state() -> None:
    desk = powered()
    assert [desk.receives("701#R1") for _ in range(3)] == [["701#7F"], ["701#FF"], ["701#7F"]]
    desk.receives("000#8201")
    assert desk.receives("701#R1") == ["701#7F"]


def test_guarding_rests_while_heartbeats_are_produced() -> None:
    assert producing(100).receives("701#R1") == []


def test_life_guarding_starts_with_the_first_request() -> None:
    desk = powered()
    desk.writes(0x100C, 0, (100).to_bytes(2, "little"))
    desk.writes(0x100D, 0, b"\x03")
    assert desk.waits(5000 * MILLISECOND) == []
    desk.receives("701#R1")
    assert desk.waits(300 * MILLISECOND - 1) == []
    assert desk.waits(1) == [LOST]


def test_a_time_that_is_written_as_it_stands_changes_nothing() -> None:
    """No watch ends by it, and no heartbeat is shifted."""
    desk = watching()
    desk.receives("764#05")
    desk.waits(150 * MILLISECOND)
    assert desk.writes(0x1016, 1, (BRIDGE << 16 | 200).to_bytes(4, "little")) == "ok"
    assert desk.waits(50 * MILLISECOND) == [LOST]

    desk = producing(100)
    desk.waits(60 * MILLISECOND)
    assert desk.receives("601#2B17100064000000") == ["581#6017100000000000"]
    assert desk.waits(40 * MILLISECOND) == ["701#7F"]

    desk = powered()
    desk.writes(0x100C, 0, (100).to_bytes(2, "little"))
    desk.writes(0x100D, 0, b"\x03")
    desk.receives("701#R1")
    desk.waits(200 * MILLISECOND)
    desk.writes(0x100C, 0, (100).to_bytes(2, "little"))
    desk.writes(0x100D, 0, b"\x03")
    assert desk.waits(100 * MILLISECOND) == [LOST]
