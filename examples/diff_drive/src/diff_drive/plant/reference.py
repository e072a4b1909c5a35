"""The reference trajectory: voltages over time, and what the plant answered, in reference.csv.

`python -m diff_drive.plant.reference` writes the file again; only when the equations are meant to change.
"""

from pathlib import Path
from typing import Final

from fmu.build import ensure
from fmu.parts import table

from diff_drive.plant.parameters import LEFT, PLANT, RIGHT

FILE: Final = Path(__file__).with_name("reference.csv")
INPUTS: Final = tuple(f"voltage_{axis}" for axis in (LEFT, RIGHT))
OUTPUTS: Final = (
    *(f"{quantity}_{axis}" for axis in (LEFT, RIGHT) for quantity in ("current", "angle", "speed")),
    *("x", "y", "heading", "speed", "yaw_rate", "battery_voltage"),
)

COURSE: Final = (
    # until s, left, right
    (0.2, 0.0, 0.0),
    (1.5, 12.0, 12.0),
    (3.0, 9.0, 15.0),
    (4.0, -8.0, 8.0),
    (5.5, -10.0, -9.0),
    (7.0, 0.0, 0.0),
)
"""Ahead, a bow to the left, round on the spot, backwards until the castors have turned over, to rest."""


def rows(path: Path) -> list[list[float]]:
    """Return time and all outputs every 0.1 s of the plant in this FMU."""
    return table.rows(path, INPUTS, OUTPUTS, COURSE)


if __name__ == "__main__":
    table.write(FILE, OUTPUTS, rows(ensure(PLANT)))
