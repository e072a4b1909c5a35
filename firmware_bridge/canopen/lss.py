"""CANopen's layer setting services (LSS): a master's requests and a slave's answers.

Source: CiA 305. The state in which a slave listens is the slave's.
"""

from enum import IntEnum
from typing import Final

LENGTH: Final = 8


class LssCommand(IntEnum):
    """First byte of a frame in either direction."""

    SWITCH_GLOBAL = 0x04
    SET_NODE = 0x11
    SET_BIT_TIMING = 0x13
    ACTIVATE_BIT_TIMING = 0x15
    STORE = 0x17
    SELECT_VENDOR = 0x40
    SELECT_PRODUCT = 0x41
    SELECT_REVISION = 0x42
    SELECT_SERIAL = 0x43
    SELECTED = 0x44
    IDENTIFY_VENDOR = 0x46
    IDENTIFY_PRODUCT = 0x47
    IDENTIFY_REVISION_LOW = 0x48
    IDENTIFY_REVISION_HIGH = 0x49
    IDENTIFY_SERIAL_LOW = 0x4A
    IDENTIFY_SERIAL_HIGH = 0x4B
    IDENTIFY_UNCONFIGURED = 0x4C
    IDENTIFIED = 0x4F
    UNCONFIGURED = 0x50
    INQUIRE_VENDOR = 0x5A
    INQUIRE_PRODUCT = 0x5B
    INQUIRE_REVISION = 0x5C
    INQUIRE_SERIAL = 0x5D
    INQUIRE_NODE = 0x5E


class LssError(IntEnum):
    """Second byte of an answer that can fail."""

    NONE = 0x00
    REFUSED = 0x01
    """Node number out of range, bit timing or storing not supported."""
    STORE_FAILED = 0x02


WAITING: Final = 0x00
CONFIGURATION: Final = 0x01


def encode_lss(command: LssCommand, value: int = 0, size: int = 4) -> bytes:
    """Return a frame's eight bytes: the command, a number of `size` bytes, zeros."""
    # CiA 305: bytes without content are reserved and sent as 0.
    return (bytes((command,)) + value.to_bytes(size, "little")).ljust(LENGTH, b"\0")
