"""Faults and inputs of devices that a test has started, in real time: the fixtures, and the command."""

import json
from collections.abc import Callable, Sequence

import pytest

from emulators.testing.emulated import Boards, Drives
from emulators.testing.errors import RigError
from emulators.testing.plugin import PROGRAM
from emulators.testing.process import Process
from firmware_bridge.testing.control import ControlError, of_process
from hil_tests.lanes import HUNG_S

pytest_plugins = ["emulators.testing.plugin"]

UnderTest = Callable[[Sequence[str]], Process]


@pytest.fixture
def runs(under_test: UnderTest) -> Callable[..., str]:
    """Return what runs the program to its end, and returns what it has printed."""

    def run(*words: str, status: int = 0) -> str:
        process = under_test((*PROGRAM, *words))
        assert process.ends(HUNG_S) == status, process.printed
        return process.printed

    return run


def test_an_input_of_a_drive_is_set_and_read_over_its_line(drives: Drives, runs: Callable[..., str]) -> None:
    port = drives("1")
    words = ("epos2", "read", "0x2071:1", "--json", "--serial", port)

    def level() -> int:
        return int(json.loads(runs(*words))["objects"][0]["value"])

    before = level()
    drives.input("motor1", "input2", 1)
    assert level() != before
    drives.input("motor1", "input2", 0)
    assert level() == before


def test_a_drive_loses_its_supply_and_has_it_again(drives: Drives, runs: Callable[..., str]) -> None:
    port = drives("1")
    number = drives.fault("supply_sag", to_v=8.0)
    errors = ("epos2", "read", "0x1003:1", "--json", "--serial", port)
    assert json.loads(runs(*errors))["objects"][0]["value"] == 0x3220
    drives.clear(number)
    with pytest.raises(ControlError, match="not on a real bus or line"):
        drives.fault("bus_off", node=1)
    with pytest.raises(RigError, match="no drives '2' were started"):
        drives.fault("drive_restart", nodes="2", node=2)


def test_a_board_is_reset_over_its_control_port(board: Boards) -> None:
    board("mw")
    board.fault("board_reset")
    number = board.fault("motor_cable_off", node="M1")
    board.clear(number)


def test_the_command_injects_lists_clears_and_ends(under_test: UnderTest, runs: Callable[..., str]) -> None:
    program = under_test((*PROGRAM, "emulate", "rome", "--serial", "pty", "--duration", "600"))
    program.prints("Ctrl-C ends it", HUNG_S)
    at = ("--at", f"rome-{program.pid}")
    assert "; number 0" in runs("inject", "shaft_blocked", "node=one", *at)
    listed = runs("inject", "state", *at)
    assert "fault 0: shaft_blocked on one since" in listed
    assert "can be set: battery_emf" in listed
    assert "cleared: 0" in runs("inject", "clear", *at)
    assert json.loads(runs("inject", "state", "--json", *at))["faults"] == []
    runs("inject", "set", "mass=30.5", *at)
    assert "rome has no node 'four'" in runs("inject", "shaft_blocked", "node=four", *at, status=1)
    assert "only a fault has an end" in runs("inject", "state", "--for", "2s", *at, status=2)
    assert "as 2s or 300ms" in runs("inject", "shaft_blocked", "node=one", "--for", "soon", *at, status=2)
    runs("inject", "shutdown", *at)
    assert program.ends(HUNG_S) == 0
    assert "ended: finished" in program.printed
    assert "fault shaft_blocked begins at" in program.printed
    assert "fits 0" in runs("inject", "state", *at, status=1)


def test_a_program_without_a_control_port_has_none(under_test: UnderTest) -> None:
    program = under_test(
        (*PROGRAM, "emulate", "ar2", "--serial", "pty", "--control", "none", "--duration", "60")
    )
    program.prints("Ctrl-C ends it", HUNG_S)
    with pytest.raises(ControlError, match="has no control port"):
        of_process(program.pid)
