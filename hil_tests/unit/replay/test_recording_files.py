"""Recordings that cannot be used: one clear message each, with the file, the place and what is wrong."""

import gzip
import lzma
from pathlib import Path

import hypothesis.strategies as st
import pytest
from hypothesis import HealthCheck, given, settings
from typer.testing import CliRunner

from emulators.replay import Into, RecordingFileError, ReplayOrder, replay
from emulators.replay.recordings import Recording, cut_off, read_can, read_lines, read_telemetry
from firmware_bridge.cli import program
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.packet import Packet
from firmware_bridge.recording import candump_line, tlog_records
from firmware_bridge.robot_types import find
from firmware_bridge.units import SECOND

RARS = find("rars")
REAL = 1_700_000_000 * SECOND
BOOT = candump_line(0, Packet("can", 0x701, b"\0"), "can0", REAL)
BEAT = candump_line(SECOND, Packet("can", 0x764, b"\x05"), "can0", REAL)
BEFORE = candump_line(SECOND // 2, Packet("can", 0x764, b"\x05"), "can0", REAL)
OTHER = candump_line(SECOND, Packet("can", 0x701, b"\0"), "can1", REAL)
HEARTBEAT = Codec(255, 190).encode(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
TLOG = tlog_records(0, HEARTBEAT, REAL)
LINE = "(1700000000.000000000) board T 62 0D"
EARLIER = "(1600000000.000000000) board R 62 0D"

NO_LINE = "a.log, line 1: no line of a candump log"
BAD: dict[str, tuple[str, bytes, str]] = {
    "empty": ("a.log", b"", "a.log: holds no CAN frame"),
    "blank lines": ("a.log", b"\n\n", "a.log: holds no CAN frame"),
    "binary": ("a.log", f"{BOOT}\n".encode() + bytes(range(256)), "a.log, line 2: no "),
    "not ASCII": ("a.log", f"{BOOT}\n\xe4\n".encode(), "a.log, line 2: no text; a CAN log has a line for"),
    "of the terminal": ("a.log", b"  can0  701   [1]  00\n", NO_LINE),
    "CAN FD": ("a.log", b"(1.000000) can0 701##100\n", NO_LINE),
    "nine bytes": ("a.log", b"(1.000000) can0 701#" + b"00" * 9, NO_LINE),
    "a long line": ("a.log", b"x" * 999, f"{NO_LINE}, as '(12.345678) can0 123#DEADBEEF': '{'x' * 80}...'"),
    "back in time": ("a.log", f"{BOOT}\n{BEAT}\n{BEFORE}\n".encode(), "a.log, line 3: its instant is before"),
    "two buses": ("a.log", f"{BOOT}\n{OTHER}\n".encode(), "a.log: holds frames of can0, can1; choose"),
    "of no one here": ("a.log", b"(1.000000) can0 710#00\n", "a.log: holds no frame of a drive of rars"),
    "no gzip": ("a.log.gz", BOOT.encode(), "a.log.gz: cannot be unpacked: "),
    "no xz": ("a.log.xz", BOOT.encode(), "a.log.xz: cannot be unpacked: "),
    "empty telemetry": ("a.tlog", b"", "a.tlog: holds no MAVLink message"),
    "cut telemetry": ("a.tlog", TLOG[:-1], "a.tlog: no whole MAVLink message at byte 8 "),
    "text as telemetry": ("a.tlog", BOOT.encode(), "a.tlog: no whole MAVLink message at byte 8 "),
    "cut lines": ("serial.log", b"(1.000000000) board T 6", "serial.log, line 1: no line of bytes, as '("),
    "a bad line": ("b.log", f"{LINE}\n(1.000000000) board\n".encode(), "b.log, line 2: no line of bytes, as"),
    "a bad place": ("b.log", f"{LINE}\n(9.000000000) a R 1.1.1:1 0\n".encode(), "b.log, line 2: no line of"),
    "lines back in time": ("b.log", f"{LINE}\n{EARLIER}\n".encode(), "b.log, line 2: its instant is before"),
    "another's lines": ("b.log", f"{LINE}\n".encode(), "b.log, line 1: rars has no line 'board'; it has:"),
    "empty lines": ("serial.log", b"\n", "serial.log: holds nothing that a line has carried"),
    "no lines": ("capture.log", b"(1.0) can0 701#00\n", "capture.log, line 1: no line of bytes, as"),
    "telemetry back in time": ("a.tlog", tlog_records(1000, HEARTBEAT, REAL) + TLOG, "a.tlog, message 2"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_a_bad_file_is_one_message_and_status_2(case: str, tmp_path: Path) -> None:
    name, content, message = BAD[case]
    file = tmp_path / name
    file.write_bytes(content)
    result = CliRunner().invoke(program, ["replay", str(file), "rars"])
    assert result.exit_code == 2
    assert result.stderr.startswith(f"firmware-bridge: {message}")
    assert result.stderr.count("\n") == 1
    assert result.stdout == ""


CUT: dict[str, tuple[str, bytes, str]] = {
    "in a frame": ("a.log", f"{BOOT}\n{BEAT}"[:-3].encode(), "a.log: its end is cut off; line 2 is left out"),
    "in an instant": ("a.log", f"{BOOT}\n(17".encode(), "a.log: its end is cut off; line 2 is left out"),
    "zeros": ("a.log", f"{BOOT}\n".encode() + bytes(700), "a.log: its end is cut off"),
    "a frame and zeros": ("a.log", f"{BOOT}\n{BEAT}"[:-1].encode() + bytes(9), "a.log: its end is cut off"),
    "gzip": ("a.log.gz", gzip.compress(f"{BOOT}\n".encode())[:-5], "a.log.gz: its end is cut off"),
    "xz": ("a.log.xz", lzma.compress(f"{BOOT}\n".encode())[:-9], "a.log.xz: its end is cut off"),
}  # fmt: skip


@pytest.mark.parametrize("case", CUT)
def test_what_is_there_of_a_recording_that_is_cut_off_is_played_and_shown(case: str, tmp_path: Path) -> None:
    """As after a loss of power, a kill, a full stick."""
    name, content, message = CUT[case]
    file = tmp_path / name
    file.write_bytes(content)
    played = CliRunner().invoke(program, ["replay", str(file), "rars"])
    assert played.exit_code == 0, played.stderr
    assert played.stdout.startswith(message)
    assert len(read_can(file, None).entries) == 1
    shown = CliRunner().invoke(program, ["monitor", "--log", str(file)])
    assert shown.exit_code == 0, shown.stderr
    assert "its end is cut off" in shown.stdout
    assert "1 frames in 0.000 s" in shown.stdout


def test_the_last_record_of_lines_and_of_telemetry_may_be_cut_off(tmp_path: Path) -> None:
    lines, telemetry = tmp_path / "serial.log", tmp_path / "a.tlog"
    lines.write_text(f"{LINE}\n{LINE}"[:-1], encoding="ascii")
    assert [entry.packet.payload for entry in read_lines(lines).entries] == [b"b\r"]
    for cut in range(1, len(TLOG)):
        telemetry.write_bytes(TLOG + TLOG[:cut])
        assert len(read_telemetry(telemetry).entries) == 1, cut
        assert cut_off(telemetry) == "a.tlog: its end is cut off; its last message is left out"
    telemetry.write_bytes(TLOG + b"12345678no message")
    with pytest.raises(RecordingFileError, match="no whole MAVLink message at byte"):
        read_telemetry(telemetry)
    for whole in (f"{LINE}\n{LINE}", f"{LINE}\n"):
        lines.write_text(whole, encoding="ascii")
        assert cut_off(lines) is None


def test_a_telemetry_log_is_no_bus_and_what_reads_it_is_named(tmp_path: Path) -> None:
    file = tmp_path / "operator.tlog"
    file.write_bytes(TLOG)
    shown = CliRunner().invoke(program, ["monitor", "--log", str(file)])
    assert shown.exit_code == 2
    assert "a telemetry log is no bus: `firmware-bridge replay` plays it" in shown.stderr


@pytest.mark.parametrize("name", ["missing.log", "missing.tlog", "missing.log.gz"])
def test_a_file_that_is_not_there(name: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(program, ["replay", str(tmp_path / name), "rars"])
    assert result.exit_code == 2
    assert result.stderr.endswith(f"{name}: cannot be read: No such file or directory\n")


ORDERS: dict[str, tuple[Into, str, str | None, str]] = {
    "telemetry into the drives": (Into.DRIVES, "a.tlog", None, "a telemetry log is played into the bench"),
    "telemetry into the bridge": (Into.BRIDGE, "a.tlog", None, "a telemetry log is played into the bench"),
    "frames into the bench": (Into.BENCH, "a.log", None, "wants one telemetry log"),
    "the drives' operator": (Into.DRIVES, "a.log", "a.tlog", "a.tlog: the drives take no operator"),
    "a bridge that is silent": (Into.BRIDGE, "silent.log", None, "holds no word of a bridge"),
    "no one answers": (Into.BENCH, "a.tlog", None, "a.tlog: holds no message of the bridge of rars"),
    "another day's operator": (Into.BRIDGE, "a.log", "b.tlog", "b.tlog: was recorded at another time"),
}


@pytest.mark.parametrize("case", ORDERS)
def test_what_does_not_go_together_is_refused(case: str, tmp_path: Path) -> None:
    into, name, operator, message = ORDERS[case]
    (tmp_path / "a.log").write_text(f"{BOOT}\n{BEAT}\n", encoding="ascii")
    (tmp_path / "silent.log").write_text(f"{BOOT}\n", encoding="ascii")
    (tmp_path / "a.tlog").write_bytes(TLOG)
    (tmp_path / "b.tlog").write_bytes(tlog_records(0, HEARTBEAT, 2 * REAL))
    order = ReplayOrder(RARS, tmp_path / name, None if operator is None else tmp_path / operator, into)
    with pytest.raises(RecordingFileError, match=message):
        replay(order)


def test_a_bridge_on_a_serial_line_sends_no_frames(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text(f"{BOOT}\n{BEAT}\n", encoding="ascii")
    with pytest.raises(RecordingFileError, match="is on a serial line"):
        replay(ReplayOrder(over_serial(RARS, Generation.V2), tmp_path / "a.log", into=Into.BRIDGE))


def test_one_of_two_buses_is_chosen(tmp_path: Path) -> None:
    file = tmp_path / "a.log"
    file.write_text(f"{BOOT}\r\n{OTHER}\r\n{BEAT}\r\n\r\n", encoding="ascii")
    assert [one.where for one in read_can(file, "can0").entries] == ["a.log, line 1", "a.log, line 3"]
    with pytest.raises(RecordingFileError, match="holds no frame of 'can2', but of can0, can1"):
        read_can(file, "can2")


def test_reports_of_the_recorders_controller_are_left_out(tmp_path: Path) -> None:
    file = tmp_path / "a.log"
    file.write_text(f"(1.000000) can0 20000004#0004000000000000\n{BOOT}\n", encoding="ascii")
    assert [one.packet.address for one in read_can(file, None).entries] == [0x701]


@pytest.mark.parametrize(("suffix", "pack"), [(".gz", gzip.compress), (".xz", lzma.compress)])
def test_compressed_files_are_read_as_they_are(suffix: str, pack: object, tmp_path: Path) -> None:
    assert callable(pack)
    (tmp_path / f"a.log{suffix}").write_bytes(pack(BOOT.encode()))
    (tmp_path / f"a.tlog{suffix}").write_bytes(pack(TLOG))
    assert len(read_can(tmp_path / f"a.log{suffix}", None).entries) == 1
    assert len(read_telemetry(tmp_path / f"a.tlog{suffix}").entries) == 1


def read_can_log(path: Path) -> Recording:
    return read_can(path, None)


READERS = {".tlog": read_telemetry, ".serial": read_lines}


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=80), st.sampled_from(["a.log", "a.tlog", "a.log.gz", "a.log.xz", "a.serial"]))
def test_any_bytes_are_read_or_refused(tmp_path: Path, content: bytes, name: str) -> None:
    file = tmp_path / name
    file.write_bytes(content)
    refused = None
    try:
        recording = READERS.get(file.suffix, read_can_log)(file)
    except RecordingFileError as error:
        refused = str(error)
    assert refused is None or (refused.startswith("a.") and "\n" not in refused)
    assert refused is not None or recording.entries
