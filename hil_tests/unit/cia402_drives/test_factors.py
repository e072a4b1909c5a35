"""Factors 0x608F, 0x6091 and 0x6092: the set-up writes them, and the axis goes where it went before."""

import re
from collections.abc import Iterator

import pytest

from emulators.cia402.servo import Servo
from emulators.testing.rig import VirtualRig
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import parse, robots

COARSE, FINE = 720, 36_000
"""Units of position in a turn of the motor, beside 2,000 edges of its encoder."""
PLACE = 1.5
EDGES = 2_000
FEED = Address(0x6092, 1)


def scaled(units: int) -> AnyRobot:
    """Return one axis whose drive counts so many units in a turn of the motor, behind a gear of 3 to 2."""
    text = robots()["servo_axis"].read_text(encoding="utf-8")
    factors = (
        f"{{ encoder_counts = {EDGES}, gear_motor_turns = 3, gear_shaft_turns = 2, feed = {units * 3 // 2} }}"
    )
    error = round(300 * units / EDGES)
    for pattern, new in (
        (r"encoder_counts = 2_000 .*", f"encoder_counts = {units}\nfactors = {factors}"),
        (r"max_following_error_qc = 300 .*", f"max_following_error_qc = {error}"),
    ):
        text, times = re.subn(pattern, new, text)
        assert times, pattern
    return parse(text, "scaled.toml")


@pytest.fixture
def rigs() -> Iterator[list[VirtualRig]]:
    made: list[VirtualRig] = []
    yield made
    for rig in made:
        rig.bench.finish()


@pytest.mark.parametrize("units", [COARSE, FINE])
def test_the_axis_goes_where_its_file_has_it_within_its_limits(rigs: list[VirtualRig], units: int) -> None:
    robot = scaled(units)
    rigs.append(rig := VirtualRig(robot))
    rig.bench.runs(4.0)
    assert rig.interlock_events == {}
    (servo,) = rig.bench.devices.nodes(Servo).values()
    assert servo.store.live(FEED) == units * 3 // 2
    rig.operator.does("goes", position=PLACE)
    rig.bench.runs(4.0)
    assert abs(rig.bench.samples[-1]["x_m"] - PLACE) < 0.01
    assert max(map(abs, rig.bench.samples.column("speed_mps"))) <= 1.05 * robot.geometry.limits.speed
    assert rig.bench.guard.refused == 0


def test_a_drive_whose_factors_are_fixed_is_not_armed_and_named(rigs: list[VirtualRig]) -> None:
    rigs.append(rig := VirtualRig(scaled(FINE)))
    (servo,) = rig.bench.devices.nodes(Servo).values()

    def fixed(_value: int) -> None:
        raise SdoAbort(AbortCode.READ_ONLY)

    servo.store.on_write(FEED, fixed)
    rig.bench.runs(4.0)
    assert not rig.operator.armed
    texts = " ".join((*rig.interlock_events.values(), *rig.operator.texts))
    assert "0x6092:01" in texts
    assert "where the drive has it fixed, leave factors out" in texts
