"""Options that more than one command on emulated EPOS2 drives takes."""

from typing import Annotated

import typer

from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.device_profile import DeviceProfile
from firmware_bridge.cli.console import refusal

ProfileOption = Annotated[str, typer.Option("--profile", "-p", help=f"Which type: {', '.join(PROFILES)}.")]


def find_profile(name: str) -> DeviceProfile:
    """Return the type of this name; an unknown one ends the program with a message."""
    found = PROFILES.get(name)
    if found is None:
        raise refusal(f"--profile {name}: there is no such type; there are: {', '.join(PROFILES)}")
    return found
