"""Any targets in any turn: both bounds hold, and the target is reached."""

import math

from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.robot_types import find
from firmware_bridge.robots.rars.kinematics import ramp_of
from firmware_bridge.units import MILLISECOND, to_seconds

RAMP = ramp_of(find("rars"))
SPEEDS = st.floats(-0.5, 0.5)
BENDS = st.floats(-1 / 0.415, 1 / 0.415)
TIMES = st.integers(1, 200 * MILLISECOND)


@given(SPEEDS, SPEEDS, BENDS, TIMES)
def test_no_step_passes_either_bound(speed: float, target: float, bend: float, elapsed: int) -> None:
    set_point = RAMP.step(speed, target, bend, elapsed)
    seconds = to_seconds(min(elapsed, RAMP.longest_step))
    along = abs(set_point - speed) / seconds
    centripetal = max(abs(speed), abs(set_point)) ** 2 * abs(bend)
    assert math.hypot(along, centripetal) <= RAMP.limit_mps2 * (1 + 1e-6)
    assert along * (1 + RAMP.half_track_m * abs(bend)) <= RAMP.limit_mps2 * (1 + 1e-6)
    assert min(speed, target) <= set_point <= max(speed, target)


@given(SPEEDS, SPEEDS, BENDS)
def test_the_target_is_reached_and_kept(speed: float, target: float, bend: float) -> None:
    for _ in range(60):
        speed = RAMP.step(speed, target, bend, RAMP.longest_step)
    assert speed == target
