"""A robot file for an axis of one's own: its numbers, worked out from motor, gear and load.

The drive's table is its family's. What a reader has to check is marked as assumed.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from emulators.family import AxisDrive, EmulatedFamily
from emulators.motors import Motor
from emulators.specification import SpecificationError

RPM: Final = 60.0 / math.tau
USABLE_SPEED: Final = 0.85
"""Share of a motor's no-load speed: the rest is for load and a supply that is not full."""
PROFILE_SHARE: Final = 0.92
"""Share of the speed limit for the drive's own profile: the rest is for what its regulator overshoots."""
TOP_MARGIN: Final = 1.1
MAX_MARGIN: Final = 1.4
"""Ratio of the drive's own speed limit to the axis's."""
FOLLOWS_S: Final = 0.02
"""Following error in seconds of the speed limit: an encoder that stands still is noticed by it."""
BRIDGE_NODES: Final = (100, 101)
STOPS: Final = 0.1
"""Share of the travel from its ends to the plant's stops."""
FRICTION_MARGIN: Final = 2.0
"""Ratio of the current that friction may take to the motor's without load."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisSpecification:
    """What a user knows of an axis; lengths in its unit, `rad` or `m`."""

    name: str
    unit: str
    by_position: bool
    node: int
    motor: Motor
    gear: float
    """rad of the motor for 1 of the unit."""
    encoder_lines: int
    load: float
    """kg m2, or kg of an axis in m, behind the gear."""
    voltage_v: float
    speed: float
    acceleration: float
    travel: tuple[float, float] | None

    @property
    def inertia(self) -> float:
        """All that the motor's shaft turns, kg m2."""
        return self.motor.rotor_inertia_kg_m2 + self.load / self.gear**2


def numbers(given: AxisSpecification) -> Mapping[str, int]:
    """Return the drive's profile in rpm, rpm/s and counts; SpecificationError for too slow a motor."""
    usable = USABLE_SPEED * given.motor.no_load_speed(given.voltage_v) / given.gear
    if MAX_MARGIN * given.speed > usable:
        raise SpecificationError(
            f"{given.speed:g} {given.unit}/s with some reserve take {MAX_MARGIN * given.speed:.3g}; "
            f"{given.motor.title} behind {given.gear:g} gives {usable:.3g} {given.unit}/s: take a smaller "
            "--gear, or less --speed"
        )
    rpm = given.speed * given.gear * RPM
    ramp = round(given.acceleration * given.gear * RPM)
    counts = 4 * given.encoder_lines / math.tau
    return {
        "velocity_rpm": max(1, math.floor(PROFILE_SHARE * rpm)),
        "acceleration_rpm_s": max(1, ramp),
        "deceleration_rpm_s": max(1, ramp),
        "quick_stop_rpm_s": max(1, 2 * ramp),
        "max_velocity_rpm": math.ceil(MAX_MARGIN * rpm),
        "max_following_error_qc": max(100, round(FOLLOWS_S * given.speed * given.gear * counts)),
    }


def robot_file(given: AxisSpecification, family: EmulatedFamily) -> str:
    """Return the robot file's text; SpecificationError."""
    unit, motor = given.unit, given.motor
    if family.axis_table is None:
        raise SpecificationError("--family: it has no drive of one axis")
    drive = family.axis_table(AxisDrive(given.node, motor, given.encoder_lines, given.inertia))
    profile = "\n".join(f"{key} = {value}" for key, value in numbers(given).items())
    zero = travel = ""
    plant = {
        "battery_emf": given.voltage_v,
        "backlash": 0.0,
        "load_inertia": given.load,
        "resistance_axis": motor.resistance_ohm,
        "inductance_axis": motor.inductance_h,
        "torque_constant_axis": motor.torque_constant_nm_a,
        "rotor_inertia_axis": motor.rotor_inertia_kg_m2,
        "coulomb_axis": motor.friction / 2.0,
        "viscous_axis": motor.friction / 2.0 / motor.no_load_speed(given.voltage_v),
    }
    if given.travel is not None:
        low, high = given.travel
        beyond = STOPS * (high - low)
        plant |= {"stop_low": low - beyond, "stop_high": high + beyond}
        travel = f"travel = [{low!r}, {high!r}]\n"
        zero = '\n[axes.zero]\nhow = "confirm"                 # or home: see docs/robot-file.md\n'
    command = "position" if given.by_position else "speed"
    parameters = "\n".join(f"{key} = {value:.6g}" for key, value in plant.items())
    return f"""\
# {given.name}: one axis. `firmware-bridge robots FILE` checks this file, `bench FILE` drives it.
# Check each number before the real axis moves; those of the load and of friction are assumed.

name = "{given.name}"
kind = "servo_axis"
title = "{given.name}: one axis"
source = "its maker"

cycle_ms = 20

[links.drives]
driver = "{drive.driver}"
bit_rate = 1_000_000
bridge_node = {next(node for node in BRIDGE_NODES if node != given.node)}
bridge_heartbeat_ms = 50
bridge_silent_ms = 200          # the drive stops by itself after this silence of the bridge
drive_heartbeat_ms = 100
silent_ms = 250                 # the bridge stops the axis after this silence of the drive

[geometry.limits]
speed = {given.speed!r}                     # {unit}/s
acceleration = {given.acceleration!r}              # {unit}/s2

[operator]
silent_ms = 500
max_age_ms = 500                # an older motion command is not executed
system_id = 1
component_id = 1

[plant]
fmu = "single_axis"

[plant.parameters]              # the simulated axis; friction of the load: see `firmware-bridge fmu`
{parameters}

[[axes]]
name = "axis"
title = "the axis"
link = "drives"
command = "{command}"
unit = "{unit}"
{travel}top_speed = {TOP_MARGIN * given.speed:.6g}
ratio = {given.gear!r}                    # rad of the motor for 1 {unit}
direction = 1                   # -1 where the motor's forwards is the axis's backwards
unpowered = "free"              # or "holds": what becomes of it without power
plausibility = {{ friction = {FRICTION_MARGIN * motor.no_load_current_a:.3g} }} # A
{zero}
[axes.settings]
node = {given.node}
{drive.settings}
[axes.settings.profile]
{profile}
{drive.after}"""
