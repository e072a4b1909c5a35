"""The reference trajectory: voltages over time, and what the plant answered, in reference.csv.

`python -m fmu.rars.reference` writes the file anew; do that only when the equations are meant to change.
"""

import csv
from pathlib import Path
from typing import Final

from fmu.build import ensure
from fmu.interface import INPUTS, OUTPUTS
from fmu.plant import FmuPlant

FILE: Final = Path(__file__).with_name("reference.csv")
STEPS_A_ROW: Final = 1000
"""Communication steps of 100 us between two rows."""

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
    table: list[list[float]] = []
    with FmuPlant(path, list(INPUTS), list(OUTPUTS)) as plant:
        for until, *voltages in VOLTAGES:
            for i, voltage in enumerate(voltages):
                plant.inputs[i] = voltage
            while plant.steps_done < round(until * 10_000):
                if plant.steps_done % STEPS_A_ROW == 0:
                    table.append([plant.steps_done / 10_000, *plant.outputs])
                plant.step()
        table.append([plant.steps_done / 10_000, *plant.outputs])
    return table


def main() -> None:
    """Write reference.csv."""
    with FILE.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["time", *OUTPUTS])
        writer.writerows([[f"{value:.12g}" for value in row] for row in rows(ensure("rars", 3))])


if __name__ == "__main__":
    main()
