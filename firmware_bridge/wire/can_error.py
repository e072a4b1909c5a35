"""A CAN controller's error reports: packets with the ERROR flag, packed as SocketCAN packs them.

Source: Linux, `linux/can/error.h`; TEC and REC in bytes 6 and 7. Counting errors is left to the controllers.
"""

from enum import IntEnum
from types import MappingProxyType
from typing import Final

from firmware_bridge.wire.can import ERROR

CONTROLLER: Final = ERROR | 0x004
"""The controller's state has changed, or it has lost a frame; byte 1 gives the details."""
BUS_OFF: Final = ERROR | 0x040
"""The controller has left the bus."""
RESTARTED: Final = ERROR | 0x100
"""The controller is back on the bus."""

RECEIVE_OVERFLOW: Final = 0x01
TRANSMIT_OVERFLOW: Final = 0x02
RECEIVE_PASSIVE: Final = 0x10
TRANSMIT_PASSIVE: Final = 0x20
ACTIVE_AGAIN: Final = 0x40
"""Bits of byte 1 of a `CONTROLLER` report."""
_STATE: Final = 1
_DETAIL: Final = 5
LENGTH: Final = 8

_CLASSES: Final = MappingProxyType(
    {
        0x001: "transmission timed out",
        0x002: "arbitration lost",
        0x004: "controller",
        0x008: "protocol violation",
        0x010: "transceiver",
        0x020: "no acknowledgement",
        0x040: "bus off",
        0x080: "bus error",
        0x100: "restarted",
    }
)
"""Classes of errors, the bits of a report's address."""
_STATES: Final = MappingProxyType(
    {
        RECEIVE_OVERFLOW: "receive overflow",
        TRANSMIT_OVERFLOW: "transmit overflow",
        0x04: "receive warning",
        0x08: "transmit warning",
        RECEIVE_PASSIVE: "receive passive",
        TRANSMIT_PASSIVE: "transmit passive",
        ACTIVE_AGAIN: "active again",
    }
)


class Loss(IntEnum):
    """Cause of a loss, in byte 5, which is the controller's own."""

    UNKNOWN = 0
    OBJECT = 1
    """A message object was overwritten before it was read."""
    QUEUE = 2
    """The driver's queue was full."""


def encode_report(
    state: int = 0, loss: Loss = Loss.UNKNOWN, transmit_errors: int = 0, receive_errors: int = 0
) -> bytes:
    """Return the eight bytes of a report; counters beyond a byte are reported as 255."""
    # The kernel's counters are wider than the byte that the report has for each.
    counters = bytes((min(transmit_errors, 0xFF), min(receive_errors, 0xFF)))
    return bytes((0, state, 0, 0, 0, loss)) + counters


def decode_report(payload: bytes) -> tuple[int, Loss]:
    """Return the bits of byte 1 and what was lost; nothing for a payload that is too short."""
    if len(payload) < LENGTH:
        return 0, Loss.UNKNOWN
    # The byte is the controller's own: another driver than the emulated one may use other numbers.
    known = payload[_DETAIL] in tuple(Loss)
    return payload[_STATE], Loss(payload[_DETAIL]) if known else Loss.UNKNOWN


def error_text(address: int, payload: bytes) -> str:
    """Return a report in words: its classes, and the controller's state."""
    texts = [text for bit, text in _CLASSES.items() if address & bit]
    state = payload[_STATE] if len(payload) > _STATE else 0
    texts += [text for bit, text in _STATES.items() if address & CONTROLLER & ~ERROR and state & bit]
    return "error report: " + (", ".join(texts) or "of another kind")
