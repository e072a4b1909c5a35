"""The reference trajectory: voltages over time, and what the plant answered, in climber.csv.

`python -m validation.references.climber` writes it again, where the equations are meant to change.
"""

from pathlib import Path
from typing import Final

from fmu.build import ensure
from fmu.climber.equations import CONTACTS, WHEELS
from fmu.climber.parameters import AXES
from fmu.parts import table

FILE: Final = Path(__file__).with_name("climber.csv")
INPUTS: Final = tuple(f"voltage_{axis}" for axis in AXES)
OUTPUTS: Final = (
    *(f"{quantity}_{axis}" for quantity in ("current", "angle", "speed") for axis in AXES),
    *("arc", "height", "heading", "speed", "yaw_rate", "x", "y", "z", "qx", "qy", "qz", "qw"),
    *(f"{name}_{side}" for side in WHEELS for name in CONTACTS),
    *(f"gap_{side}" for side in WHEELS),
    *("pitch", "joint", "swivel", "fallen", "fall", "battery_voltage"),
    *("analogue_1_right", "analogue_2_left"),
)

COURSE: Final = (
    # until s, left, right
    (0.3, 0.0, 0.0),
    (1.5, 12.0, 12.0),
    (3.0, 8.0, 16.0),
    (5.0, 12.0, 12.0),
    (6.0, -6.0, 6.0),
    (7.0, 0.0, 0.0),
)
"""Climbs, turns, goes on slantwise, turns on the spot, rests."""


def rows(path: Path) -> list[list[float]]:
    """Return time and all outputs every 0.1 s of the plant in this FMU."""
    return table.rows(path, INPUTS, OUTPUTS, COURSE)


if __name__ == "__main__":
    table.write(FILE, OUTPUTS, rows(ensure("climber", 3)))
