"""A robot file for an axis of one's own: its numbers, worked out from motor, gear and load.

The drive's table is its family's. What a reader has to check is marked as assumed.
"""

from dataclasses import dataclass
from typing import Final

from emulators.family import EmulatedFamily
from emulators.new_drive import MAX_MARGIN, AxisDrive
from emulators.specification import SpecificationError

USABLE_SPEED: Final = 0.85
"""Share of a motor's no-load speed: the rest is for load and a supply that is not full."""
TOP_MARGIN: Final = 1.1
STOPS: Final = 0.1
"""Share of the travel from its ends to the plant's stops."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisSpecification:
    """What a user knows of an axis; lengths in its unit, `rad` or `m`."""

    name: str
    unit: str
    drive: AxisDrive
    travel: tuple[float, float] | None


def _must_be_possible(given: AxisSpecification) -> None:
    drive = given.drive
    usable = USABLE_SPEED * drive.motor.no_load_speed(drive.voltage_v) / drive.gear
    if MAX_MARGIN * drive.speed > usable:
        raise SpecificationError(
            f"{drive.speed:g} {given.unit}/s with some reserve take {MAX_MARGIN * drive.speed:.3g}; "
            f"{drive.motor.title} behind {drive.gear:g} gives {usable:.3g} {given.unit}/s: take a smaller "
            "--gear, or less --speed"
        )


def robot_file(given: AxisSpecification, family: EmulatedFamily) -> str:
    """Return the robot file's text; SpecificationError."""
    unit, drive, motor = given.unit, given.drive, given.drive.motor
    if family.axis_table is None:
        raise SpecificationError("--family: it has no drive of one axis")
    table = family.axis_table(drive)
    _must_be_possible(given)
    zero = travel = ""
    plant = {
        "battery_emf": drive.voltage_v,
        "backlash": 0.0,
        "load_inertia": drive.load,
        "resistance_axis": motor.resistance_ohm,
        "inductance_axis": motor.inductance_h,
        "torque_constant_axis": motor.torque_constant_nm_a,
        "rotor_inertia_axis": motor.rotor_inertia_kg_m2,
        "coulomb_axis": motor.friction / 2.0,
        "viscous_axis": motor.friction / 2.0 / motor.no_load_speed(drive.voltage_v),
    }
    if given.travel is not None:
        low, high = given.travel
        beyond = STOPS * (high - low)
        plant |= {"stop_low": low - beyond, "stop_high": high + beyond}
        travel = f"travel = [{low!r}, {high!r}]\n"
        zero = '\n[axes.zero]\nhow = "confirm"                 # or home: see docs/robot-file.md\n'
    command = "position" if drive.by_position else "speed"
    parameters = "\n".join(f"{key} = {value:.6g}" for key, value in plant.items())
    return f"""\
# {given.name}: one axis. `firmware-bridge robots FILE` checks this file, `bench FILE` drives it.
# Check each number before the real axis moves; those of the load and of friction are assumed.

name = "{given.name}"
kind = "servo_axis"
title = "{given.name}: one axis"
source = "its maker"

cycle_ms = {table.cycle_ms}

[links.drives]
{table.link}
[geometry.limits]
speed = {drive.speed!r}                     # {unit}/s
acceleration = {drive.acceleration!r}              # {unit}/s2

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
{travel}top_speed = {TOP_MARGIN * drive.speed:.6g}
ratio = {drive.gear!r}                    # rad of the motor for 1 {unit}
direction = 1                   # -1 where the motor's forwards is the axis's backwards
unpowered = "free"              # or "holds": what becomes of it without power
plausibility = {table.plausibility}
{zero}
[axes.settings]
{table.settings}{table.after}"""
