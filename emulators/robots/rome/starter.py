"""A robot file for an omni base of one's own: three wheels on a motor shield, from motor, gear and mass.

Board, plant and rules are those of ROME's base; gains are ROME's, scaled to this motor and encoder. What a
reader has to check is marked as assumed.
"""

import math
from dataclasses import dataclass
from typing import Final

from emulators.arduino_omni import starter as shield
from emulators.motors import Motor
from emulators.new_drive import AxisDrive
from emulators.specification import SpecificationError
from firmware_bridge.families.motor_shield.settings import ShieldProtocol
from firmware_bridge.robots.rome.geometry import FASTEST, SPEED_SHARE

KIT: Final = Motor(
    title="12 V gear motor of 17 W",
    resistance_ohm=1.9,
    inductance_h=65e-6,
    torque_constant_nm_a=13.4e-3,
    rotor_inertia_kg_m2=5.8e-7,
    no_load_current_a=0.075,
    continuous_current_a=1.2,
    source="assumed: ROME's kit",
)
WHEELS: Final = ("one", "two", "three")
TOP_MARGIN: Final = 1.02
BOUND_MARGIN: Final = 1.14
"""Ratio of the guard's bounds to the limits: ROME's, for the swing of the loop on the board."""
TURN_BOUND_MARGIN: Final = 1.27
TURNS_WITHIN_S: Final = 0.375
"""From standstill to the greatest turn rate: ROME's."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OmniSpecification:
    """What a user knows of an omni base; SI."""

    name: str
    protocol: ShieldProtocol
    wheel_radius_m: float
    wheel_distance_m: float
    """From a wheel to the middle."""
    motor: Motor
    gear: float
    encoder_lines: int
    mass_kg: float
    voltage_v: float
    speed_mps: float
    acceleration_mps2: float
    turn_rate_rad_s: float

    def drive(self, number: int) -> AxisDrive:
        """Return a wheel, from 1."""
        return AxisDrive(
            number=number,
            by_position=False,
            motor=self.motor,
            encoder_lines=self.encoder_lines,
            gear=self.gear,
            load=self.mass_kg / len(WHEELS) * self.wheel_radius_m**2,
            voltage_v=self.voltage_v,
            speed=self.speed_mps / self.wheel_radius_m,
            acceleration=self.acceleration_mps2 / self.wheel_radius_m,
        )


def _must_be_possible(given: OmniSpecification) -> None:
    shield.check(given.drive(1))
    turning = given.turn_rate_rad_s * given.wheel_distance_m
    if turning > given.speed_mps:
        raise SpecificationError(
            f"--turn-rate {given.turn_rate_rad_s:g}: on the spot {turning:.3g} m/s at a rim, --speed allows "
            f"{given.speed_mps:g}"
        )


def _paths(given: OmniSpecification) -> str:
    # Meters to the unit, so that each path of ROME keeps the speed limit.
    set_point = SPEED_SHARE * given.speed_mps
    scales = {
        name: math.floor(100.0 * min(1.0, set_point / speed)) / 100.0 for name, speed in FASTEST.items()
    }
    return "\n".join(f"{name} = {max(scale, 0.01):g}" for name, scale in scales.items())


def _plant(given: OmniSpecification) -> str:
    motor = given.motor
    values = {
        "mass": given.mass_kg,
        "yaw_inertia": given.mass_kg * given.wheel_distance_m**2 / 2.0,
        "battery_emf": given.voltage_v,
        "resistance_wheel": motor.resistance_ohm,
        "inductance_wheel": motor.inductance_h,
        "torque_constant_wheel": motor.torque_constant_nm_a,
        "rotor_inertia_wheel": motor.rotor_inertia_kg_m2,
        "coulomb_wheel": motor.friction / 2.0,
        "viscous_wheel": motor.friction / 2.0 / motor.no_load_speed(given.voltage_v),
    }
    return "\n".join(f"{key} = {value:.6g}" for key, value in values.items())


def _wheel(given: OmniSpecification, number: int) -> str:
    name, drive = WHEELS[number], given.drive(number + 1)
    return f"""
[[axes]]
name = "{name}"
title = "wheel at {120 * number} degrees"
role = "wheel_{name}"
link = "board"
command = "speed"
top_speed = {TOP_MARGIN * drive.speed:.6g}
ratio = {given.gear!r}
direction = 1                   # -1 where forwards turns the base clockwise
unpowered = "holds"             # assumed: on a level floor the gear keeps it
plausibility = {shield.plausibility(drive)}

[axes.settings]
{shield.axis_lines(drive)}"""


def robot_file(given: OmniSpecification) -> str:
    """Return the robot file's text; SpecificationError."""
    _must_be_possible(given)
    radius, distance = given.wheel_radius_m, given.wheel_distance_m
    ahead, turns = radius / math.sqrt(3.0), radius / (3.0 * distance)
    return f"""\
# {given.name}: an omni base. `firmware-bridge robots FILE` checks this file, `bench FILE` drives it.
# Check each number before the real base moves; gains are ROME's, scaled to this motor and encoder (assumed).

name = "{given.name}"
kind = "rome"
title = "{given.name}: three omni wheels on a motor shield"
source = "its maker"

cycle_ms = {shield.cycle_ms(given.protocol)}

[links.board]
{shield.link_lines(given.drive(1), given.protocol, len(WHEELS))}
[geometry.base]
wheel_radius_m = {radius!r}
wheel_distance_m = {distance!r}         # from a wheel to the middle

[geometry.limits]
speed_mps = {given.speed_mps!r}
acceleration_mps2 = {given.acceleration_mps2!r}
turn_rate_rad_s = {given.turn_rate_rad_s!r}
turn_acceleration_rad_s2 = {given.turn_rate_rad_s / TURNS_WITHIN_S:.4g}
rim_mps = {given.speed_mps!r}

[geometry.control]              # of path followers; assumed
kp_per_s = 2.0
ki_per_s2 = 0.5

[geometry.paths]                # meters for each unit of ROME's paths
{_paths(given)}

[operator]
silent_ms = 500                 # the robot stops after this silence of the operator
system_id = 1
component_id = 1

[[guard.sums]]
name = "speed ahead"
of = {{ two = {-ahead:.6g}, three = {ahead:.6g} }}
bound = {BOUND_MARGIN * given.speed_mps:.4g}

[[guard.sums]]
name = "speed at 60 degrees"
of = {{ one = {ahead:.6g}, two = {-ahead:.6g} }}
bound = {BOUND_MARGIN * given.speed_mps:.4g}

[[guard.sums]]
name = "speed at 120 degrees"
of = {{ one = {ahead:.6g}, three = {-ahead:.6g} }}
bound = {BOUND_MARGIN * given.speed_mps:.4g}

[[guard.sums]]
name = "turn rate"
of = {{ one = {turns:.6g}, two = {turns:.6g}, three = {turns:.6g} }}
bound = {TURN_BOUND_MARGIN * given.turn_rate_rad_s:.4g}

[plant]                         # the simulated base, for `bench` and `emulate`
fmu = "rome_base"

[plant.parameters]
{_plant(given)}
{"".join(_wheel(given, number) for number in range(len(WHEELS)))}"""
