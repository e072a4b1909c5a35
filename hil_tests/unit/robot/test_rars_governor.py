"""RARS's governor: what it allows on the level, uphill, downhill and across, by the thesis's figures."""

import json
import math
import re
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.bench.cases import Situation
from emulators.robots.rars.cases import BALANCE, WELL
from emulators.testing.inherited.fake_driver import START, active, gate_of, seen
from firmware_bridge.drivers.driver import Reading
from firmware_bridge.motion.standing import Standing
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot_types import find, parse, robots
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.governor import BRAKES, LEAST_BRAKES, SAFE_SHARE, Governor
from firmware_bridge.robots.rars.motion import RarsState

EXACT = BALANCE.model_copy(update={"tilt_error_deg": 0.0})
ROUGH = EXACT.model_copy(update={"floor_friction": 2.0})
"""A floor on which it never slides."""
SLOPES = st.floats(-0.45, 0.45)


def geometry(balance: object = EXACT) -> RarsGeometry:
    given: RarsGeometry = find("rars").geometry
    base = given.base.model_copy(update={"centre_offset_m": 0.141})
    return given.model_copy(update={"base": base, "balance": balance})


def tilted(pitch_deg: float, roll_deg: float = 0.0, lift_m: float = 0.0) -> RarsState:
    return replace(WELL, tilt_rad=(math.radians(pitch_deg), math.radians(roll_deg)), lift_m=lift_m)


@pytest.mark.parametrize(
    ("table", "reported"),
    [
        ("pitch", "geometry.balance.pitch: no sensor 'pitc'; perhaps 'pitch'?"),
        ("roll", "geometry.balance.roll: no sensor 'pitc'; perhaps 'pitch'?"),
    ],
)
def test_a_sensor_that_is_not_there_is_reported_by_its_key(table: str, reported: str) -> None:
    file = robots()["rars"]
    rars, imu = (file.with_name(f"{name}.toml").read_text(encoding="utf-8") for name in ("rars", "imu"))
    names = {"pitch": "pitch", "roll": "roll", table: "pitc"}
    balance = EXACT.model_dump(exclude_none=True) | names
    rows = "\n".join(f"{key} = {json.dumps(value)}" for key, value in balance.items())
    with pytest.raises(RobotFileError, match=re.escape(reported)):
        parse(f"{rars}\n{imu}\n[geometry.balance]\n{rows}\n", "mine.toml")


@pytest.mark.parametrize(("while_driving", "stops"), [(False, True), (True, False)])
def test_it_drives_with_the_lift_up_only_where_the_robot_file_lets_it(
    *, while_driving: bool, stops: bool
) -> None:
    balance = EXACT.model_copy(update={"lift_while_driving": while_driving})
    machine = find("rars").model_copy(update={"geometry": geometry(balance)})
    decision = gate_of(machine).rule(seen(machine, START, Situation(body=tilted(0.0, lift_m=0.3))))
    assert ("lift extended" in active(decision)) is stops
    assert ("base" in decision.stopped) is stops


def test_without_its_table_it_changes_nothing() -> None:
    governor = Governor(geometry(None))
    assert governor.tilt({}) is None
    assert governor.ramped(0.1, 0.5, tilted(30.0), 0.0, 0.05) == 0.5
    assert governor.top_speed(tilted(30.0), 1.0, 0.0) == math.inf
    assert governor.highest_lift(tilted(30.0)) == math.inf


def test_on_the_level_nothing_of_the_robot_s_own_limits_is_taken() -> None:
    governor, limits = Governor(geometry()), geometry().limits
    for direction in (-1.0, 1.0):
        for bend in (-1.0 / limits.turn_radius_m, 0.0, 1.0 / limits.turn_radius_m):
            assert governor.top_speed(tilted(0.0), direction, bend) > limits.speed_mps
    assert governor.highest_lift(tilted(0.0)) == math.inf
    step = limits.acceleration_mps2 * 0.05
    for before in (-0.3, 0.0, 0.3):
        for after in (before - 0.8 * step, before + 0.8 * step):
            assert governor.ramped(before, after, tilted(0.0), 0.0, 0.05) == pytest.approx(after)


def test_ten_kilograms_on_thirty_degrees_may_back_downhill_and_not_climb() -> None:
    governor = Governor(geometry())
    uphill = tilted(30.0)
    assert governor.top_speed(uphill, 1.0, 0.0) == 0.0
    assert 0.03 < governor.top_speed(uphill, -1.0, 0.0) < 0.10
    assert governor.highest_lift(uphill) <= 0.0
    assert governor.ramped(0.0, 0.05, uphill, 0.0, 0.05) == 0.0
    backs = governor.ramped(0.0, -0.05, uphill, 0.0, 0.05)
    assert backs == -0.05, "downhill it is held by all its wheels"


def test_nose_downhill_it_is_the_other_way_round() -> None:
    governor = Governor(geometry(ROUGH))
    downhill = tilted(-30.0)
    assert governor.top_speed(downhill, 1.0, 0.0) > 0.5
    assert governor.top_speed(downhill, -1.0, 0.0) > 0.5


def test_a_braking_robot_always_brakes() -> None:
    governor = Governor(geometry())
    for before in (-0.2, 0.2):
        for pitch in (-30.0, 0.0, 30.0):
            after = governor.ramped(before, 0.0, tilted(pitch), 0.0, 0.05)
            assert abs(before) - abs(after) >= LEAST_BRAKES * 0.05 - 1e-12
            assert before * after >= 0.0


@pytest.mark.parametrize(("roll_deg", "worse"), [(20.0, 1.0), (-20.0, -1.0)])
def test_across_a_slope_it_turns_downhill_faster_than_uphill(roll_deg: float, worse: float) -> None:
    governor = Governor(geometry())
    # The left side is up: a turn to the left pushes it to the right, downhill.
    risky, calm = (governor.top_speed(tilted(0.0, roll_deg), 1.0, side * 2.4) for side in (worse, -worse))
    assert risky < calm


def test_the_table_rises_as_far_as_the_margin_stays() -> None:
    model = geometry()
    governor = Governor(model)
    state = tilted(20.0)
    highest = governor.highest_lift(state)
    assert 0.0 < highest < 1.0
    corners = ((0.0, -0.2), (0.515, -0.168), (0.515, 0.168), (0.0, 0.2))
    height = EXACT.height(model.base, highest)
    margin = Standing(corners, (0.141, 0.0, height), *state.tilt_rad or ()).margin()
    assert margin == pytest.approx(EXACT.least_margin_m, abs=1e-9)


@given(SLOPES, SLOPES, st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-2.4, 2.4))
def test_no_acceleration_that_it_lets_pass_takes_a_margin_that_it_could_leave(
    pitch: float, roll: float, before: float, after: float, bend: float
) -> None:
    model = geometry()
    governor = Governor(model)
    state = replace(WELL, tilt_rad=(pitch, roll))
    speed = governor.ramped(before, after, state, bend, 0.05)
    assert min(before, after) - 1e-12 <= speed <= max(before, after) + 1e-12
    ahead = (speed - before) / 0.05
    height = EXACT.height(model.base, 0.0)
    corners = ((0.0, -0.2), (0.515, -0.168), (0.515, 0.168), (0.0, 0.2))
    standing = Standing(corners, (0.141, 0.0, height), pitch, roll)
    brakes = ahead * before < 0.0 and abs(ahead) <= BRAKES + 1e-9
    if brakes and abs(ahead) > LEAST_BRAKES + 1e-9:
        # Slipping wheels stop a third harder than commanded, as measured on 30 degrees.
        assert standing.margin(1.35 * ahead, before * before * bend) >= 0.0
    elif ahead and not brakes:
        assert standing.margin(ahead, before * before * bend) >= EXACT.needed(height) - 1e-9


@given(SLOPES, SLOPES, st.sampled_from((-1.0, 1.0)))
def test_at_its_top_speed_not_even_a_stop_at_once_tips_it(pitch: float, roll: float, way: float) -> None:
    model = geometry()
    top = Governor(model).top_speed(replace(WELL, tilt_rad=(pitch, roll)), way, 0.0)
    corners = ((0.0, -0.2), (0.515, -0.168), (0.515, 0.168), (0.0, 0.2))
    standing = Standing(corners, (0.141, 0.0, EXACT.height(model.base, 0.0)), pitch, roll)
    assert top <= SAFE_SHARE * standing.safe_speed(way) + 1e-12


@pytest.mark.parametrize(
    "values", [{}, {"pitch": 0.0}, {"pitch": math.nan, "roll": 0.0}, {"pitch": 1.2, "roll": 0.0}]
)
def test_a_tilt_that_is_not_whole_is_unknown(values: dict[str, float]) -> None:
    readings = {name: Reading(value, 0, 0) for name, value in values.items()}
    assert Governor(geometry()).tilt(readings) is None
