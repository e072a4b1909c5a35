"""A serial port of this machine, by pyserial: eight data bits, no parity, one stop bit, no flow control."""

import contextlib
import errno
import sys
from typing import Final

import serial

from firmware_bridge.node import DTR_DOWN, DTR_UP
from firmware_bridge.runtime.ports.byte_file import ByteFile
from firmware_bridge.runtime.ports.port import LostPort, PortError
from firmware_bridge.units import Nanoseconds

MOST_WAITING: Final = 65_536
"""Most waiting bytes of a port; one with more sends nothing at all."""

_IN_USE: Final = "it is in use; end the program that has it"
_PROBLEMS: Final = {
    errno.ENOENT: "there is no such device; `ls /dev/tty*` shows those that there are",
    errno.EACCES: "not allowed; join the group that owns it, often dialout, and log in again",
    errno.EBUSY: _IN_USE,
    errno.EAGAIN: _IN_USE,
    errno.ENOTTY: "it is no serial line; `ls /dev/tty*` shows those that there are",
}


class SerialLine(ByteFile):
    """A serial device, as /dev/ttyUSB0. Opening it raises PortError with what to do."""

    def __init__(self, device: str, baud: int) -> None:
        self.name = f"serial port {device}"
        self._serial = _opened(device, baud, self.name)
        super().__init__(self._serial.fileno())

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send bytes, or keep them for `flush`; an empty packet may set the wire DTR. LostPort."""
        if address in {DTR_UP, DTR_DOWN} and not payload:
            # A line without that wire has nothing to be reset by.
            with contextlib.suppress(OSError, serial.SerialException):
                self._serial.dtr = address == DTR_UP
            return
        super().write(address, payload, now)

    def close(self) -> None:
        """Close the device; never fails, and may be called again."""
        with contextlib.suppress(OSError, serial.SerialException):
            self._serial.close()

    def _crowded(self, waiting: bytearray) -> None:
        if len(waiting) > MOST_WAITING:
            raise LostPort(self, f"{len(waiting)} bytes wait, and it sends none")


def _opened(device: str, baud: int, name: str) -> serial.Serial:
    try:
        port = serial.Serial(device, baud, timeout=0, write_timeout=0, exclusive=True)
    except (serial.SerialException, OSError, ValueError) as error:
        raise PortError(f"cannot open {name} at {baud} Bd: {_why(error)}") from error
    if sys.platform == "linux":
        with contextlib.suppress(OSError, NotImplementedError, ValueError):
            # A converter chip on USB keeps received bytes for up to 16 ms otherwise.
            port.set_low_latency_mode(True)
    return port


def _why(error: BaseException) -> str:
    return _PROBLEMS.get(_number(error), " ".join(str(error).split()))


def _number(error: BaseException) -> int:
    """Return the system's number of an error; where pyserial gives its text alone, that of its cause."""
    for each in (error, error.__context__):
        number = getattr(each, "errno", None) or next(iter(getattr(each, "args", ())), None)
        if isinstance(number, int):
            return number
    return 0
