"""An EPOS2 of one axis in a robot file: its type, its motor and its gains."""

from emulators.epos2.objects.catalogue import PROFILES
from emulators.new_drive import AxisDrive, AxisTable, on_can
from emulators.servo.tuning import tuned
from firmware_bridge.canopen_drive.settings import BRUSHED, SINUSOIDAL
from firmware_bridge.families.epos2.settings import Epos2Device, Epos2Driver


def axis_table(drive: AxisDrive) -> AxisTable:
    """Return a drive's lines: an EPOS2 70/10, whose regulators are tuned for motor and load."""
    motor, device = drive.motor, Epos2Device.EPOS2_70_10
    milliamperes = min(round(1000.0 * motor.continuous_current_a), device.continuous_ma)
    kind = BRUSHED if motor.kind == "dc" else SINUSOIDAL
    pairs = "" if motor.kind == "dc" or motor.pole_pairs is None else f"pole_pairs = {motor.pole_pairs}\n"
    gains = tuned(
        drive.inertia_kg_m2,
        torque_constant=motor.torque_constant_nm_a,
        resistance=motor.resistance_ohm,
        inductance=motor.inductance_h,
    )
    return on_can(
        Epos2Driver.CAN.value,
        drive,
        f"""\
device = "{device.value}"
product_code = 0x{(PROFILES[device].hardware_version or 0) << 16:08X}
motor = "{motor.title}"
encoder_lines = {drive.encoder_lines}
motor_type = {kind}
{pairs}continuous_current_ma = {milliamperes}
peak_current_ma = {min(2 * milliamperes, device.peak_ma)}
thermal_time_constant_100ms = 40 # assumed
""",
        f"""
[axes.settings.gains]           # a start that runs, by motor and load; refine it on the axis
current_p = {gains.current_p}
current_i = {gains.current_i}
velocity_p = {gains.velocity_p}
velocity_i = {gains.velocity_i}
acceleration_feedforward = {gains.velocity_acceleration_forward}
position_p = {gains.position_p}
position_i = {gains.position_i}
position_d = {gains.position_d}
position_acceleration_feedforward = {gains.position_acceleration_forward}
""",
    )
