"""Errors that a device finds on the bus, and the emergency codes of CiA 301 for them.

Source: CiA 301 v4.02, table of emergency error codes. Those without a row are the product's, or not reported.
"""

from collections.abc import Iterator, Mapping
from enum import Enum
from types import MappingProxyType
from typing import Final

from firmware_bridge.wire.can_error import (
    BUS_OFF,
    CONTROLLER,
    RECEIVE_OVERFLOW,
    RECEIVE_PASSIVE,
    TRANSMIT_OVERFLOW,
    TRANSMIT_PASSIVE,
    Loss,
    decode_report,
)


class BusError(Enum):
    """Error found on the bus side of a device."""

    OBJECT_LOST = "message object of the CAN controller overwritten"
    RECEIVE_OVERRUN = "receive queue full"
    OVERRUN = "frame lost, place not known"
    TRANSMIT_OVERRUN = "transmit queue full"
    PASSIVE = "CAN controller error passive"
    BUS_OFF = "CAN controller bus off"
    COB_ID_COLLISION = "data frame with the device's own transmit COB-ID"
    PDO_TOO_SHORT = "receive PDO shorter than its mapping"
    PDO_MISSED = "receive PDO not received within its event timer"
    PARAMETERS_LOST = "saved parameters cannot be read"


CIA_301_CODES: Final[Mapping[BusError, int]] = MappingProxyType(
    {
        BusError.OBJECT_LOST: 0x8110,
        BusError.PASSIVE: 0x8120,
        BusError.COB_ID_COLLISION: 0x8150,
        BusError.PDO_TOO_SHORT: 0x8210,
        BusError.PDO_MISSED: 0x8250,
    }
)

REPORTS: Final = (CONTROLLER, BUS_OFF)
_OVERRUNS: Final[Mapping[Loss, BusError]] = MappingProxyType(
    {
        Loss.OBJECT: BusError.OBJECT_LOST,
        Loss.QUEUE: BusError.RECEIVE_OVERRUN,
        Loss.UNKNOWN: BusError.OVERRUN,
    }
)


def errors_in(address: int, payload: bytes) -> Iterator[BusError]:
    """Give the errors that a report of the CAN controller stands for."""
    if address == BUS_OFF:
        yield BusError.BUS_OFF
        return
    state, loss = decode_report(payload)
    if state & (RECEIVE_PASSIVE | TRANSMIT_PASSIVE):
        yield BusError.PASSIVE
    if state & RECEIVE_OVERFLOW:
        yield _OVERRUNS[loss]
    if state & TRANSMIT_OVERFLOW:
        yield BusError.TRANSMIT_OVERRUN
