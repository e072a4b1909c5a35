"""SDO abort codes, and the exception that carries one.

Sources: CiA 301 v4.02; 0x0F00FFxx from maxon's command library. The serial protocols use the same codes.
"""

from enum import IntEnum
from typing import Final, Self

from firmware_bridge.canopen.address import Address


class AbortCode(IntEnum):
    """An SDO abort code: the number on the wire and its meaning."""

    meaning: str

    def __new__(cls, code: int, meaning: str) -> Self:
        """Make a member from its row."""
        member = int.__new__(cls, code)
        member._value_ = code
        member.meaning = meaning
        return member

    TOGGLE = (0x0503_0000, "toggle bit did not alternate")
    TIMEOUT = (0x0504_0000, "no answer in time")
    UNKNOWN_COMMAND = (0x0504_0001, "command specifier unknown")
    CHECKSUM = (0x0504_0004, "check sum is wrong")
    OUT_OF_MEMORY = (0x0504_0005, "out of memory")
    UNSUPPORTED_ACCESS = (0x0601_0000, "access not supported here")
    WRITE_ONLY = (0x0601_0001, "object is write-only")
    READ_ONLY = (0x0601_0002, "object is read-only")
    NO_OBJECT = (0x0602_0000, "no such object")
    NOT_MAPPABLE = (0x0604_0041, "object cannot be mapped to this PDO")
    PDO_LENGTH = (0x0604_0042, "mapped objects exceed the PDO's length")
    PARAMETER_CLASH = (0x0604_0043, "parameters contradict each other")
    DEVICE_CLASH = (0x0604_0047, "internal contradiction in the device")
    HARDWARE = (0x0606_0000, "hardware error")
    LENGTH = (0x0607_0010, "length does not match the object")
    TOO_LONG = (0x0607_0012, "too many bytes for the object")
    TOO_SHORT = (0x0607_0013, "too few bytes for the object")
    NO_SUBINDEX = (0x0609_0011, "no such sub-index")
    RANGE = (0x0609_0030, "value out of range")
    TOO_HIGH = (0x0609_0031, "value too high")
    TOO_LOW = (0x0609_0032, "value too low")
    LIMITS_CROSSED = (0x0609_0036, "maximum below minimum")
    GENERAL = (0x0800_0000, "general error")
    CANNOT_STORE = (0x0800_0020, "cannot transfer or store")
    LOCAL_CONTROL = (0x0800_0021, "under local control")
    DEVICE_STATE = (0x0800_0022, "not in this state of the device")
    WRONG_NODE = (0x0F00_FFB9, "wrong node number")
    NOT_IN_SERVICE = (0x0F00_FFBC, "not in service mode")
    WRONG_PASSWORD = (0x0F00_FFBE, "wrong password")
    ILLEGAL_COMMAND = (0x0F00_FFBF, "illegal command on the serial line")
    WRONG_NMT_STATE = (0x0F00_FFC0, "not in this NMT state")


_BY_CODE: Final = {int(member): member for member in AbortCode}


def meaning_of(code: int) -> str:
    """Return an abort code as text for people; unknown codes come back as their number."""
    known = _BY_CODE.get(code)
    return f"0x{code:08X}" if known is None else f"0x{code:08X} {known.meaning}"


class SdoAbort(Exception):  # noqa: N818 - the standard's word: a transfer is aborted, also by a healthy peer
    """A refused SDO request, with the abort code."""

    def __init__(self, code: AbortCode, address: Address | None = None) -> None:
        """Keep the code for the answer, and the address, where known, for people."""
        super().__init__(code, address)
        self.code = code
        self.address = address

    def __str__(self) -> str:
        """Format it only on request: a drive refuses more often than its text is read."""
        where = "" if self.address is None else f"{self.address}: "
        return f"{where}{meaning_of(self.code)}"
