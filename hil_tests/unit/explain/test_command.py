"""`explain` at the command line: its output, its forms, its exit statuses."""

import io
import json
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import pytest

from firmware_bridge.cli.explain import explain
from hil_tests.unit.explain.bus_log import CONTROLWORD, MODE, OFF, STATUSWORD, TARGET_VELOCITY, BusLog
from hil_tests.unit.explain.line_log import LineLog


@dataclass(frozen=True)
class Result:
    exit_code: int
    output: str


def run(*words: str) -> Result:
    """Run the command itself, as the program's row of it does."""
    output, status = io.StringIO(), 0
    with redirect_stdout(output), redirect_stderr(output):
        try:
            explain.main(args=list(words), prog_name="explain")
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 0
    return Result(status, output.getvalue())


@pytest.fixture
def mistaken(tmp_path: Path) -> Path:
    log = BusLog().started().write(MODE, 3).write(TARGET_VELOCITY, 500)
    return log.write(CONTROLWORD, 0x0F).shows(STATUSWORD, OFF).stands().save(tmp_path / "can.log")


@pytest.fixture
def good(tmp_path: Path) -> Path:
    return BusLog().started().beats(20).save(tmp_path / "good.log")


def test_incidents_end_with_status_1_and_a_verdict(mistaken: Path) -> None:
    result = run(str(mistaken))
    assert result.exit_code == 1
    lines = result.output.splitlines()
    assert "controlword 0x000F in switch on disabled has no transition: write 0x0006 first" in lines[0]
    assert "601#2B4060000F000000" in lines[1]
    assert [line.split()[0] for line in lines[1:6]] == [
        "evidence",
        "cause",
        "consequence",
        "recovery",
        "check",
    ]
    assert lines[-1].startswith(f"{mistaken}: 1 incident at 0.007000 s, node 1: a drive is commanded")
    assert "1 without recovery" in lines[-1]


def test_a_recording_without_incident_ends_with_status_0(good: Path) -> None:
    result = run(str(good))
    assert result.exit_code == 0
    assert result.output == f"{good}: no incident (24 frames, 1.9 s, 1 node)\n"


def test_a_run_s_folder_is_explained(mistaken: Path) -> None:
    assert run(str(mistaken.parent)).exit_code == 1


def test_data_for_programs(mistaken: Path) -> None:
    result = run(str(mistaken), "--json")
    assert result.exit_code == 1
    read = json.loads(result.output)
    assert read["format"] == 1
    assert read["nodes"] == [1]
    (one,) = read["incidents"]
    assert one["kind"] == "not_moving"
    assert one["node"] == 1
    assert one["evidence"]["frame"] == "601#2B4060000F000000"
    assert one["recovered_at_s"] is None


def test_a_table_for_a_summary(mistaken: Path, good: Path) -> None:
    lines = run(str(mistaken), "--markdown").output.splitlines()
    assert lines[0].startswith("### ")
    assert lines[2] == "| at | where | incident | likely cause | recovery | check first |"
    assert lines[4].count(" | ") == 5
    assert run(str(good), "--markdown").output.count("\n") == 1


def test_one_form_at_a_time(good: Path) -> None:
    result = run(str(good), "--json", "--markdown")
    assert result.exit_code == 2
    assert "choose one of them" in result.output


def test_a_robot_names_its_drives(tmp_path: Path) -> None:
    log = BusLog(3).boot().beats(10).frame(0x083, "2032040000000000").save(tmp_path / "can.log")
    assert "node 3 (steering): EMCY 0x3220" in run(str(log), "--robot", "rars").output


def test_defaults_of_a_family_decode_its_pdos(tmp_path: Path) -> None:
    log = BusLog().started().frame(0x401, "0F").beats(1).save(tmp_path / "can.log")
    assert run(str(log)).exit_code == 0
    result = run(str(log), "--device", "epos2")
    assert result.exit_code == 1
    assert "RPDO 3 has 1 bytes, its mapping 6" in result.output


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("0x8130",), "EMCY / error code 0x8130"),
        (("statusword 0x0537",), "statusword 0x0537: operation enabled"),
        (("controlword", "0x1F"), "controlword 0x001F: enable operation"),
        (("0x06090011", "--json"), '"kind": "abort code"'),
        (("0x06090011", "--markdown"), "* SDO abort code"),
    ],
)
def test_a_number_is_explained(words: tuple[str, ...], text: str) -> None:
    result = run(*words)
    assert result.exit_code == 0
    assert text in result.output


@pytest.mark.parametrize(
    ("words", "status", "text"),
    [
        (("0xDEADBEEF",), 2, "a number that is in no list"),
        (("nonsense",), 2, "neither a recording nor a number"),
        (("missing.log",), 3, "no such file or folder"),
        (("0x8130", "--link", "x"), 0, "EMCY"),
    ],
)
def test_a_wrong_argument_gives_one_message(words: tuple[str, ...], status: int, text: str) -> None:
    result = run(*words)
    assert result.exit_code == status
    assert text in result.output
    assert status == 0 or result.output.count("\n") == 1


@pytest.mark.parametrize("option", [("--link", "x"), ("--device", "x"), ("--robot", "rome")])
def test_a_wrong_option_gives_one_message(option: tuple[str, str], good: Path) -> None:
    result = run(str(good), *option)
    assert result.exit_code == 2
    assert result.output.count("\n") == 1


def test_an_unreadable_recording_ends_with_status_3(tmp_path: Path) -> None:
    path = tmp_path / "can.log"
    path.write_bytes(bytes(range(200)))
    result = run(str(path))
    assert result.exit_code == 3
    assert result.output.count("\n") == 1


def test_a_bus_that_is_not_in_the_recording_gives_one_message(good: Path) -> None:
    result = run(str(good), "-c", "can7")
    assert result.exit_code == 3
    assert "holds no frame of 'can7'" in result.output


@pytest.fixture
def line(tmp_path: Path) -> Path:
    log = LineLog()
    for cycle in range(60):
        log.exchanges(b"e\r", b"" if 20 <= cycle < 40 else b"1 2 3\r\n")
    return log.save(tmp_path / "serial.log")


@pytest.mark.parametrize("options", [(), ("--protocol", "ros-arduino-bridge"), ("-c", "board")])
def test_a_recording_of_a_serial_line_is_explained(options: tuple[str, ...], line: Path) -> None:
    result = run(str(line), *options)
    assert result.exit_code == 1
    assert "1.000000 s  line board: no answer to read encoders, and nothing else for 1.1 s" in result.output
    assert result.output.splitlines()[-1].endswith("(100 chunks, 3.0 s, 1 line)")


def test_a_robot_gives_the_protocols_of_its_lines(line: Path) -> None:
    protocol = ("--robot", "rome", "--protocol", "ros-arduino-bridge")
    assert "no answer to read encoders" in run(str(line), *protocol).output
    assert "use --protocol ros-arduino-bridge" in run(str(line), "--robot", "rome", "--protocol", "mw").output


def test_a_run_s_folder_with_lines_only_is_explained(line: Path) -> None:
    (line.parent / "can.log").touch()
    assert "line board" in run(str(line.parent), "--json").output


def test_lines_beside_a_bus_are_not_explained_and_a_note_names_them(line: Path) -> None:
    BusLog().started().beats(20).save(line.parent / "can.log")
    result = run(str(line.parent))
    assert "serial.log is not explained beside can.log" in result.output
    assert "1 node)" in result.output


def test_a_line_that_is_not_in_the_recording_gives_one_message(line: Path) -> None:
    result = run(str(line), "-c", "arm")
    assert result.exit_code == 3
    assert "holds no frame of 'arm'" in result.output


def test_a_protocol_is_of_serial_lines_only(good: Path) -> None:
    result = run(str(good), "--protocol", "mw")
    assert result.exit_code == 2
    assert "not of serial lines" in result.output


def test_a_damaged_line_ends_with_status_3_and_a_cut_off_end_with_a_note(line: Path) -> None:
    whole = line.read_text()
    line.write_text(whole + "(1577836803.0000000")
    assert "its end is cut off" in run(str(line)).output
    line.write_text(whole.replace(" R 31", " R 3", 1))
    assert run(str(line)).exit_code == 3
