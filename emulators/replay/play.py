"""Replay of a recording in virtual time, until a packet differs from it or it ends."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

from emulators.replay.comparison import first, in_words
from emulators.replay.order import Into, ReplayOrder
from emulators.replay.recordings import is_lines, is_telemetry
from emulators.replay.stages import STAGES
from firmware_bridge.units import MILLISECOND, Nanoseconds

SLICE: Final[Nanoseconds] = 250 * MILLISECOND
"""Simulated time between two looks at the differences."""

Progress: TypeAlias = Callable[[Nanoseconds, Nanoseconds], None]
"""Callback with the progress of the replay, and its end."""


@dataclass(frozen=True, slots=True)
class ReplayResult:
    """Result of a replay."""

    into: Into
    played: int
    """Packets of the recording that were put on the links."""
    compared: int
    """Packets that came as they were recorded."""
    until: Nanoseconds
    """The end of the recording, or the first difference."""
    difference: str | None
    """The first difference as text; None where there is none."""


def replay(order: ReplayOrder, progress: Progress = lambda _now, _end: None) -> ReplayResult:
    """Play a recording; RecordingFileError where a file cannot be used, PlantError where the plant cannot."""
    into = order.into or _suitable(order)
    stage = STAGES[into](order)
    now = 0
    try:
        while True:
            now = min(now + SLICE, stage.end)
            stage.run(now)
            progress(now, stage.end)
            difference = first(stage.comparisons, now)
            if difference is not None or now == stage.end:
                break
    finally:
        stage.finish()
    compared = sum(one.compared for one in stage.comparisons)
    if difference is None:
        return ReplayResult(into, stage.played, compared, stage.end - stage.lead, None)
    words = in_words(difference, stage.recorded, stage.lead, stage.kinds)
    return ReplayResult(into, stage.played, compared, difference.at - stage.lead, words)


def _suitable(order: ReplayOrder) -> Into:
    """Return what a recording suits: the folder of a run, and what lines have carried, the bridge."""
    if is_telemetry(order.recording):
        return Into.BENCH
    whole = order.operator is not None or order.recording.is_dir() or is_lines(order.recording)
    return Into.BRIDGE if whole else Into.DRIVES
