"""Builds plants; apart from their other commands, for a plant that was built before takes no time at all."""

from pathlib import Path

from firmware_bridge.cli.console import one_message, say
from fmu.build import place
from fmu.errors import PlantError
from fmu.platforms import here, reachable


def build_model(model: str, *, fmi: int, out: Path | None) -> None:
    """Do what `fmu build` says."""
    target = out or Path(f"{model}.fmu")
    others, missing = reachable()
    with one_message(PlantError, OSError):
        place(model, fmi, target, others)
        size = target.stat().st_size
    say(f"{target}: {model}, FMI {fmi}.0, co-simulation and model exchange, {size // 1024} KiB")
    say(f"binaries: {', '.join(one.name for one in (here(), *others))}")
    for one in missing:
        lacks = f"no {one.compiler} here (Debian's {one.package})"
        say(f"no binary for {one.name}: {lacks}; its sources build there")
