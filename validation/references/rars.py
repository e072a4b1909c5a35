"""The reference trajectory: voltages over time, and what the plant answered, in rars.csv.

`python -m validation.references.rars` writes it again, where the equations are meant to change.
"""

from pathlib import Path
from typing import Final

from fmu.build import ensure
from fmu.parts import table
from fmu.rars.interface import INPUTS, OUTPUTS

FILE: Final = Path(__file__).with_name("rars.csv")
VOLTAGES: Final = (
    # until s, left, right, steer, lift
    (0.5, 0.0, 0.0, 0.0, 0.0),
    (2.0, 6.0, 6.0, 0.0, 0.0),
    (4.0, 5.0, 7.0, 6.0, 0.0),
    (6.0, -4.0, -4.0, -12.0, 24.0),
    (7.0, 0.0, 0.0, 0.0, 0.0),
    (9.0, 8.0, 3.0, 3.0, -12.0),
    (10.0, 0.0, 0.0, 0.0, -24.0),
)
"""Turns both ways, runs the rack into its stop, lifts and lowers, ends on the lift's lower stop."""


def rows(path: Path) -> list[list[float]]:
    """Return time and all outputs every 0.1 s of the plant in this FMU."""
    return table.rows(path, list(INPUTS), list(OUTPUTS), VOLTAGES)


if __name__ == "__main__":
    table.write(FILE, list(OUTPUTS), rows(ensure("rars", 3)))
