"""Positions of axes given when the bridge was started: confirmed as by an operator, once it runs.

They are of that moment. A position that cannot be confirmed for some seconds is dropped, and the axis stays
unreferenced.
"""

from collections.abc import Callable, Iterable
from typing import Final

from firmware_bridge.intent import Answer, ConfirmPosition
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

WITHIN: Final[Nanoseconds] = 5 * SECOND
"""From the first time that the bridge could take it."""


class ConfirmedAtStart:
    """The requests that are left."""

    def __init__(self, requests: Iterable[ConfirmPosition]) -> None:
        self._left = tuple(requests)
        self._until: Nanoseconds = NEVER

    def wait(self) -> None:
        """Let what is left wait, however long: one of its own is under way, as a homing is."""
        self._until = NEVER

    def confirm(self, decide: Callable[[ConfirmPosition], Answer], now: Nanoseconds) -> None:
        """Ask for what is left; called in every cycle of a bridge that runs."""
        if not self._left:
            return
        if self._until == NEVER:
            self._until = now + WITHIN
        verdicts = [(request, decide(request)) for request in self._left]
        again = [request for request, verdict in verdicts if not verdict.accepted and verdict.temporary]
        self._left = tuple(again) if now < self._until else ()
