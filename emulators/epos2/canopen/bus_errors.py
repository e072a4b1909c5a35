"""Map from the CAN controller's reports to the drive's emergencies.

Source: EPOS Firmware Specification, error handling (by analogy). Assumed: the assignment of the two overruns,
and that the receive queue is the one between controller and firmware.
"""

from collections.abc import Iterator, Mapping
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
from firmware_bridge.wire.epos2 import emergency

REPORTS: Final = (CONTROLLER, BUS_OFF)
_OVERRUNS: Final[Mapping[Loss, int]] = MappingProxyType(
    {
        Loss.OBJECT: emergency.CAN_OBJECT_LOST,
        Loss.QUEUE: emergency.RECEIVE_QUEUE_OVERRUN,
        Loss.UNKNOWN: emergency.CAN_OVERRUN,
    }
)


def emergencies_of(address: int, payload: bytes) -> Iterator[int]:
    """Give the emergency codes that a report stands for."""
    if address == BUS_OFF:
        yield emergency.BUS_OFF
        return
    state, loss = decode_report(payload)
    if state & (RECEIVE_PASSIVE | TRANSMIT_PASSIVE):
        yield emergency.CAN_PASSIVE
    if state & RECEIVE_OVERFLOW:
        yield _OVERRUNS[loss]
    if state & TRANSMIT_OVERFLOW:
        yield emergency.TRANSMIT_QUEUE_OVERRUN
