"""The black box as one file: packets, texts and the bridge's state; no disk holds up a run."""

import resource
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

from emulators.bench import mission
from emulators.rig import BRIDGE, Rig
from emulators.robots.rars import BENCH_SETUP
from emulators.run import Progress, RunOrder, drive, in_virtual_time
from emulators.wires.ends import Observer
from firmware_bridge.cli.recorded import recording
from firmware_bridge.mavlink.frames import Codec
from firmware_bridge.mavlink.texts import Speaker
from firmware_bridge.mcap_file.bridge_watch import BridgeWatch
from firmware_bridge.mcap_file.channels import drive_topics
from firmware_bridge.mcap_file.reader import attachments
from firmware_bridge.node import CAN, OPERATOR, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.recording import Direction, device_side
from firmware_bridge.robot_types import find
from firmware_bridge.runtime.black_box import CAN_LOG, CAPTURE_LOG, OPERATOR_LOG, SERIAL_LOG, BlackBoxError
from firmware_bridge.runtime.mcap_box import McapBox
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.mcap_file.recorded_run import CRAWL, rows

FILES: Final = {CAN: CAN_LOG, "line": SERIAL_LOG, "cameras": CAPTURE_LOG, OPERATOR: OPERATOR_LOG}
PLACE: Final = number_of("192.168.1.10", 1511)
LONG: Final = "control: 255/190 at 10.0.0.1:14550 drives, and this is a text of more than fifty characters"


def stated(text: str) -> list[bytes]:
    codec, speaker = Codec(1, 1), Speaker()
    return [codec.encode(message) for message in speaker.say(Severity.WARNING, text)]


def test_what_passed_and_what_was_reported_is_in_the_file_by_the_runs_own_time(tmp_path: Path) -> None:
    path, reported = tmp_path / "new" / "run.mcap", list[str]()
    called, known = {"line": device_side("line", "mw")}, {"run.json": "{}"}
    with McapBox(path, FILES, reported.append, called, known=known) as box:
        box.report("before the first packet")
        box.note(0, Direction.RECEIVED, Packet(CAN, 0x181, b"\1\2"))
        box.note(MILLISECOND, Direction.SENT, Packet(CAN, 0x201, b"\3"))
        box.note(2 * MILLISECOND, Direction.SENT, Packet("line", 0, b"\x90"))
        box.note(2 * MILLISECOND, Direction.RECEIVED, Packet("line", 1, b""))
        box.note(2 * MILLISECOND, Direction.RECEIVED, Packet("unknown", 0, b"\1"))
        box.note(3 * MILLISECOND, Direction.RECEIVED, Packet("cameras", PLACE, b"\1"))
        for _station in range(2):
            for datagram in stated(LONG):
                box.note(4 * MILLISECOND, Direction.SENT, Packet(OPERATOR, 7, datagram))
        box.note(5 * MILLISECOND, Direction.RECEIVED, Packet(OPERATOR, 7, stated("from a station")[0]))
        box.report("armed")
    assert reported == ["before the first packet", "armed"]
    found = list(rows(path))
    frames = [(row.at, row.message.id, row.message.sent) for row in found if row.topic == "/can/frames"]
    assert frames == [(0, 0x181, False), (MILLISECOND, 0x201, True)]
    (chunk,) = (row for row in found if row.topic == "/serial")
    assert (chunk.at, chunk.message.link, chunk.message.data) == (2 * MILLISECOND, "line~mw", b"\x90")
    datagrams = [row.message for row in found if row.topic == "/datagrams"]
    assert datagrams[0].place == "192.168.1.10:1511"
    assert len(datagrams) == 2 + 2 * len(stated(LONG))
    texts = [(row.message.name, row.message.message) for row in found if row.topic == "/log"]
    program = "firmware-bridge"
    assert texts == [(program, "before the first packet"), (OPERATOR, LONG), (program, "armed")]
    log = [row.at for row in found if row.topic == "/log"]
    assert log[0] == 0
    assert log[-1] >= 5 * MILLISECOND, "not before a packet that passed before it"
    assert attachments(path) == {"run.json": b"{}"}


def noted(box: McapBox, link: str) -> Observer:
    """Return what shows a box the packets of a wire, as its bridge would."""

    def note(now: Nanoseconds, sender: str, packet: Packet) -> None:
        direction = Direction.SENT if sender == BRIDGE else Direction.RECEIVED
        box.note(now, direction, Packet(link, packet.address, packet.payload))

    return note


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return the file of a black box and that of the bench, of one run."""
    folder = tmp_path_factory.mktemp("both")

    def carry(rig: Rig, end: Nanoseconds, progress: Progress) -> None:
        watch = BridgeWatch(rig.robot, lambda: rig.bridge)
        with McapBox(folder / "box.mcap", FILES, lambda _text: None, watch=watch) as box:
            rig.can_wire.observe(noted(box, CAN))
            rig.operator_wire.observe(noted(box, OPERATOR))
            in_virtual_time(rig, end, progress)

    rars = find("rars")
    script = mission.parse(CRAWL, "crawl", rars, BENCH_SETUP)
    results, file = folder / "results", folder / "bench.mcap"
    drive(RunOrder(rars, BENCH_SETUP, "crawl", script, 0, results, record=file), lambda _now: None, carry)
    return folder / "box.mcap", file


def in_common(path: Path, topic: str) -> list[tuple[Nanoseconds, object]]:
    """Return a channel's messages without the fields that only the bench has, or names otherwise."""
    found = list(rows(path, topic))
    fields = set() if not found else set(found[0].message.DESCRIPTOR.fields_by_name)
    for own in fields & {"statusword", "mode", "mode_name", "bus"}:
        for row in found:
            row.message.ClearField(own)
    return [(row.at, row.message) for row in found]


@pytest.mark.parametrize("topic", ["/can/frames", "/robot/joints", *drive_topics(find("rars")).values()])
def test_a_bridge_that_drives_is_in_it_as_it_is_on_the_bench(both: tuple[Path, Path], topic: str) -> None:
    box, bench = (in_common(path, topic) for path in both)
    assert len(box) > 40
    assert box == bench


def test_it_has_the_bridges_events_and_its_own_pose(both: tuple[Path, Path]) -> None:
    box, bench = ([row.message for row in rows(path, "/events")] for path in both)
    assert box
    # Which faults are on is known on the bench alone.
    assert box == [one for one in bench if one.kind not in {one.FAULT_BEGAN, one.FAULT_ENDED}]
    odometry = [row.message.pose.position.x for row in rows(both[0], "/robot/odometry")]
    assert odometry[-1] > 0.01
    assert "/robot/pose" not in {row.topic for row in rows(both[0])}, "the truth is not known there"


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
    with McapBox(tmp_path / "run.mcap", {SERIAL: SERIAL_LOG}, reported.append) as box:
        for at in range(1000):
            box.note(at, Direction.RECEIVED, Packet(SERIAL, 0, bytes(8)))
    for _ in range(3):
        box.note(0, Direction.RECEIVED, Packet(SERIAL, 0, bytes(8)))
    assert reported == [f"recording in {box.path} has ended: File too large; the run goes on"]


def test_a_file_that_is_there_already_is_kept_and_named(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    path.write_bytes(b"another run")
    with pytest.raises(BlackBoxError, match=r"cannot record in .*run\.mcap: File exists; name a new file"):
        McapBox(path, FILES, print)
    assert path.read_bytes() == b"another run"


class Silent:
    """A node that sends nothing."""

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        del packet, now
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        del now
        return Reaction()


def test_a_name_that_ends_in_mcap_is_a_file_and_any_other_a_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("run.mcap", "runs"):
        with recording(tmp_path / name, FILES) as (around, _report):
            around(Silent()).receive(Packet(CAN, 0x80, b""), 5)
    (row,) = rows(tmp_path / "run.mcap")
    assert (row.at, row.topic, row.message.id) == (5, "/can/frames", 0x80)
    assert [len(log.read_text().splitlines()) for log in (tmp_path / "runs").glob(f"*/{CAN_LOG}")] == [1]
    assert capsys.readouterr().out.startswith(f"recording in {tmp_path / 'run.mcap'}\n")
