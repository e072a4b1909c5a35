"""Cameras in a robot file: the values read, and the reports of mistakes."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from emulators.cli.emulate_robot import RobotOptions, run
from firmware_bridge.cli.places import BusAddress, places_of
from firmware_bridge.families.motion_capture.settings import CaptureBody, CaptureDriver, CaptureLink
from firmware_bridge.families.motion_capture.wire import messages
from firmware_bridge.families.motion_capture.wire.messages import MessageId, packet, split
from firmware_bridge.node import Node
from firmware_bridge.packet import Packet
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot_types import robot_type_named
from firmware_bridge.runtime.clock import Clock, LivedClock
from firmware_bridge.units import MILLISECOND
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.capture_driver.captured_diff_drive import CAPTURE, captured_diff_drive, file_at, written

SETTINGS = 'body = "diff_drive", fastest_mps = 1.0, fastest_rad_s = 2.0'
LEFT = 'role = "left_wheel"\nlink = "drives"'


def test_a_link_to_cameras_and_a_body_are_read() -> None:
    robot = captured_diff_drive()
    link = CaptureLink.all_of(robot)["cameras"]
    assert (link.driver, link.server_number) == (CaptureDriver.NATNET, number_of("192.168.1.10", 1510))
    settings = robot.sensors[-1].settings
    assert isinstance(settings, CaptureBody)
    assert (settings.body, settings.up, settings.mount.x) == ("diff_drive", "y", 0.0)


def test_cameras_are_where_the_file_states_and_need_no_place() -> None:
    assert list(places_of(captured_diff_drive(), None, BusAddress())) == ["drives"]


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        (('"natnet"', '"natnett"'), "links.cameras.driver: 'natnett' is not known"),
        (
            ("192.168.1.10:1510", "motive"),
            "links.cameras.server: must be HOST:PORT, as 192.168.1.10:1510, but it is 'motive'",
        ),
        (('driver = "natnet"', 'driver = "mavlink-pose"'), "give listen a port"),
        (('link = "cameras"', 'link = "drives"'), "another device: 'drives' is a link to EPOS2 drives"),
        (("fastest_mps = 1.0", "fastest_mps = 0.0"), "fastest_mps"),
        (("fastest_mps = 1.0, ", ""), "fastest_mps: is missing"),
        (('body = "diff_drive"', 'body = "diff_drive", up = "x"'), "'x' is not known; there are: y, z"),
        (
            ('body = "diff_drive"', 'body = "diff_drive", mount = { x = 200.0 }'),
            "more than 10 m from the robot",
        ),
        ((SETTINGS, 'axis = "left", input = 2, per_volt = 1.0'), "'cameras' is a motion capture system; its"),
        (('name = "place"', 'name = "place"\nevery = 3'), "every: no such key"),
    ],
)
def test_a_mistake_is_reported(change: tuple[str, str], reported: str, tmp_path: Path) -> None:
    with pytest.raises(RobotFileError, match=re.escape(reported)):
        file_at(tmp_path, written(change))


def test_an_axis_on_cameras_and_a_battery_that_is_a_body_are_reported(tmp_path: Path) -> None:
    assert LEFT in written()
    text = written().replace(LEFT, LEFT.replace("drives", "cameras"))
    with pytest.raises(RobotFileError, match="'cameras' is a motion capture system, which has no axis"):
        file_at(tmp_path, text)
    with pytest.raises(RobotFileError, match="'place' measures no voltage"):
        file_at(tmp_path, written().replace('sensor = "battery"', 'sensor = "place"'))


def test_emulate_serves_the_cameras_beside_the_drives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file_at(tmp_path, written(server="127.0.0.1:1510"))
    sent: list[Packet] = []
    opened: dict[str, Any] = {}

    def carried(node: Node, openers: Mapping[str, Any], *_rest: object, clock: Clock) -> None:
        assert isinstance(clock, LivedClock)
        opened.update(openers)
        node.wake(0)
        sent.extend(node.receive(Packet("cameras commands", 99, packet(MessageId.CONNECT)), 0).sent)
        for now in range(1, 40):
            sent.extend(node.wake(now * MILLISECOND).sent)

    monkeypatch.setattr("firmware_bridge.cli.real_time.carry", carried)
    given: Any = {"robot": str(tmp_path / "diff_drive.toml"), "interface": "virtual"}
    run(RobotOptions(**given))
    assert {"can", "cameras commands", "cameras frames"} <= set(opened)
    (answer,) = [it for it in sent if it.link == "cameras commands"]
    assert answer.address == 99
    assert messages.server_info(split(answer.payload)[1]).version == (3, 1)
    frames = [it for it in sent if it.link == "cameras frames"]
    assert len(frames) == pytest.approx(9, abs=2)
    assert {split(it.payload)[0] for it in frames} == {MessageId.FRAMEOFDATA}


def test_emulate_serves_the_cameras_beside_a_board(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = robot_type_named("rome").file.read_text(encoding="utf-8") + CAPTURE.replace(
        "192.168.1.10", "127.0.0.1"
    )
    path = tmp_path / "rome.toml"
    path.write_text(text, encoding="utf-8")
    sent: list[Packet] = []

    def carried(node: Node, openers: Mapping[str, Any], *_rest: object, clock: Clock) -> None:
        assert isinstance(clock, LivedClock)
        assert set(openers) == {"serial", "cameras commands", "cameras frames", "control"}
        node.wake(0)
        node.receive(Packet("cameras commands", 99, packet(MessageId.CONNECT)), 0)
        for now in range(1, 40):
            sent.extend(node.wake(now * MILLISECOND).sent)

    monkeypatch.setattr("firmware_bridge.cli.real_time.carry", carried)
    run(RobotOptions(robot=str(path), serial="pty"))
    frames = [it for it in sent if it.link == "cameras frames"]
    assert len(frames) == pytest.approx(9, abs=2)
