"""Axes of MANUAL_CONTROL that count for a robot, their neutral, and the reports on the others."""

import re
from dataclasses import replace
from typing import Any

import pytest

from firmware_bridge import robot_types
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.teleop.incoming import UNUSED
from firmware_bridge.teleop.station import USUAL_AXES, StationRows, Stick, StickAxis
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.teleop.bench import CYCLE, RarsBench, bench_of, rars
from hil_tests.unit.teleop.received import texts
from hil_tests.unit.teleop.toy import toy

LIFTS = 1 << 3
ROBOTS = robot_types.names()


def manual(x: int = 0, y: int = 0, z: int = 0, r: int = 0, buttons: int = 0) -> Any:
    return dialect.MAVLink_manual_control_message(1, x, y, z, r, buttons)


def channels(value: int, *others: int) -> Any:
    return dialect.MAVLink_rc_channels_override_message(1, 1, value, value, value, value, *others)


RESTING = {
    "QGroundControl, throttle springs to its middle": manual(z=500),
    "QGroundControl, throttle rests below": manual(z=0),
    "QGroundControl, negative thrust": manual(z=-1000),
    "MAVSDK": manual(z=500),
    "a raw joystick whose trigger rests at its end": manual(z=-1000, r=12, x=-9, y=31),
    "a station without a throttle": manual(z=UNUSED),
    "MAVProxy": channels(1500, 0, 0, 0, 0),
    "MAVProxy, version 2": channels(1500, 1500, 65535, 65535, 65535),
}
"""Values sent by stations with the stick untouched.

QGroundControl's Joystick.cc, MAVSDK's manual_control plugin, MAVProxy's joystick module.
"""


@pytest.mark.parametrize("robot", ROBOTS)
def test_what_rests_is_neutral_for_every_installed_robot(robot: str) -> None:
    for station, message in RESTING.items():
        bench = bench_of(robot)
        bench.say(message)
        assert bench.operator.intent.deflected == "", station


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_station_declares_the_axes_that_its_robot_reads(robot: str) -> None:
    bench = bench_of(robot)
    rest = dict.fromkeys(("forward", "left", "turn", "up"), None)
    still = bench.rows.stick(Stick(**rest), bench.rest, bench.robot)
    moved = {
        axis
        for axis in StickAxis
        if bench.rows.stick(Stick(**(rest | {axis.name.lower(): 0.5})), bench.rest, bench.robot) != still
    }
    assert moved == set(bench.rows.axes)


@pytest.mark.parametrize(
    ("robot", "axes", "reason"),
    [
        ("rome", {"x": 51}, "x stands at 51: this robot wants 0"),
        ("rome", {"y": -400}, "y stands at -400: this robot wants 0"),
        ("rome", {"r": 1000}, "r stands at 1000: this robot wants 0"),
        ("rome", {"x": 50, "y": -50, "r": 50}, ""),
        ("rars", {"z": 700, "buttons": LIFTS}, ""),
    ],
)
def test_of_an_axis_that_is_read_its_name_and_value_are_stated(
    robot: str, axes: dict[str, int], reason: str
) -> None:
    bench = bench_of(robot)
    bench.say(manual(**axes))
    assert bench.operator.intent.deflected == reason


def test_a_robot_may_read_z_without_a_button() -> None:
    bench = bench_of("rome")
    bench.rows = replace(bench.rows, axes=(*USUAL_AXES, StickAxis.UP))
    bench.restart()
    bench.say(manual(z=500))
    assert bench.operator.intent.deflected == "z stands at 500: this robot wants 0"


def test_an_axis_that_is_deflected_and_not_read_is_stated_once_a_station() -> None:
    bench = toy()
    bench.rows = replace(bench.rows, axes=USUAL_AXES)
    bench.restart()
    for z in (0, 50, 500, 600, 0, 500):
        bench.say(manual(z=z))
        bench.now += CYCLE
    extended = manual()
    extended.enabled_extensions, extended.s, extended.aux1, extended.t = 0b101, 300, -300, 300
    bench.say(extended)
    bench.say(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
    reported = "".join(texts(bench.report()))
    assert re.findall(r"(\w+) of 255/190.*? stands at (-?\d+): this robot does not read it", reported) == [
        ("z", "500"),
        ("s", "300"),
        ("aux1", "-300"),
    ]


def lifted(bench: RarsBench, *steps: tuple[int, bool]) -> list[float]:
    """Send z with or without its button, once a period; return the shares of its full rate."""
    found = []
    for z, held in steps:
        bench.say(manual(z=z, buttons=LIFTS if held else 0))
        bench.now += CYCLE
        found.append(round(bench.command.lift_rate_mps / 0.1, 6))
    return found


@pytest.mark.parametrize("rest", [-1000, 0, 500, 1000])
def test_while_its_button_is_held_the_lift_follows_z_from_where_it_stood_up_and_down(rest: int) -> None:
    steps = [(rest, False), (rest, True), (rest + 300, True), (rest, True), (rest - 300, True), (rest, False)]
    held = [(max(min(z, 1000), -1000), pressed) for z, pressed in steps]
    ways = [0.0, 0.0, 0.3 if rest < 1000 else 0.0, 0.0, -0.3 if rest > -1000 else 0.0, 0.0]
    assert lifted(rars(), *held) == ways


@pytest.mark.parametrize(
    ("steps", "ways"),
    [
        # A button that is down in a station's first message: z stood where it is.
        (((500, True), (700, True)), [0.0, 0.2]),
        # It stood where the message before had it.
        (((0, False), (600, True)), [0.0, 0.6]),
        # Each press counts again.
        (((0, False), (600, True), (600, False), (600, True)), [0.0, 0.6, 0.0, 0.0]),
        # Where z was not used it stood nowhere.
        (((UNUSED, False), (600, True), (800, True)), [0.0, 0.0, 0.2]),
        (((0, False), (UNUSED, True), (500, True)), [0.0, 0.0, 0.5]),
        # From end to end is full stick, not twice.
        (((-1000, False), (1000, True)), [0.0, 1.0]),
    ],
)
def test_where_z_stood(steps: tuple[tuple[int, bool], ...], ways: list[float]) -> None:
    assert lifted(rars(), *steps) == ways


def test_after_a_silence_a_button_that_is_still_held_counts_as_pressed_then() -> None:
    bench = rars()
    assert lifted(bench, (0, False), (600, True)) == [0.0, 0.6]
    bench.now += SECOND
    assert lifted(bench, (600, True), (500, True)) == [0.0, -0.1]
    bench.now += 400 * MILLISECOND
    assert lifted(bench, (500, True)) == [-0.1]


@pytest.mark.parametrize("robot", ["rars", "climber", "diff_drive", "rome"])
def test_an_axis_that_is_not_used_any_more_is_neutral_at_once(robot: str) -> None:
    bench = bench_of(robot)
    bench.say(manual())
    still = bench.command
    bench.say(manual(r=400))
    assert bench.command != still
    bench.say(manual(r=UNUSED, y=UNUSED))
    assert bench.command == still


@pytest.mark.parametrize("robot", ["rars", "climber", "diff_drive", "rome"])
def test_a_channel_that_is_given_back_is_neutral_at_once(robot: str) -> None:
    bench = bench_of(robot)
    bench.say(manual())
    still = bench.command
    bench.say(dialect.MAVLink_rc_channels_override_message(1, 1, 1700, 65535, 1600, *(65535,) * 5))
    bench.say(dialect.MAVLink_rc_channels_override_message(1, 1, 0, 65535, 65535, *(65535,) * 5))
    only_ahead = bench.command
    bench.say(dialect.MAVLink_rc_channels_override_message(1, 1, 65535, 65535, 0, *(65535,) * 5))
    assert only_ahead != still
    assert bench.command == still


def test_what_steers_instead_of_an_axis_that_was_given_back_steers_at_once() -> None:
    bench = rars()
    bench.say(manual(r=400))
    bench.say(manual(r=UNUSED, y=-500))
    assert bench.command.steer_rad == pytest.approx(0.5 * bench.robot.geometry.limits.steer_angle_rad)


def test_an_up_button_without_its_axis_is_refused() -> None:
    rows = bench_of("rome").rows
    with pytest.raises(ValueError, match=r"an up button, and StickAxis\.UP is not among the axes"):
        StationRows(
            stick=rows.stick,
            target=rows.target,
            twist=rows.twist,
            forgotten=rows.forgotten,
            largest=rows.largest,
            up_button=3,
        )
