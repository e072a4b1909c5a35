"""The black box of a run: what it leaves behind, and that no disk holds up a run."""

import resource
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

from firmware_bridge.cli.drive import texts_of
from firmware_bridge.mavlink.frames import Codec
from firmware_bridge.mavlink.texts import Speaker
from firmware_bridge.node import CAN, OPERATOR, SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.recording import Direction, device_side, parse_candump, parse_chunk, parse_tlog
from firmware_bridge.runtime.black_box import (
    CAN_LOG,
    CAPTURE_LOG,
    OPERATOR_LOG,
    SERIAL_LOG,
    STATIONS_LOG,
    BlackBox,
    BlackBoxError,
)
from firmware_bridge.runtime.last_places import RECORDED, LastPlaces, known_places
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.units import MILLISECOND
from firmware_bridge.wire.internet import number_of

FILES: Final = {CAN: CAN_LOG, "line": SERIAL_LOG, "cameras": CAPTURE_LOG, OPERATOR: OPERATOR_LOG}
PLACE: Final = number_of("192.168.1.10", 1511)
LONG: Final = "control: 255/190 at 10.0.0.1:14550 drives, and this is a text of more than fifty characters"


def stated(text: str) -> list[bytes]:
    codec, speaker = Codec(1, 1), Speaker()
    return [codec.encode(message) for message in speaker.say(Severity.WARNING, text)]


def test_what_passed_is_in_files_that_the_field_reads(tmp_path: Path) -> None:
    reported: list[str] = []
    with BlackBox(tmp_path, FILES, reported.append, texts_of()) as box:
        box.note(0, Direction.RECEIVED, Packet(CAN, 0x181, b"\1\2"))
        box.note(MILLISECOND, Direction.SENT, Packet(CAN, 0x201, b"\3"))
        box.note(2 * MILLISECOND, Direction.SENT, Packet("line", 0, b"\x90\x02"))
        box.note(2 * MILLISECOND + 1, Direction.RECEIVED, Packet("cameras", PLACE, b"\1"))
        for _station in range(2):
            for datagram in stated(LONG):
                box.note(3 * MILLISECOND, Direction.SENT, Packet(OPERATOR, 7, datagram))
        box.note(4 * MILLISECOND, Direction.RECEIVED, Packet(OPERATOR, 7, stated("from a station")[0]))
        box.report("armed")
    assert reported == ["armed"]
    received, sent = (box.folder / CAN_LOG).read_text().splitlines()
    first, channel, packet = parse_candump(received, epoch=0)
    assert (channel, packet) == (CAN, Packet(CAN, 0x181, b"\1\2"))
    assert parse_candump(sent, epoch=0)[0] - first == MILLISECOND
    text = (box.folder / SERIAL_LOG).read_text()
    assert text.endswith(" line T 90 02\n")
    at, way, frame = parse_chunk((box.folder / CAPTURE_LOG).read_text().rstrip("\n"), epoch=0)
    (first_word, _), *_ = parse_tlog((box.folder / OPERATOR_LOG).read_bytes(), epoch=0)
    assert at - first_word == 1 - MILLISECOND, "what is cut to microseconds has the same instants"
    assert (at - parse_chunk(text.rstrip("\n"), epoch=0)[0], way) == (1, Direction.RECEIVED), (
        "to the nanosecond"
    )
    assert frame == Packet("cameras", PLACE, b"\1")
    assert len(list(parse_tlog((box.folder / OPERATOR_LOG).read_bytes()))) == 2 * len(stated(LONG)) + 1
    events = [line.partition(" ")[2] for line in (box.folder / "events.log").read_text().splitlines()]
    assert events == [f"to the operator: {LONG}", "armed"]


def test_each_run_has_a_folder_of_its_own(tmp_path: Path) -> None:
    folders = set()
    for _ in range(3):
        with BlackBox(tmp_path / "runs", FILES, print) as box:
            folders.add(box.folder)
    assert len(folders) == 3


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BlackBoxError, match=r"cannot record in .*file: File exists; name a folder"):
        BlackBox(tmp_path / "file", FILES, print)


@pytest.fixture
def small_disk() -> Iterator[None]:
    """Let no file of this process grow beyond 4 kB: the kernel refuses more, as a full disk does."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.usefixtures("small_disk")
def test_a_disk_that_is_full_ends_the_recording_with_one_message_and_nothing_else(tmp_path: Path) -> None:
    reported: list[str] = []
    with BlackBox(tmp_path, {SERIAL: SERIAL_LOG}, reported.append) as box:
        for at in range(1000):
            box.note(at, Direction.RECEIVED, Packet(SERIAL, 0, bytes(8)))
    for _ in range(3):
        box.note(0, Direction.RECEIVED, Packet(SERIAL, 0, bytes(8)))
    assert reported == [f"recording in {box.folder} has ended: File too large; the run goes on"]


def test_a_disk_that_is_too_slow_ends_it_before_the_memory_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("firmware_bridge.runtime.disk_thread.MOST", 10)
    monkeypatch.setattr("firmware_bridge.runtime.disk_thread.EVERY_S", 60.0)
    reported: list[str] = []
    with BlackBox(tmp_path, FILES, reported.append) as box:
        for at in range(100):
            box.note(at, Direction.RECEIVED, Packet(CAN, 0x80, b""))
        assert reported == [f"recording in {box.folder} has ended: the disk is too slow; the run goes on"]


def test_a_device_records_its_lines_under_what_they_speak_each_in_its_file(tmp_path: Path) -> None:
    files = {"base": f"base-{SERIAL_LOG}", "arm": f"arm-{SERIAL_LOG}"}
    called = {"base": device_side("base", "mw"), "arm": device_side("arm", "ar2-2.0")}
    with BlackBox(tmp_path, files, lambda _: None, called=called) as box:
        box.note(0, Direction.RECEIVED, Packet("base", 0, b"a"))
        box.note(1, Direction.SENT, Packet("arm", 0, b"b"))
    assert (box.folder / "base-serial.log").read_text().endswith(" base~mw R 61\n")
    assert (box.folder / "arm-serial.log").read_text().endswith(" arm~ar2-2.0 T 62\n")


def test_what_was_known_before_is_a_file_of_its_own(tmp_path: Path) -> None:
    with BlackBox(tmp_path, FILES, lambda _text: None, known=known_places({"steer": 10.0})) as box:
        pass
    assert LastPlaces(box.folder / RECORDED).read() == {"steer": 10.0}
    assert known_places({}) == {}, "no file where nothing is known"


def test_from_where_a_station_speaks_is_noted_when_it_is_new(tmp_path: Path) -> None:
    elsewhere = number_of("192.168.1.11", 14550)
    with BlackBox(tmp_path, FILES, lambda _text: None) as box:
        for at, place in enumerate((PLACE, PLACE, elsewhere, elsewhere)):
            box.note(at * MILLISECOND, Direction.RECEIVED, Packet(OPERATOR, place, stated("here")[0]))
        box.note(9 * MILLISECOND, Direction.SENT, Packet(OPERATOR, PLACE, stated("there")[0]))
    lines = (box.folder / STATIONS_LOG).read_text().splitlines()
    found = [parse_chunk(line, epoch=0) for line in lines]
    assert [packet for _, _, packet in found] == [
        Packet(OPERATOR, place, b"\1\1") for place in (PLACE, elsewhere)
    ]
    assert found[1][0] - found[0][0] == 2 * MILLISECOND
