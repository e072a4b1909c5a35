"""Files of a recording: one that was named, or those in the folder of a run."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from emulators.recorded import CHUNKS, FRAMES, SIGHTS, WORDS
from emulators.replay.order import ReplayOrder
from emulators.replay.recordings import RecordingFileError, is_lines, is_telemetry

PACKED: Final = ("", ".gz", ".xz")


@dataclass(frozen=True, slots=True)
class Files:
    """Files by their contents; None for a missing one."""

    frames: Path | None = None
    """File of CAN buses."""
    chunks: Path | None = None
    """File of serial lines."""
    sights: Path | None = None
    """File of cameras."""
    words: Path | None = None
    """File of the operator."""


def files_of(order: ReplayOrder) -> Files:
    """Return the files with the bridge's input; RecordingFileError for a telemetry log alone."""
    named = order.recording
    if named.is_dir():
        words = order.operator or within(named, WORDS)
        return Files(within(named, FRAMES), within(named, CHUNKS), within(named, SIGHTS), words)
    if is_telemetry(named):
        raise RecordingFileError(
            f"{named.name}: a telemetry log is played into the bench; give a CAN log, and this one"
            " beside it with --operator"
        )
    if is_lines(named):
        return Files(chunks=named, words=order.operator)
    return Files(frames=named, words=order.operator)


def named(order: ReplayOrder) -> tuple[Path, ...]:
    """Return every file that is there of a recording."""
    folder = order.recording
    parts = [folder]
    if folder.is_dir():
        parts = [
            file for name in (FRAMES, CHUNKS, SIGHTS, WORDS) if (file := within(folder, name)) is not None
        ]
    beside = [] if order.operator is None else [order.operator]
    return tuple(file for file in (*parts, *beside) if file.is_file())


def within(folder: Path, name: str) -> Path | None:
    """Return a run's file of this name, packed or not; None where there is none, or it is empty."""
    found = (folder / f"{name}{packed}" for packed in PACKED)
    return next((file for file in found if file.is_file() and file.stat().st_size), None)


def one_file(order: ReplayOrder, name: str) -> Path:
    """Return the file that was named, or the run's of this name; RecordingFileError."""
    if not order.recording.is_dir():
        return order.recording
    file = within(order.recording, name)
    if file is None:
        raise RecordingFileError(f"{order.recording}: holds no {name}, or an empty one")
    return file
