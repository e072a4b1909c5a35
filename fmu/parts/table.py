"""A run from a table of inputs over time, and the file that it is kept in.

The model is not known here: names, inputs and times are given.
"""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from fmu.plant import FmuPlant

STEPS_A_ROW: Final = 1000
"""Communication steps of 100 us between two rows."""


def rows(
    path: Path, inputs: Sequence[str], outputs: Sequence[str], course: Sequence[Sequence[float]]
) -> list[list[float]]:
    """Return time and outputs every 0.1 s of the FMU in `path`.

    `course` has rows of: until when (s), then the inputs until then.
    """
    table: list[list[float]] = []
    with FmuPlant(path, list(inputs), list(outputs)) as plant:
        for until, *values in course:
            for i, value in enumerate(values):
                plant.inputs[i] = value
            # In steps of 100 us: times are compared as integers.
            while plant.steps_done < round(until * 10_000):
                # Before the step: a row has the outputs that the inputs until then have made.
                if plant.steps_done % STEPS_A_ROW == 0:
                    table.append([plant.steps_done / 10_000, *plant.outputs])
                plant.step()
        table.append([plant.steps_done / 10_000, *plant.outputs])
    return table


def write(file: Path, outputs: Sequence[str], table: Sequence[Sequence[float]]) -> None:
    """Write the rows with a head line."""
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["time", *outputs])
        writer.writerows([[f"{value:.12g}" for value in row] for row in table])
