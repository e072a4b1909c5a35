"""One axis: by position and by speed, turning and sliding, on drives of two families, as one test file."""

import re
from collections.abc import Iterator

import pytest

from emulators.testing.rig import VirtualRig
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot_types import parse, robots

TEXT = robots()["servo_axis"].read_text(encoding="utf-8")
GAINS = """
[axes.settings.gains]
current_p = 86
current_i = 13
velocity_p = 6_200
velocity_i = 3_000
acceleration_feedforward = 4_900
position_p = 310
position_i = 124
position_d = 3_100
position_acceleration_feedforward = 4_900
"""
EPOS2 = (
    ('driver = "cia402-can"', 'driver = "epos2-can"'),
    ('device = "cia402"', 'device = "70/10"'),
    (r"vendor_id = 0 .*\n", ""),
    (r"product_code = 402 .*", "product_code = 0x6420_0000"),
    (r"encoder_counts = 2_000 .*", "encoder_lines = 500\\nmotor_type = 1\\nthermal_time_constant_100ms = 40"),
    (r"tuned_for_kg_m2 = .*\n", ""),
    (r"max_following_error_qc = 300 .*\n", f"max_following_error_qc = 300\\n{GAINS}"),
)
BY_SPEED = (
    ('command = "position"', 'command = "speed"'),
    (r"travel = .*\n", ""),
    ('parameter_set = "between_stops"', 'parameter_set = "free"'),
    (r'\[axes.zero\]\nhow = "confirm" .*\n', ""),
)
SLIDING = ((r"(?m)^travel = ", 'unit = "m"\\ntravel = '),)
FAMILIES = pytest.mark.parametrize("family", [(), EPOS2], ids=["cia402", "epos2"])
READY_S = 4.0
RATTLES = 0.06
"""In a second: what the load moves to and fro in the gear's backlash, while the motor holds."""


def axis(*changes: tuple[str, str]) -> AnyRobot:
    made = TEXT
    for pattern, new in changes:
        made, times = re.subn(pattern, new, made)
        assert times, pattern
    return parse(made, "my axis.toml")


@pytest.fixture
def rigs() -> Iterator[list[VirtualRig]]:
    made: list[VirtualRig] = []
    yield made
    for rig in made:
        rig.bench.finish()


def ready(rigs: list[VirtualRig], *changes: tuple[str, str]) -> VirtualRig:
    """Return a rig of the axis, armed."""
    rigs.append(rig := VirtualRig(axis(*changes)))
    rig.bench.runs(READY_S)
    assert rig.interlock_events == {}
    return rig


def within(rig: VirtualRig) -> None:
    """At no sample it was beyond its travel or faster than its limit, and the guard has refused nothing."""
    assert rig.bench.guard.refused == 0
    limit = rig.robot.geometry.limits.speed
    assert max(map(abs, rig.bench.samples.column("speed_mps"))) <= 1.02 * limit
    travel = rig.robot.axes[0].travel
    if travel is not None:
        assert travel[0] - 0.02 <= min(rig.bench.samples.column("x_m"))
        assert max(rig.bench.samples.column("x_m")) <= travel[1] + 0.02


@FAMILIES
@pytest.mark.parametrize("kind", [(), SLIDING], ids=["turning", "sliding"])
def test_it_goes_to_a_place_and_stays(
    rigs: list[VirtualRig], family: tuple[tuple[str, str], ...], kind: tuple[tuple[str, str], ...]
) -> None:
    rig = ready(rigs, *family, *kind)
    for place in (1.2, -0.5, 1.8):
        rig.operator.does("goes", position=place)
        rig.bench.runs(3.0)
        assert rig.bench.samples[-1]["x_m"] == pytest.approx(place, abs=0.02)
        assert abs(rig.bench.samples[-1]["speed_mps"]) < RATTLES
    within(rig)


@FAMILIES
def test_the_stick_jogs_it_and_no_further_than_its_end(
    rigs: list[VirtualRig], family: tuple[tuple[str, str], ...]
) -> None:
    rig = ready(rigs, *family)
    rig.operator.drives(0.5)
    rig.bench.runs(1.0)
    assert rig.bench.samples[-1]["speed_mps"] == pytest.approx(0.5, abs=0.15)
    rig.operator.drives(0.0)
    rig.bench.runs(1.0)
    stands = rig.bench.samples[-1]["x_m"]
    assert stands == pytest.approx(0.5, abs=0.15)
    rig.operator.drives(-2.0)
    rig.bench.runs(3.0)
    assert "travel limit" in rig.interlock_events
    assert rig.bench.samples[-1]["x_m"] == pytest.approx(-0.8, abs=0.02)
    within(rig)


@FAMILIES
def test_an_axis_by_speed_turns_as_fast_as_it_is_commanded_and_not_faster(
    rigs: list[VirtualRig], family: tuple[tuple[str, str], ...]
) -> None:
    rig = ready(rigs, *family, *BY_SPEED)
    for speed in (0.5, -1.5, 1.9):
        rig.operator.drives(speed)
        rig.bench.runs(2.0)
        assert rig.bench.samples[-1]["speed_mps"] == pytest.approx(speed, abs=0.1)
    rig.operator.stops()
    rig.bench.runs(2.0)
    assert abs(rig.bench.samples[-1]["speed_mps"]) < RATTLES
    within(rig)


@FAMILIES
def test_an_axis_by_speed_stops_at_its_ends_and_goes_to_no_position(
    rigs: list[VirtualRig], family: tuple[tuple[str, str], ...]
) -> None:
    rig = ready(rigs, *family, BY_SPEED[0])
    for speed, end in ((1.9, 1.8), (-1.9, -0.8)):
        rig.operator.drives(speed)
        rig.bench.runs(4.0)
        assert "travel limit" in rig.interlock_events
        assert rig.bench.samples[-1]["x_m"] == pytest.approx(end, abs=0.05)
        assert abs(rig.bench.samples[-1]["speed_mps"]) < RATTLES
    rig.operator.does("goes", position=1.0)
    rig.bench.runs(2.0)
    assert rig.bench.samples[-1]["x_m"] == pytest.approx(-0.8, abs=0.05)
    within(rig)


@FAMILIES
def test_it_is_homed_to_a_switch(rigs: list[VirtualRig], family: tuple[tuple[str, str], ...]) -> None:
    homed = (
        r'how = "confirm" .*\n',
        (
            'how = "home"\\n\\n[axes.zero.homing]\\nmethod = 17\\nspeed = 0.4\\nzero_speed = 0.1\\n'
            "acceleration = 5.0\\nat = -0.8\\nwithin_s = 30.0\\n"
        ),
    )
    limits = ("backlash = 0.0", "backlash = 0.0, limit_low = -0.8")
    rigs.append(rig := VirtualRig(axis(*family, homed, limits)))
    rig.bench.runs(2.0)
    rig.operator.does("homes", home=["axis"])
    rig.bench.runs(15.0)
    assert "axis restarted: axis" not in rig.interlock_events
    assert "reference lost: axis" not in rig.interlock_events
    last = rig.bench.samples[-1]
    assert last["odometry_x_m"] == pytest.approx(last["x_m"], abs=0.03)


def test_a_method_that_the_family_has_not_is_reported_with_what_there_is() -> None:
    homed = (
        r'how = "confirm" .*\n',
        (
            'how = "home"\\n\\n[axes.zero.homing]\\nmethod = -3\\nspeed = 0.4\\nzero_speed = 0.1\\n'
            "acceleration = 5.0\\nat = -0.8\\ncurrent_a = 1.0\\nwithin_s = 30.0\\n"
        ),
    )
    with pytest.raises(RobotFileError, match="of CiA 402 there are 1, 2, 7"):
        axis(homed)
    axis(*EPOS2, homed)
