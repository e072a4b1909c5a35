"""Sources of an FMU: a plant's equations, those that they take, and the generators of C; their token."""

import hashlib
import importlib.util
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from fmu.errors import PlantError
from fmu.plants import Plant

HERE: Final = Path(__file__).parent


def folder_of(plant: Plant, package: str) -> Path:
    """Return where a package of a plant lies; PlantError where there is none."""
    try:
        spec = importlib.util.find_spec(package)
    except ImportError:
        spec = None
    if spec is None or not spec.submodule_search_locations:
        raise PlantError(f"the plant '{plant.name}' is to stand in the package {package}: there is none")
    return Path(spec.submodule_search_locations[0])


def token_of(plant: Plant) -> str:
    """Return the token of an FMU's sources, 32 hexadecimal digits; PlantError where some are missing."""
    digest = hashlib.sha256()
    for name, path in _sources(plant):
        # With names: a file that is renamed or moved is another source.
        digest.update(name.encode() + b"\0" + path.read_bytes() + b"\0")
    if plant.starts:
        digest.update(repr(sorted(plant.starts.items())).encode())
    return digest.hexdigest()[:32]


def _sources(plant: Plant) -> Iterator[tuple[str, Path]]:
    """Yield what the FMU is made from: a name that is the same on every machine, and the file."""
    yield "fingerprint.py", HERE / "fingerprint.py"
    folders = {"export": HERE / "export", "parts": HERE / "parts"}
    folders |= {package: folder_of(plant, package) for package in (plant.package, *plant.made_of)}
    for name, place in folders.items():
        for path in sorted(place.rglob("*")):
            if path.suffix in {".py", ".c", ".h", ".md"}:
                yield f"{name}/{path.relative_to(place).as_posix()}", path
