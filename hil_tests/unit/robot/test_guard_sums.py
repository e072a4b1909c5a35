"""A guard's sums, and a drive's currents, are compared with the rest of the file."""

from typing import Final

import pytest

from emulators.epos2.objects.catalogue import PROFILES
from firmware_bridge import robot_types
from firmware_bridge.families.epos2.settings import Epos2Device
from firmware_bridge.robot import RobotFileError

DIFF_DRIVE: Final = robot_types.robots()["diff_drive"].read_text(encoding="utf-8")


def problems(text: str, *changes: tuple[str, str]) -> str:
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    try:
        robot_types.parse(text, "diff_drive.toml")
    except RobotFileError as error:
        return str(error)
    return ""


RADIUS: Final = "wheel_radius_m = 0.08"
DEVICE: Final = 'device = "70/10"', 'device = "50/5"'
PEAK: Final = "peak_current_ma = 11540", "peak_current_ma = 25001"
TRACK: Final = "track_m = 0.35"


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        (
            (RADIUS, "wheel_radius_m = 0.12"),
            [
                "guard.sums[0]: with this geometry 'base speed' reaches its bound of 0.603 at 0.904,",
                "the robot's limit is 0.6; use of = {left = 0.06, right = 0.06}",
                "guard.sums[1]: with this geometry 'turn rate' reaches its bound of 1.212 at 1.82,",
                "the robot's limit is 1.2; use of = {left = -0.3429, right = 0.3429}",
            ],
        ),
        (
            (RADIUS, "wheel_radius_m = 0.09"),
            ["0.678, the robot's limit is 0.6", "1.36, the robot's limit is 1.2"],
        ),
        ((TRACK, "track_m = 0.25"), ["use of = {left = -0.32, right = 0.32}"]),
        ((RADIUS, "wheel_radius_m = 0.0805"), []),
        (("bound = 0.603", "bound = 0.77"), []),
        (("bound = 0.603", "bound = 0.9"), ["at 0.9, the robot's limit is 0.6; use bound = 0.606"]),
        (("bound = 0.603", "bound = 0.59"), ["at 0.59, the robot's limit is 0.6; use bound = 0.606"]),
    ],
)
def test_a_sum_of_another_geometry_is_reported_with_the_right_line(
    change: tuple[str, str], reported: list[str]
) -> None:
    found = problems(DIFF_DRIVE, change)
    assert all(text in found for text in reported), found
    assert found.count("guard.sums") == (2 if "wheel" in change[1] and reported else len(reported))


def test_the_offered_lines_make_the_file_good() -> None:
    assert (
        problems(
            DIFF_DRIVE,
            (RADIUS, "wheel_radius_m = 0.12"),
            ("{ left = 0.04, right = 0.04 }", "{ left = 0.06, right = 0.06 }"),
            ("{ left = -0.2286, right = 0.2286 }", "{ left = -0.3429, right = 0.3429 }"),
        )
        == ""
    )


@pytest.mark.parametrize("name", robot_types.robots())
def test_every_robot_s_sums_fit_its_geometry(name: str) -> None:
    robot_types.find(name)


@pytest.mark.parametrize("device", Epos2Device)
def test_a_drive_s_currents_are_those_of_the_emulated_one(device: Epos2Device) -> None:
    profile = PROFILES[device.value]
    assert (device.continuous_ma, device.peak_ma) == (profile.continuous_current_ma, profile.peak_current_ma)


@pytest.mark.parametrize(
    ("changes", "reported"),
    [
        (
            (('device = "70/10"', 'device = "50/5"'),),
            "continuous_current_ma = 5770: an EPOS2 50/5 takes 5000 at most",
        ),
        (
            (("peak_current_ma = 11540", "peak_current_ma = 25001"),),
            "peak_current_ma = 25001: an EPOS2 70/10 takes 25000",
        ),
        (
            (("encoder_lines = 500", "encoder_lines = 70_000"),),
            "encoder_lines and max_velocity_rpm: 70000 lines at 4782 rpm are 5.58 MHz a channel: an EPOS2 co",
        ),
        (
            (("nominal_v = 24.0", "nominal_v = 70.5"),),
            "battery.nominal_v: 70.5 V: the EPOS2 70/10 of 'left' takes 70 V at most",
        ),
        (
            (("motor_type = 1 ", "pole_pairs = 7\nmotor_type = 1 "),),
            "pole_pairs = 7: motor_type 1 is brushed",
        ),
    ],
)
def test_what_is_beyond_the_drive_or_the_motor_is_reported_with_its_bound(
    changes: tuple[tuple[str, str], ...], reported: str
) -> None:
    assert reported in problems(DIFF_DRIVE, *changes)


def test_one_wrong_key_of_an_axis_makes_no_other_mistake() -> None:
    misspelt = DIFF_DRIVE.replace('command = "speed"', 'comand = "speed"', 1)
    assert problems(misspelt).splitlines() == [
        "diff_drive.toml: axes[0].command: is missing",
        "diff_drive.toml: axes[0].comand: no such key; perhaps 'command'?",
    ]
    second = DIFF_DRIVE.index("[[axes]]", DIFF_DRIVE.index("[[axes]]") + 1)
    alone = DIFF_DRIVE[: DIFF_DRIVE.index("[[axes]]")] + DIFF_DRIVE[second:]
    found = problems(alone, ("top_speed = 10.33", "top_speeed = 10.33"))
    assert "axes[0].top_speeed: no such key; perhaps 'top_speed'?" in found
    assert "must have at least 1" not in found


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        ((RADIUS, "wheel_radius_m = 0.4"), "wheel_radius_m = 0.4 is not below track_m = 0.35"),
        (
            ("ratio = 43.0", "ratio = 0.0233"),
            "axes[0].ratio: with 0.0233 top_speed turns the motor with 2.3 rpm",
        ),
        (
            ("motor_type = 1 ", "motor_type = 2 "),
            "axes[0].settings.motor_type: 0x6402 knows 1 (brushed DC), 10 (EC",
        ),
    ],
)
def test_numbers_that_no_robot_has_are_refused_with_the_reason(
    change: tuple[str, str], reported: str
) -> None:
    assert reported in problems(DIFF_DRIVE, change)
