"""FMUs that came with the installed package, where it brings its plants built: then no one needs a compiler.

Each is named by plant, FMI, sources and machine: one whose sources have changed since, or that is another
machine's, is not taken. A checkout has none: there, and for a plant of your own, the cache serves.
"""

from pathlib import Path
from typing import Final

from fmu.plants import Plant
from fmu.platforms import here
from fmu.sources import token_of

FOLDER: Final = Path(__file__).parent / "fmus"


def file_name(plant: Plant, fmi: int) -> str:
    """Return what this plant's FMU for this machine is called; PlantError where its sources are not here."""
    return f"{plant.name}-fmi{fmi}-{token_of(plant)[:16]}-{here().name}.fmu"


def ready(plant: Plant, fmi: int) -> Path | None:
    """Return the FMU that came with the package; None where none did, or of other sources."""
    path = FOLDER / file_name(plant, fmi)
    return path if path.is_file() else None
