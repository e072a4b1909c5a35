"""The files of the checkout, and those that a wheel has more or less."""

import subprocess
from pathlib import Path
from typing import Final
from zipfile import ZipFile

ROOT: Final = Path(__file__).parents[2]
PACKAGES: Final = ("firmware_bridge/", "emulators/", "fmu/")

PLOTS = {f"firmware_bridge/live/uplot.{name}" for name in ("js", "css", "LICENSE")}
"""What draws the live page's plots: taken from npm where that is there, and in no checkout."""


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
    # All of it, its licence included, or nothing of it.
    built |= PLOTS if held >= PLOTS else set()
    return ours - held, held - ours - built
