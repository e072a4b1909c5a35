"""The telemetry profiles of a robot file: their rows, their load, and a name that is none."""

import pytest

from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot_types import find, parse, robot_type_of
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.teleop.streams import PACKET, load, narrowest, streams_of


def periods(robot: AnyRobot) -> dict[str, int]:
    """Return the periods by the rows' titles."""
    return {row.title: row.period for row in streams_of(robot, robot_type_of(robot).station)}


def test_the_profile_brings_the_packets_fields_to_its_rate_and_leaves_all_others() -> None:
    usual, whole = periods(find("rars")), periods(find("rars+thesis"))
    assert {title for title in whole if whole[title] != usual[title]} == {
        "STEER: inner wheel, deg, left positive",
        "ZPOS: m above collapsed",
        "wheels: units a second",
        "I1, I2, ...: A, all axes",
        "voltage, sum of the currents",
    }
    assert {whole[title] for title in whole if whole[title] != usual[title]} == {PACKET}


def test_on_a_link_too_narrow_for_it_the_profile_has_the_slower_periods() -> None:
    robot = find("rars+thesis")
    station = robot_type_of(robot).station
    least = round(narrowest(load(streams_of(robot, station))) + 0.5)
    assert periods(robot.discriminated_by(least)) == periods(robot)
    assert periods(robot.discriminated_by(least - 20)) == periods(find("rars").discriminated_by(57_600))


@pytest.mark.parametrize(
    ("line", "stated"),
    [
        (
            'profile = "theses"',
            "my.toml: operator.telemetry.profile: 'theses' is not known; perhaps 'thesis'",
        ),
        ('profil = "thesis"', "my.toml: operator.telemetry.profil: no such key; perhaps 'profile'"),
    ],
)
def test_a_profile_that_is_none_is_refused_by_file_and_key(line: str, stated: str) -> None:
    text = ROBOT_TYPE.file.read_text(encoding="utf-8")
    with pytest.raises(RobotFileError, match=stated):
        parse(f"{text}\n[operator.telemetry]\n{line}\n", "my.toml")
