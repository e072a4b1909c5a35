"""RARS with an IMU: its file, guard, faults at their instants, and missions that it drives as without."""

import math
from collections.abc import Iterator

import pytest
from typer.testing import CliRunner

from emulators.bench.faults import read
from emulators.testing.inherited.scripted import scripted
from emulators.testing.rig import VirtualRig
from firmware_bridge.cli import program
from firmware_bridge.families.imu.guard import ImuRules
from firmware_bridge.families.imu.settings import ImuLink, Quantity
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot.table import Medium
from firmware_bridge.robot_types import find, parse, robot_type_named, robots
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import NEVER, Nanoseconds, from_seconds

NAME = "rars+imu"
NOISE_DEG = 0.5
"""Three standard deviations of the part's bias, 3 mg, are 0.52 degrees; its noise is far below."""


def file_with(old: str, new: str) -> str:
    robot_type = robot_type_named("rars")
    text = robot_type.file.read_text(encoding="utf-8") + robot_type.more["imu"].read_text(encoding="utf-8")
    assert old in text
    return text.replace(old, new)


def tipping(**parameters: float) -> AnyRobot:
    """Return the robot on the plant that rolls, pitches and stands on slopes."""
    robot = find(NAME)
    plant = {"fmu": "rars_tipping", "parameters": {**robot.plant.parameters, **parameters}}
    return robot.model_copy(update={"plant": robot.plant.model_copy(update=plant)})


def angles(rig: VirtualRig) -> tuple[float, float] | None:
    """Return pitch and roll in degrees as the bridge has them; None where both are absent."""
    readings = rig.bench.bridge.all_drivers.readings(rig.bench.world.now)
    assert ("pitch" in readings) is ("roll" in readings)
    if "pitch" not in readings:
        return None
    return math.degrees(readings["pitch"].value), math.degrees(readings["roll"].value)


def problem(rig: VirtualRig) -> str:
    (found,) = (one.link for one in rig.bench.bridge.all_drivers.all if one.name == "imu")
    return str(getattr(found, "problem"))  # noqa: B009 - the family's own, of no link else


def test_the_file_is_a_variant_and_the_robot_itself_has_no_imu() -> None:
    assert NAME in robots()
    link = ImuLink.all_of(find(NAME))["imu"]
    assert (link.medium, link.rate, link.silent_ms, link.stops) == (Medium.SERIAL, 115_200, 100, ())
    assert ImuLink.all_of(find("rars")) == {}
    assert {one.value for one in Quantity} >= {"pitch", "roll", "acceleration_x", "rate_z"}


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        (('quantity = "pitch"', 'quantity = "yaw"'), "'yaw' is not known"),
        (('driver = "imu-serial"', 'driver = "imu-can"'), "'imu-can' is not known"),
        (("time_constant_s = 20.0", "time_constant_s = 0.5"), "time_constant_s"),
        (("time_constant_s = 20.0", "baud = 19_200"), "baud"),
        (("time_constant_s = 20.0", "mounted = { about_z_deg = 270.0 }"), "about_z_deg"),
        (("time_constant_s = 20.0", 'stops = ["wings"]'), "no group 'wings'"),
        (("silent_ms = 100                 # without", "silent_ms = 50 # without"), "silent_ms"),
        (('link = "imu"', 'link = "drives"'), "another device: 'drives' is a link to EPOS2 drives"),
    ],
)
def test_a_mistake_in_the_file_is_reported_with_its_key(change: tuple[str, str], reported: str) -> None:
    with pytest.raises(RobotFileError) as caught:
        parse(file_with(*change), "my.toml")
    assert reported in str(caught.value)


class States:
    """A bridge that sends what it was given, once."""

    def __init__(self, *packets: Packet) -> None:
        self.packets = packets

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        del packet, now
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        del now
        return Reaction(self.packets, NEVER)


@pytest.mark.parametrize("data", [b"", b"\x00", b"identify\n", bytes(22)])
def test_nothing_leaves_to_an_imu_and_nothing_stops_for_it(data: bytes) -> None:
    beside = Packet("operator", 0, b"telemetry")
    assert guarded(States(Packet("imu", 0, data), beside), find(NAME)).wake(0).sent == (beside,)


def test_the_rules_of_its_line_know_no_axis() -> None:
    rules, packet = ImuRules(find(NAME), "imu"), Packet("imu", 0, b"x")
    assert (rules.link, rules.axes, rules.waiting) == ("imu", (), False)
    assert rules.refuses(packet, 0) == "an IMU takes no command"
    assert (rules.axes_of(packet), dict(rules.requested_by(packet)), rules.safe(None)) == ((), {}, ())
    assert (rules.replacement_of(packet), rules.sends(packet, 0, requested=False)) == ((), ())
    assert rules.receives(packet, 0)


def test_a_fault_of_an_imu_wants_an_imu() -> None:
    for kind in ("imu_frozen", "imu_axes_swapped", "imu_silent"):
        fault = read({"kind": kind, "at_s": 1.0, "until_s": 2.0})
        assert list(fault.problems(find(NAME))) == []
        assert list(fault.problems(find("rars"))) == [("kind", "rars has no IMU")]


def test_the_commands_list_it() -> None:
    shown = CliRunner().invoke(program, ["faults", NAME], env={"COLUMNS": "200"})
    assert shown.exit_code == 0
    assert all(kind in shown.stdout for kind in ("imu_frozen", "imu_axes_swapped", "imu_silent"))


@pytest.fixture(scope="module")
def driving() -> Iterator[VirtualRig]:
    """RARS on a slope of 5.7 degrees, ahead with 0.2 m/s: pitch and roll differ."""
    rig = VirtualRig(tipping())
    rig.arms()
    rig.bench.devices.plant.change("slope", 0.0)
    for step in range(1, 101):
        # A gentle ramp that begins below it.
        rig.bench.devices.plant.change("slope", 0.001 * step)
        rig.runs(0.01)
    rig.operator.drives(forward=0.2)
    rig.runs(1.5)
    yield rig
    rig.finish()


def test_the_slope_is_seen_while_it_drives(driving: VirtualRig) -> None:
    pitch, roll = angles(driving) or (math.nan, math.nan)
    assert pitch == pytest.approx(math.degrees(0.1), abs=NOISE_DEG)
    assert roll == pytest.approx(0.0, abs=NOISE_DEG)


@pytest.mark.parametrize(
    ("kind", "first", "then"),
    [
        ("imu_frozen", 0.05, "all six values are the same in 10 frames: the sensor is stuck"),
        ("imu_silent", 0.07, "no frame for 100 ms"),
        ("serial_unplugged", None, "the serial adapter is unplugged"),
    ],
)
def test_a_fault_takes_the_readings_away_at_its_time_and_stops_no_one(
    driving: VirtualRig, kind: str, first: float | None, then: str
) -> None:
    with driving.branch() as rig:
        rig.fault(kind, for_s=0.5)
        if first is not None:
            rig.runs(first)
            assert angles(rig) is not None
        rig.runs(0.15)
        assert (angles(rig), problem(rig)) == (None, then)
        rig.runs(0.5)
        # The filter settles for a second after the end.
        assert angles(rig) is None
        rig.runs(1.2)
        pitch, _ = angles(rig) or (math.nan, math.nan)
        assert pitch == pytest.approx(math.degrees(0.1), abs=1.0)
        assert rig.body.speed == pytest.approx(0.2, abs=0.03)
        assert "imu" not in str(dict(rig.interlock_events))


def test_swapped_axes_show_the_slope_aside_and_go_back(driving: VirtualRig) -> None:
    with driving.branch() as rig:
        rig.fault("imu_axes_swapped", for_s=10.0)
        # The gyro does not turn at the exchange: the filter follows with its time constant of 20 s.
        share = 1.0 - math.exp(-10.0 / 20.0)
        rig.runs(10.0)
        pitch, roll = angles(rig) or (math.nan, math.nan)
        assert roll == pytest.approx(share * math.degrees(0.1), abs=NOISE_DEG)
        assert pitch == pytest.approx((1.0 - share) * math.degrees(0.1), abs=NOISE_DEG)
        rig.runs(10.0)
        back, _ = angles(rig) or (math.nan, math.nan)
        assert back > pitch + 0.5


def test_a_line_that_is_lost_stops_those_whom_the_robot_file_names() -> None:
    robot = parse(file_with("time_constant_s = 20.0", 'stops = ["base"]'), "my.toml")
    rig = VirtualRig(robot)
    try:
        rig.arms()
        rig.operator.drives(forward=0.2)
        rig.runs(2.0)
        rig.fault("serial_unplugged", for_s=1.0)
        rig.runs(0.9)
        assert "link lost: imu" in rig.interlock_events
        assert rig.body.speed == pytest.approx(0.0, abs=0.02)
    finally:
        rig.finish()


def driven(name: str, mission: str, until_s: float) -> tuple[dict[str, str], list[tuple[float, float]]]:
    """Return the hashes of the links, and pitch and roll in degrees every 0.1 s, of a mission's begin."""
    found = []
    with scripted(find(name), mission) as rig:
        for step in range(1, round(until_s * 10) + 1):
            rig.run(from_seconds(step / 10))
            readings = rig.bridge.all_drivers.readings(rig.world.now)
            if "pitch" in readings:
                angle = (math.degrees(readings[one].value) for one in ("pitch", "roll"))
                found.append((next(angle), next(angle)))
        return rig.world.links_sha256, found


def test_the_mission_line_is_driven_to_the_bit_as_without_and_the_floor_is_level() -> None:
    # To 5.5 s the robot is armed and has accelerated; the whole mission is a matter of `bench rars+imu`.
    alone, _ = driven("rars", "line", 12.0)
    with_imu, found = driven(NAME, "line", 12.0)
    assert {link: with_imu[link] for link in alone} == alone
    assert len(found) >= 110
    assert max(abs(one) for both in found for one in both) < NOISE_DEG


def test_circles_are_no_slope() -> None:
    _, found = driven(NAME, "circles", 40.0)
    assert len(found) >= 390
    assert max(abs(one) for both in found for one in both) < NOISE_DEG
