"""The reference trajectory: inputs over time, and what the plant answered, in rome_base.csv.

`python -m validation.references.rome_base` writes it again, where the equations are meant to change.
"""

from pathlib import Path
from typing import Final

from fmu.build import ensure
from fmu.parts import table
from fmu.rome_base.parameters import AXES

FILE: Final = Path(__file__).with_name("rome_base.csv")
INPUTS: Final = tuple(f"voltage_{axis}" for axis in AXES)
OUTPUTS: Final = (
    *(f"{quantity}_{axis}" for quantity in ("current", "angle", "speed") for axis in AXES),
    *("x", "y", "heading", "speed", "speed_sideways", "yaw_rate", "battery_voltage"),
)

COURSE: Final = (
    # until s, wheels one, two, three
    (0.2, 0.0, 0.0, 0.0),
    (1.5, 0.0, -6.0, 6.0),
    (3.0, 4.0, 4.0, 4.0),
    (4.5, 8.0, -4.0, -4.0),
    (6.0, 0.0, 0.0, 0.0),
)
"""Ahead, round on the spot, sideways, coasts to rest."""


def rows(path: Path) -> list[list[float]]:
    """Return time and all outputs every 0.1 s of the plant in this FMU."""
    return table.rows(path, INPUTS, OUTPUTS, COURSE)


if __name__ == "__main__":
    table.write(FILE, OUTPUTS, rows(ensure("rome_base", 3)))
