"""Motors of a board: commands, and counts that do not follow them."""

from collections.abc import Callable
from pathlib import Path

from firmware_bridge.explain.explainer import Explained
from hil_tests.unit.explain.line_log import LineLog, kinds_of

CYCLE_MS = 50
PER_CYCLE = 20.0
"""Counts of a motor at its command in one cycle."""


def driven(
    folder: Path, rates: Callable[[float], tuple[float, float, float]], seconds: float = 5.0
) -> Explained:
    """Three motors with a command of 30, whose counts follow by `rates`, as a share of the usual."""
    log, counts = LineLog(), [0.0, 0.0, 0.0]
    while log.now < seconds * 1_000:
        counts = [
            count + PER_CYCLE * rate for count, rate in zip(counts, rates(log.now / 1_000), strict=True)
        ]
        log.exchanges(b"e\r", " ".join(str(int(count)) for count in counts).encode() + b"\r\n", cycle=10)
        log.exchanges(b"m 30 30 30\r", b"OK\r\n", cycle=CYCLE_MS - 10)
    return log.explained(folder, "ros-arduino-bridge")


def test_motors_that_follow_are_no_incident(tmp_path: Path) -> None:
    assert driven(tmp_path, lambda _: (1, 1, 1)).incidents == ()


def test_one_motor_that_stops(tmp_path: Path) -> None:
    found = driven(tmp_path, lambda at: (1, float(not 3 < at < 4), 1))
    (one,) = found.incidents
    assert one.kind.name == "not_turning"
    assert one.where == "motor 2"
    assert [("blocked" in one.causes[0]), ("cable" in one.causes[1]), ("encoder" in one.causes[2])] == [
        True
    ] * 3
    assert one.recovery == "it counts again"


def test_all_motors_that_stop(tmp_path: Path) -> None:
    found = driven(tmp_path, lambda at: (float(at < 3),) * 3)
    assert kinds_of(found) == ["no_motor_turns"]
    assert "supply" in found.incidents[0].causes[0]


def test_motors_that_never_turn(tmp_path: Path) -> None:
    assert kinds_of(driven(tmp_path, lambda _: (0, 0, 0))) == ["no_motor_turns"]


def test_a_motor_that_turns_the_other_way(tmp_path: Path) -> None:
    found = driven(tmp_path, lambda at: (1, 1, -1 if at > 3 else 1))
    (one,) = found.incidents
    assert one.kind.name == "turns_backwards"
    assert one.where == "motor 3"
    assert "leads" in one.causes[0]


def test_a_motor_that_turns_the_other_way_from_the_start(tmp_path: Path) -> None:
    found = driven(tmp_path, lambda _: (1, -1, 1))
    assert [(one.kind.name, one.where) for one in found.incidents] == [("turns_backwards", "motor 2")]


def test_one_motor_that_falls_behind(tmp_path: Path) -> None:
    found = driven(tmp_path, lambda at: (0.2 if at > 3 else 1, 1, 1))
    (one,) = found.incidents
    assert one.kind.name == "counts_fall_behind"
    assert "cable" in one.causes[0]


def test_all_motors_that_fall_behind_have_a_low_supply(tmp_path: Path) -> None:
    found = driven(tmp_path, lambda at: (0.2,) * 3 if at > 3 else (1, 1, 1))
    assert kinds_of(found) == ["counts_fall_behind"] * 3
    assert all("supply" in one.causes[0] for one in found.incidents)


def test_a_motor_whose_load_is_off_runs_ahead(tmp_path: Path) -> None:
    found = driven(tmp_path, lambda at: (3 if at > 3 else 1, 1, 1))
    assert kinds_of(found) == ["counts_run_ahead"]


def test_counts_of_16_bits_go_on_at_the_other_end(tmp_path: Path) -> None:
    log = LineLog()
    for cycle in range(120):
        count = (32_000 + 20 * cycle + 0x8000) % 0x10000 - 0x8000
        log.exchanges(b"e\r", f"{count} {count} {count}\r\n".encode(), cycle=10)
        log.exchanges(b"m 30 30 30\r", b"OK\r\n", cycle=CYCLE_MS - 10)
    assert log.explained(tmp_path, "ros-arduino-bridge").incidents == ()


def test_a_count_that_jumps(tmp_path: Path) -> None:
    found = driven(tmp_path, lambda at: (1, 1, 900 if 3 <= at < 3.04 else 1))
    assert kinds_of(found) == ["counts_jump"]
    assert "jumps by 18000" in found.incidents[0].what


def test_counts_that_begin_at_0_by_themselves_show_a_start(tmp_path: Path) -> None:
    log = LineLog()
    for cycle in range(160):
        count = 20 * (cycle if cycle < 100 else cycle - 100)
        log.exchanges(b"e\r", f"{count} {count} {count}\r\n".encode(), cycle=10)
        log.exchanges(b"m 30 30 30\r", b"OK\r\n", cycle=CYCLE_MS - 10)
    found = log.explained(tmp_path, "ros-arduino-bridge")
    assert kinds_of(found) == ["line_restart"]
    assert "its counts begin at 0 by themselves" in found.incidents[0].what


def test_an_emergency_stop_of_the_controller_is_no_incident(tmp_path: Path) -> None:
    log, count, speed = LineLog(), 0.0, 0.0
    for cycle in range(160):
        command = 30 if cycle < 80 else 0
        speed += (20 * command / 30 - speed) * 0.3
        count += speed
        log.exchanges(b"e\r", (" ".join([str(int(count))] * 3)).encode() + b"\r\n", cycle=10)
        log.exchanges(f"m {command} {command} {command}\r".encode(), b"OK\r\n", cycle=CYCLE_MS - 10)
    assert log.explained(tmp_path, "ros-arduino-bridge").incidents == ()
