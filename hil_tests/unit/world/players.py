"""Nodes that follow a script, for tests of the code that carries them."""

from collections.abc import Callable, Sequence

from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds


class Player:
    """Node that sends packets at given instants, and notes the received ones with their times."""

    def __init__(self, *plan: tuple[Nanoseconds, Packet]) -> None:
        self.received: list[tuple[Nanoseconds, Packet]] = []
        self.woken: list[Nanoseconds] = []
        self._plan = sorted(plan, key=lambda entry: entry[0])

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.received.append((now, packet))
        return Reaction((), self._next())

    def wake(self, now: Nanoseconds) -> Reaction:
        self.woken.append(now)
        sent = []
        while self._plan and self._plan[0][0] <= now:
            sent.append(self._plan.pop(0)[1])
        return Reaction(tuple(sent), self._next())

    def _next(self) -> Nanoseconds:
        return self._plan[0][0] if self._plan else NEVER


class Echo:
    """Answers every packet at once with the packets that a function makes of it."""

    def __init__(self, answer: Callable[[Packet], Sequence[Packet]]) -> None:
        self.received: list[tuple[Nanoseconds, Packet]] = []
        self._answer = answer

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.received.append((now, packet))
        return Reaction(tuple(self._answer(packet)))

    def wake(self, now: Nanoseconds) -> Reaction:
        del now
        return Reaction()


class Ticks:
    """Physics in steps of `step`, which names nodes at given instants."""

    def __init__(self, step: Nanoseconds, *events: tuple[Nanoseconds, str]) -> None:
        self.reached: Nanoseconds = 0
        self.requested: list[Nanoseconds] = []
        self._step = step
        self._events = sorted(events)

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        self.requested.append(until)
        target = until // self._step * self._step
        if self._events and self._events[0][0] <= target:
            self.reached, name = self._events.pop(0)
            return self.reached, (name,)
        self.reached = max(self.reached, target)
        return self.reached, ()


def frame(address: int, content: str = "") -> Packet:
    return Packet("can", address, bytes.fromhex(content))
