"""Recording of a test's wires, kept in memory until it is written to files."""

from io import BytesIO
from pathlib import Path
from typing import Final, TypeAlias

from emulators.recorded import CHUNKS, FILES, FRAMES, recorded_wires
from emulators.rig import Rig
from emulators.wires.ends import Observer
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds

SAMPLES: Final = "samples.csv"

Carried: TypeAlias = tuple[int, Nanoseconds, str, Packet]
"""The wire's number, when the packet had arrived, who sent it."""


class Recording:
    """One test's recording from the moment at which the robot was switched on.

    The packets are kept as they are; most tests are green, and no one reads a line of theirs.
    """

    def __init__(self, rig: Rig) -> None:
        self._rig: Final = rig
        self._carried: Final[list[Carried]] = []
        for number, (wire, _) in enumerate(recorded_wires(rig, _empty())):
            wire.observe(self._noting(number))

    @property
    def frames(self) -> tuple[str, ...]:
        """The frames on the buses, each as a line of candump."""
        return tuple(self._written()[FRAMES].decode().splitlines())

    @property
    def chunks(self) -> tuple[str, ...]:
        """The bytes on the serial lines, a line for each chunk."""
        return tuple(self._written()[CHUNKS].decode().splitlines())

    def keep(self, folder: Path) -> list[Path]:
        """Write it into a folder, with the table of samples, and return the files; what is empty is none.

        OSError where that cannot be written.
        """
        content = {**self._written(), SAMPLES: self._rig.samples.csv().encode("ascii")}
        folder.mkdir(parents=True, exist_ok=True)
        kept = []
        for name, data in content.items():
            if data:
                (folder / name).write_bytes(data)
                kept.append(folder / name)
        return kept

    def mark(self) -> int:
        """Return how long it is."""
        return len(self._carried)

    def cut(self, mark: int) -> None:
        """Forget what came after."""
        # In place: the observers hold this list's `append`.
        self._carried[mark:] = []

    def _noting(self, number: int) -> Observer:
        note = self._carried.append
        return lambda now, sender, packet: note((number, now, sender, packet))

    def _written(self) -> dict[str, bytes]:
        """Return each file's content."""
        files = _empty()
        writers = [observer for _, observer in recorded_wires(self._rig, files)]
        for number, now, sender, packet in self._carried:
            writers[number](now, sender, packet)
        return {name: file.getvalue() for name, file in files.items()}


def _empty() -> dict[str, BytesIO]:
    return {name: BytesIO() for name in FILES}
