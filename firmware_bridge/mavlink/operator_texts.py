"""Texts of a bridge to its operator, read out of its datagrams: STATUSTEXT, whole, each once."""

from collections.abc import Iterator
from typing import Final

from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.mavlink.texts import Received, TextCollector

_WANTED: Final = frozenset({dialect.MAVLINK_MSG_ID_STATUSTEXT})


class OperatorTexts:
    """Reader of the datagrams that a bridge sends."""

    def __init__(self) -> None:
        self._codec: Final = Codec(0, 0)
        self._collector: Final = TextCollector()
        self._last: Received | None = None

    def read(self, datagram: bytes) -> Iterator[Received]:
        """Yield its texts with their MAV_SEVERITY; what goes to several stations in a row, once."""
        for message in self._codec.decode(datagram, _WANTED):
            for received in self._collector.receive(message):
                if received != self._last:
                    self._last = received
                    yield received
