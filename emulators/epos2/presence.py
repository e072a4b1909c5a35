"""A request to a drive behind a serial line that changes nothing: its device type."""

from typing import Final

from firmware_bridge.canopen.objects import DEVICE_TYPE
from firmware_bridge.families.epos2.maxon.frame import Frame, Generation, MaxonAnswer
from firmware_bridge.families.epos2.maxon.lines import host_end

READ_OBJECT: Final = 0x10
NO_ERROR: Final = bytes(4)


class DeviceTypeRead:
    """An `emulators.family.Question`."""

    def __init__(self, spoken: str, node: int) -> None:
        """Take the protocol, `v1` or `v2`, and the drive's number."""
        self._spoken: Final = Generation(spoken)
        self._node: Final = node
        self._host = host_end(self._spoken, 0)
        self.answered = False
        """True once the drive has answered without an error."""

    def begin(self) -> bytes:
        """Return the bytes that ask, from the beginning."""
        # A new protocol end: an answer that was cut off must not spoil the next one.
        self._host = host_end(self._spoken, 0)
        index = DEVICE_TYPE.index.to_bytes(2, "little")
        self._host.ask(Frame(READ_OBJECT, index + bytes((DEVICE_TYPE.subindex, self._node))), 0)
        return self._host.taken()

    def receive(self, chunk: bytes) -> bytes:
        """Take bytes; return those to send."""
        outcome = self._host.receive(chunk, 0)
        # The first four bytes are the error code; 0 is success.
        self.answered |= isinstance(outcome, MaxonAnswer) and outcome.body[:4] == NO_ERROR
        return self._host.taken()
