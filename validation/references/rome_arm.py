"""The reference trajectory: inputs over time, and what the plant answered, in rome_arm.csv.

`python -m validation.references.rome_arm` writes it again, where the equations are meant to change.
"""

from pathlib import Path
from typing import Final

from fmu.ar2.parameters import AXES
from fmu.build import ensure
from fmu.parts import table
from fmu.rome_base.parameters import AXES as WHEELS

FILE: Final = Path(__file__).with_name("rome_arm.csv")
INPUTS: Final = (
    *(f"voltage_{wheel}" for wheel in WHEELS),
    *(f"field_{axis}" for axis in AXES),
    "current_on",
)
OUTPUTS: Final = (
    *(f"{quantity}_{wheel}" for quantity in ("current", "angle", "speed", "load") for wheel in WHEELS),
    *("x", "y", "heading", "speed", "speed_sideways", "yaw_rate", "battery_voltage"),
    *(f"{quantity}_{axis}" for quantity in ("angle", "speed", "lag") for axis in AXES),
    *("tool_x", "tool_y", "tool_z", "tool_speed"),
)

COURSE: Final = (
    # until s, wheels one, two, three in V, fields of six motors in rad, current
    (0.1, *(0.0, 0.0, 0.0), *(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 1.0),
    (0.4, *(0.0, -5.0, 5.0), *(0.02, 0.03, 0.02, -0.02, 0.02, 0.02), 1.0),
    (0.7, *(4.0, 4.0, 4.0), *(-0.02, 0.0, 0.03, 0.01, 0.0, -0.02), 1.0),
    (1.0, *(0.0, 0.0, 0.0), *(-0.02, 0.0, 0.03, 0.01, 0.0, -0.02), 0.0),
)
"""Ahead and round with some steps of every joint, and a fall without current."""


def rows(path: Path) -> list[list[float]]:
    """Return time and all outputs every 0.1 s of the plant in this FMU."""
    return table.rows(path, INPUTS, OUTPUTS, COURSE)


if __name__ == "__main__":
    table.write(FILE, OUTPUTS, rows(ensure("rome_arm", 3)))
