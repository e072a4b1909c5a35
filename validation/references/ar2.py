"""The reference trajectory: inputs over time, and what the plant answered, in ar2.csv.

`python -m validation.references.ar2` writes it again, where the equations are meant to change.
"""

from pathlib import Path
from typing import Final

from fmu.ar2.parameters import AXES
from fmu.build import ensure
from fmu.parts import table

FILE: Final = Path(__file__).with_name("ar2.csv")
INPUTS: Final = (*(f"field_{axis}" for axis in AXES), "current_on")
OUTPUTS: Final = (
    *(f"{quantity}_{axis}" for quantity in ("angle", "speed", "lag") for axis in AXES),
    *("tool_x", "tool_y", "tool_z", "tool_speed"),
)

COURSE: Final = (
    # until s, fields of six motors in rad, current
    (0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0),
    (0.5, 0.02, 0.03, 0.02, -0.02, 0.02, 0.02, 1.0),
    (0.8, -0.02, 0.0, 0.03, 0.01, 0.0, -0.02, 1.0),
    (1.1, -0.02, 0.0, 0.03, 0.01, 0.0, -0.02, 0.0),
)
"""Inputs with some steps of every motor, and a fall without current."""


def rows(path: Path) -> list[list[float]]:
    """Return time and all outputs every 0.1 s of the plant in this FMU."""
    return table.rows(path, INPUTS, OUTPUTS, COURSE)


if __name__ == "__main__":
    table.write(FILE, OUTPUTS, rows(ensure("ar2", 3)))
