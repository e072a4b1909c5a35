"""Odometry counts how wheels roll; on a floor of 0.3 the robot does not roll as they do. Both are held apart.

The mission `interlocks` brakes at the ramp over and over, and turns: without rolling resistance the thesis's
floor leaves 37 mm between odometry and truth, whatever the odometry does.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt
import pytest

from emulators.bench.columns import SAMPLE_EVERY, Samples
from emulators.bench.summary import mean_acceleration, odometry_errors
from emulators.run import HAND_STREAM
from emulators.servo.axis import ServoAxis
from emulators.testing.inherited.scripted import mission_of, scripted
from firmware_bridge.canopen_drive.driver.scale import Scale
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.motion.ramp import MARGIN
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds, to_seconds
from fmu.rars.parameters import PARAMETERS

if TYPE_CHECKING:
    from collections.abc import Mapping

BOUND_M: Final = 0.01
"""Limit of the odometry's error where wheels roll, at the mission's end."""
GRIPS: Final = (("floor_friction", 1e4), ("rolling_resistance", 0.0))
P: Final = {row.name: row.start for row in PARAMETERS}
STEP_S: Final = to_seconds(SAMPLE_EVERY)


@dataclass(frozen=True)
class Drive:
    """A run's rows, and the rear wheels' quadcounts every 10 ms."""

    rows: Samples
    counts: npt.NDArray[np.float64]


@cache
def driven(plant: tuple[tuple[str, float], ...] = ()) -> Drive:
    """Drive `interlocks` on a floor."""
    rars = find("rars")
    parameters: Mapping[str, float] = dict(plant)
    robot = rars.model_copy(update={"plant": rars.plant.model_copy(update={"parameters": parameters})})
    script = mission_of(robot, "interlocks")
    counts = []
    with scripted(robot, script, stream=(0, HAND_STREAM), noise=script.noise) as rig:
        wheels = [*rig.devices.motors(ServoAxis).values()][:2]
        while rig.world.now < from_seconds(script.duration_s):
            rig.run(rig.world.now + SAMPLE_EVERY)
            counts.append([wheel.position for wheel in wheels])
        return Drive(rig.samples, np.array(counts, dtype=np.float64))


def rolled(drive: Drive) -> complex:
    """Return where the rear wheels have rolled, (4.13)-(4.15) with the middle of each step's heading."""
    rars = find("rars")
    ways = (
        Scale.of(rars.axes[0]).position(1) * rars.geometry.base.wheel_radius_m * np.diff(drive.counts, axis=0)
    )
    turns = (ways[:, 1] - ways[:, 0]) / rars.geometry.base.rear_track_m
    heading = drive.rows[0]["odometry_heading_rad"] + np.cumsum(turns) - turns / 2
    return complex(np.sum(ways.mean(axis=1) * np.exp(1j * heading)))


def slip(acceleration: float) -> float:
    """Return the rear wheels' slip by (3.83) at an acceleration in m/s2: 0.15 x the pull over 0.3 N."""
    mass = P["platform_mass"] + 2 * P["wheel_mass"]
    front = P["platform_mass"] * 9.81 * P["centre_offset"] / P["wheelbase"]
    pull = mass * acceleration + P["rolling_resistance"] * front
    load = mass * 9.81 - front - P["cg_height"] * mass * acceleration / P["wheelbase"]
    return P["peak_slip"] * pull / (P["floor_friction"] * load)


@pytest.mark.long(beside="test_odometry_counts_what_the_wheels_rolled")
def test_odometry_counts_what_the_wheels_roll() -> None:
    first, last = driven().rows[0], driven().rows[-1]
    believed = complex(
        last["odometry_x_m"] - first["odometry_x_m"], last["odometry_y_m"] - first["odometry_y_m"]
    )
    assert abs(believed - rolled(driven())) < BOUND_M


@pytest.mark.long(beside="test_odometry_counts_what_the_wheels_rolled")
def test_where_the_wheels_grip_odometry_is_right() -> None:
    assert odometry_errors(driven(GRIPS).rows)[-1] < BOUND_M


@pytest.mark.long(beside="test_the_thesis_own_floor_lets_odometry_drift")
def test_on_the_thesis_own_floor_it_errs_by_what_the_tyres_slip() -> None:
    """Along the way by the slip that the acceleration takes, across it by that of the turn's."""
    rows = driven().rows
    speed = rows.column("speed_mps")
    turning = np.abs(speed * rows.column("yaw_rate_rad_s"))
    changing = np.zeros_like(speed)
    changing[5:] = np.abs(mean_acceleration(speed))
    slips = [slip(float(a)) for a in changing] + P["peak_slip"] * turning / (P["floor_friction"] * 9.81)
    slid = float(np.sum(slips * np.abs(speed)) * STEP_S)
    error = odometry_errors(rows)[-1]
    assert BOUND_M < error < slid
    assert slid < 0.02 * float(np.sum(np.abs(speed)) * STEP_S)


def test_the_ramp_leaves_room_for_slip() -> None:
    """A steady slip s brakes the robot by the ramp over 1 - s: 0.138 at the limit, so 0.862 is allowed."""
    limit = find("rars").geometry.limits.acceleration_mps2
    assert slip(limit) == pytest.approx(0.138, abs=1e-3)
    assert pytest.approx((1 - slip(limit)) * 0.93, abs=5e-3) == MARGIN
    profile = Epos2Axis.of(find("rars").axes[0]).profile
    for ramp in (profile.acceleration_rpm_s, profile.deceleration_rpm_s, profile.quick_stop_rpm_s):
        rim = ramp * math.pi / 30 / 26 * P["wheel_radius"]
        assert rim / (1 - slip(limit)) < limit
