"""A recording in MCAP as the folder of a run, which a replay into the bridge reads.

Instants count from the start of the run, as the bench's own do: MCAP has no date.
"""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from emulators.recorded import CHUNKS, FRAMES, SIGHTS, WORDS
from emulators.replay.recordings import RecordingFileError
from firmware_bridge.node import OPERATOR
from firmware_bridge.recording import RecordingError, candump_line, chunk_line, tlog_records
from firmware_bridge.runtime.can_files import mcap_reader
from firmware_bridge.runtime.run_file import RUN_FILE
from firmware_bridge.wire.can import ERROR


@contextmanager
def unpacked(path: Path, note: Callable[[str], None]) -> Iterator[Path]:
    """Give the files of a recording in MCAP in a folder of their own, which is gone at the end.

    `note` takes remarks on a recording that is read all the same. RecordingFileError, also for a recording
    that lacks what a bridge receives.
    """
    with TemporaryDirectory(prefix="firmware-bridge-") as place:
        folder = Path(place)
        try:
            _write(path, folder, note)
        except RecordingError as error:
            raise RecordingFileError(f"{path}: {error}") from None
        except OSError as error:
            raise RecordingFileError(f"{path}: cannot be read: {error.strerror}") from None
        written = {file.name for file in folder.iterdir() if file.stat().st_size}
        missing = "" if written & {FRAMES, CHUNKS} else "frames and no bytes of serial lines"
        missing = missing or ("" if WORDS in written else "messages of an operator's link")
        if missing:
            raise RecordingFileError(f"{path}: has no {missing}; record it with `bench` or `drive`")
        try:
            yield folder
        except RecordingFileError as error:
            # The folder is no place that the user knows.
            text = str(error).replace(str(folder), str(path)).replace(folder.name, path.name)
            raise RecordingFileError(text) from None


def _write(path: Path, folder: Path, note: Callable[[str], None]) -> None:
    reader = mcap_reader()
    frames = (
        f"{candump_line(at, packet, bus)}\n".encode()
        for at, bus, packet in reader.frames(path, note)
        if not packet.address & ERROR
    )
    _put(folder / FRAMES, frames)
    chunks = (
        f"{chunk_line(at, packet.link, direction, packet)}\n".encode()
        for at, direction, packet in reader.chunks(path, _unnoted)
    )
    _put(folder / CHUNKS, chunks)
    with (folder / WORDS).open("wb") as words, (folder / SIGHTS).open("wb") as sights:
        for at, direction, packet in reader.datagrams(path, _unnoted):
            if packet.link == OPERATOR:
                words.write(tlog_records(at, packet.payload))
            else:
                sights.write(f"{chunk_line(at, packet.link, direction, packet)}\n".encode())
    attached = reader.attachments(path)
    if RUN_FILE in attached:
        (folder / RUN_FILE).write_bytes(attached[RUN_FILE])


def _put(file: Path, lines: Iterable[bytes]) -> None:
    with file.open("wb") as opened:
        opened.writelines(lines)


def _unnoted(_remark: str) -> None:
    """Take no notice: it was reported with the frames."""
