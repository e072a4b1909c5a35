"""Recordings of other tools hold the frames that candump's log of the run holds, and garbage is one line."""

import re
from pathlib import Path

import can
import pytest

from emulators.replay.recordings import RecordingFileError, is_lines, read_can
from firmware_bridge.cli.program import main
from firmware_bridge.mcap_file.channels import SUFFIX as MCAP
from firmware_bridge.mcap_file.writer import RecordingWriter
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import EPOCH, candump_line
from firmware_bridge.runtime.can_files import SUFFIXES, frames, is_foreign
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import EXTENDED, REMOTE

REMOTE_ONE = (3 * SECOND, Packet(CAN, 0x701 | REMOTE, b"\x00"))
FRAMES = (
    (2 * SECOND, Packet(CAN, 0x701, b"\x00")),
    (2 * SECOND + 56 * MICROSECOND, Packet(CAN, 0x181, bytes(range(8)))),
    (2 * SECOND + 300 * MICROSECOND, Packet(CAN, 0x12345678 | EXTENDED, b"\xff")),
    REMOTE_ONE,
    (70 * SECOND, Packet(CAN, 0x80, b"")),
)


def known(suffix: str) -> list[tuple[Nanoseconds, Packet]]:
    """Return the frames that a format can hold: python-can knows no remote ones in PEAK's."""
    return [one for one in FRAMES if suffix != ".trc" or one is not REMOTE_ONE]


def written(path: Path) -> Path:
    """Write the frames by python-can's own writer, and an error frame among them; MCAP by this project's."""
    if path.suffix == MCAP:
        with path.open("wb") as file:
            writer = RecordingWriter(file, {})
            for at, packet in FRAMES:
                writer.frame(at, "can0", packet, sent=False)
            writer.finish()
        return path
    with can.Logger(path) as out:
        for at, packet in known(path.suffix):
            address = packet.address & ~(EXTENDED | REMOTE)
            message = can.Message(
                timestamp=(EPOCH + at) / SECOND,
                arbitration_id=address,
                is_extended_id=bool(packet.address & EXTENDED),
                is_remote_frame=bool(packet.address & REMOTE),
                dlc=len(packet.payload),
                data=b"" if packet.address & REMOTE else packet.payload,
                channel=0,
            )
            out.on_message_received(message)
        if path.suffix != ".trc":  # its writer supports none
            out.on_message_received(
                can.Message(timestamp=(EPOCH + 71 * SECOND) / SECOND, is_error_frame=True)
            )
    return path


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_frames_are_those_that_were_written(suffix: str, tmp_path: Path) -> None:
    path = written(tmp_path / f"run{suffix}")
    assert is_foreign(path)
    assert not is_lines(path)
    wanted = known(suffix)
    found = [(at, packet) for at, _bus, packet in frames(path)]
    assert [packet for _, packet in found] == [packet for _, packet in wanted]
    began = found[0][0] if suffix == ".asc" else wanted[0][0]
    assert [at - began for at, _ in found] == [at - wanted[0][0] for at, _ in wanted]
    recording = read_can(path, None)
    assert [entry.packet for entry in recording.entries] == [packet for _, packet in wanted]
    assert recording.entries[1].where == f"run{suffix}, frame 2"
    assert recording.virtual is (suffix != ".asc"), "only a log with the hour has the bench's"


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_monitor_draws_the_same_of_them_as_of_candumps(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "can.log"
    log.write_text(
        "".join(f"{candump_line(at, packet, 'can0')}\n" for at, packet in known(suffix)), encoding="ascii"
    )
    drawn = []
    for path in (log, written(tmp_path / f"run{suffix}")):
        monkeypatch.setattr("sys.argv", ["firmware-bridge", "monitor", "--log", str(path)])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code in {0, None}
        drawn.append(re.sub(r"\d+\.\d+ %", "", capsys.readouterr().out))
    assert drawn[0] == drawn[1]
    assert "701" in drawn[0]


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("content", [b"garbage\n", b"\x00\xff" * 40, b""])
def test_what_is_no_such_recording_is_one_line(suffix: str, content: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"broken{suffix}"
    path.write_bytes(content)
    with pytest.raises(RecordingFileError, match=re.escape(path.name)) as reported:
        read_can(path, None)
    assert "\n" not in str(reported.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(RecordingFileError, match=r"nowhere\.blf: cannot be read: No such file"):
        read_can(tmp_path / "nowhere.blf", None)
