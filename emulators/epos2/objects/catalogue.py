"""The types of EPOS2 that can be emulated, and the provenance of each of their figures.

A figure without a source is marked, not invented: an unknown hardware version is none, and the drive returns
0. Limits that are assumed are there because a drive needs a limit, and are marked as assumed. Types without a
row in `families.epos2.wire.differences` answer with the object dictionary of the 70/10.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.epos2.objects.device_profile import EPOS2_70_10, DeviceProfile, Known
from firmware_bridge.canopen.object_row import Provenance
from firmware_bridge.families.epos2.wire.differences import EDS_50_5
from firmware_bridge.families.epos2.wire.hardware import TYPES
from firmware_bridge.families.epos2.wire.rows import EDS

_NAME: Final = Known(Provenance.DOCUMENTED, "the type's name gives supply and continuous current")
_PEAK: Final = Known(Provenance.ASSUMED, "own assumption: twice the continuous current; no document at hand")
_UNKNOWN: Final = Known(Provenance.ASSUMED, "no source states it")
_ORDERED: Final = Known(Provenance.DOCUMENTED, "documents and projects of users that name the order number")
_FIRMWARE_FILE: Final = "names of maxon's firmware files and users' drivers"
_HARDWARE: Final = Known(Provenance.DOCUMENTED, _FIRMWARE_FILE)
_SOFTWARE: Final = Known(Provenance.BY_ANALOGY, f"{EDS}; other versions have been seen")


def _marked(**marks: Known) -> Mapping[str, Known]:
    base = {
        "order_numbers": _ORDERED,
        "hardware_version": _HARDWARE,
        "software_version": _SOFTWARE,
        "continuous_current_ma": _NAME,
        "peak_current_ma": _PEAK,
        "supply_v": _NAME,
    }
    return MappingProxyType(base | marks)


EPOS2_24_2: Final = DeviceProfile(
    name="EPOS2 24/2",
    order_numbers=("380264", "390438"),
    hardware_version=None,
    continuous_current_ma=2_000,
    peak_current_ma=4_000,
    supply_v=24,
    marks=_marked(hardware_version=_UNKNOWN),
)
EPOS2_24_5: Final = DeviceProfile(
    name=TYPES[0x6220],
    hardware_version=0x6220,
    continuous_current_ma=5_000,
    peak_current_ma=10_000,
    supply_v=24,
    marks=_marked(order_numbers=_UNKNOWN),
)
_OWN_EDS: Final = Known(Provenance.PROVEN, EDS_50_5)
EPOS2_50_5: Final = DeviceProfile(
    name=TYPES[0x6322],
    order_numbers=("347717",),
    hardware_version=0x6322,
    continuous_current_ma=5_000,
    peak_current_ma=10_000,
    supply_v=50,
    marks=_marked(
        order_numbers=_OWN_EDS,
        hardware_version=_OWN_EDS,
        software_version=_OWN_EDS,
        continuous_current_ma=_OWN_EDS,
        peak_current_ma=_OWN_EDS,
    ),
)
EPOS2_50_5_OTHER: Final = DeviceProfile(
    name=TYPES[0x6320],
    hardware_version=0x6320,
    continuous_current_ma=5_000,
    peak_current_ma=10_000,
    supply_v=50,
    marks=_marked(order_numbers=_UNKNOWN),
)
"""Another hardware version of it, known from names of firmware files and users' drivers."""
EPOS2_MODULE_36_2: Final = DeviceProfile(
    name=TYPES[0x6120],
    order_numbers=("360665",),
    hardware_version=0x6120,
    continuous_current_ma=2_000,
    peak_current_ma=4_000,
    supply_v=36,
    marks=_marked(),
)

PROFILES: Final[Mapping[str, DeviceProfile]] = MappingProxyType(
    {
        "24/2": EPOS2_24_2,
        "24/5": EPOS2_24_5,
        "36/2": EPOS2_MODULE_36_2,
        "50/5": EPOS2_50_5,
        "50/5-6320": EPOS2_50_5_OTHER,
        "70/10": EPOS2_70_10,
    }
)
"""Every type by the name that the command line takes."""
