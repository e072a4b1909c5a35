"""RARS on the bench: the inputs of a mission's step, the station's messages, and the pictures.

Signs and scales are written here again, not taken from the bridge, so that a mistake there is not repeated.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Final, Literal, Self, TypeAlias

import numpy as np
from pydantic import Field, model_validator

from emulators.bench.bench_setup import BenchSetup, Channel, StickAxes, TwistAxes
from emulators.bench.columns import PLANAR, SAMPLE_EVERY, Column, Curve, Panel, Samples
from emulators.bench.step import Finite, Holds, NonNegative, Positive, Presses, Sends, Slope, Step
from emulators.robots.rars.cases import cases
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.units import to_seconds

Rars: TypeAlias = Robot[RarsGeometry]
BUTTONS: Final = {"detector": 1, "headlamp": 2, "emergency_stop": 4}
LIFT_ENABLE: Final = 8
STEERS_RAD_S: Final = 0.05
"""Rate of the inner wheel from which on the rack counts as moving: 1.5 mm/s in the middle."""
JUDGED_MPS: Final = 0.1
"""Least speed at which the wheels' ratio is judged; below, a count of the encoders is a percent of it."""
_ILLUMINATOR: Final = 405
_RELAY: Final = 181
_ACTUATOR: Final = 187


def steer_of_radius(radius_m: float, robot: Rars) -> float:
    """Return the inner wheel's angle in rad for a turn, R = a_k / 2 + w cot(theta) (thesis 2.13)."""
    base = robot.geometry.base
    inner = math.atan2(base.wheelbase_m, abs(radius_m) - base.kingpin_distance_m / 2.0)
    return math.copysign(inner, radius_m)


def lift_travel(robot: Rars) -> float:
    """Return how far the platform rises: N l (sin extended - sin collapsed) (thesis 2.16)."""
    lift = robot.geometry.lift
    low, high = math.radians(lift.collapsed_angle_deg), math.radians(lift.extended_angle_deg)
    return lift.stages * lift.link_length_m * (math.sin(high) - math.sin(low))


class RarsStep(Step):
    """The RARS operator's input at one instant; speed, steering and lift rate stay until a later step."""

    speed_mps: Annotated[Finite | None, Holds("speed")] = None
    """Forward positive; at once, or with `ramp_mps2`."""
    ramp_mps2: Annotated[Positive | None, Slope("speed")] = None
    steer_deg: Annotated[
        float | None, Field(gt=-90, lt=90), Holds("steer", lambda angle, _: math.radians(angle))
    ] = None
    """Inner front wheel, left positive."""
    radius_m: Annotated[Finite | None, Holds("steer", steer_of_radius)] = None
    """Radius of the rear axle's middle, left positive; another way to give `steer_deg`."""
    lift_m: Annotated[
        NonNegative | None,
        Sends(_ACTUATOR, lambda height, robot: (2.0 * height / lift_travel(robot) - 1.0,), -3),
    ] = None
    """Go to this height above collapsed."""
    lift_rate_mps: Annotated[Finite | None, Holds("lift rate")] = None
    """Move the lift by stick, up positive, until a later step changes it."""
    headlamp: Annotated[bool | None, Sends(_ILLUMINATOR, lambda on, _: (float(on),), -1)] = None
    detector: Annotated[bool | None, Sends(_RELAY, lambda on, _: (0.0, float(on)), -2)] = None
    press: Annotated[Literal["detector", "headlamp", "emergency_stop"] | None, Presses(BUTTONS)] = None
    """Tap a button of the stick."""

    @model_validator(mode="after")
    def _a_turn_has_a_radius(self) -> Self:
        if self.radius_m == 0:
            raise ValueError("radius_m must not be 0; straight ahead is steer_deg = 0")
        return self


def _stick(values: Mapping[str, float], robot: Rars) -> StickAxes:
    limits = robot.geometry.limits
    # Without its button the bridge takes no lift rate from z, so the button is held while the lift moves.
    rate = values["lift rate"] / limits.lift_rate_mps
    return StickAxes(
        x=values["speed"] / limits.speed_mps,
        z=rate,
        r=-values["steer"] / math.radians(limits.steer_angle_deg),
        buttons=LIFT_ENABLE if rate else 0,
    )


def _twist(values: Mapping[str, float], robot: Rars) -> TwistAxes:
    speed, steer = values["speed"], values["steer"]
    # Straight ahead has no finite radius.
    if steer == 0.0:
        return TwistAxes(speed, yaw_rate=-speed * 0.0)
    base = robot.geometry.base
    # The inner wheel turns about its kingpin, half the kingpins' distance nearer to the center.
    radius = base.kingpin_distance_m / 2.0 + base.wheelbase_m / math.tan(abs(steer))
    return TwistAxes(speed, yaw_rate=-speed * math.copysign(1.0 / radius, steer))


def ratio_error(samples: Samples, robot: Rars) -> float | None:
    """Return the largest error of the wheels' ratio while the rack moves, as a share; None without.

    Against the ratio of the angle at that instant (4.10), (4.11), by the plant, at 0.1 m/s or more.
    """
    base = robot.geometry.base
    steer, speed = samples.column("steer_rad"), samples.column("speed_mps")
    inner = base.kingpin_distance_m / 2.0 * np.abs(np.sin(steer)) + base.wheelbase_m * np.cos(steer)
    across = base.rear_track_m / 2.0 * np.sin(steer) / inner
    moves = np.abs(np.gradient(steer, to_seconds(SAMPLE_EVERY))) if len(steer) > 1 else np.zeros(len(steer))
    rows = (moves > STEERS_RAD_S) & (np.abs(speed) >= JUDGED_MPS)
    left, right = (samples.column(f"motor_speed_{side}_rad_s")[rows] for side in ("left", "right"))
    if not rows.any() or not left.all():
        return None
    error = right / left * (1.0 - across[rows]) / (1.0 + across[rows]) - 1.0
    return float(np.abs(error).max())


def _commanded(seen: Snapshot[RarsMotion, RarsState]) -> float:
    return seen.commanded.speed_mps


def _remarks(robot: Rars) -> Mapping[str, str]:
    limits = robot.geometry.limits
    return {
        "max_speed_mps": f"limit {limits.speed_mps:g}",
        "max_acceleration_mps2": f"limit {limits.acceleration_mps2:.3f}",
    }


BENCH_SETUP: Final = BenchSetup(
    step=RarsStep,
    missions=Path(__file__).with_name("missions"),
    channels=(
        Channel("speed", lambda robot: robot.geometry.limits.speed_mps, trembles_with="speed"),
        Channel(
            "steer", lambda robot: math.radians(robot.geometry.limits.steer_angle_deg), trembles_with="speed"
        ),
        Channel("lift rate", lambda robot: robot.geometry.limits.lift_rate_mps, stick_only=True),
    ),
    stick=_stick,
    twist=_twist,
    columns=(
        *PLANAR,
        Column("steer_rad", "inner front wheel, left positive", "rad", plant="steer"),
        Column("lift_m", "height above collapsed", "m", plant="lift_height"),
        Column("demanded_speed_mps", "the bridge's set-points of the wheels", "m/s", seen=_commanded),
    ),
    panels=(
        Panel(
            "Forward speed",
            "speed [m/s]",
            (
                Curve("demanded_speed_mps", "set-point", step=True),
                Curve("speed_mps", "actual (plant)"),
            ),
            limit=lambda robot: (robot.geometry.limits.speed_mps, "m/s"),
            shaded=True,
            height=3.0,
        ),
        Panel(
            "Steering, left is positive",
            "angle [deg]",
            (
                Curve("steer_rad", "angle of the inner wheel", scale=math.degrees(1.0)),
                Curve("yaw_rate_rad_s", "yaw rate", scale=math.degrees(1.0), right=True),
            ),
            right="yaw rate [deg/s]",
            least=5.0,
            height=2.0,
        ),
        Panel("Lift", "height [mm]", (Curve("lift_m", "height above collapsed", scale=1000.0),), least=20.0),
    ),
    remarks=_remarks,
    figures_by_file={"ratio_error_while_steering": ratio_error},
    cases=cases,
    well={"pitch": 0.0, "roll": 0.0},
)
