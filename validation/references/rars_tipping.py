"""The reference trajectory of RARS that can tip over: voltages, and its answer, in rars_tipping.csv.

`python -m validation.references.rars_tipping` writes it again, where the equations are meant to change.
"""

from pathlib import Path
from typing import Final

from fmu.build import ensure
from fmu.parts import table
from fmu.rars_tipping.interface import INPUTS, OUTPUTS
from validation.references.rars import VOLTAGES

FILE: Final = Path(__file__).with_name("rars_tipping.csv")


def rows(path: Path) -> list[list[float]]:
    """Return time and all outputs every 0.1 s of the plant in this FMU."""
    return table.rows(path, list(INPUTS), list(OUTPUTS), VOLTAGES)


if __name__ == "__main__":
    table.write(FILE, list(OUTPUTS), rows(ensure("rars_tipping", 3)))
