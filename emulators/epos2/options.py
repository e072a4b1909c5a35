"""Options of a robot's emulated drives."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from firmware_bridge.families.epos2.maxon.frame import Generation

PRODUCT: Final = "EPOS2"
"""Name in the files of saved parameters: those of all types are alike."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Epos2Options:
    """Options of emulated drives that the robot file does not have."""

    serial: Mapping[str, Generation | None] | None = None
    """Axes with a host on their drive's serial port, and its protocol, None as the host's.

    Without it those of the robot file.
    """
