"""`epos2 read`, `write`, `state`, `version`, `nmt` on the command line, on emulated drives in real time."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import pytest
import serial
from typer.testing import CliRunner

from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.canopen.sdo_client import SdoClient
from firmware_bridge.cli import program
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.units import SECOND
from hil_tests.unit.cli.bench_drives import Bench, Reported, ask, bench

COMMANDS = {
    "scan": (),
    "read": ("statusword",),
    "write": ("profile-velocity", "500"),
    "state": (),
    "version": (),
    "nmt": ("start",),
}


@pytest.fixture
def on() -> Iterator[Bench]:
    with bench() as found:
        yield found


@pytest.fixture(params=["can", "v1", "v2", "v1 gateway", "can far"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[str, ...]]:
    """Return the options that lead to a drive in one way; all answer, however busy the machine is."""
    name: str = request.param
    monkeypatch.setattr(SdoClient.__init__, "__defaults__", (10 * SECOND,))
    with bench(Generation.V2 if name == "v2" else Generation.V1) as found:
        line = found.can if name.startswith("can") else found.serial
        yield (*line, "--node", "2") if name in {"v1 gateway", "can far"} else line


def data(reported: Reported) -> Any:
    assert reported.status == 0, reported.err
    return json.loads(reported.out)


def test_objects_are_read_with_name_unit_and_words(way: tuple[str, ...]) -> None:
    reported = ask("read", "statusword", "profile velocity", "0x60F6:1", "0x1008", "modes-of-operation", *way)
    assert reported.status == 0, reported.err
    assert [" ".join(line.split()) for line in reported.out.splitlines()] == [
        "0x6041 Statusword 0x0540 switch on disabled, target reached",
        "0x6081 Profile Velocity 1000 rpm",
        "0x60F6:01 Current Regulator P-Gain 300 x 1/256 Ohm",
        "0x1008 Manufacturer Device Name EPOS2",
        "0x6060 Modes of Operation 1 profile position",
    ]


def test_a_value_is_written_and_read_back(way: tuple[str, ...]) -> None:
    reported = ask("write", "profile-velocity", "500rpm", *way)
    assert (reported.status, reported.out) == (0, "written: 0x6081 Profile Velocity 500 rpm\n")
    assert " 500 rpm" in ask("read", "0x6081", *way).out


def test_a_value_below_zero_is_no_option(on: Bench) -> None:
    for words in (
        ("write", "target-velocity", "-20rpm", "--yes", *on.can),
        ("write", "-y", "0x60FF", "-20", *on.can),
    ):
        assert ask(*words).out == "written: 0x60FF Target Velocity -20 rpm\n"
    reported = ask("write", "home-offset", "-500qc", *on.serial)
    assert reported.out == "written: 0x607C Home Offset -500 qc\n"
    assert ask("write", *on.can, "home-offset", "--", "-7").out == "written: 0x607C Home Offset -7 qc\n"


def test_a_drive_is_enabled_and_switched_off(way: tuple[str, ...]) -> None:
    for command, state in (
        ("enable", "operation enabled"),
        ("quick-stop", "quick stop active"),
        ("disable", "switch on disabled"),
        ("shutdown", "ready to switch on"),
        ("reset-fault", "ready to switch on"),
    ):
        reported = ask("state", command, "--yes", *way)
        assert reported.status == 0, reported.err
        assert f"state        {state}\n" in reported.out
        assert "\nleft so: " in reported.out
    assert "left so" not in ask("state", *way).out


def test_version(way: tuple[str, ...]) -> None:
    out = ask("version", *way).out
    for text in ("EPOS2", "0x6420", "0x2126", "0x66208001595"):
        assert text in out


PATIENT = ("--timeout", "10000", "--listen", "0")
"""Long times, for a busy machine."""


def test_who_is_there(on: Bench) -> None:
    reported = ask("scan", "--node", "1-2", *PATIENT, *on.can)
    assert (reported.status, reported.err) == (0, "")
    head, *rows, silent = [" ".join(line.split()) for line in reported.out.splitlines()]
    assert head == "node device version serial number network state"
    assert rows == [
        f"{node} EPOS2 70/10 software 0x2126, hardware 0x6420 0x66208001595{5 + node - 1} pre-operational "
        "switch on disabled"
        for node in (1, 2)
    ]
    assert silent == "silent: none"
    found = data(ask("scan", "-n", "1", "--json", *PATIENT, *on.can))
    assert [(each["node"], each["device"], each["software"]) for each in found["nodes"]] == [
        (1, "EPOS2 70/10", 0x2126)
    ]


def test_who_is_behind_a_line(on: Bench) -> None:
    reported = ask("scan", "--node", "1-3", *on.serial)
    assert [line[:1] for line in reported.out.splitlines()] == ["n", "1", "2", "s"]
    assert reported.out.endswith("silent: 3\n")
    other = ask("scan", "--gateway", "2", *on.serial)
    assert "the drive on the line is node 1, not 2; nothing was done" in other.line


def test_a_bus_where_no_one_answers_is_reported(on: Bench) -> None:
    reported = ask("scan", "--node", "5-6,9", "--timeout", "5", "--listen", "0", *on.can)
    assert (reported.status, reported.out) == (1, "silent: 5-6,9\n")
    assert f"no one answers on {on.channel}: are they on, on this bus, at this bit rate" in reported.line


def test_network_commands(way: tuple[str, ...]) -> None:
    reported = ask("nmt", "start", *way)
    assert reported.status == 0, reported.err
    assert "and the drive did so" in reported.out
    assert "network      operational\n" in ask("state", *way).out
    assert ask("nmt", "reset-node", *way).status == 0
    assert "remote" not in ask("state", *way).out
    assert "and no one answers that" in ask("nmt", "start", *way[:4], "--node", "0").out
    assert "network      operational\n" in ask("state", *way).out


def test_json_of_read(way: tuple[str, ...]) -> None:
    found = data(ask("read", "statusword", "0x1008", "--json", *way))
    assert set(found) == {"node", "objects"}
    assert found["objects"][0] == {
        "index": "0x6041",
        "subindex": 0,
        "name": "Statusword",
        "type": "UNSIGNED16",
        "value": 0x0540,
        "raw": "4005",
        "unit": "",
        "words": ["switch on disabled", "target reached"],
    }
    assert found["objects"][1]["value"] == "EPOS2"


def test_json_reports_a_refusal_in_its_place(on: Bench) -> None:
    reported = ask("read", "0x5555", "statusword", "--json", *on.can)
    assert reported.status == 1
    missing, word = json.loads(reported.out)["objects"]
    assert missing["error"] == {"code": "0x06020000", "text": "0x06020000 no such object"}
    assert "value" not in missing
    assert "error" not in word
    assert "check the index" in reported.line


def test_json_of_the_others(on: Bench) -> None:
    written = data(ask("write", "0x6081", "7", "--json", *on.can))
    assert (written["node"], written["written"]["value"]) == (1, 7)
    state = data(ask("state", "--json", *on.serial))
    assert set(state) == {"node", "state", "mode", "network", "next", "history", "objects"}
    assert state["next"] == "0x0006 to 0x6040, shutdown"
    assert (state["node"], state["state"], state["history"]) == (None, "switch on disabled", [])
    assert state["mode"] == {"number": 1, "name": "profile position"}
    assert state["network"] == ["pre-operational", "stopped"]
    assert data(ask("version", "--json", *on.can))["objects"][1]["value"] == 0x6420
    sent = data(ask("nmt", "start", "--json", *on.serial))
    assert sent == {"node": 1, "command": "start", "seen": True}


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("write", "statusword", "3"), "write 3 to 0x6041 Statusword: 0x06010002 object is read-only; it"),
        (("write", "0x607F", "25001rpm"), "0x06090031 value too high (a 70/10 allows 0 to 25000); choose"),
        (("write", "0x607A", "1", "--size", "2"), "leave --size out"),
        (("write", "0x5555", "1"), "0x06020000 no such object; this drive has no such object"),
        (("write", "0x6040:7", "0"), "0x06090011 no such sub-index; check the sub-index"),
        (("read", "buffer-clear"), "0x06010001 object is write-only; it can be written only"),
        (("write", "0x1010:1", "5"), "wrong password; write `save` or `load`"),
        (("read", "statusword", "--node", "9"), "node 9 on"),
        (("state", "enable", "--yes", "--node", "9"), "does not answer"),
        (("nmt", "start", "--node", "9"), "does not answer"),
    ],
)  # fmt: skip
def test_what_the_drive_refuses_is_reported_in_words(
    on: Bench, words: tuple[str, ...], reported: str
) -> None:
    found = ask(*words, *on.can)
    assert found.status == 1
    assert reported in found.line


def test_a_node_behind_the_line_that_is_not_there_is_reported(on: Bench) -> None:
    found = ask("read", "statusword", *on.serial, "--node", "9")
    assert found.status == 1
    assert "node 9" in found.line
    assert "does not answer through the drive on the line" in found.line


def test_another_drive_on_the_line_than_named_is_reported(on: Bench) -> None:
    found = ask("write", "0x6081", "7", *on.serial, "--gateway", "2")
    assert found.status == 1
    assert "the drive on the line is node 1, not 2; nothing was done" in found.line
    assert ask("read", "0x6081", *on.serial, "--gateway", "1", "--node", "2").status == 0


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("read", "stausword"), "did you mean statusword"),
        (("write", "serial-number", "1"), "use the index"),
        (("write", "profile-velocity", "fast"), "'fast' is no value for 0x6081 Profile Velocity; give"),
        (("write", "profile-velocity", "5mA"), "is in rpm"),
        (("write", "controlword", "70000"), "2 bytes hold 0 to 65535"),
        (("write", "0x2004", "1"), "values of up to 4 can be written"),
        (("write", "target-velocity", "5"), "follows it at once; use --yes where that is safe"),
        (("write", "controlword", "0x0F"), "it enables operation, and may start a move; use --yes"),
        (("state", "enable"), "it may start to move; use --yes"),
        (("read", "statusword", "--baud", "9600"), "--baud: only a serial line has that"),
        (("read", "statusword", "--gateway", "1", "--baud", "9600"), "--baud, --gateway: only a serial"),
        (("read", "statusword", "--serial", "/dev/null", "-c", "can0"), "-c: only the CAN bus has that"),
        (("read", "statusword", "--serial", "/dev/no-such"), "/dev/no-such at 115200 Bd: there is no"),
        (("state", "--serial", "/dev/no-such", "--protocol", "v2"), "/dev/no-such at 1000000 Bd"),
        (("read", "statusword", "--serial", "/dev/null"), "cannot open serial port /dev/null"),
        (("write", "0x6081", "5", "--size", "4", "--serial", "/dev/null"), "always carries four bytes"),
        (("scan", "--serial", "/dev/no-such"), "/dev/no-such at 115200 Bd: there is no"),
        (("scan", "--node", "0-3"), "--node 0-3: nodes are numbered 1 to 127"),
        (("scan", "-i", "socketcan", "-c", "nosuchcan0"), "nosuchcan0"),
        (("read", "statusword", "-i", "smoke", "-c", "0"), "The interfaces are"),
        (("read", "statusword", "-i", "socketcan", "-c", "nosuchcan0"), "nosuchcan0"),
    ],
)  # fmt: skip
def test_mistakes_are_reported_in_one_line_before_anything_is_sent(
    words: tuple[str, ...], reported: str
) -> None:
    found = ask(*words)
    assert found.status == 2
    assert reported in found.line
    assert not found.out


def test_a_line_in_use_is_reported(on: Bench) -> None:
    with serial.Serial(on.path, exclusive=True):
        found = ask("read", "statusword", *on.serial)
    assert found.status == 2
    assert "it is in use; end the program that has it" in found.line


@pytest.mark.parametrize("words", [("read",), ("read", "--watch"), ("write",), ("write", "0x6081"), ("nmt",)])
def test_a_command_that_lacks_its_words_states_which(words: tuple[str, ...]) -> None:
    result = CliRunner().invoke(program, ["epos2", *words], env={"COLUMNS": "200", "TERM": "dumb"})
    assert isinstance(result.exception, SystemExit)
    assert result.exit_code == 2
    assert "missing argument" in result.output


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_explains_itself_with_an_example(command: str) -> None:
    result = CliRunner().invoke(program, ["epos2", command, "--help"], env={"COLUMNS": "200", "TERM": "dumb"})
    assert result.exit_code == 0
    assert f"firmware-bridge epos2 {command}" in result.stdout


def test_every_readable_number_can_be_read_over_the_line(on: Bench) -> None:
    named = [
        str(row.address) for row in EPOS2_70_10.objects.values() if row.access.readable and row.type.size
    ]
    reported = ask("read", *named, *on.serial)
    assert reported.status == 0, reported.err
    assert len(reported.out.splitlines()) == len(named)


def test_the_group_needs_no_simulation() -> None:
    code = (
        "import sys; sys.modules['emulators'] = None\n"
        "from firmware_bridge.cli import program\n"
        "program(['epos2', '--help'])"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "TERM": "dumb"},
    )
    assert ended.returncode == 0, ended.stderr
    for command in COMMANDS:
        assert f" {command} " in ended.stdout
    assert " fidelity " not in ended.stdout
    assert "the commands of 'emulators' are left out" in ended.stderr
