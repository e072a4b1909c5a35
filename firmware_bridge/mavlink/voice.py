"""The voice for one place: its own sequence, version of MAVLink, numbers of modes, and intervals."""

from typing import TYPE_CHECKING, Final

from firmware_bridge.mavlink.frames import Codec, Message, dialect
from firmware_bridge.mavlink.modes import CARRIERS, in_px4

if TYPE_CHECKING:
    from firmware_bridge.mavlink.schedule import Schedule


class Voice:
    """One place's."""

    __slots__ = ("_codec", "mavlink_1", "px4", "schedule")

    def __init__(self, codec: Codec) -> None:
        """Write with this codec."""
        self._codec: Final = codec
        self.mavlink_1 = False
        """True where the newest good frame from there was one of MAVLink 1. With a key none is good."""
        self.px4 = False
        """True where a mode was requested from there in PX4's numbers."""
        self.schedule: Schedule | None = None
        """The schedule of intervals requested from there; None where those of all serve."""

    def frame(self, message: Message, stamp: int) -> bytes | None:
        """Return the message as one frame; None where its version of MAVLink cannot carry it."""
        if self.px4:
            number: int = message.get_msgId()
            if number in CARRIERS:
                return self._in_px4(message, number, stamp)
        return self._frame(message, stamp)

    def _in_px4(self, message: Message, number: int, stamp: int) -> bytes | None:
        mode: int = message.custom_mode
        # One message serves all stations: its number is put back after this one's frame is packed.
        message.custom_mode = in_px4(mode)
        if number == dialect.MAVLINK_MSG_ID_CURRENT_MODE:
            message.intended_custom_mode = message.custom_mode
        frame = self._frame(message, stamp)
        message.custom_mode = mode
        if number == dialect.MAVLINK_MSG_ID_CURRENT_MODE:
            message.intended_custom_mode = mode
        return frame

    def _frame(self, message: Message, stamp: int) -> bytes | None:
        if self.mavlink_1:
            return self._codec.encode_1(message)
        return self._codec.encode(message, stamp)
