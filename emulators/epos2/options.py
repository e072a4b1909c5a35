"""Options of a robot's emulated drives."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from emulators.canopen.saved_parameters import Storage
from firmware_bridge.families.epos2.maxon.frame import Generation


@dataclass(frozen=True, slots=True, kw_only=True)
class Epos2Options:
    """Options of emulated drives that the robot file does not have."""

    serial: Mapping[str, Generation | None] | None = None
    """Axes with a host on their drive's serial port, and its protocol, None as the host's.

    Without it those of the robot file.
    """
    storages: Mapping[str, Storage] = field(default_factory=lambda: MappingProxyType({}))
    """Saved parameters by axis; a drive without comes from the factory, and forgets."""
