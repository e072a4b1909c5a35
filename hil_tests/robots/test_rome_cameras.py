"""ROME's base under cameras: its further file, its path follower unseen, boards with two encoders."""

from dataclasses import replace
from typing import Any, Final

import pytest
from typer.testing import CliRunner

from emulators.testing.inherited.fake_driver import START, seen
from firmware_bridge.cli import program
from firmware_bridge.families.motion_capture.settings import CaptureLink
from firmware_bridge.families.motor_shield.driver.link_drivers import measured, over_protocol
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.motion.captured import Located, Source
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot_types import find, parse, robots
from firmware_bridge.robots.rome import ROBOT_TYPE
from firmware_bridge.robots.rome.motion import RomeMotion
from firmware_bridge.robots.rome.path_follower import named
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import MILLISECOND, Nanoseconds

ROBOT: Final[Any] = find("rome+cameras")
CYCLE: Final = 50 * MILLISECOND
KNOWN: Final = Located(Pose(2.0, 1.0, 0.0), Source.CAPTURED, 0.0, 0.0, 0.0, 0)


def placed(located: Located, now: Nanoseconds, motion: RomeMotion | None = None) -> Snapshot[Any, Any]:
    """The base armed and well, and where it is known to be."""
    well = seen(ROBOT, now)
    return Snapshot(
        facts=well.facts,
        command=motion or well.command,
        commanded=well.commanded,
        body=well.body,
        pose=located.pose,
        located=located,
    )


def test_its_further_file_adds_cameras_and_changes_nothing_else() -> None:
    plain = find("rome")
    assert "rome+cameras" in robots()
    assert ROBOT.located_by is not None
    assert plain.located_by is None
    assert CaptureLink.all_of(ROBOT).keys() == {"cameras"}
    both = {"links": plain.links, "sensors": plain.sensors}
    assert ROBOT.model_copy(update=both) == plain


def test_what_a_robot_does_not_have_is_named_with_what_it_has() -> None:
    with pytest.raises(RobotFileError, match=r"rome has no 'camera'; perhaps 'cameras'\?"):
        find("rome+camera")


def test_a_robot_is_located_by_one_body_only() -> None:
    text = "\n".join(
        path.read_text(encoding="utf-8") for path in (ROBOT_TYPE.file, ROBOT_TYPE.more["cameras"])
    )
    sensors = text[text.index("[[sensors]]") :]
    with pytest.raises(RobotFileError, match=r"located by sensors\[0\] already; leave odometry out here"):
        parse(text + sensors.replace('name = "place"', 'name = "again"'), "two.toml")


def test_before_it_is_seen_the_guide_commands_nothing_and_the_path_begins_where_it_is_seen() -> None:
    path_follower = named(ROBOT, "line")
    unseen = replace(KNOWN, source=Source.UNSEEN, pose=Pose())
    for cycle in range(3):
        motion = path_follower.command(placed(unseen, START + cycle * CYCLE), CYCLE)
        assert motion == RomeMotion(path_s=0.0)
    first = path_follower.command(placed(KNOWN, START + 3 * CYCLE), CYCLE)
    assert (first.ahead_mps, first.left_mps, first.path_s) == pytest.approx((0.5, 0.0, 0.0))


@pytest.mark.parametrize("protocol", ["mw", "arduinoio", "firmata"])
def test_two_encoders_are_enough_where_cameras_see_the_base(protocol: str) -> None:
    assert ShieldLink.of_link(measured(over_protocol(ROBOT, protocol)), "board").counted == 2
    with pytest.raises(RobotFileError, match=r"2 encoders, and not that of motor M3 .*let cameras see it"):
        measured(over_protocol(find("rome"), protocol))
    assert ShieldLink.of_link(measured(over_protocol(find("rome"), protocol, 3)), "board").counted == 3


@pytest.mark.parametrize("words", [["bench"], ["drive", "--serial", "/dev/null"]])
def test_drive_and_bench_refuse_with_the_reason_where_no_one_would_know_the_pose(words: list[str]) -> None:
    command, *more = words
    result = CliRunner().invoke(program, [command, "rome", "--protocol", "mw", *more], env={"COLUMNS": "200"})
    assert result.exit_code == 2
    assert "without another source of its pose no one would know where the robot is" in result.stderr
