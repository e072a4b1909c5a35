"""CANopen's services outside SDO and PDO: identifiers, network management, heartbeat, emergency.

Source: CiA 301 v4.02, predefined connection set. The time of sending is not known here.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import Final

NMT: Final = 0x000
SYNC: Final = 0x080
EMERGENCY: Final = 0x080
TIME_STAMP: Final = 0x100
TRANSMIT_PDO: Final = (0x180, 0x280, 0x380, 0x480)
"""First identifiers of the device's transmit PDOs 1 to 4."""
RECEIVE_PDO: Final = (0x200, 0x300, 0x400, 0x500)
"""First identifiers of the device's receive PDOs 1 to 4."""
SDO_RESPONSE: Final = 0x580
"""Server to client."""
SDO_REQUEST: Final = 0x600
"""Client to server."""
ERROR_CONTROL: Final = 0x700
"""Boot-up, heartbeat and node guarding."""
LSS_RESPONSE: Final = 0x7E4
LSS_REQUEST: Final = 0x7E5

ALL_NODES: Final = 0
FIRST_NODE: Final = 1
LAST_NODE: Final = 127
NODE_MASK: Final = 0x7F

COB_ID_INVALID: Final = 1 << 31
"""In a COB-ID entry: the PDO or the message is switched off."""
COB_ID_NO_REMOTE: Final = 1 << 30
"""In a transmit PDO's COB-ID entry: no remote request allowed."""
COB_ID_EXTENDED: Final = 1 << 29
COB_ID_MASK: Final = 0x7FF

TOGGLE: Final = 0x80
"""In a node guarding answer: changes each time."""
EMERGENCY_EXTRA: Final = 5
"""Size in bytes of an emergency message's manufacturer part."""
_NMT_LENGTH: Final = 2
_EMERGENCY_HEAD: Final = 3


class NmtCommand(IntEnum):
    """NMT command specifier; first byte of the frame 0x000."""

    START = 0x01
    STOP = 0x02
    ENTER_PRE_OPERATIONAL = 0x80
    RESET_NODE = 0x81
    RESET_COMMUNICATION = 0x82


class NmtState(IntEnum):
    """NMT state of a node in heartbeat and node guarding."""

    BOOT_UP = 0x00
    STOPPED = 0x04
    OPERATIONAL = 0x05
    PRE_OPERATIONAL = 0x7F

    @property
    def title(self) -> str:
        """The state as people say it."""
        return self.name.lower().replace("_", "-")


_STATE_BY_BYTE: Final = {int(state): state for state in NmtState}


def encode_nmt(command: NmtCommand, node: int = ALL_NODES) -> bytes:
    """Return the payload of a network management command for one node, or for all."""
    return bytes((command, node))


def decode_nmt(payload: bytes) -> tuple[NmtCommand, int] | None:
    """Return command and node (0: all); None for a short frame or an unknown command."""
    if len(payload) < _NMT_LENGTH:
        return None
    try:
        return NmtCommand(payload[0]), payload[1]
    except ValueError:
        return None


def encode_heartbeat(state: NmtState) -> bytes:
    """Return the payload of a heartbeat; `BOOT_UP` makes it the boot-up message."""
    return bytes((state,))


def decode_heartbeat(payload: bytes) -> NmtState | None:
    """Return the state in a heartbeat; None for what is none. A guarding toggle bit is ignored."""
    # A node guarding answer has the state in bits 0 to 6 and a toggle in bit 7; a heartbeat has 0 there.
    return _STATE_BY_BYTE.get(payload[0] & ~TOGGLE) if payload else None


@dataclass(frozen=True, slots=True)
class EmergencyMessage:
    """A drive's emergency: error code (0: all errors gone), error register 0x1001, bytes of the maker."""

    code: int
    register: int
    extra: bytes = bytes(EMERGENCY_EXTRA)


def encode_emergency(message: EmergencyMessage) -> bytes:
    """Return the eight bytes of an emergency message."""
    # CiA 301: error code of 16 bits with the low byte first, error register, five bytes of the maker.
    return message.code.to_bytes(2, "little") + bytes((message.register,)) + message.extra


def decode_emergency(payload: bytes) -> EmergencyMessage | None:
    """Return the emergency in `payload`; None when it is too short for code and register."""
    if len(payload) < _EMERGENCY_HEAD:
        return None
    return EmergencyMessage(int.from_bytes(payload[:2], "little"), payload[2], payload[_EMERGENCY_HEAD:])
