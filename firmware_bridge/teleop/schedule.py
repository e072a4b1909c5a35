"""When each stream of telemetry is due, and how stations change that; it knows nothing of what is told."""

from typing import Final

from firmware_bridge.units import NEVER, Nanoseconds


class Schedule:
    """Which streams are due; each keeps to the grid of its period: a late report shifts no later one."""

    def __init__(self, streams: tuple[tuple[int, Nanoseconds], ...], cycle: Nanoseconds) -> None:
        """Take each stream's message number and period; several streams may share a number."""
        # Reports come once a cycle and jitter: rather a little early than a cycle late.
        self._early: Final[Nanoseconds] = cycle // 4
        self._numbers: Final = tuple(number for number, _ in streams)
        self._defaults: Final = tuple(period for _, period in streams)
        self._periods = list(self._defaults)
        self._due: list[Nanoseconds] = [0] * len(streams)

    @property
    def next_due(self) -> Nanoseconds:
        """The instant at which the next message is due."""
        return min(self._due)

    def due(self, now: Nanoseconds) -> list[int]:
        """Return the places of the streams that are due now, and plan them anew."""
        reached = now + self._early
        ready: list[int] = []
        for index, due in enumerate(self._due):
            if due <= reached:
                ready.append(index)
                following = due + self._periods[index]
                self._due[index] = following if following > now else now + self._periods[index]
        return ready

    def period(self, number: int) -> Nanoseconds | None:
        """Return a message's shortest period; `NEVER` where it is off, None where it is no stream."""
        periods = [p for n, p in zip(self._numbers, self._periods, strict=True) if n == number]
        return min(periods) if periods else None

    def change(self, number: int, period: Nanoseconds | None, now: Nanoseconds) -> None:
        """Give every stream of this message a new period; `NEVER` is off, None is the default."""
        for index, its_number in enumerate(self._numbers):
            if its_number == number:
                self._periods[index] = self._defaults[index] if period is None else period
                self._due[index] = NEVER if period == NEVER else now
