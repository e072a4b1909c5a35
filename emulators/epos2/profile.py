"""What tells one drive type from another, and every choice that the sources leave open.

Each open choice is a field, annotated with its provenance and source, so that a document can list them and a
user can change them. It refuses to know how a choice is carried out.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import Annotated, Final, get_type_hints

from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.abort import AbortCode
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.rows import (
    APPLICATION_NOTES,
    ASSUMPTION,
    CIA_301,
    DEVICE,
    EDS,
    FIRMWARE_SPECIFICATION,
    LIBRARY,
    Provenance,
)

BIT_RATE: Final = Address(0x2001)
BIT_RATE_IN_USE: Final = Address(0x200A)
DIP_SWITCH: Final = Address(0x2009)
USB_FRAME_TIMEOUT: Final = Address(0x2006)
BUFFER_SIZE: Final = Address(0x60C4, 1)
BUFFER_FREE: Final = Address(0x60C4, 2)
SERIAL_NUMBER_64: Final = Address(0x2004)


@dataclass(frozen=True, slots=True)
class Known:
    """How far a field of the profile is known, and from where."""

    provenance: Provenance
    source: str


_ASSUMED: Final = Known(Provenance.ASSUMED, ASSUMPTION)
_DEVICE: Final = Known(Provenance.PROVEN, DEVICE)


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviceProfile:
    """One drive type. Identities as in 0x1018, 0x2003 and 0x2004; times in ns unless named otherwise."""

    name: str
    hardware_version: int
    software_version: Annotated[int, Known(Provenance.PROVEN, EDS)] = 0x2126
    application_number: Annotated[int, _DEVICE] = 0
    application_version: Annotated[int, _DEVICE] = 0
    base_sector_version: Annotated[int, _DEVICE] = 0x2DB6
    serial_number: Annotated[int, _DEVICE] = 0x0000_6620_8001_5954
    continuous_current_ma: int
    """Default of 0x6410:1; its bounds stand in the object table."""
    peak_current_ma: int
    """Default of 0x6410:2."""
    bit_rate: Annotated[int, _ASSUMED] = 0
    """Coded as in 0x2001: 0 is 1 Mbit/s."""
    usb_frame_timeout_ms: Annotated[int, Known(Provenance.ASSUMED, "a real device had 475")] = 500
    interpolation_buffer: Annotated[
        int, Known(Provenance.DOCUMENTED, "application note Interpolation Position Mode, December 2008")
    ] = 64
    """Places for data records."""

    boot_time: Annotated[Nanoseconds, _ASSUMED] = 0
    """From power-on or reset to the boot-up message; maxon's library waits 100 ms after a reset."""
    sdo_latency: Annotated[
        Nanoseconds, Known(Provenance.DOCUMENTED, f"{APPLICATION_NOTES}, p. 168: below 0.5 ms")
    ] = 0
    """From an SDO request to its answer."""
    poll: Annotated[Nanoseconds, _ASSUMED] = 1_000_000
    """How often a transmit PDO on change looks at values that move by themselves; never more often."""
    mapping_needs_invalid_pdo: Annotated[bool, Known(Provenance.BY_ANALOGY, FIRMWARE_SPECIFICATION)] = True
    """Whether a mapping changes only while bit 31 of the PDO's COB-ID is set."""
    accepts_long_pdo: Annotated[bool, Known(Provenance.ASSUMED, CIA_301)] = True
    """Whether a receive PDO with more bytes than mapped is taken; its other bytes do not count."""
    sends_on_start: Annotated[bool, _ASSUMED] = True
    """Whether a transmit PDO on change is sent once on entering Operational."""
    tells_cured: Annotated[bool, Known(Provenance.ASSUMED, f"{CIA_301}, error reset")] = True
    """Whether an emergency with code 0 is sent when the errors are gone."""
    heartbeat_toggles: Annotated[
        bool, Known(Provenance.BY_ANALOGY, f"{FIRMWARE_SPECIFICATION}; {APPLICATION_NOTES}, p. 158, differ")
    ] = False
    """Whether bit 7 of the heartbeat changes each time."""
    wrong_signature: Annotated[AbortCode, Known(Provenance.BY_ANALOGY, LIBRARY)] = AbortCode.WRONG_PASSWORD
    """Answer to a value that is not the signature of 0x1010 or 0x1011."""

    def differing(self, node_id: int) -> Mapping[Address, int | bytes]:
        """Return the defaults in which this drive differs from the object table."""
        return MappingProxyType(
            {
                at.PRODUCT_CODE: self.hardware_version << 16 | self.application_number,
                at.REVISION: self.software_version << 16 | self.application_version,
                at.SERIAL_NUMBER: self.serial_number & 0xFFFF_FFFF,
                Address(0x2003, 1): self.software_version,
                Address(0x2003, 2): self.hardware_version,
                Address(0x2003, 3): self.application_number,
                Address(0x2003, 4): self.application_version,
                Address(0x2003, 5): self.base_sector_version,
                SERIAL_NUMBER_64: self.serial_number,
                Address(0x2FFF, 4): self.base_sector_version,
                Address(0x2FFF, 5): self.serial_number >> 32,
                Address(0x2FFF, 6): self.serial_number & 0xFFFF_FFFF,
                BIT_RATE: self.bit_rate,
                BIT_RATE_IN_USE: self.bit_rate,
                DIP_SWITCH: node_id,
                USB_FRAME_TIMEOUT: self.usb_frame_timeout_ms,
                BUFFER_SIZE: self.interpolation_buffer,
                BUFFER_FREE: self.interpolation_buffer,
                at.CONTINUOUS_CURRENT_LIMIT: self.continuous_current_ma,
                at.OUTPUT_CURRENT_LIMIT: self.peak_current_ma,
            }
        )


EPOS2_70_10: Final = DeviceProfile(
    name="EPOS2 70/10",
    hardware_version=0x6420,
    continuous_current_ma=10_000,
    peak_current_ma=25_000,
)


def choices() -> tuple[tuple[str, object, Provenance, str], ...]:
    """Return each choice with its default, provenance and source, for documents."""
    hints = get_type_hints(DeviceProfile, include_extras=True)
    marks = ((each, getattr(hints[each.name], "__metadata__", ())) for each in fields(DeviceProfile))
    return tuple(
        (each.name, each.default, mark.provenance, mark.source) for each, found in marks for mark in found
    )
