"""A joystick of the kernel's, as /dev/input/js0: its events, and nothing to write."""

import errno
import os
from contextlib import suppress
from typing import Final

from firmware_bridge.shell.ports.byte_file import ByteFile
from firmware_bridge.shell.ports.port import PortError

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
