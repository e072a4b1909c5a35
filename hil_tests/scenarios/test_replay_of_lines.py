"""Runs over lines to boards, arms and drives play again into the bridge; one changed byte is found."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Final

import numpy as np
import pytest

from emulators.bench import mission
from emulators.bench.bench_setup import bench_setup_of
from emulators.recorded import CHUNKS, FRAMES, SIGHTS, WORDS, recorded
from emulators.replay import Into, RecordingFileError, ReplayOrder, replay
from emulators.run import HAND_STREAM
from emulators.testing.inherited.scripted import mission_of, scripted
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.node import OPERATOR, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.recording import (
    Direction,
    Recorded,
    candump_line,
    chunk_line,
    mavlink_origin,
    parse_chunk,
    parse_tlog,
    tlog_records,
)
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds, from_seconds

REAL: Final = 1_700_000_000 * SECOND
"""Some clock of a real machine."""


@dataclass(frozen=True, slots=True)
class Run:
    """A run on the bench: who, which mission, and how much of it moves already."""

    robot: AnyRobot
    mission: str
    seconds: float


RUNS: Final = {
    "ros_arduino_bridge": Run(find("rome"), "circle", 6.5),
    "mw": Run(over_protocol(find("rome"), "mw", 3), "circle", 6.5),
    "arduinoio": Run(over_protocol(find("rome"), "arduinoio", 3), "circle", 6.5),
    "firmata": Run(over_protocol(find("rome+cameras"), "firmata"), "circle", 6.5),
    "arm": Run(find("ar2"), "sine", 6.5),
    "two boards": Run(find("rome_arm"), "orbit", 6.5),
    "serial drives": Run(over_serial(find("rars"), Generation.V2), "line", 2.0),
}

BUS: Final = Run(find("rars"), "line", 2.0)


@cache
def folder_of(title: str, seconds: float | None = None) -> Path:
    """Drive the first seconds of a run, and return the folder of its recording."""
    folder = Path(mkdtemp(prefix="lines-"))
    driven(RUNS[title], seconds or RUNS[title].seconds, folder)
    return folder


def driven(run: Run, seconds: float, folder: Path) -> None:
    """Drive the first seconds of a run, and record it in a folder as `bench` does."""
    script = mission_of(run.robot, run.mission)
    with (
        scripted(run.robot, script, stream=(1, HAND_STREAM), seed=1, noise=script.noise) as rig,
        recorded(rig, folder),
    ):
        rig.run(from_seconds(seconds))


def read(folder: Path, name: str = CHUNKS) -> list[str]:
    file = folder / name
    return file.read_text(encoding="ascii").splitlines() if file.exists() else []


def plays_again(title: str, folder: Path) -> None:
    outcome = replay(ReplayOrder(RUNS[title].robot, folder))
    assert outcome.difference is None
    assert outcome.into is Into.BRIDGE
    sent = sum(" T " in line for name in (CHUNKS, SIGHTS) for line in read(folder, name))
    reported = [message for _, message in parse_tlog((folder / WORDS).read_bytes())]
    own = sum(mavlink_origin(message)[:2] == (1, 1) for message in reported)
    assert outcome.compared == sent + own, "every byte and every message that it has sent"


@pytest.mark.long(keeps=["firmata"])
@pytest.mark.parametrize("title", RUNS)
def test_all_that_the_bridge_has_sent_is_sent_again_to_the_byte_and_the_nanosecond(title: str) -> None:
    plays_again(title, folder_of(title))


@pytest.mark.long(beside="test_all_that_the_bridge_has_sent_is_sent_again_to_the_byte_and_the_nanosecond")
@pytest.mark.parametrize("title", RUNS)
def test_whole_missions_do(title: str) -> None:
    run = RUNS[title]
    whole = mission.find(run.mission, run.robot, bench_setup_of(run.robot)).duration_s
    plays_again(title, folder_of(title, whole))


def with_lines(folder: Path, lines: list[str], into: Path) -> Path:
    """Return a copy of a recording whose serial line carried something else."""
    into.mkdir(exist_ok=True)
    for name in (SIGHTS, WORDS):
        if (folder / name).exists():
            (into / name).write_bytes((folder / name).read_bytes())
    (into / CHUNKS).write_text("\n".join(lines) + "\n", encoding="ascii")
    return into


def flipped(line: str, bit: int) -> str:
    """Return a line of the recording with one bit of its last byte changed."""
    return f"{line[:-2]}{int(line[-2:], 16) ^ 1 << bit:02X}"


def places_of(lines: list[str], way: str, begin: float) -> list[int]:
    """Return five places of a way's lines after some part of the recording."""
    found = [place for place, line in enumerate(lines) if f" {way} " in line]
    found = found[int(begin * len(found)) :]
    return [found[part * (len(found) - 1) // 4] for part in range(5)]


@pytest.mark.long(keeps=["firmata"])
@pytest.mark.parametrize("title", ["firmata", "mw", "arm", "serial drives"])
def test_one_changed_bit_of_what_the_bridge_has_sent_is_named_by_its_line(title: str, tmp_path: Path) -> None:
    lines = read(folder_of(title))
    for bit, place in enumerate(places_of(lines, "T", 0.0)):
        changed = [*lines[:place], flipped(lines[place], bit), *lines[place + 1 :]]
        outcome = replay(ReplayOrder(RUNS[title].robot, with_lines(folder_of(title), changed, tmp_path)))
        assert outcome.difference is not None
        head, *_, came = [line for line in outcome.difference.splitlines() if not line.startswith("bytes ")]
        assert head == f"serial.log, line {place + 1} is the first that differs"
        assert came.startswith("but came  ")


@pytest.mark.long(beside="test_one_changed_bit_of_what_the_bridge_has_sent_is_named_by_its_line")
@pytest.mark.parametrize("title", ["firmata", "mw"])
def test_one_changed_bit_of_what_it_has_received_is_another_run(title: str, tmp_path: Path) -> None:
    """Of Firmata a count is another one; an MWProtocol frame is damaged, and the bridge sends it again."""
    lines = read(folder_of(title))
    place = next(
        place
        for place in range(int(0.9 * len(lines)), len(lines))
        if len(lines[place].partition(" R ")[2]) >= len("F0 61 00 5A 13")
    )
    words = lines[place].split(" ")
    words[6] = f"{int(words[6], 16) ^ 0x10:02X}"
    changed = [*lines[:place], " ".join(words), *lines[place + 1 :]]
    outcome = replay(ReplayOrder(RUNS[title].robot, with_lines(folder_of(title), changed, tmp_path)))
    assert outcome.difference is not None
    received_at = parse_chunk(lines[place])[0]
    assert received_at < outcome.until < received_at + 100 * MILLISECOND, (
        "what it reports next is another word"
    )


@pytest.mark.long(beside="test_one_changed_bit_of_what_the_bridge_has_sent_is_named_by_its_line")
def test_a_word_more_or_less_and_one_that_comes_late_are_differences(tmp_path: Path) -> None:
    run, folder = RUNS["firmata"], folder_of("firmata")
    lines = read(folder)
    place = places_of(lines, "T", 0.5)[2]
    at, way, packet = parse_chunk(lines[place])
    late = chunk_line(at + 1, packet.link, way, packet)
    for changed, tolerance in (
        ([*lines[:place], *lines[place + 1 :]], MICROSECOND),
        ([*lines[: place + 1], *lines[place:]], MICROSECOND),
        ([*lines[:place], late, *lines[place + 1 :]], 0),
    ):
        order = ReplayOrder(run.robot, with_lines(folder, changed, tmp_path))
        assert replay(replace(order, tolerance=tolerance)).difference is not None
    assert replay(replace(order, tolerance=1)).difference is None


class Late:
    """A machine that wakes its node up to 4 ms late, by a seed, in whole microseconds."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._chance = np.random.default_rng(18)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        reaction = self._node.receive(packet, now)
        return reaction if reaction.wake_at <= now else self._late(reaction, reaction.wake_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        reaction = self._node.wake(now)
        return self._late(reaction, max(reaction.wake_at, now))

    def _late(self, reaction: Reaction, requested: Nanoseconds) -> Reaction:
        return Reaction(reaction.sent, requested + MICROSECOND * int(self._chance.integers(20, 4_000)))


@pytest.mark.long(keeps=["mw"])
@pytest.mark.interpreted
@pytest.mark.parametrize("title", ["mw", "ros_arduino_bridge", "arduinoio", "arm", "two boards", "bus"])
def test_a_machine_that_was_late_is_late_again(
    title: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its telemetry carries its own instants, and its odometry depends on them: all of it comes again."""
    run = RUNS.get(title, BUS)
    lines: list[str] = []
    words: list[bytes] = []

    def note(now: Nanoseconds, way: Direction, packet: Packet) -> None:
        if packet.link == OPERATOR:
            words.append(tlog_records(now, packet.payload, REAL))
        elif run is BUS:
            lines.append(candump_line(now, packet, packet.link, REAL))
        elif packet.payload:
            lines.append(chunk_line(now, packet.link, way, packet, REAL))

    monkeypatch.setattr(
        "emulators.rig.guarded", lambda bridge, robot: Recorded(Late(guarded(bridge, robot)), note)
    )
    driven(run, run.seconds, tmp_path)
    (tmp_path / (FRAMES if run is BUS else CHUNKS)).write_text("\n".join(lines) + "\n", encoding="ascii")
    (tmp_path / WORDS).unlink()
    order = ReplayOrder(run.robot, tmp_path)
    if run is not BUS:
        with pytest.raises(RecordingFileError, match="do not show when the bridge was started; give"):
            replay(order)
    (tmp_path / WORDS).write_bytes(b"".join(words))
    outcome = replay(order)
    assert outcome.difference is None
    assert outcome.compared > 400


@pytest.mark.long(beside="test_a_bad_file_is_one_message_and_status_2")
def test_what_does_not_go_together_is_refused_with_what_to_give(tmp_path: Path) -> None:
    cameras, rome = find("rome+cameras"), find("rome")
    seen, blind = folder_of("firmata"), folder_of("ros_arduino_bridge")
    for robot, recording, message in (
        (cameras, blind, "holds nothing of rome's link 'cameras'; give the folder of a run that has all"),
        (rome, seen, "capture.log, line 1: rome has no line 'cameras'; it has: 'board'"),
        (find("rars"), folder_of("serial drives"), "line 1: rars has no line 'drives'.* use --serial"),
        (rome, tmp_path, "holds no"),
    ):
        with pytest.raises(RecordingFileError, match=message):
            replay(ReplayOrder(robot, recording))
    for into in (Into.DRIVES, Into.BENCH):
        with pytest.raises(RecordingFileError, match=r"serial\.log: "):
            replay(ReplayOrder(rome, blind / CHUNKS, into=into))
