"""The files of the checkout, and those that a wheel has more or less."""

import subprocess
from pathlib import Path
from typing import Final
from zipfile import ZipFile

ROOT: Final = Path(__file__).parents[2]
PACKAGES: Final = ("firmware_bridge/", "emulators/", "fmu/")


def tracked() -> set[str]:
    """Return the checkout's files."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)  # noqa: S607
    return set(listed.stdout.splitlines())


def difference(wheel: Path) -> tuple[set[str], set[str]]:
    """Return what a wheel lacks of the packages, and what it has besides that was not built."""
    ours = {name for name in tracked() if name.startswith(PACKAGES)}
    with ZipFile(wheel) as archive:
        held = set(archive.namelist())
    built = {it for it in held if it.endswith((".so", ".fmu")) or ".dist-info/" in it}
    return ours - held, held - ours - built
