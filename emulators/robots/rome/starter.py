"""A robot file for an omni base of one's own: three wheels on a motor shield, from motor, gear and mass.

Board, plant and rules are those of ROME's base; gains are ROME's, scaled to this motor and encoder. What a
reader has to check is marked as assumed.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from emulators.motors import Motor
from emulators.specification import SpecificationError
from firmware_bridge.families.motor_shield.settings import CYCLES_MS, ENCODERS, FULL_PWM, ShieldProtocol
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
ENCODER_PINS: Final = ((2, 3), (18, 19), (10, 11))
"""Of the first, second and third encoder on a Mega: ROME's."""
SUPPLY_V: Final = (4.5, 13.5)
"""Motor supply that the shield takes: Adafruit, Motor Shield V2."""
CONTINUOUS_MA: Final = 1_200
PEAK_MA: Final = 3_200
"""Of a channel: TB6612FNG."""
USABLE_SPEED: Final = 0.85
"""Share of a motor's no-load speed: the rest is for load and a supply that is not full."""
RPM: Final = 60.0 / math.tau
FRAMES_PER_S: Final = 30
"""Of ros_arduino_bridge's loop."""
TICKS_A_FRAME: Final = 226.7
"""Of ROME's motors at full PWM, for which its gains on the board are."""
KP: Final = 50
KD: Final = 20
KO: Final = 50
GREATEST_GAIN: Final = 1_000
WHEEL_RAD_S: Final = 13.9
"""Of ROME's wheels at full PWM, for which the gains of the bridge's own loop are."""
SPEED_P: Final = 8.0
SPEED_I: Final = 24.0
START: Final = 1.5
"""Ratio of the PWM at which a motor is taken to start to that which its friction holds."""
SLOPE: Final = 2.5
"""Ratio of the PWM's slope to that of the acceleration."""
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

    @property
    def full_rad_s(self) -> float:
        """A wheel's speed at full PWM, without load."""
        return self.motor.no_load_speed(self.voltage_v) / self.gear

    @property
    def ticks_a_frame(self) -> float:
        """Counts in one frame of the loop on the board, at full PWM."""
        return 4 * self.encoder_lines * self.full_rad_s * self.gear / math.tau / FRAMES_PER_S


def board_gains(given: OmniSpecification) -> Mapping[str, int]:
    """Return the gains of the loop on the board, whole numbers; SpecificationError."""
    share = TICKS_A_FRAME / given.ticks_a_frame
    # The loop divides by ko: fine encoders take a greater one, coarse ones greater gains.
    gains = {"kp": KP, "kd": KD, "ki": 0, "ko": round(KO / share)}
    if share > 1.0:
        gains |= {"kp": round(KP * share), "kd": round(KD * share), "ko": KO}
    if max(gains.values()) > GREATEST_GAIN:
        raise SpecificationError(
            f"--encoder-lines {given.encoder_lines}: at full speed {given.ticks_a_frame:.4g} counts in a "
            f"frame of the board's loop; its gains take {TICKS_A_FRAME / 20:.0f} to {TICKS_A_FRAME * 20:.0f}"
        )
    return gains


def _must_be_possible(given: OmniSpecification) -> None:
    low, high = SUPPLY_V
    if not low <= given.voltage_v <= high:
        raise SpecificationError(
            f"--voltage {given.voltage_v:g}: the shield's motor supply is {low:g} to {high:g} V"
        )
    if given.motor.kind != "dc":
        raise SpecificationError(
            f"--motor: {given.motor.title} has three phases; a shield drives brushed ones"
        )
    usable = USABLE_SPEED * given.full_rad_s * given.wheel_radius_m
    if given.speed_mps > usable:
        raise SpecificationError(
            f"{given.speed_mps:g} m/s at a rim; {given.motor.title} behind {given.gear:g} gives {usable:.3g} "
            "m/s with a load: take a smaller --gear, or less --speed"
        )
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


def _encoders(protocol: ShieldProtocol) -> str:
    published = ENCODERS[protocol]
    if published >= len(WHEELS):
        return ""
    return f"encoders = {len(WHEELS)}      # it is published with {published}: flash one with all\n"


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
    name, motor = WHEELS[number], given.motor
    scale = WHEEL_RAD_S / given.full_rad_s
    friction_v = motor.friction / motor.torque_constant_nm_a * motor.resistance_ohm
    acceleration = given.acceleration_mps2 / given.wheel_radius_m
    return f"""
[[axes]]
name = "{name}"
title = "wheel at {120 * number} degrees"
role = "wheel_{name}"
link = "board"
command = "speed"
top_speed = {TOP_MARGIN * given.speed_mps / given.wheel_radius_m:.6g}
ratio = {given.gear!r}
direction = 1                   # -1 where forwards turns the base clockwise
unpowered = "holds"             # assumed: on a level floor the gear keeps it
plausibility = {{ speed = {0.065 * given.full_rad_s:.3g}, lag_ms = 300 }}

[axes.settings]
port = {number + 1}                        # M{number + 1}
device = "motor-shield-v2"
motor = "{motor.title}"
encoder_pins = [{ENCODER_PINS[number][0]}, {ENCODER_PINS[number][1]}]
counts_per_turn = {4 * given.encoder_lines}
full_speed_rpm = {given.full_rad_s * given.gear * RPM:.6g}
slope_pwm_s = {SLOPE * FULL_PWM * acceleration / given.full_rad_s:.4g}
acceleration = {acceleration:.6g}
continuous_current_ma = {min(CONTINUOUS_MA, round(1000.0 * motor.continuous_current_a))}
peak_current_ma = {PEAK_MA}
regulator = {{ p = {SPEED_P * scale:.3g}, i = {SPEED_I * scale:.3g}, \
start = {START * FULL_PWM * friction_v / given.voltage_v:.3g} }} # without a loop on the board
"""


def robot_file(given: OmniSpecification) -> str:
    """Return the robot file's text; SpecificationError."""
    _must_be_possible(given)
    gains = ", ".join(f"{key} = {value}" for key, value in board_gains(given).items())
    radius, distance = given.wheel_radius_m, given.wheel_distance_m
    ahead, turns = radius / math.sqrt(3.0), radius / (3.0 * distance)
    cycle = max(50, CYCLES_MS[given.protocol])
    return f"""\
# {given.name}: an omni base. `firmware-bridge robots FILE` checks this file, `bench FILE` drives it.
# Check each number before the real base moves; gains are ROME's, scaled to this motor and encoder (assumed).

name = "{given.name}"
kind = "rome"
title = "{given.name}: three omni wheels on a motor shield"
source = "its maker"

cycle_ms = {cycle}

[links.board]
driver = "motor-shield"
protocol = "{given.protocol.value}"
{_encoders(given.protocol)}\
silent_ms = {8 * cycle}                 # the bridge stops the base after this silence of the board
gains = {{ {gains} }} # of the loop on the board

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
