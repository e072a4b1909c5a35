"""The frames of a run on real links in another tool's file: no disk holds up a run, and no file is lost."""

import resource
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest
import typer

from firmware_bridge.cli.recorded import recording
from firmware_bridge.node import CAN, OPERATOR, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.recording import Direction
from firmware_bridge.runtime.black_box import CAN_LOG, OPERATOR_LOG, SERIAL_LOG, BlackBoxError
from firmware_bridge.runtime.can_box import CanBox
from firmware_bridge.runtime.can_files import OF_FRAMES, frames
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.can_error import BUS_OFF

FILES: Final = {"left": CAN_LOG, "line": SERIAL_LOG, "right": CAN_LOG, OPERATOR: OPERATOR_LOG}


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_the_frames_of_all_buses_are_in_it_and_nothing_else(suffix: str, tmp_path: Path) -> None:
    path, reported = tmp_path / "new" / f"run{suffix}", list[str]()
    with CanBox(path, FILES, reported.append) as box:
        box.report("armed")
        box.note(0, Direction.RECEIVED, Packet("left", 0x181, b"\1"))
        box.note(MILLISECOND, Direction.SENT, Packet("line", 0, b"\x90"))
        box.note(MILLISECOND, Direction.SENT, Packet(OPERATOR, 7, b"\xfd"))
        box.note(2 * MILLISECOND, Direction.SENT, Packet("right", 0x201, b"\2"))
    assert reported == ["armed"]
    found = [(bus[-1], packet.address) for _at, bus, packet in frames(path)]
    numbers = ("1", "2") if suffix == ".trc" else ("0", "1")
    assert found == [(numbers[0], 0x181), (numbers[1], 0x201)]


@pytest.fixture
def small_disk() -> Iterator[None]:
    """Let no file of this process grow beyond 4 kB: the kernel refuses more, as a full disk does."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.usefixtures("small_disk")
@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_a_disk_that_is_full_ends_the_recording_with_one_message_and_nothing_else(
    suffix: str, tmp_path: Path
) -> None:
    reported: list[str] = []
    with CanBox(tmp_path / f"run{suffix}", {CAN: CAN_LOG}, reported.append) as box:
        for at in range(1000):
            box.note(at, Direction.RECEIVED, Packet(CAN, 0x181, bytes(8)))
    for _ in range(3):
        box.note(0, Direction.RECEIVED, Packet(CAN, 0x181, bytes(8)))
    assert reported == [f"recording in {box.path} has ended: File too large; the run goes on"]


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_a_folder_that_is_removed_stops_nothing(suffix: str, tmp_path: Path) -> None:
    reported: list[str] = []
    with CanBox(tmp_path / "gone" / f"run{suffix}", {CAN: CAN_LOG}, reported.append) as box:
        shutil.rmtree(tmp_path / "gone")
        for at in range(1000):
            box.note(at, Direction.RECEIVED, Packet(CAN, 0x181, bytes(8)))
    assert reported == []


def test_a_file_that_is_there_already_is_kept_and_named(tmp_path: Path) -> None:
    path = tmp_path / "run.asc"
    path.write_bytes(b"another run")
    with pytest.raises(BlackBoxError, match=r"cannot record in .*run\.asc: File exists; name a new file"):
        CanBox(path, FILES, print)
    assert path.read_bytes() == b"another run"


def test_what_the_format_lacks_is_reported_at_the_end(tmp_path: Path) -> None:
    reported: list[str] = []
    with CanBox(tmp_path / "run.trc", {CAN: CAN_LOG}, reported.append) as box:
        box.note(0, Direction.RECEIVED, Packet(CAN, BUS_OFF, bytes(8)))
    assert reported == [f"{box.path}: 1 error frames are left out; .asc, .blf and .mcap have them"]


class Silent:
    """A node that sends nothing."""

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        del packet, now
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        del now
        return Reaction()


@pytest.mark.parametrize("name", ["run.asc", "run.BLF", "run.trc"])
def test_the_name_of_the_file_chooses_the_format(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with recording(tmp_path / name, {CAN: CAN_LOG}) as (around, _report):
        around(Silent()).receive(Packet(CAN, 0x80, b""), 5)
    assert [packet for _at, _bus, packet in frames(tmp_path / name)] == [Packet(CAN, 0x80, b"")]
    assert capsys.readouterr().out == f"recording in {tmp_path / name}\n"


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_a_run_without_a_bus_is_refused_in_one_line(
    suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"run{suffix}"
    with pytest.raises(typer.Exit), recording(path, {SERIAL: SERIAL_LOG, OPERATOR: OPERATOR_LOG}):
        pass
    assert capsys.readouterr().err == (
        f"firmware-bridge: --record {path}: has CAN frames only, and this run has no bus; "
        "a name that ends in .mcap, or a folder, has lines\n"
    )
    assert not path.exists()
