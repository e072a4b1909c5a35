"""A joystick of the kernel's, as /dev/input/js0: its events, and nothing to write."""

import errno
import fcntl
import os
from contextlib import suppress
from typing import Final

from firmware_bridge.runtime.ports.byte_file import ByteFile
from firmware_bridge.runtime.ports.port import PortError

_READ: Final = 2 << 30 | ord("j") << 8
_ABS_COUNT: Final = 64
_NAME: Final = _READ | 128 << 16 | 0x13
_AXES: Final = _READ | 1 << 16 | 0x11
_AXIS_MAP: Final = _READ | _ABS_COUNT << 16 | 0x32
"""JSIOCGNAME, JSIOCGAXES and JSIOCGAXMAP, linux/joystick.h."""
_PROBLEMS: Final = {
    errno.ENOENT: "there is no such device; `ls /dev/input/js*` shows those that there are",
    errno.EACCES: "not allowed; join the group that owns it, often input, and log in again",
}


class JoystickPort(ByteFile):
    """The events of one joystick. PortError where it cannot be opened; LostPort when it is unplugged."""

    def __init__(self, device: str) -> None:
        self.name = f"joystick {device}"
        try:
            fileno = os.open(device, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as error:
            problem = _PROBLEMS.get(error.errno or 0, str(error.strerror))
            raise PortError(f"cannot open {self.name}: {problem}") from error
        super().__init__(fileno)

    def close(self) -> None:
        """Close the device; never fails, and may be called again."""
        with suppress(OSError):
            os.close(self._fileno)

    def _crowded(self, waiting: bytearray) -> None:
        """Nothing is ever written to it."""


def identity(fileno: int) -> tuple[str, frozenset[int]]:
    """Return a joystick's name, and the codes of its axes, linux/joystick.h; nothing where it has none."""
    name, count, codes = bytearray(128), bytearray(1), bytearray(_ABS_COUNT)
    try:
        for request, answer in ((_NAME, name), (_AXES, count), (_AXIS_MAP, codes)):
            fcntl.ioctl(fileno, request, answer)
    except OSError:
        return "", frozenset()
    return name.partition(b"\0")[0].decode("utf-8", "replace"), frozenset(codes[: count[0]])
