"""The reference trajectory: inputs over time, and what the plant answered, in single_axis.csv.

`python -m validation.references.single_axis` writes it again, where the equations are meant to change.
"""

from pathlib import Path
from typing import Final

from fmu.build import ensure
from fmu.parts import table

FILE: Final = Path(__file__).with_name("single_axis.csv")
INPUTS: Final = ("voltage_axis", "load_torque")
OUTPUTS: Final = (
    "current_axis",
    "angle_axis",
    "speed_axis",
    "load_angle",
    "load_speed",
    "battery_voltage",
    "negative_limit_axis",
    "positive_limit_axis",
    "home_axis",
)

COURSE: Final = (
    # until s, voltage, load torque
    (0.2, 0.0, 0.0),
    (1.2, 12.0, 0.0),
    (2.0, 12.0, -2.0),
    (3.0, -6.0, 0.0),
    (4.0, 0.0, 0.0),
    (5.0, 0.0, 3.0),
)
"""Starts through the backlash, is loaded, reverses, coasts, is turned from outside."""


def rows(path: Path) -> list[list[float]]:
    """Return time and all outputs every 0.1 s of the plant in this FMU."""
    return table.rows(path, INPUTS, OUTPUTS, COURSE)


if __name__ == "__main__":
    table.write(FILE, OUTPUTS, rows(ensure("single_axis", 3)))
