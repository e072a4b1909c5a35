"""The numbers of a differential robot: the templates' values, worked out from the specification."""

import math
from dataclasses import dataclass
from typing import Final

from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.starter.tuning import velocity_gains
from emulators.motors import Motor
from emulators.servo.tuning import VELOCITY_P
from emulators.specification import SpecificationError
from firmware_bridge.canopen_drive.settings import BRUSHED, SINUSOIDAL
from firmware_bridge.families.epos2.settings import Epos2Device
from firmware_bridge.families.epos2.wire.hardware import too_fast

BRIDGE_NODE: Final = 100
TOP_MARGIN: Final = 1.02
"""Ratio of the guard's bound to the fastest wheel that the limits require."""
RPM: Final = 60.0 / math.tau
PROFILE_SHARE: Final = 0.82
"""Share of the limits' acceleration for the drives' own profile: a little above the bridge's ramp."""
QUICK_STOP_SHARE: Final = 0.78
OVERSPEED: Final = 1.15
"""Ratio of a motor's commanded speed to the fastest set-point above which its drive clips."""
USABLE_SPEED: Final = 0.85
"""Share of a motor's no-load speed: the rest is for load and a battery that is not full."""
LEAST_OF_THE_MOTOR: Final = 0.01
"""Least share of that usable speed at the robot's limit: below it the gear's ratio is inverted."""
ROLLS: Final = 0.010
"""Resistance over load, the castors': the plant's wheels roll at half of it."""
FRICTION_MARGIN: Final = 1.15
"""Ratio of the current that friction may hold to the computed current of motor and floor."""
GRAVITY: Final = 9.81
INPUT_V: Final = 5.0
"""Full scale of the drive's analog input."""


@dataclass(frozen=True, slots=True)
class Specification:
    """User's specification of a differential robot; SI."""

    kind: str
    name: str
    nodes: tuple[int, int]
    wheel_radius_m: float
    track_m: float
    motor: Motor
    axes: tuple[str, str] = ("left", "right")
    device: Epos2Device = Epos2Device.EPOS2_70_10
    gear: float = 43.0
    mass_kg: float = 25.0
    encoder_lines: int = 500
    voltage_v: float = 24.0
    speed_mps: float = 0.6
    acceleration_mps2: float = 0.5
    turn_rate_rad_s: float = 1.2


def worked_out(given: Specification) -> dict[str, str]:
    """Return each template's word with what stands for it; SpecificationError where no robot is like that."""
    motor = given.motor
    radius, track, gear = given.wheel_radius_m, given.track_m, given.gear
    fastest = (given.speed_mps + given.turn_rate_rad_s * track / 2.0) / radius
    _must_be_possible(given, fastest)
    turn_acceleration = 2.0 * given.turn_rate_rad_s
    sideways = 0.8 * given.speed_mps * given.turn_rate_rad_s
    rim = given.acceleration_mps2 / radius * gear * RPM
    wheel_mass = 0.03 * given.mass_kg
    wheel_inertia = wheel_mass * radius**2 / 2.0
    inertia = motor.rotor_inertia_kg_m2 + (given.mass_kg / 2.0 * radius**2 + wheel_inertia) / gear**2
    gains = velocity_gains(motor, inertia, given.voltage_v)
    count = 1000.0 * math.tau / (4 * given.encoder_lines)
    continuous_ma = min(round(1000.0 * motor.continuous_current_a), given.device.continuous_ma)
    rolling = ROLLS * GRAVITY * given.mass_kg / 2.0 * radius / gear / motor.torque_constant_nm_a
    numbers: dict[str, object] = {
        "name": given.name,
        "Name": given.name.replace("_", " ").capitalize(),
        "left": given.axes[0],
        "right": given.axes[1],
        "left_node": given.nodes[0],
        "right_node": given.nodes[1],
        "bridge_node": next(node for node in (BRIDGE_NODE, 101, 102) if node not in given.nodes),
        "wheel_radius": _number(radius),
        "track": _number(track),
        "speed": _number(given.speed_mps),
        "acceleration": _number(given.acceleration_mps2),
        "turn_rate": _number(given.turn_rate_rad_s),
        "turn_acceleration": _number(turn_acceleration),
        "sideways": _number(sideways),
        "voltage": _number(given.voltage_v),
        "low_voltage": _number(0.875 * given.voltage_v),
        "per_volt": _number(1.25 * given.voltage_v / INPUT_V),
        "mean": _number(radius / 2.0),
        "difference": _number(radius / track),
        "speed_bound": _number(1.005 * given.speed_mps),
        "turn_bound": _number(1.01 * given.turn_rate_rad_s),
        "top_speed": _number(TOP_MARGIN * fastest),
        "gear": _number(gear),
        "device": given.device.value,
        "product_code": f"0x{(PROFILES[given.device].hardware_version or 0) << 16:08X}",
        "motor": motor.title,
        "winding": _winding(motor),
        "encoder_lines": given.encoder_lines,
        "continuous_ma": continuous_ma,
        "peak_ma": min(2 * continuous_ma, given.device.peak_ma),
        "friction": f"{FRICTION_MARGIN * (motor.no_load_current_a + rolling):.2g}",
        "velocity_rpm": math.ceil(TOP_MARGIN * fastest * gear * RPM),
        "max_velocity_rpm": math.ceil(OVERSPEED * fastest * gear * RPM),
        "profile_rpm_s": round(PROFILE_SHARE * rim),
        "quick_stop_rpm_s": round(QUICK_STOP_SHARE * rim),
        "mass": _number(given.mass_kg),
        "body_mass": _number(given.mass_kg - 2.0 * wheel_mass),
        "wheel_mass": _number(wheel_mass),
        "wheel_inertia": _number(wheel_inertia),
        "wheel_yaw_inertia": _number(wheel_inertia / 2.0),
        "yaw_inertia": _number(given.mass_kg * track**2 / 4.0),
        "empty_mass": _number(given.mass_kg / 2.0),
        "empty_inertia": _number(given.mass_kg * track**2 / 8.0),
        "centre_offset": _number(radius),
        "centre_height": _number(track / 2.0),
        "castor_ahead": _number(0.9 * track),
        "castor_track": _number(0.7 * track),
        "castor_trail": _number(0.375 * radius),
        "resistance": _number(motor.resistance_ohm),
        "inductance": _number(motor.inductance_h),
        "torque_constant": _number(motor.torque_constant_nm_a),
        "rotor_inertia": _number(motor.rotor_inertia_kg_m2),
        "no_load_current": _number(motor.no_load_current_a),
        "inductance_mh": f"{1e3 * motor.inductance_h:.3g}",
        "torque_constant_mnm": f"{1e3 * motor.torque_constant_nm_a:.3g}",
        "inertia_gcm2": f"{1e7 * inertia:.4g}",
        "count_current": f"{gains.velocity_p / VELOCITY_P * count:.2f}",
        **gains.model_dump(),
        # What the missions ask for.
        "cruise": _number(0.5 * given.speed_mps),
        "gentle": _number(0.2 * given.acceleration_mps2),
        "too_fast": _number(1.6 * given.speed_mps),
        "turn_deg_s": _number(0.5 * math.degrees(given.turn_rate_rad_s)),
        "too_quick_deg_s": _number(2.0 * math.degrees(given.turn_rate_rad_s)),
        "full_turn_deg_s": _number(math.degrees(given.turn_rate_rad_s)),
    }
    return {word: str(number) for word, number in numbers.items()}


def _must_be_possible(given: Specification, fastest: float) -> None:
    """SpecificationError where wheels, motor and gear make no robot; `fastest` is a wheel's, in rad/s."""
    radius, track, gear = given.wheel_radius_m, given.track_m, given.gear
    if radius >= track:
        raise SpecificationError(
            f"--wheel-radius {radius:g} is not below --track {track:g}: both are in meters"
        )
    if given.voltage_v > given.device.supply_v:
        raise SpecificationError(
            f"--voltage {given.voltage_v:g}: an EPOS2 {given.device} takes {given.device.supply_v} V at most:"
            " take another --device"
        )
    if why := too_fast(given.encoder_lines, OVERSPEED * fastest * gear * RPM):
        raise SpecificationError(f"--encoder-lines: {why}")
    usable = USABLE_SPEED * given.motor.no_load_speed(given.voltage_v) / gear
    if fastest > usable:
        raise SpecificationError(
            f"{given.speed_mps:g} m/s and {given.turn_rate_rad_s:g} rad/s take {fastest:.3g} rad/s of a "
            f"wheel, {given.motor.title} behind {gear:g}:1 gives {usable:.3g}: take a smaller --gear, or "
            "less --speed"
        )
    # A ratio that was given as its reciprocal would pass every other check.
    if fastest < LEAST_OF_THE_MOTOR * usable:
        raise SpecificationError(
            f"--gear {gear:g}: at the speed limit the motor turns with {fastest * gear * RPM:.2g} rpm, it "
            f"can turn with {usable * gear * RPM:.0f}; a ratio is turns of the motor for one of the wheel"
        )


def _winding(motor: Motor) -> str:
    """Return the robot file's lines for the kind of the motor's winding."""
    if motor.kind == "dc":
        return f"motor_type = {BRUSHED}                  # brushed DC"
    lines = [f"motor_type = {SINUSOIDAL}                 # EC, sinusoidal commutation"]
    # Without a source the drive keeps what EPOS Studio has set.
    if motor.pole_pairs is not None:
        lines.append(f"pole_pairs = {motor.pole_pairs}")
    return "\n".join(lines)


def _number(value: float) -> str:
    """Return a number as a person writes it, always with a point or an exponent."""
    short = f"{value:.4g}"
    return short if "." in short or "e" in short else f"{short}.0"
