"""The due times of telemetry streams, and their change by stations; contents are not known here."""

from typing import Final

from firmware_bridge.units import NEVER, Nanoseconds


class Schedule:
    """Due times of the streams; each keeps to the grid of its period: a late report shifts no later one."""

    def __init__(
        self,
        streams: tuple[tuple[int, Nanoseconds], ...],
        cycle: Nanoseconds,
        goes_on: tuple[list[Nanoseconds], list[Nanoseconds]] | None = None,
    ) -> None:
        """Take each stream's message number and period; several streams may share a number.

        `goes_on`: the periods and the instants of one that it goes on from.
        """
        self._cycle: Final = cycle
        # Reports come once a cycle and jitter: rather a little early than a cycle late.
        self._early: Final[Nanoseconds] = cycle // 4
        self._numbers: Final = tuple(number for number, _ in streams)
        self._defaults: Final = tuple(period for _, period in streams)
        periods, due = (self._defaults, [0] * len(streams)) if goes_on is None else goes_on
        self._periods: list[Nanoseconds] = list(periods)
        self._due: list[Nanoseconds] = list(due)
        self._chosen: set[int] = set()
        """The messages whose period was requested: a new default does not change it."""

    @property
    def next_due(self) -> Nanoseconds:
        """The instant at which the next message is due."""
        return min(self._due)

    def due(self, now: Nanoseconds) -> list[int]:
        """Return the places of the streams that are due now, and plan them again."""
        reached = now + self._early
        ready: list[int] = []
        for index, due in enumerate(self._due):
            if due <= reached:
                ready.append(index)
                following = due + self._periods[index]
                # On the grid of its period, but never in the past: a long pause is not made up for.
                self._due[index] = following if following > now else now + self._periods[index]
        return ready

    def period(self, number: int) -> Nanoseconds | None:
        """Return a message's shortest period; `NEVER` where it is off, None where it is no stream."""
        periods = [p for n, p in zip(self._numbers, self._periods, strict=True) if n == number]
        return min(periods) if periods else None

    def default(self, number: int) -> Nanoseconds | None:
        """Return the shortest period of a message without a request for another one."""
        periods = [p for n, p in zip(self._numbers, self._defaults, strict=True) if n == number]
        return min(periods) if periods else None

    def copy(self) -> "Schedule":
        """Return a copy for a place that requests other periods."""
        rows = tuple(zip(self._numbers, self._defaults, strict=True))
        return Schedule(rows, self._cycle, (self._periods, self._due))

    def change(self, number: int, period: Nanoseconds | None, now: Nanoseconds) -> None:
        """Give every stream of this message a new period; `NEVER` is off, None is the default."""
        self._chosen.discard(number) if period is None else self._chosen.add(number)
        self._set(number, period, now)

    def follow(self, number: int, period: Nanoseconds, now: Nanoseconds) -> None:
        """Take the new period of all places for this message, unless another one was requested here."""
        if number not in self._chosen:
            self._set(number, period, now)

    def _set(self, number: int, period: Nanoseconds | None, now: Nanoseconds) -> None:
        for index, its_number in enumerate(self._numbers):
            if its_number == number:
                wanted = self._defaults[index] if period is None else period
                self._periods[index] = wanted
                self._due[index] = NEVER if wanted == NEVER else now
