"""The command `study`: it comes with a checkout, in the package `validation`; else one line reports so."""

from importlib.metadata import entry_points
from typing import Final

from typer.core import TyperCommand

from firmware_bridge.cli.console import refusal

GROUP: Final = "firmware_bridge.study"
"""The entry point of this group is the command."""


def _found() -> TyperCommand:
    for entry in entry_points(group=GROUP):
        command: TyperCommand = entry.load()
        return command
    raise refusal("studies come with a checkout of the sources, where `make setup` installs them")


study: Final = _found()
