"""The EPOS2 as a product of CANopen: maxon's choices where CiA 301 and 305 leave them open.

Sources: EPOS Firmware Specification and Communication Guide (by analogy), EDS, EPOS2 Application Notes,
p. 158 (error control); recorded from an EPOS2: emergencies (code, register, five zero bytes), transmission
type 253 and remote requests. Block transfer of SDO does not exist in the device (assumed: nothing in the EDS
or in maxon's library). Assumed: the assignment of the two overruns, and that the receive queue is the one
between controller and firmware.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.canopen.bus_errors import CIA_301_CODES, BusError
from emulators.canopen.product import LayerSetting, Product
from emulators.epos2.objects.device_profile import (
    BIT_RATE,
    BIT_RATE_IN_USE,
    BIT_RATES,
    NODE_NUMBER,
    DeviceProfile,
)
from emulators.epos2.objects.parameters import RESTORE_COMMANDS, is_parameter
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.pdo import EVERY_SYNC, ON_CHANGE, ON_REQUEST
from firmware_bridge.families.epos2.wire import emergency

POWER_STAGE: Final = 1 << 4
"""Statusword bit; 0x1011 refuses while it is set."""
LAYER_SETTING: Final = LayerSetting(
    node_number=NODE_NUMBER, bit_rate=BIT_RATE, bit_rate_in_use=BIT_RATE_IN_USE, bit_rates=BIT_RATES
)
BUS_ERRORS: Final[Mapping[BusError, int]] = MappingProxyType(
    {
        **CIA_301_CODES,
        BusError.OVERRUN: emergency.CAN_OVERRUN,
        BusError.BUS_OFF: emergency.BUS_OFF,
        BusError.RECEIVE_OVERRUN: emergency.RECEIVE_QUEUE_OVERRUN,
        BusError.TRANSMIT_OVERRUN: emergency.TRANSMIT_QUEUE_OVERRUN,
        # Assumed: a copy of the parameters that can no longer be read is an internal software error.
        BusError.PARAMETERS_LOST: emergency.INTERNAL_SOFTWARE,
    }
)


def product_of(profile: DeviceProfile) -> Product:
    """Return the product that a drive type is, with the profile's choices."""
    return Product(
        name="EPOS2",
        layer_setting=LAYER_SETTING,
        is_parameter=is_parameter,
        restore_commands=RESTORE_COMMANDS,
        restore_refused_by=POWER_STAGE,
        wrong_signature=profile.wrong_signature,
        emergencies=emergency.EMERGENCIES,
        bus_errors=BUS_ERRORS,
        reports_reset=profile.reports_reset,
        heartbeat_toggles=profile.heartbeat_toggles,
        receive_types=frozenset({EVERY_SYNC, ON_CHANGE}),
        transmit_types=frozenset({EVERY_SYNC, ON_REQUEST, ON_CHANGE}),
        wrong_nmt_state=AbortCode.WRONG_NMT_STATE,
        mapping_needs_invalid_pdo=profile.mapping_needs_invalid_pdo,
        accepts_long_pdo=profile.accepts_long_pdo,
        sends_on_start=profile.sends_on_start,
        poll=profile.poll,
        boot_time=profile.boot_time,
        sdo_latency=profile.sdo_latency,
    )
