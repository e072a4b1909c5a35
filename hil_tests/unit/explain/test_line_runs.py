"""Recordings of real rides over serial lines explained: without a fault there is no incident."""

from pathlib import Path

import pytest

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.run import RunOrder, drive
from emulators.testing.rig import VirtualRig
from firmware_bridge.cli.fitted import driven
from firmware_bridge.explain.explainer import Explained, Setup
from firmware_bridge.explain.line_explainer import Lines, explain_lines
from firmware_bridge.explain.line_source import chunks
from firmware_bridge.family import LinkOptions
from firmware_bridge.robot_types import find

BOARDS = (("mw", 3), ("ros-arduino-bridge", 3), ("arduinoio", 3))


def ridden(robot: str, options: LinkOptions, folder: Path, **drives: float) -> tuple[VirtualRig, Explained]:
    rig = VirtualRig(driven(find(robot), options))
    rig.arms()
    rig.operator.drives(**drives)
    rig.runs(3.0)
    rig.operator.returns_to_neutral()
    rig.runs(1.5)
    rig.recording.keep(folder)
    return rig, explain_lines(chunks(folder / "serial.log", lambda _: None), Lines({}, Setup()))


@pytest.mark.parametrize(("protocol", "encoders"), BOARDS)
def test_a_ride_of_a_board_has_no_incident(protocol: str, encoders: int, tmp_path: Path) -> None:
    options = LinkOptions(protocol, encoders=encoders)
    _, found = ridden("rome", options, tmp_path, forward=0.2, turn_deg_s=20.0)
    assert found.incidents == ()
    assert found.remarks == ()
    assert found.frames > 400


def test_a_ride_with_cameras_and_two_encoders_has_no_incident(tmp_path: Path) -> None:
    _, found = ridden("rome+cameras", LinkOptions("firmata", encoders=2), tmp_path, forward=0.2)
    assert found.incidents == ()


def test_a_ride_of_an_arm_has_no_incident(tmp_path: Path) -> None:
    _, found = ridden("ar2", LinkOptions(), tmp_path, forward=0.02)
    assert found.incidents == ()


def test_drives_behind_a_serial_port_are_explained_as_on_a_bus(tmp_path: Path) -> None:
    _, found = ridden("rars", LinkOptions("v2", lines=("drives",)), tmp_path, forward=0.2)
    assert found.nodes == (1, 2, 3, 4, 100)
    # At its start, without power, the bridge proves that the drives notice its silence.
    assert found.incidents == ()
    assert "before any drive had power: node 1, 2, 3, 4 reported EMCY 0x8130" in found.remarks[0]


def test_the_faults_of_a_mission_are_named_and_little_else(tmp_path: Path) -> None:
    robot, setup = driven(find("rome"), LinkOptions("mw", encoders=3)), bench_setup_of(find("rome"))
    drive(
        RunOrder(robot, setup, "faults", missions.find("faults", robot, setup), 0, tmp_path), lambda _: None
    )
    found = explain_lines(chunks(tmp_path / "serial.log", lambda _: None), Lines({}, Setup()))
    seen = [((one.at - found.began_at) / 1e9, one.kind.name) for one in found.incidents]
    # The recording begins when the board has started, 1.1 s after the mission.
    for at_s, kind in (
        (5.9, "not_turning"),
        (25.9, "line_silent"),
        (37.9, "line_silent"),
        (49.9, "not_turning"),
    ):
        assert any(kind == name and abs(second - at_s) < 0.3 for second, name in seen), kind
    assert len(seen) <= 6
