"""What a test's wires have carried, kept in memory until somebody wants it in files."""

from io import BytesIO, StringIO
from pathlib import Path
from typing import Final, TypeAlias

from emulators.recorded import CHUNKS, FRAMES, WORDS, record
from emulators.rig import Rig

Mark: TypeAlias = tuple[int, int, int]
SAMPLES: Final = "samples.csv"


class Recording:
    """One test's recording from the moment at which the robot was switched on."""

    def __init__(self, rig: Rig) -> None:
        self._rig: Final = rig
        self._frames: Final = StringIO()
        self._chunks: Final = StringIO()
        self._words: Final = BytesIO()
        record(rig, self._frames, self._chunks, self._words)

    @property
    def frames(self) -> tuple[str, ...]:
        """The frames on the buses, each as a line of candump."""
        return tuple(self._frames.getvalue().splitlines())

    @property
    def chunks(self) -> tuple[str, ...]:
        """The bytes on the serial lines, a line for each chunk."""
        return tuple(self._chunks.getvalue().splitlines())

    def keep(self, folder: Path) -> list[Path]:
        """Write it into a folder, with the table of samples, and return the files; what is empty is none.

        OSError where that cannot be written.
        """
        texts = {
            FRAMES: self._frames.getvalue(),
            CHUNKS: self._chunks.getvalue(),
            SAMPLES: self._rig.samples.csv() if self._rig.samples else "",
        }
        content = {name: text.encode("ascii") for name, text in texts.items()}
        content[WORDS] = self._words.getvalue()
        folder.mkdir(parents=True, exist_ok=True)
        written = []
        for name, data in content.items():
            if data:
                (folder / name).write_bytes(data)
                written.append(folder / name)
        return written

    def mark(self) -> Mark:
        """Return how long it is."""
        return self._frames.tell(), self._chunks.tell(), self._words.tell()

    def cut(self, mark: Mark) -> None:
        """Forget what came after."""
        for file, end in zip((self._frames, self._chunks, self._words), mark, strict=True):
            file.seek(end)
            file.truncate()
