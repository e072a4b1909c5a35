"""The guard's memory of each drive: power and motion, and the refusals that follow."""

from typing import Final

import pytest

from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND
from hil_tests.safety.guard_bench import LINK, Bench, aborted, frame, position, raw, status, wheel, write

START_NODE: Final = Packet(LINK, 0x000, b"\x01\x00")


def test_a_drive_with_power_keeps_its_watch_over_the_bridge(bench: Bench) -> None:
    ends_watch = write(2, 0x1016, 1, bytes(4))
    bench.states(wheel(1, 0x000F, 0))
    bench.receives(status(2, 0x0140))
    assert bench.states(ends_watch) == (ends_watch,)
    for word in (0x000F, 0x010F):
        bench.states(wheel(2, word, 0))
        reason, sent = bench.refuses(ends_watch)
        assert reason == "0x1016:01 set to 0 while node 2 may have power"
        assert sent == aborted(2, 0x1016, 1)
        keeps = write(2, 0x1016, 1, raw(100 << 16 | 200, 4))
        assert bench.states(keeps) == (keeps,)
        zero_elsewhere = write(2, 0x1003, 0, bytes(1))
        assert bench.states(zero_elsewhere) == (zero_elsewhere,)
    bench.states(wheel(2, 0x0006, 0))
    assert bench.refuses(ends_watch)[1] == aborted(2, 0x1016, 1)
    bench.receives(status(2, 0x0121))
    assert bench.states(ends_watch) == (ends_watch,)


@pytest.mark.parametrize("command", [0x80, 0x82])
@pytest.mark.parametrize("addressed", [0, 2])
def test_a_drive_that_moves_is_not_taken_off_the_bus(bench: Bench, command: int, addressed: int) -> None:
    leave = Packet(LINK, 0x000, bytes((command, addressed)))
    bench.states(wheel(1, 0x000F, 0), wheel(2, 0x000F, 1), position(3, 0x000F, 5))
    assert bench.states(START_NODE) == (START_NODE,)
    reason, sent = bench.refuses(leave)
    assert reason == "node 2 moves and would receive no more set-points"
    assert sent == (wheel(1, 0x000F, 0), wheel(2, 0x000F, 0), position(3, 0x010F, 5))
    # It was stopped instead, so the next try is allowed; afterwards it counts as without power.
    assert bench.states(leave) == (leave,)
    left = () if addressed == 0 else (wheel(1, 0x000F, 0), position(3, 0x010F, 5))
    assert bench.refuses(frame(0x123, ""))[1] == left


@pytest.mark.parametrize("addressed", [0, 2])
def test_a_drive_that_left_the_bus_counts_as_without_power(bench: Bench, addressed: int) -> None:
    bench.states(wheel(2, 0x000F, 0), Packet(LINK, 0x000, bytes((0x82, addressed))))
    assert bench.refuses(wheel(2, 0x000F, 9999))[1] == (wheel(2, 0x0000, 0),)


PATIENCE: Final = 200 * MILLISECOND
"""Time for a drive to confirm a word: RARS's file leaves `stop_confirmed_ms.by_object` to CAN."""
OFF: Final = tuple(make(node, 0x0000, 0) for node, make in enumerate((wheel, wheel, position, position), 1))


def reset(node: int) -> Packet:
    return Packet(LINK, 0x000, bytes((0x81, node)))


@pytest.mark.parametrize("others", [wheel(2, 0x000F, 500), wheel(2, 0x000F, 0), wheel(2, 0x000B, 0)])
@pytest.mark.parametrize("addressed", [0, 2])
def test_a_drive_that_was_not_commanded_to_give_up_its_power_is_never_reset(
    bench: Bench, others: Packet, addressed: int
) -> None:
    bench.states(OFF[0], others, OFF[2], OFF[3])
    assert "node 2" in bench.refuses(reset(addressed), 100 * PATIENCE)[0]
    assert reset(1) in bench.states(reset(1), now=100 * PATIENCE), "that one was"


@pytest.mark.parametrize("addressed", [0, 1, 2, 3, 4])
@pytest.mark.parametrize("by", ["PDO", "SDO"])
def test_a_drive_is_reset_where_it_has_not_confirmed_in_its_time(
    bench: Bench, by: str, addressed: int
) -> None:
    words = OFF if by == "PDO" else tuple(write(node, 0x6040, 0, bytes(2)) for node in (1, 2, 3, 4))
    bench.states(wheel(1, 0x000F, 0), wheel(2, 0x000F, 0), position(3, 0x003F, 7), position(4, 0x003F, 7))
    bench.states(*words, now=PATIENCE)
    bench.states(*words, now=PATIENCE + 50 * MILLISECOND)
    reason = f"node {addressed or 1} has been without an order to disable its power stage for 200 ms"
    assert bench.refuses(reset(addressed), 2 * PATIENCE - 1)[0] == reason
    assert bench.states(reset(addressed), now=2 * PATIENCE) == (reset(addressed),)


@pytest.mark.parametrize(
    ("statusword", "left"), [(0x0140, False), (0x0108, False), (0x0137, True), (0x0117, True)]
)
def test_a_drive_that_has_confirmed_needs_no_reset(bench: Bench, statusword: int, *, left: bool) -> None:
    bench.states(*OFF)
    bench.receives(status(2, statusword), now=PATIENCE)
    assert (reset(2) in bench.states(reset(2), now=2 * PATIENCE)) is left
    if not left:
        assert bench.guard.refusals[-1].reason == "node 2 has no power, and nothing to be reset for"


@pytest.mark.parametrize("word", [0x000F, 0x010F, 0x000B, 0x0006, 0x0080])
def test_any_other_word_starts_the_time_again(bench: Bench, word: int) -> None:
    bench.states(*OFF)
    bench.states(wheel(2, word, 0), now=PATIENCE)
    bench.states(OFF[1], now=2 * PATIENCE)
    assert "has been without an order" in bench.refuses(reset(2), 3 * PATIENCE - 1)[0]
    assert bench.states(reset(2), now=3 * PATIENCE) == (reset(2),)
    assert "has been without an order" in bench.refuses(reset(2), 4 * PATIENCE)[0], "once"


def test_another_drive_may_leave_the_bus(bench: Bench) -> None:
    bench.states(wheel(2, 0x000F, 1))
    leave = frame(0x000, "8001")
    assert bench.states(leave) == (leave,)


@pytest.mark.parametrize(
    ("packet", "moves"),
    [
        (wheel(1, 0x000F, 1), True),
        (wheel(1, 0x000F, -1), True),
        (wheel(1, 0x000F, 0), False),
        (wheel(1, 0x010F, 1), False),
        (wheel(1, 0x0006, 1), False),
        (position(4, 0x003F, 0), True),
        (position(4, 0x003F, 9), True),
        (position(4, 0x000F, 9), False),
        (position(4, 0x010F, 9), False),
    ],
)
def test_what_counts_as_moving(bench: Bench, packet: Packet, *, moves: bool) -> None:
    bench.states(packet)
    leave = frame(0x000, "8000")
    assert (bench.states(leave) != (leave,)) is moves


def test_a_controlword_over_sdo_takes_the_power_away(bench: Bench) -> None:
    bench.states(wheel(1, 0x000F, 0), write(1, 0x6040, 0, b"\x0b\x00"))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, 0x000B, 0),)


def test_bytes_that_an_expedited_write_does_not_use_say_nothing(bench: Bench) -> None:
    bench.states(wheel(1, 0x000F, 0), frame(0x601, "2b4060000b00ffff"))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, 0x000B, 0),)


def test_an_upload_of_the_controlword_changes_nothing(bench: Bench) -> None:
    bench.states(wheel(1, 0x000F, 0), frame(0x601, "4040600000000000"))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, 0x000F, 0),)
