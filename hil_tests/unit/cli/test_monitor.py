"""`monitor`: a bus in words, live over a port that must not be written to, and from a recording."""

import gzip
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

import pytest
from rich.console import Console
from typer.testing import CliRunner

from firmware_bridge.cli import program
from firmware_bridge.cli.monitor import Listening
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction, chunk_line, device_side
from firmware_bridge.runtime.ports import LostPort
from firmware_bridge.units import NEVER, Nanoseconds
from hil_tests.rows import every

RECEIVED = (
    (0x703, b"\0"),
    (0x703, b"\x7f"),
    (0x083, bytes.fromhex("2032040000000000")),
    (0x183, b"\x37\x07"),
)
LOG = """(1577836800.000000) can0 703#00
(1577836800.100000) can0 703#7F
(1577836800.200000) can0 083#2032040000000000
(1577836800.300000) can0 183#3707
"""
LINES = """(1577836803.000000000) board T 65 0D
(1577836803.002528000) board R 31 20 2D 32
(1577836803.006624000) board R 20 33 0D 0A
"""


class Scripted:
    """A port on which some frames come, and that is lost then. To write to it is what must not be."""

    name = "a scripted bus"
    retry_at: Nanoseconds = NEVER

    def __init__(self, frames: Sequence[tuple[int, bytes]]) -> None:
        self._frames = list(frames)
        self._readable, self._writable = os.pipe()
        os.write(self._writable, b"!")
        self.closed = False

    def fileno(self) -> int:
        return self._readable

    def read(self, _now: Nanoseconds) -> list[tuple[int, bytes]]:
        if not self._frames:
            raise LostPort(self, "the interface is gone")
        frames, self._frames = self._frames, []
        return frames

    def write(self, address: int, _payload: bytes, _now: Nanoseconds) -> NoReturn:
        raise AssertionError(f"{address:03X} was sent by who only listens")

    def flush(self, _now: Nanoseconds) -> None: ...

    def close(self) -> None:
        if not self.closed:
            self.closed = True
            os.close(self._readable)
            os.close(self._writable)


def run(*words: str) -> Any:
    result = CliRunner().invoke(program, ["monitor", *words], env={"COLUMNS": "140"})
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def on_scripted(monkeypatch: pytest.MonkeyPatch, *words: str) -> Any:
    monkeypatch.setattr("firmware_bridge.runtime.ports.open_can", lambda *_, **_more: Scripted(RECEIVED))
    return run("-i", "virtual", "-c", "foreign", *words)


def test_a_live_bus_is_reported_change_by_change_and_as_a_picture_at_its_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    reported = on_scripted(monkeypatch)
    assert reported.exit_code == 1
    assert "lost a scripted bus: the interface is gone" in reported.stderr
    lines = reported.stdout.splitlines()
    assert lines[0] == "listening on foreign; Ctrl-C ends it"
    assert [line.partition(" s  ")[2] for line in lines[1:5]] == [
        "node 3 is there",
        "node 3: restarted",
        "node 3: pre-operational",
        "EMCY node 3: 0x3220, under-voltage; error register 0x04 (voltage)",
    ]
    assert "37 07, by a mapping that is not known" in reported.stdout


def test_on_a_terminal_it_is_drawn_and_nothing_is_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = Console(force_terminal=True, width=140, height=50, record=True)
    monkeypatch.setattr("firmware_bridge.cli.tables.terminal", lambda: screen)
    monkeypatch.setattr("firmware_bridge.cli.monitor.on_a_terminal", lambda: True)
    on_scripted(monkeypatch)
    shown = screen.export_text()
    assert "last error: " in shown
    assert "node 3 is there" not in shown, "no lines beside the picture"


def test_who_listens_sends_nothing_whatever_comes() -> None:
    node = Listening(BusPicture(1_000_000), lambda _: None, lambda: None)
    for number, (address, payload) in enumerate(
        (*RECEIVED, (0x603, b""), (0x000, b"\x81\0"), (0x703, b"\x05"))
    ):
        assert node.wake(number).sent == ()
        assert node.receive(Packet(CAN, address, payload), number).sent == ()


@pytest.mark.parametrize("compressed", [False, True])
def test_a_recording_is_one_picture(tmp_path: Path, *, compressed: bool) -> None:
    path = tmp_path / ("can.log.gz" if compressed else "can.log")
    path.write_bytes(gzip.compress(LOG.encode()) if compressed else LOG.encode())
    reported = run("--log", str(path), "--robot", "rars", "-b", "500000")
    assert reported.exit_code == 0, reported.stderr
    assert reported.stdout == run("--log", str(path), "--robot", "rars", "-b", "500000").stdout
    first, error, *_ = reported.stdout.splitlines()
    assert first.startswith("4 frames in 0.300 s; load at 500 kbit/s: ")
    assert error == "last error: 0.200 s, EMCY node 3: 0x3220, under-voltage; error register 0x04 (voltage)"
    assert "3 steering" in reported.stdout
    assert "0x0737 (operation enabled, power stage on" in reported.stdout


BUSMASTER = """date Mon Dec 6 11:21:13 am 2021
base hex  no internal events logged
// version 7.1.0
40874.808200 1 701 Rx d 1 00
40874.809100 1 181 Rx d 2 40 05
40874.810300 1 000 Tx d 2 01 01
"""


def test_the_first_frame_of_a_recording_of_busmaster_counts(tmp_path: Path) -> None:
    path = tmp_path / "busmaster.asc"
    path.write_text(BUSMASTER, encoding="ascii")
    reported = run("--log", str(path), "--device", "epos2")
    assert reported.stdout.startswith("3 frames in 0.002 s")
    assert "0x0540 (switch on disabled" in reported.stdout
    assert "operational" in reported.stdout


@pytest.mark.parametrize("second", [1, 1_000_000_000, 1_577_836_800])
def test_a_recording_of_any_year_has_its_own_length_and_rates(tmp_path: Path, second: int) -> None:
    path = tmp_path / "can.log"
    path.write_text("".join(f"({second}.{k}00000) can0 701#05\n" for k in range(10)), encoding="ascii")
    reported = run("--log", str(path))
    assert reported.stdout.startswith("10 frames in 0.900 s")
    assert "100 ms" in reported.stdout


def test_a_configuration_file_reports_how_its_node_is_set_up(tmp_path: Path) -> None:
    path, sheet = tmp_path / "can.log", tmp_path / "drive.dcf"
    path.write_text("(1.000000) can0 201#03\n", encoding="ascii")
    sheet.write_text(
        "[DeviceComissioning]\nNodeID=5\n[1800sub1]\nParameterValue=0x201\n"
        "[1A00]\nParameterValue=1\n[1A00sub1]\nParameterValue=0x60610008\n",
        encoding="ascii",
    )
    assert "0x6061 Modes of Operation Display = 3" in run("--log", str(path), "--dcf", str(sheet)).stdout


@pytest.mark.parametrize("compressed", [False, True])
def test_a_recording_of_lines_is_stated_line_by_line(tmp_path: Path, *, compressed: bool) -> None:
    path = tmp_path / ("serial.log.gz" if compressed else "serial.log")
    path.write_bytes(gzip.compress(LINES.encode()) if compressed else LINES.encode())
    reported = run("--log", str(path), "--robot", "rome")
    assert reported.exit_code == 0, reported.stderr
    assert reported.stdout.splitlines() == [
        "0.000000000 s  board  bridge  650D  read encoders",
        "0.002528000 s  board  board  31202D32  part of a line",
        "0.006624000 s  board  board  20330D0A  answer to read encoders: 1 -2 3",
    ]
    assert run("--log", str(path), "--robot", "rome", "-c", "board").stdout == reported.stdout
    other = run("--log", str(path), "--robot", "rome", "--protocol", "firmata")
    assert "read encoders" not in other.stdout
    assert len(other.stdout.splitlines()) == 3


@every(
    ("kind", "received", "stated"),
    [
        ("ros-arduino-bridge", "650D", "read encoders"),
        ("mw", "5A0800810200006040 06CF", "#1 createMotorShield"),
        ("ar2-2.0", "544D71310A", "TM, echo: q1"),
        ("serial", "1001416000 01ABF0", "ReadObject: 0x6041 Statusword"),
    ],
)
def test_what_a_device_has_recorded_states_its_side_and_needs_no_robot(
    tmp_path: Path, kind: str, received: str, stated: str
) -> None:
    path, name = tmp_path / "serial.log", device_side("line", kind)
    host, device = Packet(name, 0, bytes.fromhex(received)), Packet(name, 0, b"O")
    lines = (chunk_line(0, name, Direction.RECEIVED, host), chunk_line(1, name, Direction.SENT, device))
    path.write_text("\n".join(lines), encoding="ascii")
    first, second = run("--log", str(path)).stdout.splitlines()
    assert first.startswith("0.000000000 s  line  bridge  ")
    assert stated in first
    assert second.startswith("0.000000001 s  line  line  4F")
    assert run("--log", str(path), "-c", "other").exit_code == 0


@every(
    ("words", "content", "reported"),
    [
        (("--log", "LOG", "-i", "virtual"), LOG, "a recording has no interface"),
        (("--log", "LOG", "-c", "can7"), LOG, "holds no frame of 'can7': it holds frames of can0; name one"),
        (("--log", "LOG"), LOG + LOG.replace("can0", "can1"), "frames of can0 and can1; choose one with -c"),
        (("--log", "LOG"), LOG + "nonsense\n", "line 5: no line of a candump log"),
        (("--log", "LOG"), "\xff", "cannot be read"),
        (("--log", "LOG.nowhere"), "", "cannot be read"),
        (("--link", "can", "--log", "LOG"), LOG, "only a robot has links"),
        (("--robot", "rars", "--link", "bus", "--log", "LOG"), LOG, "select one with --link"),
        (("--robot", "rome", "--log", "LOG"), LOG, "has no drives on a CAN bus"),
        (("--robot", "no one", "--log", "LOG"), LOG, "no one"),
        (("--log", "LOG"), LINES, "can.log: holds the bytes of lines; name their robot with --robot"),
        (
            ("--robot", "rome", "--log", "LOG"),
            LINES + "(1.000000) board\n",
            "line 4: no line of bytes",
        ),
        (("--robot", "ar2", "--log", "LOG"), LINES, "line 1: ar2 has no link 'board'; it has: arm"),
        (
            ("--robot", "rome", "--log", "LOG", "-c", "arm"),
            LINES,
            "-c arm: rome has no such link",
        ),
        (("--robot", "rome", "--protocol", "mx", "--log", "LOG"), LINES, "protocol: no 'mx'"),
        (("-i", "socketcan", "-c", "nosuchcan0"), LOG, "nosuchcan0"),
        (
            ("--log", "LOG"),
            "  can0  701   [1]  05\n",
            "what candump shows on the screen has no times",
        ),
        (
            ("--log", "LOG", "--device", "epos4"),
            LOG,
            "--device epos4: there is cia402, epos2; for any other use",
        ),
        (("--log", "LOG", "--dcf", "LOG"), LOG, "cannot be read as a data sheet"),
        (("--log", "LOG", "--dcf", "LOG"), "[6402]\nParameterValue=1\n", "it names no node"),
        (("--log", "LOG", "--eds", "LOG.none"), LOG, "cannot be read as a data sheet"),
    ],
)
def test_mistakes_are_reported_in_one_line(
    tmp_path: Path, words: tuple[str, ...], content: str, reported: str
) -> None:
    path = tmp_path / "can.log"
    path.write_text(content, encoding="latin-1")
    found = run(*(word.replace("LOG", str(path)) for word in words))
    assert found.exit_code == 2, found.output
    (line,) = found.stderr.splitlines()
    assert reported in line


REPEATED = (
    LOG
    + """(1577836800.400000) can0 183#3707
(1577836800.500000) can0 183#3702
(1577836800.600000) can0 000#8104
(1577836800.700000) can0 604#4041600000000000
(1577836800.800000) can0 080#
"""
)


def shown(tmp_path: Path, *words: str) -> list[str]:
    """Return the lines of a log, without the instants."""
    log = tmp_path / "can.log"
    log.write_text(REPEATED)
    result = run("--log", str(log), "--device", "epos2", *words)
    assert result.exit_code == 0, result.output
    return [line.split(maxsplit=2)[2] for line in result.stdout.splitlines()]


def test_each_frame_is_a_line_in_words(tmp_path: Path) -> None:
    lines = shown(tmp_path, "--lines")
    assert len(lines) == REPEATED.count("\n")
    assert [line.split()[0] for line in lines] == [
        "703", "703", "083", "183", "183", "183", "000", "604", "080"
    ]  # fmt: skip
    assert "EMCY node 3: under-voltage" in lines[2].replace("0x3220, ", "")
    assert "NMT reset node, node 4" in lines[6]
    assert "read" in lines[7]


def test_changes_leave_out_what_repeats(tmp_path: Path) -> None:
    lines = shown(tmp_path, "--changes", "--filter", "pdo")
    assert [line.split()[0] for line in lines if line.startswith("183")] == ["183", "183"]
    assert not [line for line in lines if line.startswith(("703", "000"))]


@pytest.mark.parametrize(
    ("words", "identifiers"),
    [
        (("--filter", "nmt,sync"), ["000", "080"]),
        (("--filter", "180-1FF"), ["183", "183", "183"]),
        (("--filter", "0x703,emergency"), ["703", "703", "083"]),
        (("--node", "4"), ["000", "604", "080"]),
        (("--node", "3", "--filter", "heartbeat"), ["703", "703"]),
        (("--filter", "lss"), []),
    ],
)
def test_frames_are_chosen_by_service_identifier_and_node(
    tmp_path: Path, words: tuple[str, ...], identifiers: list[str]
) -> None:
    assert [line.split()[0] for line in shown(tmp_path, "--lines", *words)] == identifiers


OTHERS = """(1577836800.000000) can0 703#05
(1577836800.010000) can0 704#05
(1577836800.100000) can0 703#05
(1577836800.110000) can0 704#05
(1577836800.200000) can0 703#05
(1577836800.210000) can0 704#05
(1577836800.220000) can0 084#2032040000000000
(1577836800.300000) can0 703#05
(1577836800.400000) can0 703#05
(1577836800.500000) can0 703#05
"""


@pytest.mark.parametrize(("node", "missing"), [("3", False), ("4", True), ("3-4", True)])
def test_changes_of_other_nodes_are_left_out(tmp_path: Path, node: str, missing: bool) -> None:  # noqa: FBT001
    log = tmp_path / "can.log"
    log.write_text(OTHERS)
    printed = run("--log", str(log), "--changes", "--node", node).stdout
    for number in "34":
        assert (f"node {number} is there" in printed) is (number in {"3": "3", "4": "4", "3-4": "34"}[node])
    assert ("EMCY node 4" in printed) is missing
    assert ("node 4: no heartbeat for more than" in printed) is missing


def test_an_empty_recording_has_no_frame_of_a_bus(tmp_path: Path) -> None:
    log = tmp_path / "can.log"
    log.write_text("")
    result = run("--log", str(log), "-c", "can0")
    assert result.exit_code == 2
    assert "holds no frame of 'can0': it is empty; record while" in " ".join(result.stderr.split())
    for words in ((), ("--lines",)):
        result = run("--log", str(log), *words)
        assert result.exit_code == 0
        assert "can.log: holds no frame; record while frames are sent" in result.stderr


def test_a_link_that_a_recording_of_lines_does_not_have_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "serial.log"
    path.write_text(LINES.replace("board", "board~ros-arduino-bridge"), encoding="ascii")
    other = run("--log", str(path), "-c", "other")
    assert other.stdout == ""
    assert other.stderr.endswith("serial.log: holds nothing of 'other', but of board\n")
    assert run("--log", str(path), "-c", "board").stderr == ""


def test_on_a_bus_frames_are_lines_too(monkeypatch: pytest.MonkeyPatch) -> None:
    result = on_scripted(monkeypatch, "--lines", "--node", "3")
    assert "083 EMCY node 3" in result.stdout.replace("0.000 s", "").replace("   ", " ").replace("  ", " ")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--filter", "sdo"), "add --lines or --changes"),
        (("--node", "3"), "add --lines or --changes"),
        (("--lines", "--filter", "sod"), "--filter sod: give nmt"),
        (("--lines", "--filter", "1FF-180"), "--filter 1FF-180"),
        (("--lines", "--node", "x"), "--node x"),
    ],
)
def test_a_wrong_choice_of_frames_is_one_message(tmp_path: Path, words: tuple[str, ...], reason: str) -> None:
    log = tmp_path / "can.log"
    log.write_text(LOG)
    result = run("--log", str(log), *words)
    assert result.exit_code == 2
    assert reason in " ".join(result.stderr.split())
