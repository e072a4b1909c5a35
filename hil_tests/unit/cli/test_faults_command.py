"""`faults`: the same names as missions and tests have, and of a robot those that it can have."""

import pytest
from typer.testing import CliRunner

from emulators.bench.faults import kinds
from emulators.bench.faults.failures import failures_of
from firmware_bridge.cli import program
from firmware_bridge.robot_types import find


def listed(*words: str) -> tuple[int, list[list[str]], str]:
    reported = CliRunner().invoke(program, ["faults", *words], env={"COLUMNS": "400", "NO_COLOR": "1"})
    rows = [
        [cell.strip() for cell in line.split("│")[1:-1]]
        for line in reported.stdout.splitlines()
        if "│" in line
    ]
    # What is long goes on in further lines.
    return reported.exit_code, [row for row in rows if row[0]], reported.stderr


def test_without_a_robot_it_lists_all() -> None:
    status, rows, _ = listed()
    assert status == 0
    assert [row[0] for row in rows] == list(kinds())


@pytest.mark.parametrize("robot", ["rars", "rome", "ar2", "climber"])
def test_of_a_robot_it_lists_those_that_it_can_have_and_where(robot: str) -> None:
    _, rows, _ = listed(robot)
    known = {failure.kind for failure in failures_of(find(robot))}
    assert {row[0] for row in rows} == known
    for name, where, keys, what in rows:
        assert what
        places = [failure.place for failure in failures_of(find(robot)) if failure.kind == name]
        assert all(place in where for place in places)
        assert "at_s" not in keys
    assert known < set(kinds())


def test_a_key_that_is_needed_stands_without_brackets() -> None:
    _, rows, _ = listed("rome")
    keys = {row[0]: row[2] for row in rows}
    assert keys["encoder_cable_off"] == "node"
    assert "(every_ms)" in keys["line_garbage"]


def test_a_robot_that_is_none_is_refused() -> None:
    status, _, complained = listed("romm")
    assert status == 2
    assert "no such robot; perhaps 'rome'" in complained


def test_of_a_device_it_lists_those_that_emulate_can_put_on_it_alone() -> None:
    _, board, _ = listed("board")
    where = {row[0]: row[1] for row in board}
    assert where["motor_cable_off"] == "M1, M2, M3, M4"
    assert {"board_hangs", "i2c_stuck", "line_garbage", "serial_unplugged"} <= set(where)
    assert not set(where) & {"datagram_loss", "bridge_ends", "bus_off"}
    for device in ("epos2", "cia402"):
        names = {row[0] for row in listed(device)[1]}
        assert {"drive_restart", "encoder_cut", "supply_sag", "node_silent"} <= names
        assert not names & {"board_hangs", "motor_cable_off", "datagram_loss", "bridge_ends", "bus_off"}
