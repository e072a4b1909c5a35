"""When each stream of telemetry is due, and how stations change that; it knows nothing of what is told."""

from firmware_bridge.teleop.telemetry import STREAMS, Stream
from firmware_bridge.units import NEVER, Nanoseconds


class Schedule:
    """Which streams are due; each keeps to the grid of its period: a late report shifts no later one."""

    __slots__ = ("_due", "_early", "_periods")

    def __init__(self, cycle: Nanoseconds) -> None:
        self._early = (
            cycle // 4
        )  # reports come once a cycle and jitter: rather a little early than a cycle late
        self._periods = [stream.period for stream in STREAMS]
        self._due: list[Nanoseconds] = [0] * len(STREAMS)

    @property
    def next_due(self) -> Nanoseconds:
        """The instant at which the next message is due."""
        return min(self._due)

    def due(self, now: Nanoseconds) -> list[Stream]:
        """Return the streams that are due now, and plan them anew."""
        reached = now + self._early
        ready: list[Stream] = []
        for index, due in enumerate(self._due):
            if due <= reached:
                ready.append(STREAMS[index])
                following = due + self._periods[index]
                self._due[index] = following if following > now else now + self._periods[index]
        return ready

    def period(self, number: int) -> Nanoseconds | None:
        """Return a message's shortest period; `NEVER` where it is off, None where it is no stream."""
        return min(
            (p for s, p in zip(STREAMS, self._periods, strict=True) if s.number == number), default=None
        )

    def change(self, number: int, period: Nanoseconds | None, now: Nanoseconds) -> None:
        """Give every stream of this message a new period; `NEVER` is off, None is the default."""
        for index, stream in enumerate(STREAMS):
            if stream.number == number:
                self._periods[index] = stream.period if period is None else period
                self._due[index] = NEVER if period == NEVER else now
