"""What the guard remembers of each drive: power and motion, and what it then refuses."""

from typing import Final

import pytest

from firmware_bridge.packet import Packet
from hil_tests.safety.guard_bench import LINK, Bench, aborted, frame, position, raw, wheel, write

START_NODE: Final = Packet(LINK, 0x000, b"\x01\x00")


def test_a_drive_with_power_keeps_its_watch_over_the_bridge(bench: Bench) -> None:
    ends_watch = write(2, 0x1016, 1, bytes(4))
    bench.says(wheel(1, 0x000F, 0))
    assert bench.says(ends_watch) == (ends_watch,)
    for word in (0x000F, 0x010F):
        bench.says(wheel(2, word, 0))
        reason, sent = bench.refuses(ends_watch)
        assert reason == "0x1016:01 set to 0 while node 2 has power"
        assert sent == aborted(2, 0x1016, 1)
        keeps = write(2, 0x1016, 1, raw(100 << 16 | 200, 4))
        assert bench.says(keeps) == (keeps,)
        zero_elsewhere = write(2, 0x1003, 0, bytes(1))
        assert bench.says(zero_elsewhere) == (zero_elsewhere,)
    bench.says(wheel(2, 0x0006, 0))
    assert bench.says(ends_watch) == (ends_watch,)


@pytest.mark.parametrize("command", [0x80, 0x81, 0x82])
@pytest.mark.parametrize("addressed", [0, 2])
def test_a_drive_that_moves_is_not_taken_off_the_bus(bench: Bench, command: int, addressed: int) -> None:
    leave = Packet(LINK, 0x000, bytes((command, addressed)))
    bench.says(wheel(1, 0x000F, 0), wheel(2, 0x000F, 1), position(3, 0x000F, 5))
    assert bench.says(START_NODE) == (START_NODE,)
    reason, sent = bench.refuses(leave)
    assert reason == "node 2 moves and would no longer hear set-points"
    assert sent == (wheel(1, 0x000F, 0), wheel(2, 0x000F, 0), position(3, 0x010F, 5))
    # It was stopped instead, so the next try is allowed; afterwards it counts as without power.
    assert bench.says(leave) == (leave,)
    left = () if addressed == 0 else (wheel(1, 0x000F, 0), position(3, 0x010F, 5))
    assert bench.refuses(frame(0x123, ""))[1] == left


@pytest.mark.parametrize("addressed", [0, 2])
def test_a_drive_that_left_the_bus_counts_as_without_power(bench: Bench, addressed: int) -> None:
    bench.says(wheel(2, 0x000F, 0), Packet(LINK, 0x000, bytes((0x81, addressed))))
    assert bench.refuses(wheel(2, 0x000F, 9999))[1] == (wheel(2, 0x0000, 0),)


def test_another_drive_may_leave_the_bus(bench: Bench) -> None:
    bench.says(wheel(2, 0x000F, 1))
    leave = frame(0x000, "8001")
    assert bench.says(leave) == (leave,)


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
    bench.says(packet)
    leave = frame(0x000, "8000")
    assert (bench.says(leave) != (leave,)) is moves


def test_a_controlword_over_sdo_takes_the_power_away(bench: Bench) -> None:
    bench.says(wheel(1, 0x000F, 0), write(1, 0x6040, 0, b"\x0b\x00"))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, 0x000B, 0),)


def test_bytes_that_an_expedited_write_does_not_use_say_nothing(bench: Bench) -> None:
    bench.says(wheel(1, 0x000F, 0), frame(0x601, "2b4060000b00ffff"))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, 0x000B, 0),)


def test_an_upload_of_the_controlword_changes_nothing(bench: Bench) -> None:
    bench.says(wheel(1, 0x000F, 0), frame(0x601, "4040600000000000"))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, 0x000F, 0),)
