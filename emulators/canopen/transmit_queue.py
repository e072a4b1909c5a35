"""Transmit queue of a device: frames of this instant, and SDO answers whose latency has not passed yet."""

from collections import deque
from typing import Final

from emulators.canopen.identity import Identity
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds


class TransmitQueue:
    """Frames on their way to the controller. A device that its bit rate keeps off the bus sends none."""

    def __init__(self, identity: Identity, latency: Nanoseconds) -> None:
        """`latency` is from a request's last bit until its answer is given to the controller."""
        self._identity: Final = identity
        self._latency: Final = latency
        self._sent: list[Packet] = []
        self._answers: deque[tuple[Nanoseconds, bytes]] = deque()
        self.answer_due: Nanoseconds = NEVER
        """Time at which the next SDO answer leaves."""
        self.idle = Reaction()
        """The reaction to what concerns the device in nothing: it sends nothing and is woken as before."""

    def send(self, address: int, payload: bytes) -> None:
        """Let a frame leave now."""
        if self._identity.on_bus:
            self._sent.append(Packet(CAN, address, payload))

    def answer(self, payload: bytes, now: Nanoseconds) -> None:
        """Let an SDO answer leave once the latency has passed."""
        self._answers.append((now + self._latency, payload))
        self.answer_due = self._answers[0][0]

    def released(self, now: Nanoseconds) -> list[bytes]:
        """Return the SDO answers that are to be sent now."""
        due: list[bytes] = []
        while self.answer_due <= now:
            due.append(self._answers.popleft()[1])
            self.answer_due = self._answers[0][0] if self._answers else NEVER
        return due

    def drop_answers(self) -> None:
        """Forget the answers that have not left: the SDO server has stopped."""
        self._answers.clear()
        self.answer_due = NEVER

    def reaction(self, wake_at: Nanoseconds) -> Reaction:
        """Hand over what is to be sent; while there is nothing, the same reaction serves again."""
        if self.idle.wake_at != wake_at:
            self.idle = Reaction((), wake_at)
        if not self._sent:
            return self.idle
        # The list is used again: the reaction must have a copy of its own.
        sent = tuple(self._sent)
        self._sent.clear()
        return Reaction(sent, wake_at)
