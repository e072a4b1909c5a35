"""Frames that a CAN interface does not take yet: the bus is busy, or no other node is on it."""

from abc import ABC, abstractmethod
from collections import deque
from typing import Final

from firmware_bridge.runtime.ports.port import LostPort
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

PATIENCE: Final = 50 * MILLISECOND
"""Time after which an unsent frame counts as a lost bus: one cycle of the bridge."""
RETRY: Final = MILLISECOND


class Outbox(ABC):
    """The sending half of a CAN port: first in first out, never dropping a frame in silence."""

    name: str

    def __init__(self) -> None:
        self.retry_at: Nanoseconds = NEVER
        self._waiting: deque[tuple[Nanoseconds, int, bytes]] = deque()

    def write(self, address: int, payload: bytes, now: Nanoseconds) -> None:
        """Send a frame, or keep it for `flush`; LostPort."""
        # Behind a waiting frame every other waits, too: the order of frames is part of the protocol.
        if self._waiting or not self._send(address, payload):
            self._waiting.append((now, address, payload))
            self.retry_at = min(self.retry_at, now + RETRY)

    def flush(self, now: Nanoseconds) -> None:
        """Try again to send what waits; LostPort when the oldest frame has waited too long."""
        waiting = self._waiting
        while waiting:
            since, address, payload = waiting[0]
            if not self._send(address, payload):
                # Without an acknowledging node a controller repeats its frame for ever (ISO 11898-1).
                if now - since >= PATIENCE:
                    raise self._lost(
                        f"no frame could be sent for {(now - since) // MILLISECOND} ms; is another node on "
                        "the bus, with the same bit rate, and is the bus terminated at both ends?"
                    )
                self.retry_at = now + RETRY
                return
            waiting.popleft()
        self.retry_at = NEVER

    @abstractmethod
    def _send(self, address: int, payload: bytes) -> bool:
        """Send a frame at once; False where the interface has no room now; LostPort where it is gone."""

    @abstractmethod
    def _lost(self, problem: str) -> LostPort:
        """Return the exception that names this port."""
