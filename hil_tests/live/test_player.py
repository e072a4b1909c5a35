"""A recording on the live page: the state at each instant is that of the run, at any pace and place."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from emulators.bench import mission
from emulators.bench.bench_setup import bench_setup_of
from emulators.run import RunOrder, drive
from firmware_bridge.cli import program
from firmware_bridge.cli.live import incidents as found_in
from firmware_bridge.live.messages import LIVE, OPENED
from firmware_bridge.live.player import Player
from firmware_bridge.live.recording import MOST_FRAMES, Recording
from firmware_bridge.mcap_file.writer import RecordingWriter
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from firmware_bridge.wire.can import ERROR, REMOTE
from firmware_bridge.wire.can_error import (
    BUS_OFF,
    CONTROLLER,
    RECEIVE_PASSIVE,
    TRANSMIT_OVERFLOW,
    encode_report,
)

PAGE = 1
MISSION = """
title = "arm, crawl, and lose a plug"
duration_s = 6.0
[[step]]
at_s = 0.5
title = "its positions"
zero = { steering = 0.0, lift = 0.0 }
[[step]]
at_s = 1.5
title = "arm"
arm = true
[[step]]
at_s = 2.0
title = "crawl"
speed_mps = 0.1
[[fault]]
kind = "node_silent"
node = "lift"
at_s = 4.0
for_s = 0.5
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    robot = find("rars")
    setup = bench_setup_of(robot)
    script = mission.parse(MISSION, "crawl", robot, setup)
    recorded = folder / "run.mcap"
    drive(RunOrder(robot, setup, "crawl", script, 0, folder, record=recorded), lambda _: None)
    return recorded


class Played:
    """A player with a clock of the test's own, and one page."""

    def __init__(self, path: Path) -> None:
        self.player = Player(Recording(path, pytest.fail), "rars, crawl")
        self.now: Nanoseconds = 0
        self.received: list[dict[str, Any]] = []
        self.send(OPENED)

    def send(self, payload: bytes) -> list[dict[str, Any]]:
        begun = len(self.received)
        sent = self.player.receive(Packet(LIVE, PAGE, payload), self.now).sent
        self.received += [json.loads(one.payload) for one in sent]
        return self.received[begun:]

    def does(self, do: str, **keys: Any) -> dict[str, Any]:
        (answer,) = self.send(json.dumps({"id": 4, "do": do, **keys}).encode())
        assert answer["ok"], answer
        return answer

    def runs(self, seconds: float) -> list[dict[str, Any]]:
        begun, end = len(self.received), self.now + from_seconds(seconds)
        while self.now < end:
            self.now += 50 * MILLISECOND
            sent = self.player.wake(self.now).sent
            self.received += [json.loads(one.payload) for one in sent]
        return self.received[begun:]

    @property
    def state(self) -> dict[str, Any]:
        return [one for one in self.received if one.get("kind") == "state"][-1]


@pytest.fixture
def played(path: Path) -> Played:
    return Played(path)


def names(state: dict[str, Any]) -> list[str]:
    return [one["name"] for one in state["interlocks"]]


def test_it_is_introduced_and_shows_each_instant_of_the_run(played: Played) -> None:
    hello, _, _, _ = played.received
    assert (hello["mode"], hello["title"]) == ("recording", "rars, crawl")
    assert [axis["name"] for axis in hello["axes"]] == ["left", "right", "steer", "lift"]
    played.runs(1.0)
    assert not played.state["armed"]
    assert "not armed" in names(played.state)
    played.runs(2.5)
    assert played.state["armed"]
    assert names(played.state) == []
    left = played.state["axes"][0]
    assert (left["state"], left["power"]) == ("operation enabled", "on")
    assert left["velocity"] > 0
    assert played.state["true_pose"][0] == pytest.approx(played.state["pose"][0], abs=0.01)
    assert played.state["true_pose"][0] > 0.01
    played.runs(0.8)
    assert [(one["kind"], one["nodes"]) for one in played.state["faults"]] == [("node_silent", ["lift"])]
    assert "axis timeout: lift" in names(played.state)
    played.runs(5.0)
    assert (played.state["at_s"], played.state["paused"], played.state["faults"]) == (6.0, True, [])


def test_an_instant_is_the_same_whichever_way_it_is_reached(played: Played) -> None:
    played.runs(3.0)
    straight = played.state
    played.runs(3.5)
    played.does("rewind", to_s=1.0)
    played.does("speed", factor=4)
    played.runs(0.5)
    assert played.state["at_s"] == 3.0
    assert {**played.state, "speed": 1.0} == straight
    played.does("rewind", to_s=2.9)
    played.does("step", seconds=0.1)
    played.runs(1.0)
    assert {**played.state, "speed": 1.0, "paused": False} == straight


def test_each_event_comes_once(played: Played) -> None:
    events = [one["text"] for message in played.runs(7.0) for one in message.get("events", ())]
    assert events.count("fault node_silent begins: lift") == 1
    assert events.count("fault node_silent ends") == 1
    assert any("silent" in text for text in events)


def test_frames_are_in_words_by_the_mapping_that_was_written_before(played: Played) -> None:
    played.runs(3.0)
    played.does("watch_frames", on=True, filter="TPDO")
    found = [frame for one in played.runs(0.5) for frame in one.get("frames", ())]
    assert len(found) > 20
    assert all("Statusword" in text and "default" not in text for _, _, name, text in found if name == "181")
    played.does("rewind", to_s=2.0)
    again = [frame for one in played.runs(0.5) for frame in one.get("frames", ())]
    assert again
    assert all(2.0 < at <= 2.5 for at, *_ in again)
    assert all("Statusword" in text and "default" not in text for _, _, name, text in again if name == "181")
    played.does("watch_frames", on=True, filter="")
    played.does("speed", factor=10)
    assert all(len(one.get("frames", ())) <= MOST_FRAMES for one in played.runs(0.3))


def test_errors_of_a_bus_are_in_words_and_remote_frames_are_not_taken_for_data(tmp_path: Path) -> None:
    path = tmp_path / "errors.mcap"
    packets = (
        Packet(CAN, BUS_OFF, bytes(8)),
        Packet(CAN, ERROR | 0x088, bytes(8)),
        Packet(CAN, CONTROLLER, encode_report(state=RECEIVE_PASSIVE | TRANSMIT_OVERFLOW)),
        Packet(CAN, 0x701 | REMOTE, bytes(1)),
        # No flag: a frame of the same number.
        Packet(CAN, 0x040, b""),
    )
    with path.open("wb") as file:
        writer = RecordingWriter(file, {})
        for number, packet in enumerate(packets, start=1):
            writer.frame(number * MILLISECOND, "can0", packet, sent=False)
        writer.finish()
    played = Played(path)
    played.does("watch_frames", on=True, filter="")
    (shown,) = (one["frames"] for one in played.runs(0.1) if "frames" in one)
    assert [(name, text) for _at, _bus, name, text in shown] == [
        ("error", "error report: bus off"),
        ("error", "error report: protocol violation, bus error"),
        ("error", "error report: controller, transmit overflow, receive passive"),
        ("701", "remote request of 0x701"),
        ("040", "no CANopen service"),
    ]
    played.does("rewind", to_s=0.0)
    played.does("watch_frames", on=True, filter="bus off")
    assert [len(one["frames"]) for one in played.runs(0.1) if "frames" in one] == [1]


@pytest.mark.parametrize(
    "line",
    [
        *(b"{", b"[]", b'{"id":4}', b'{"do":["arm"]}', b'{"do":"arm"}', b'{"do":"pause"}'),
        *(
            b'{"do":"speed"}',
            b'{"do":"rewind","to_s":1e300}',
            b'{"id":1e999,"do":"step"}',
            b"\xff",
            b"[" * 60_000,
        ),
    ],
)
def test_a_request_that_is_none_is_refused_and_it_plays_on(played: Played, line: bytes) -> None:
    (answer,) = played.send(line)
    assert answer["ok"] is False
    assert answer["error"]
    played.runs(0.5)
    assert played.state["at_s"] == 0.5


def test_what_explain_finds_is_among_its_incidents(path: Path) -> None:
    incidents = found_in(path, "rars")
    assert any("node 4" in one["title"] and 3.9 < one["at_s"] < 4.5 for one in incidents), incidents
    assert all(one["causes"] and one["check"] for one in incidents)
    player = Player(Recording(path, pytest.fail), "rars", incidents=incidents)
    sent = [json.loads(one.payload) for one in player.receive(Packet(LIVE, PAGE, OPENED), 0).sent]
    assert [one["incidents"] for one in sent if one["kind"] == "incidents"] == [incidents]


@pytest.mark.parametrize("content", [b"", b"nothing", b"\x89MCAP0\r\n"])
def test_a_file_that_is_none_is_one_message(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "run.mcap"
    file.write_bytes(content)
    result = CliRunner().invoke(program, ["live", str(file)])
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert "run.mcap: cannot be read as a recording in MCAP" in line
    missing = CliRunner().invoke(program, ["live", str(tmp_path / "none.mcap")])
    assert missing.exit_code == 2
    assert "No such file" in " ".join(missing.stderr.split())
