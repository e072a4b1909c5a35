"""Files of other tools that `--record` writes: each frame, its channel, its instant, and one date for all."""

import datetime as dt
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import can
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.recording import EPOCH
from firmware_bridge.runtime.can_file_writer import CanFileWriter
from firmware_bridge.runtime.can_files import FROM_ITS_BEGIN, OF_FRAMES, frames
from firmware_bridge.units import MICROSECOND, SECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE
from firmware_bridge.wire.can_error import BUS_OFF

BUSES: Final = ("arm", "base")
READERS: Final = {".asc": can.ASCReader, ".blf": can.BLFReader, ".trc": can.TRCReader}
Row = tuple[Nanoseconds, str, Packet, bool]
"""Instant, bus, frame, and whether the bridge has sent it."""
ROWS: Final[tuple[Row, ...]] = (
    (1_234_999, "arm", Packet(CAN, 0x181, bytes(range(8))), False),
    (1_290_001, "base", Packet(CAN, 0x601, b"\x40\x41\x60"), True),
    (2 * SECOND, "base", Packet(CAN, 0x1 | EXTENDED, b"\xff"), True),
    (2 * SECOND, "arm", Packet(CAN, 0x1FFFFFFF | EXTENDED, b""), False),
    (3 * SECOND, "arm", Packet(CAN, 0x701 | REMOTE, bytes(1)), True),
    (3 * SECOND, "arm", Packet(CAN, 0x12345 | EXTENDED | REMOTE, bytes(8)), False),
    (3 * SECOND, "base", Packet(CAN, BUS_OFF, bytes(8)), False),
    (86_400 * SECOND + 999, "base", Packet(CAN, 0x7FF, b"\1"), False),
)


def written(path: Path, rows: tuple[Row, ...]) -> Path:
    with path.open("wb") as file:
        writer = CanFileWriter(file, path, BUSES)
        for at, bus, packet, sent in rows:
            writer.frame(at, bus, packet, sent=sent)
        writer.finish()
        assert file.closed
    return path


def messages(path: Path) -> list[can.Message]:
    return list(READERS[path.suffix](path))


def same(row: Row, message: can.Message, suffix: str) -> None:
    """Compare by what the format has."""
    at, bus, packet, sent = row
    # The dates of .blf and .trc stand in front; python-can leaves that of .asc out.
    began = 0 if suffix == ".asc" else EPOCH
    assert round(message.timestamp * 1e6) == (began + at) // MICROSECOND
    # python-can counts from 0 in Vector's formats, and leaves PEAK's number as it is.
    assert message.channel == BUSES.index(bus) + (suffix == ".trc")
    assert message.is_error_frame == bool(packet.address & ERROR)
    if message.is_error_frame:
        return
    assert message.arbitration_id == packet.address & ~(EXTENDED | REMOTE)
    assert message.is_extended_id == bool(packet.address & EXTENDED)
    assert message.is_remote_frame == bool(packet.address & REMOTE)
    assert message.is_rx is not sent
    assert message.dlc == len(packet.payload)
    assert bytes(message.data) == (b"" if message.is_remote_frame else packet.payload)


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_python_can_reads_each_frame_with_its_channel_and_instant(suffix: str, tmp_path: Path) -> None:
    held = [row for row in ROWS if suffix != ".trc" or not row[2].address & ERROR]
    found = messages(written(tmp_path / f"run{suffix}", ROWS))
    assert len(found) == len(held) > 6
    for row, message in zip(held, found, strict=True):
        same(row, message, suffix)


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_this_projects_reader_gives_the_packets_back(suffix: str, tmp_path: Path) -> None:
    found = list(frames(written(tmp_path / f"run{suffix}", ROWS)))
    held = [row for row in ROWS if not row[2].address & ERROR]
    first = 1 if suffix == ".trc" else 0
    began = FROM_ITS_BEGIN if suffix == ".asc" else 0
    assert found == [
        (began + at // MICROSECOND * MICROSECOND, f"can{BUSES.index(bus) + first}", packet)
        for at, bus, packet, _ in held
    ]


def test_a_bus_error_keeps_its_class_in_blf(tmp_path: Path) -> None:
    (report,) = (one for one in messages(written(tmp_path / "run.blf", ROWS)) if one.is_error_frame)
    assert (report.arbitration_id, bytes(report.data)) == (BUS_OFF & ~ERROR, bytes(8))


@pytest.fixture
def elsewhere() -> Iterator[None]:
    """Put the process into another time zone."""
    before = os.environ.get("TZ")
    os.environ["TZ"] = "Pacific/Auckland"
    time.tzset()
    yield
    os.environ.pop("TZ")
    if before is not None:
        os.environ["TZ"] = before
    time.tzset()


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_a_file_has_no_date_zone_or_path_of_its_run(
    suffix: str, tmp_path: Path, elsewhere: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    del elsewhere
    other = written(tmp_path / f"another{suffix}", ROWS).read_bytes()
    os.environ["TZ"] = "UTC"
    time.tzset()
    # Both clocks of python-can's writers.
    monkeypatch.setattr("can.io.asc.datetime", _Tomorrow)
    monkeypatch.setattr("can.io.blf.time.time", lambda: 2e9)
    assert written(tmp_path / f"run{suffix}", ROWS).read_bytes() == other
    assert str(tmp_path).encode() not in other


class _Tomorrow:
    """A `datetime` of another day, as far as the writer of .asc needs it."""

    @staticmethod
    def now() -> object:
        return dt.datetime(2031, 3, 4, 5, 6, 7)  # noqa: DTZ001 - as python-can has it


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_a_file_without_frames_is_whole(suffix: str, tmp_path: Path) -> None:
    assert messages(written(tmp_path / f"run{suffix}", ())) == []


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_what_was_flushed_is_read_without_the_end(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"run{suffix}"
    with path.open("wb") as file:
        writer = CanFileWriter(file, path, BUSES)
        for number in range(1000):
            writer.frame(number * MICROSECOND, "arm", Packet(CAN, 0x80, b""), sent=False)
        writer.flush()
        kept = tmp_path / f"kept{suffix}"
        kept.write_bytes(path.read_bytes())
        writer.finish()
    # A container of .blf is 8 KiB, 170 frames.
    assert len(messages(kept)) >= (800 if suffix == ".blf" else 1000)


def test_error_frames_that_a_format_lacks_are_counted_and_named(tmp_path: Path) -> None:
    path = tmp_path / "run.trc"
    with path.open("wb") as file:
        writer = CanFileWriter(file, path, BUSES)
        assert writer.remark(path) == ""
        writer.frame(0, "arm", Packet(CAN, BUS_OFF, bytes(8)), sent=False)
        assert writer.remark(path) == f"{path}: 1 error frames are left out; .asc, .blf and .mcap have them"
        writer.finish()


PACKETS: Final = st.builds(
    lambda flags, number, payload: Packet(
        CAN, flags | number & (0x1FFFFFFF if flags & EXTENDED else 0x7FF), payload
    ),
    st.sampled_from((0, EXTENDED)),
    st.integers(0, 0x1FFFFFFF),
    st.binary(max_size=8),
)


@pytest.mark.parametrize("suffix", OF_FRAMES)
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rows=st.lists(st.tuples(st.integers(0, 10**15), st.sampled_from(BUSES), PACKETS, st.booleans())))
def test_any_frames_at_any_instants_come_back(
    suffix: str, tmp_path_factory: pytest.TempPathFactory, rows: list[Row]
) -> None:
    ordered = tuple(sorted(rows, key=lambda row: row[0]))
    found = messages(written(tmp_path_factory.getbasetemp() / f"any{suffix}", ordered))
    assert len(found) == len(ordered)
    for row, message in zip(ordered, found, strict=True):
        same(row, message, suffix)
