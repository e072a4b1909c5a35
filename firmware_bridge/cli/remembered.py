"""Newest stamps of signed streams, beyond a program's end: read at its start, kept while it runs."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final

from firmware_bridge.cli.console import refusal
from firmware_bridge.mavlink.trust import Stamps, Trust
from firmware_bridge.node import Node, Stoppable
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.runtime.kept_stamps import DamagedStampsError, KeptStamps
from firmware_bridge.units import NEVER, Nanoseconds


class Remembered:
    """The stored stamps of one program's signatures; none without a key, or without a writable file."""

    def __init__(self, trust: Trust, path: Path) -> None:
        """Read the stored stamps; a damaged file ends the program."""
        self._kept: KeptStamps | None = None if trust.key is None else KeptStamps(path)
        self.trust: Final = trust if self._kept is None else replace(trust, kept=_read(self._kept))
        """The trust, with the stamps received by the run before."""
        self._reported = False

    def keep(self, stamps: Callable[[Nanoseconds], Stamps], now: Nanoseconds, *, ended: bool) -> str | None:
        """Store the newest received stamps; return the obstacle, once.

        At the end not ahead: nothing is received any more.
        """
        kept = self._kept
        if kept is None:
            return None
        kept.write(stamps(now), now) if ended else kept.keep(stamps(now), now)
        return self._once(kept.file.problem(now))

    def settled(self) -> str | None:
        """Wait a while for the disk; return the obstacle, unless it was reported."""
        return None if self._kept is None else self._once(self._kept.file.settled())

    def _once(self, problem: str | None) -> str | None:
        if problem is None or self._reported:
            return None
        self._reported = True
        return f"time stamps are not kept: {problem}"


class Remembering:
    """A `Node` around one whose signatures are remembered until it has ended."""

    def __init__(
        self,
        node: Node,
        remembered: Remembered,
        stamps: Callable[[Nanoseconds], Stamps],
        say: Callable[[str], None],
    ) -> None:
        self._say: Final = say
        self._node: Final = node
        self._remembered: Final = remembered
        self._stamps: Final = stamps

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Forward the packet, and store the stamps."""
        return self._after(self._node.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node, and keep."""
        return self._after(self._node.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the node, and keep."""
        node = self._node
        return self._after(node.stop(now) if isinstance(node, Stoppable) else Reaction(), now)

    def _after(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        problem = self._remembered.keep(self._stamps, now, ended=reaction.wake_at == NEVER)
        if problem is not None:
            self._say(problem)
        return reaction


def _read(stamps: KeptStamps) -> Stamps:
    try:
        return stamps.read()
    except DamagedStampsError as error:
        raise refusal(
            f"{error}; it keeps a recording of signed words from being obeyed: delete it, and wait for a "
            "minute, to start without"
        ) from None
