"""Differences between the drive types, and every choice that the sources leave open.

Each open choice is a field, annotated with its provenance and source, so that a document can list them and a
user can change them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Annotated, Final, get_type_hints

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_dictionary import ObjectDictionary
from firmware_bridge.canopen.object_row import Provenance
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.differences import DIFFERENCES, objects_of
from firmware_bridge.families.epos2.wire.hardware import TYPES
from firmware_bridge.families.epos2.wire.rows import (
    APPLICATION_NOTES,
    ASSUMPTION,
    CIA_301,
    DEVICE,
    EDS,
    FIRMWARE_SPECIFICATION,
    LIBRARY,
)
from firmware_bridge.units import MICROSECOND, Nanoseconds

NODE_NUMBER: Final = Address(0x2000)
BIT_RATE: Final = Address(0x2001)
BIT_RATE_IN_USE: Final = Address(0x200A)
DIP_SWITCH: Final = Address(0x2009)
RS232_RATE: Final = Address(0x2002)
USB_FRAME_TIMEOUT: Final = Address(0x2006)
BUFFER_SIZE: Final = Address(0x60C4, 1)
BUFFER_FREE: Final = Address(0x60C4, 2)
SERIAL_NUMBER_64: Final = Address(0x2004)

ANSWER_TIME: Final[Nanoseconds] = 550 * MICROSECOND
"""Time of an SDO transfer beside its two frames.

It is 0.794 ms in all at 1 Mbit/s, 12.4 ms at 20 kbit/s, and five more between them (EPOS2 Application Notes,
p. 168), less the frames with their stuff bits. Assumed: all of it is the drive's; the figures were taken with
a PC and its CAN card, whose share is not published.
"""
BOOT_TIME: Final[Nanoseconds] = 262_500 * MICROSECOND
"""Time from a reset to the boot-up message, as recorded of an EPOS2 (reset node, over slcan)."""
BIT_RATES: Final[Mapping[int, int]] = MappingProxyType(
    {0: 1_000_000, 1: 800_000, 2: 500_000, 3: 250_000, 4: 125_000, 6: 50_000, 7: 20_000}
)
"""0x2001 and 0x200A: bits a second by code (EDS, maxon's library). Code 5 is reserved."""
BAUDS: Final = (9_600, 14_400, 19_200, 38_400, 57_600, 115_200)
"""0x2002: bits a second on RS232, by code."""


@dataclass(frozen=True, slots=True)
class Known:
    """Provenance of a field of the profile, and its source."""

    provenance: Provenance
    source: str


_ASSUMED: Final = Known(Provenance.ASSUMED, ASSUMPTION)
_DEVICE: Final = Known(Provenance.PROVEN, DEVICE)


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviceProfile:
    """One drive type. Identities as in 0x1018, 0x2003 and 0x2004; times in ns unless named otherwise."""

    name: str
    order_numbers: tuple[str, ...] = ()
    """Maxon's order numbers; empty where no source gives them."""
    hardware_version: int | None
    """Hardware version; None where no source gives it: the drive then returns 0."""
    software_version: Annotated[int, Known(Provenance.PROVEN, EDS)] = 0x2126
    application_number: Annotated[int, _DEVICE] = 0
    application_version: Annotated[int, _DEVICE] = 0
    base_sector_version: Annotated[int, _DEVICE] = 0x2DB6
    serial_number: Annotated[int, _DEVICE] = 0x0000_6620_8001_5954
    continuous_current_ma: int
    """Default and upper bound of 0x6410:1."""
    peak_current_ma: int
    """Default and upper bound of 0x6410:2."""
    supply_v: int
    """The highest supply voltage, by the type's name."""
    marks: Mapping[str, Known] = field(default_factory=lambda: MappingProxyType({}), repr=False)
    """Provenance of this type's own fields, by their names; it overrides the field's annotation."""
    bit_rate: Annotated[int, _ASSUMED] = 0
    """Coded as in 0x2001: 0 is 1 Mbit/s."""
    rs232_rate: Annotated[int, _DEVICE] = 5
    """Coded as in 0x2002: 5 is 115200 Bd."""
    usb_frame_timeout_ms: Annotated[int, Known(Provenance.ASSUMED, "a real device had 475")] = 500
    interpolation_buffer: Annotated[
        int, Known(Provenance.DOCUMENTED, "application note Interpolation Position Mode, December 2008")
    ] = 64
    """Places for data records."""

    boot_time: Annotated[Nanoseconds, _ASSUMED] = 0
    """Time from power-on or reset to the boot-up message: 0 is at once, `realistic` takes `BOOT_TIME`."""
    sdo_latency: Annotated[
        Nanoseconds,
        Known(Provenance.ASSUMED, f"{APPLICATION_NOTES}, p. 168: the whole; the drive's part is assumed"),
    ] = 0
    """Time from an SDO request to its answer: 0 is at once, `realistic` takes the published time."""
    serial_latency: Annotated[Nanoseconds, _ASSUMED] = 0
    """Time from the last byte of a serial command to its answer's first, beside the time on the CAN bus."""
    gateway_latency: Annotated[Nanoseconds, Known(Provenance.DOCUMENTED, f"{APPLICATION_NOTES}, p. 168")] = (
        130_000
    )
    """Time from a serial command for another drive to the SDO frame on the CAN bus."""
    gateway_timeout: Annotated[Nanoseconds, _ASSUMED] = 500_000_000
    """Timeout for another node's answer; then the host receives 0x05040000."""
    gateway_segment: Annotated[
        int,
        Known(
            Provenance.DOCUMENTED, f"{LIBRARY}, which sends records of 8 bytes as one segment: an inference"
        ),
    ] = 8
    """The longest segment that the gateway takes from the host; more than 7 bytes leave as two on the bus."""
    beyond_size: Annotated[
        bytes, Known(Provenance.ASSUMED, "zeros; a real device gives what lies behind in its memory")
    ] = bytes(4)
    """The four bytes of a ReadObject answer, where the object is shorter."""
    bad_checksum: Annotated[AbortCode, Known(Provenance.ASSUMED, f"{CIA_301}, CRC error")] = (
        AbortCode.CHECKSUM
    )
    """Answer to a USB frame whose check sum is wrong; on RS232 that is an `F`."""
    too_long_to_read: Annotated[AbortCode, _ASSUMED] = AbortCode.LENGTH
    """Answer to ReadObject for an object of more than four bytes."""
    poll: Annotated[Nanoseconds, _ASSUMED] = 1_000_000
    """Least interval at which a transmit PDO on change checks values that move by themselves."""
    mapping_needs_invalid_pdo: Annotated[
        bool,
        Known(
            Provenance.DOCUMENTED,
            f"a published driver that remaps real EPOS2s without; {FIRMWARE_SPECIFICATION}, demands it",
        ),
    ] = False
    """True if a mapping changes only while bit 31 of the PDO's COB-ID is set, not only with 0 entries."""
    written_word_is_setpoint: Annotated[
        bool,
        Known(Provenance.DOCUMENTED, f"{LIBRARY}, which never lowers bit 4 and moves again: an inference"),
    ] = True
    """True if each controlword written by SDO or serial with bit 4 is a new set-point, edge or not.

    In a PDO, which repeats its word with every cycle, the edge counts either way.
    """
    accepts_long_pdo: Annotated[bool, Known(Provenance.ASSUMED, CIA_301)] = True
    """True if a receive PDO with more bytes than mapped is accepted; its other bytes do not count."""
    sends_on_start: Annotated[bool, _ASSUMED] = True
    """True if a transmit PDO on change is sent once on entering Operational."""
    reports_reset: Annotated[bool, Known(Provenance.ASSUMED, f"{CIA_301}, error reset")] = True
    """True if an emergency with code 0 is sent when the errors are gone."""
    heartbeat_toggles: Annotated[
        bool, Known(Provenance.BY_ANALOGY, f"{FIRMWARE_SPECIFICATION}; {APPLICATION_NOTES}, p. 158, differ")
    ] = False
    """True if bit 7 of the heartbeat changes each time."""
    wrong_signature: Annotated[AbortCode, Known(Provenance.BY_ANALOGY, LIBRARY)] = AbortCode.WRONG_PASSWORD
    """Answer to a value that is not the signature of 0x1010 or 0x1011."""

    @property
    def over_current_ma(self) -> int:
        """Return where the hardware cuts off. Assumed: at 1.5 times the largest output current."""
        return self.peak_current_ma * 3 // 2

    @property
    def over_voltage_mv(self) -> int:
        """Return where the drive reports over-voltage. Assumed: 1/14 above its supply, 75 V for 70 V."""
        return self.supply_v * 15_000 // 14

    def known(self, name: str) -> Known:
        """Return the provenance of a field in this type; an own assumption where none is given."""
        mark = self.marks.get(name)
        if mark is not None:
            return mark
        hints = get_type_hints(DeviceProfile, include_extras=True)
        found = [each for each in getattr(hints[name], "__metadata__", ()) if isinstance(each, Known)]
        return found[0] if found else _ASSUMED

    @staticmethod
    def field_of(address: Address) -> str | None:
        """Return which field of the profile an object's default comes from; None where the table gives it."""
        return _FIELDS.get(address)

    @property
    def objects(self) -> ObjectDictionary:
        """The type's object dictionary."""
        return objects_of(self.hardware_version)

    def bounds(self) -> Mapping[Address, tuple[int, int]]:
        """Return the ranges in which this drive differs from the object table."""
        return MappingProxyType(
            {
                at.CONTINUOUS_CURRENT_LIMIT: (0, self.continuous_current_ma),
                at.OUTPUT_CURRENT_LIMIT: (0, self.peak_current_ma),
            }
        )

    def differing(self, dip_switch: int) -> Mapping[Address, int | bytes]:
        """Return the defaults in which this drive differs from the object table."""
        # 0x1018:2 is the hardware version in the high word; 0 stands for one that no source gives.
        hardware = self.hardware_version or 0
        difference = DIFFERENCES.get(hardware)
        return MappingProxyType(
            {
                **({} if difference is None else difference.defaults),
                od.PRODUCT_CODE: hardware << 16 | self.application_number,
                od.REVISION: self.software_version << 16 | self.application_version,
                od.SERIAL_NUMBER: self.serial_number & 0xFFFF_FFFF,
                Address(0x2003, 1): self.software_version,
                Address(0x2003, 2): hardware,
                Address(0x2003, 3): self.application_number,
                Address(0x2003, 4): self.application_version,
                Address(0x2003, 5): self.base_sector_version,
                SERIAL_NUMBER_64: self.serial_number,
                Address(0x2FFF, 4): self.base_sector_version,
                Address(0x2FFF, 5): self.serial_number >> 32,
                Address(0x2FFF, 6): self.serial_number & 0xFFFF_FFFF,
                BIT_RATE: self.bit_rate,
                BIT_RATE_IN_USE: self.bit_rate,
                RS232_RATE: self.rs232_rate,
                DIP_SWITCH: dip_switch,
                USB_FRAME_TIMEOUT: self.usb_frame_timeout_ms,
                BUFFER_SIZE: self.interpolation_buffer,
                BUFFER_FREE: self.interpolation_buffer,
                at.CONTINUOUS_CURRENT_LIMIT: self.continuous_current_ma,
                at.OUTPUT_CURRENT_LIMIT: self.peak_current_ma,
            }
        )


_FIELDS: Final[Mapping[Address, str]] = MappingProxyType(
    {
        od.PRODUCT_CODE: "hardware_version",
        od.REVISION: "software_version",
        Address(0x2003, 1): "software_version",
        Address(0x2003, 2): "hardware_version",
        BIT_RATE: "bit_rate",
        BIT_RATE_IN_USE: "bit_rate",
        RS232_RATE: "rs232_rate",
        USB_FRAME_TIMEOUT: "usb_frame_timeout_ms",
        BUFFER_SIZE: "interpolation_buffer",
        BUFFER_FREE: "interpolation_buffer",
        at.CONTINUOUS_CURRENT_LIMIT: "continuous_current_ma",
        at.OUTPUT_CURRENT_LIMIT: "peak_current_ma",
    }
)

EPOS2_70_10: Final = DeviceProfile(
    name=TYPES[0x6420],
    order_numbers=("375711",),
    hardware_version=0x6420,
    continuous_current_ma=10_000,
    peak_current_ma=25_000,
    supply_v=70,
    marks=MappingProxyType(
        {
            "order_numbers": Known(Provenance.PROVEN, EDS),
            "hardware_version": _DEVICE,
            "continuous_current_ma": Known(Provenance.PROVEN, EDS),
            "peak_current_ma": Known(Provenance.PROVEN, EDS),
            "supply_v": Known(Provenance.DOCUMENTED, "the type's name"),
        }
    ),
)


def realistic(profile: DeviceProfile) -> DeviceProfile:
    """Return the same drive with the answer times that maxon has published, and `BOOT_TIME` to start."""
    return replace(profile, sdo_latency=ANSWER_TIME, boot_time=profile.boot_time or BOOT_TIME)


def numbered(profile: DeviceProfile, node: int) -> DeviceProfile:
    """Return the same type with the serial number of an emulated drive: no two nodes have the same."""
    return replace(profile, serial_number=profile.serial_number + node)
