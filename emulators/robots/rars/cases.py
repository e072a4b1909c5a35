"""RARS's interlocks at the edges of their thresholds; for the inherited tests."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final, TypeAlias

from emulators.bench import cases as bench
from firmware_bridge.motion import scissor
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rars.geometry import Balance, RarsGeometry, Weighing
from firmware_bridge.robots.rars.governor import Governor
from firmware_bridge.robots.rars.kinematics import ramp_of
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.robots.rars.rules import tipping_speed

Case: TypeAlias = bench.Case[RarsMotion, RarsState]
Situation: TypeAlias = bench.Situation[RarsMotion, RarsState]

WELL: Final = RarsState(
    steer_rad=0.0, lift_m=0.0, screw_rad_s=0.0, speed_mps=0.0, yaw_rate_rad_s=0.0, tilt_rad=(0.0, 0.0)
)
BALANCE: Final = Balance(
    pitch="pitch",
    roll="roll",
    mass_kg=70.0,
    scissor_kg=8.0,
    table_height_m=0.5,
    payload_kg=10.0,
    floor_friction=1.0,
)
STEEP_RAD: Final = 0.44
JUST: Final = 1.0 + 1e-5
"""A limit reports what is beyond it by more than a millionth."""


def cases(robot: Robot[RarsGeometry]) -> Iterator[Case]:
    """Yield at least one case for each interlock and limit."""
    yield from _interlocks(robot)
    yield from _limits(robot)


def _interlocks(robot: Robot[RarsGeometry]) -> Iterator[Case]:
    retracted = robot.geometry.limits.lift_retracted_m
    for unknown in (None, math.nan, math.inf):
        yield _seen("steer angle unknown", "the actual steer angle is not known", steer_rad=unknown)
    yield _seen("lift height unknown", "the actual lift height is not known", lift_m=None)
    yield Case(
        "lift extended",
        trips=Situation(body=replace(WELL, lift_m=math.nextafter(retracted, 1.0))),
        spares=Situation(body=replace(WELL, lift_m=retracted)),
        reason=f"the lift stands at {1e3 * retracted:.0f} mm, retracted is below {1e3 * retracted:.0f} mm",
    )
    for side in (-1.0, 1.0):
        yield Case(
            "lift moving",
            trips=Situation(body=replace(WELL, screw_rad_s=side * math.nextafter(0.10, 1.0))),
            spares=Situation(body=replace(WELL, screw_rad_s=side * 0.10)),
            reason=f"the lift's screw turns with {side * 0.10:.2f} rad/s",
        )
        yield Case(
            "lift refused",
            trips=Situation(
                command=RarsMotion(lift_rate_mps=0.05),
                body=replace(WELL, speed_mps=side * math.nextafter(0.010, 1.0)),
            ),
            spares=Situation(
                command=RarsMotion(lift_rate_mps=0.05), body=replace(WELL, speed_mps=side * 0.010)
            ),
            reason=f"the robot drives with {side * 0.01:.2f} m/s",
        )
        # Each wheel turns against the other: 10 mm/s at 0.2 m from the middle are 0.05 rad/s.
        yield Case(
            "lift refused",
            trips=Situation(
                command=RarsMotion(lift_rate_mps=0.05),
                body=replace(WELL, yaw_rate_rad_s=side * math.nextafter(0.05, 1.0)),
            ),
            spares=Situation(
                command=RarsMotion(lift_rate_mps=0.05),
                body=replace(WELL, yaw_rate_rad_s=side * math.nextafter(0.05, 0.0)),
            ),
            reason="the robot drives with 0.01 m/s",
        )


def _seen(interlock: str, reason: str, **body: float | None) -> Case:
    return Case(
        interlock,
        trips=Situation(body=replace(WELL, **body)),  # type: ignore[arg-type] # a field of State each
        spares=Situation(body=WELL),
        reason=reason,
    )


def _limits(robot: Robot[RarsGeometry]) -> Iterator[Case]:
    limits, tightest = robot.geometry.limits, robot.geometry.tightest_steer_rad
    highest = scissor.highest(robot.geometry.lift)
    step = ramp_of(robot).step(0.0, limits.speed_mps, 0.0, robot.cycle)
    for side in (-1.0, 1.0):
        fast, tight, rate = side * limits.speed_mps, side * tightest, side * limits.lift_rate_mps
        yield _limited("speed limit", RarsMotion(fast), RarsMotion(JUST * fast), (JUST * fast, fast, "m/s"))
        lock = side * limits.steer_angle_rad
        yield _limited(
            "steer angle limit",
            RarsMotion(steer_rad=tight),
            RarsMotion(steer_rad=JUST * lock),
            (math.degrees(JUST * lock), math.degrees(lock), "deg"),
        )
        yield _limited(
            "turn radius limit",
            RarsMotion(steer_rad=tight),
            RarsMotion(steer_rad=JUST * tight),
            (math.degrees(JUST * tight), math.degrees(tight), "deg"),
        )
        yield _limited(
            "lift rate limit",
            RarsMotion(lift_rate_mps=rate),
            RarsMotion(lift_rate_mps=JUST * rate),
            (JUST * rate, rate, "m/s"),
        )
        yield Case(
            "acceleration limit",
            trips=Situation(command=RarsMotion(side * 2.0 * step)),
            spares=Situation(command=RarsMotion(side * step)),
            reason=f"requested a step from 0.00 to {side * 2.0 * step:.2f} m/s at once, "
            f"limit {limits.acceleration_mps2:.2f} m/s2",
        )
    yield _limited(
        "lift range limit",
        RarsMotion(lift_m=highest),
        RarsMotion(lift_m=JUST * highest),
        (JUST * highest, highest, "m"),
    )
    yield _tipping(robot, tightest)
    yield from _balanced(robot)


def _balanced(robot: Robot[RarsGeometry]) -> Iterator[Case]:
    """Yield the cases of a robot that has an IMU, which the robot file lacks."""
    base = robot.geometry.base.model_copy(update={"centre_offset_m": 0.141})
    geometry = robot.geometry.model_copy(update={"base": base, "balance": BALANCE})
    with_imu = robot.model_copy(update={"geometry": geometry})
    governor = Governor(geometry)
    yield Case(
        "tilt unknown",
        trips=Situation(body=replace(WELL, tilt_rad=None)),
        spares=Situation(body=WELL),
        reason="its tilt is not known: no reading of 'pitch' and 'roll'",
        robot=with_imu,
    )
    table = Weighing(acceleration="ahead", newton_per_ampere=20.0, resistance_n=8.0)
    weighed = geometry.model_copy(update={"balance": BALANCE.model_copy(update={"weighing": table})})
    most = 1.2 * BALANCE.heaviest_kg
    yield Case(
        "load implausible",
        trips=Situation(body=replace(WELL, mass_kg=JUST * most)),
        spares=Situation(body=replace(WELL, mass_kg=most)),
        reason=f"by currents and IMU it weighs {JUST * most:.0f} kg, with payload_kg 80.0 kg; limit 96 kg",
        robot=robot.model_copy(update={"geometry": weighed}),
    )
    steep = replace(WELL, tilt_rad=(STEEP_RAD, 0.0), margin_m=0.05)
    # Nose uphill: backwards it could tip over its rear wheels as it stops.
    top = governor.top_speed(steep, -1.0, 0.0)
    yield Case(
        "margin limit",
        trips=Situation(command=RarsMotion(-JUST * top), commanded=RarsMotion(-top), body=steep),
        spares=Situation(command=RarsMotion(-top), commanded=RarsMotion(-top), body=steep),
        reason=f"requested {-JUST * top:.2f} m/s, allowed is {top:.2f} m/s, the standing margin is 50 mm",
        robot=with_imu,
    )
    highest = governor.highest_lift(steep)
    yield Case(
        "lift margin limit",
        trips=Situation(command=RarsMotion(lift_m=JUST * highest), body=steep),
        spares=Situation(command=RarsMotion(lift_m=highest), body=steep),
        reason=f"the table may rise to {1e3 * highest:.0f} mm here, it is at 0 mm",
        robot=with_imu,
    )


def _limited(
    interlock: str, within: RarsMotion, beyond: RarsMotion, values: tuple[float, float, str]
) -> Case:
    """Return the case of a limit that is passed at the pace that the robot has already."""
    requested, allowed, unit = values
    return Case(
        interlock,
        trips=Situation(command=beyond, commanded=within),
        spares=Situation(command=within, commanded=within),
        reason=f"requested {requested:.2f} {unit}, allowed is {allowed:.2f} {unit}",
    )


def _tipping(robot: Robot[RarsGeometry], steer_rad: float) -> Case:
    """Return the case of a robot that may drive fast enough to tip over, in its tightest turn."""
    top = tipping_speed(robot, steer_rad)
    # With its own speed limit the robot could not reach the tipping speed.
    limits = robot.geometry.limits.model_copy(update={"speed_mps": 2.0 * top})
    turning = replace(WELL, steer_rad=steer_rad)
    within, beyond = RarsMotion(top), RarsMotion(JUST * top)
    return Case(
        "tipping limit",
        trips=Situation(command=beyond, commanded=within, body=turning),
        spares=Situation(command=within, commanded=within, body=turning),
        reason=f"requested {JUST * top:.2f} m/s, allowed is {top:.2f} m/s",
        robot=robot.model_copy(update={"geometry": robot.geometry.model_copy(update={"limits": limits})}),
    )
