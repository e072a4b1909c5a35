"""Orders to one axis for the demands that are planned or come from outside: sin2, spline, gear, volts."""

from typing import Final

from emulators.servo import sine, spline
from emulators.servo.axis import DIRECT, ELECTRONIC_GEAR, MOVE, RAMP, TRAPEZOID, ServoAxis
from emulators.servo.commands import judge_again, regulate_position, regulate_velocity
from emulators.servo.profile import stopping_distance
from emulators.servo.scaling import acceleration_units, speed_units
from emulators.servo.spline import Knot

FIRST_PLANNED: Final = 10
WIDEST_SPLINE: Final = 1 << 37
"""Position units: what an axis covers in 255 ms at most."""


def obey_planned(axis: ServoAxis, kind: int, value: int, speed: int, slopes: tuple[int, int]) -> None:
    """10 sin2 move, 11 sin2 ramp, 12 spline, 13 following, 14 analog set-point, 15 the input turns."""
    up, down = slopes
    if kind == 15:
        axis.master += value % 100_000 - 50_000
        axis.analogue_2_mv = speed
        return
    if not axis.powered:
        return
    axis.acceleration = acceleration_units(axis, up)
    axis.deceleration = acceleration_units(axis, down)
    axis.cruise = speed_units(axis, abs(speed))
    axis.stopping_distance = stopping_distance(axis.cruise, axis.deceleration)
    axis.shape, axis.analogue_input = TRAPEZOID, 0
    ORDERS[kind](axis, value, speed, slopes)
    judge_again(axis, there=False)


def _moves(axis: ServoAxis, value: int, speed: int, slopes: tuple[int, int]) -> None:
    del speed, slopes
    regulate_position(axis)
    axis.profile, axis.target_position = MOVE, value << axis.fraction
    sine.load(axis)


def _ramps(axis: ServoAxis, value: int, speed: int, slopes: tuple[int, int]) -> None:
    del value, slopes
    regulate_velocity(axis)
    axis.profile, axis.target_velocity = RAMP, speed_units(axis, speed)
    sine.load(axis)


def _splines(axis: ServoAxis, value: int, speed: int, slopes: tuple[int, int]) -> None:
    regulate_position(axis)
    here = Knot(axis.position_demand, axis.velocity_demand)
    way = max(-WIDEST_SPLINE, min(WIDEST_SPLINE, value << axis.fraction))
    there = Knot(here.position + way, speed_units(axis, speed))
    spline.begin(axis, spline.segment(here, there, 1 + slopes[0] % 255))
    if value % 3:
        spline.prepare(axis, spline.segment(there, here, 1 + slopes[1] % 255))


def _follows(axis: ServoAxis, value: int, speed: int, slopes: tuple[int, int]) -> None:
    del speed
    regulate_position(axis)
    axis.profile, axis.target_position = ELECTRONIC_GEAR, axis.position_demand
    axis.gear_counted, axis.gear_rest = axis.master, 0
    axis.gear_numerator = (1 + slopes[0] % 65_535) * (1 if value > 0 else -1)
    axis.gear_denominator = 1 + slopes[1] % 65_535
    axis.lowest = -abs(value) << axis.fraction
    axis.highest = -axis.lowest


def _analogue(axis: ServoAxis, value: int, speed: int, slopes: tuple[int, int]) -> None:
    axis.profile, axis.regulator = DIRECT, 1 + value % 3
    axis.analogue_input = 1 + value % 2
    axis.analogue_numerator, axis.analogue_denominator = speed, 1 + slopes[0] % 1000
    axis.analogue_offset = value
    axis.highest = abs(value) << axis.fraction
    axis.lowest = -axis.highest


ORDERS: Final = {10: _moves, 11: _ramps, 12: _splines, 13: _follows, 14: _analogue}
