"""A product's choices where CiA 301 and 305 leave them open, with its own objects and codes.

The object dictionary is not among them: it is handed to the `ObjectStore`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

from emulators.canopen.bus_errors import CIA_301_CODES, BusError
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.emergency import Emergency
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.canopen.pdo import RECEIVE_TYPES, TRANSMIT_TYPES
from firmware_bridge.units import MILLISECOND, Nanoseconds

RESTORE_ALL: Final = Address(0x1011, 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class LayerSetting:
    """The product's objects for node number and bit rate, which CiA 305 sets and does not place."""

    node_number: Address
    bit_rate: Address
    bit_rate_in_use: Address
    bit_rates: Mapping[int, int]
    """Bits a second by code, as in the standard table of CiA 305; codes without a row are refused."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Product:
    """One product. Times in ns; where a field has a default, that is the standard's."""

    name: str
    layer_setting: LayerSetting
    is_parameter: Callable[[ObjectRow], bool]
    """True for an object that 0x1010:1 stores."""
    restore_commands: tuple[Address, ...] = (RESTORE_ALL,)
    """Objects that bring all defaults back."""
    restore_refused_by: int = 0
    """Bits of the Statusword with which they answer 0x08000022."""
    wrong_signature: AbortCode = AbortCode.CANNOT_STORE
    """Answer to a value that is not the signature of 0x1010 or 0x1011."""

    emergencies: Mapping[int, Emergency]
    """Rows of the emergency codes; a code without one is generic."""
    bus_errors: Mapping[BusError, int] = field(default_factory=lambda: CIA_301_CODES)
    """Emergency codes; an error without a row is not reported."""
    reports_reset: bool = True
    """True if an emergency with code 0 is sent when the errors are gone."""
    heartbeat_toggles: bool = False
    """True if bit 7 of the heartbeat changes each time."""

    receive_types: frozenset[int] = RECEIVE_TYPES
    """Transmission types of receive PDOs."""
    transmit_types: frozenset[int] = TRANSMIT_TYPES
    """Transmission types of transmit PDOs."""
    wrong_nmt_state: AbortCode = AbortCode.DEVICE_STATE
    """Answer to a new mapping outside Pre-Operational."""
    mapping_needs_invalid_pdo: bool = True
    """True if a mapping changes only while bit 31 of the PDO's COB-ID is set, not only with 0 entries."""
    accepts_long_pdo: bool = True
    """True if a receive PDO with more bytes than mapped is accepted; its other bytes do not count."""
    sends_on_start: bool = True
    """True if an event-driven transmit PDO is sent once on entering Operational."""
    poll: Nanoseconds = MILLISECOND
    """Least interval at which an event-driven transmit PDO checks values that move by themselves."""

    boot_time: Nanoseconds = 0
    """Time from power-on or reset to the boot-up message."""
    sdo_latency: Nanoseconds = 0
    """Time from an SDO request to its answer."""
