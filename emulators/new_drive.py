"""A drive of one axis in a new robot's file: what `new` knows of it, and the lines that its family writes."""

import math
from typing import Final, NamedTuple

from emulators.motors import Motor

RPM: Final = 60.0 / math.tau
PROFILE_SHARE: Final = 0.92
"""Share of the speed limit for the drive's own profile: the rest is for what its regulator overshoots."""
MAX_MARGIN: Final = 1.4
"""Ratio of the drive's own speed limit to the axis's."""
FOLLOWS_S: Final = 0.02
"""Following error in seconds of the speed limit: an encoder that stands still is noticed by it."""
BRIDGE_NODES: Final = (100, 101)
FRICTION_MARGIN: Final = 2.0
"""Ratio of the current that friction may take to the motor's without load."""


class AxisDrive(NamedTuple):
    """One drive of a new robot: its motor, what it turns, and its limits in the axis's unit."""

    number: int
    """A node, or a board's terminals."""
    by_position: bool
    motor: Motor
    encoder_lines: int
    gear: float
    """rad of the motor for 1 of the unit."""
    load: float
    """kg m2, or kg of an axis in m, behind the gear."""
    voltage_v: float
    speed: float
    acceleration: float

    @property
    def inertia_kg_m2(self) -> float:
        """All that the motor's shaft turns, the rotor's own included."""
        return self.motor.rotor_inertia_kg_m2 + self.load / self.gear**2


class AxisTable(NamedTuple):
    """A drive in a robot file: lines of the link's table, of the axis's, of its settings, and more tables."""

    link: str
    plausibility: str
    settings: str
    after: str = ""
    cycle_ms: int = 20


def on_can(driver: str, drive: AxisDrive, settings: str, after: str = "") -> AxisTable:
    """Return the lines of a CANopen drive, with the profile that its speeds and ramps are in."""
    rpm = drive.speed * drive.gear * RPM
    ramp = max(1, round(drive.acceleration * drive.gear * RPM))
    counts = 4 * drive.encoder_lines / math.tau
    error = max(100, round(FOLLOWS_S * drive.speed * drive.gear * counts))
    return AxisTable(
        f"""\
driver = "{driver}"
bit_rate = 1_000_000
bridge_node = {next(node for node in BRIDGE_NODES if node != drive.number)}
bridge_heartbeat_ms = 50
bridge_silent_ms = 200          # the drive stops by itself after this silence of the bridge
drive_heartbeat_ms = 100
silent_ms = 250                 # the bridge stops the axis after this silence of the drive
""",
        f"{{ friction = {FRICTION_MARGIN * drive.motor.no_load_current_a:.3g} }} # A",
        f"node = {drive.number}\n{settings}",
        f"""
[axes.settings.profile]
velocity_rpm = {max(1, math.floor(PROFILE_SHARE * rpm))}
acceleration_rpm_s = {ramp}
deceleration_rpm_s = {ramp}
quick_stop_rpm_s = {2 * ramp}
max_velocity_rpm = {math.ceil(MAX_MARGIN * rpm)}
max_following_error_qc = {error}
{after}""",
    )
