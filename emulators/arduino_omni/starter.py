"""A motor on a shield in a new robot's file: gains of ROME's, scaled to another motor, gear and encoder.

The numbers of ROME's base are those of its robot file, which were tuned on the plant.
"""

import math
from collections.abc import Mapping
from typing import Final

from emulators.arduino_omni.board import FIRMWARES
from emulators.new_drive import RPM, AxisDrive, AxisTable
from emulators.specification import SpecificationError
from firmware_bridge.families.motor_shield.settings import CYCLES_MS, ENCODERS, FULL_PWM, ShieldProtocol

ENCODER_PINS: Final = ((2, 3), (18, 19), (10, 11), (12, 13))
"""Of the first encoder and the further ones on a Mega: ROME's, and the next two."""
SUPPLY_V: Final = (4.5, 13.5)
"""Motor supply that the shield takes: Adafruit, Motor Shield V2."""
CONTINUOUS_MA: Final = 1_200
PEAK_MA: Final = 3_200
"""Of a channel: TB6612FNG."""
USABLE_SPEED: Final = 0.85
"""Share of a motor's no-load speed: the rest is for load and a supply that is not full."""
FRAMES_PER_S: Final = 30
"""Of ros_arduino_bridge's loop."""
TICKS_A_FRAME: Final = 226.7
"""Of ROME's motors at full PWM, for which its gains on the board are."""
FINEST: Final = 20
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
SILENT_CYCLES: Final = 8
"""After which the board is lost: ROME's."""
PLAUSIBLE: Final = 0.065
"""Share of full speed by which a reported one may differ: ROME's."""


def full_speed(drive: AxisDrive) -> float:
    """Return the axis's speed at full PWM, without load, in its unit a second."""
    return drive.motor.no_load_speed(drive.voltage_v) / drive.gear


def board_gains(drive: AxisDrive) -> Mapping[str, int]:
    """Return the gains of the loop on the board, whole numbers; SpecificationError."""
    ticks = 4 * drive.encoder_lines * full_speed(drive) * drive.gear / math.tau / FRAMES_PER_S
    share = TICKS_A_FRAME / ticks
    # The loop divides by ko: fine encoders take a greater one, coarse ones greater gains.
    gains = {"kp": KP, "kd": KD, "ki": 0, "ko": round(KO / share)}
    if share > 1.0:
        gains |= {"kp": round(KP * share), "kd": round(KD * share), "ko": KO}
    if max(gains.values()) > GREATEST_GAIN:
        raise SpecificationError(
            f"--encoder-lines {drive.encoder_lines}: at full speed {ticks:.4g} counts in a frame of the "
            f"board's loop; its gains take {TICKS_A_FRAME / FINEST:.0f} to {TICKS_A_FRAME * FINEST:.0f}"
        )
    return gains


def check(drive: AxisDrive) -> None:
    """Refuse what no motor on a shield can be; SpecificationError."""
    low, high = SUPPLY_V
    if not low <= drive.voltage_v <= high:
        raise SpecificationError(
            f"--voltage {drive.voltage_v:g}: the shield's motor supply is {low:g} to {high:g} V"
        )
    if drive.motor.kind != "dc":
        raise SpecificationError(
            f"--motor: {drive.motor.title} has three phases; a shield drives brushed ones"
        )
    if drive.by_position:
        raise SpecificationError("--command position: a motor on a shield goes to none; give --command speed")
    usable = USABLE_SPEED * full_speed(drive)
    if drive.speed > usable:
        raise SpecificationError(
            f"--speed: the axis has to go at {drive.speed:.3g}; {drive.motor.title} behind {drive.gear:g} "
            f"gives {usable:.3g} with a load: take a smaller --gear, or less --speed"
        )


def counting(motors: int) -> list[str]:
    """Return the firmwares that can count so many encoders."""
    return [name for name, firmware in FIRMWARES.items() if motors in firmware.encoders]


def link_lines(drive: AxisDrive, protocol: ShieldProtocol, motors: int) -> str:
    """Return the lines of the link's table, of a board with so many motors alike; SpecificationError."""
    gains = ", ".join(f"{key} = {value}" for key, value in board_gains(drive).items())
    published = ENCODERS[protocol]
    encoders = f"encoders = {motors}      # it is published with {published}: flash one with all\n"
    return f"""\
driver = "motor-shield"
protocol = "{protocol.value}"
{encoders if published < motors else ""}\
silent_ms = {SILENT_CYCLES * cycle_ms(protocol)}                 # the bridge stops after it
gains = {{ {gains} }} # of the loop on the board
"""


def cycle_ms(protocol: ShieldProtocol) -> int:
    """Return the shortest cycle of a robot on such a board."""
    return CYCLES_MS[protocol]


def axis_lines(drive: AxisDrive) -> str:
    """Return the lines of a motor's settings."""
    motor, full = drive.motor, full_speed(drive)
    scale, friction_v = WHEEL_RAD_S / full, motor.friction / motor.torque_constant_nm_a * motor.resistance_ohm
    pins = ENCODER_PINS[drive.number - 1]
    return f"""\
port = {drive.number}                        # M{drive.number}
device = "motor-shield-v2"
motor = "{motor.title}"
encoder_pins = [{pins[0]}, {pins[1]}]
counts_per_turn = {4 * drive.encoder_lines}
full_speed_rpm = {full * drive.gear * RPM:.6g}
slope_pwm_s = {SLOPE * FULL_PWM * drive.acceleration / full:.4g}
acceleration = {drive.acceleration:.6g}
continuous_current_ma = {min(CONTINUOUS_MA, round(1000.0 * motor.continuous_current_a))}
peak_current_ma = {PEAK_MA}
regulator = {{ p = {SPEED_P * scale:.3g}, i = {SPEED_I * scale:.3g}, \
start = {START * FULL_PWM * friction_v / drive.voltage_v:.3g} }} # without a loop on the board
"""


def plausibility(drive: AxisDrive) -> str:
    """Return the axis's limits of what is plausible: a shield measures no current."""
    return f"{{ speed = {PLAUSIBLE * full_speed(drive):.3g}, lag_ms = 300 }}"


def axis_table(drive: AxisDrive) -> AxisTable:
    """Return one motor's lines, on a board that stops it by itself; SpecificationError."""
    check(drive)
    protocol = ShieldProtocol.ROS_ARDUINO_BRIDGE
    return AxisTable(
        link_lines(drive, protocol, 1),
        plausibility(drive),
        axis_lines(drive),
        cycle_ms=cycle_ms(protocol),
    )
