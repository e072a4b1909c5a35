"""Saved parameters of emulated CANopen devices: a file for each, replaced as a whole or not at all.

Not known here: what the parameters do. The file is JSON, for people to read, and to edit with care.
"""

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from emulators.canopen.saved_parameters import Storage, StorageError, Volatile
from firmware_bridge.canopen.address import Address

HEX: Final = 16


def storage_in(folder: Path | None, node: int, product: str) -> Storage:
    """Return what keeps a node's parameters: a file of its own in the folder; without one it forgets them."""
    # A file for each node: two devices of one bus never share a copy.
    return Volatile() if folder is None else ParameterFile(folder / f"node-{node}.json", product)


@dataclass(frozen=True, slots=True)
class Storages:
    """What keeps the parameters of a robot's devices, by axis; a device without comes new, and forgets."""

    by_axis: Mapping[str, Storage]


class Commissioned:
    """The copy of a drive that someone has set up: these values, until one is saved."""

    def __init__(self, values: Mapping[Address, int], kept: Storage) -> None:
        self._values = dict(values)
        self._kept = kept

    def read(self) -> Mapping[Address, int]:
        """Return what was saved, else what the drive was set up with; StorageError."""
        # An empty copy is one that was never saved, or was given up by 'load'.
        return self._kept.read() or self._values

    def write(self, values: Mapping[Address, int]) -> None:
        """Keep a copy; StorageError."""
        self._kept.write(values)


class ParameterFile:
    """The copy that one device keeps on disk.

    A new copy is written beside the old one, brought to the disk, and renamed over it: a process killed under
    way leaves the old copy behind, whole, and a file `*.new` that the next write replaces.
    """

    def __init__(self, path: Path, product: str) -> None:
        """Take a path; a file of another product is refused."""
        self.path: Final = path
        self._format: Final = f"{product} parameters 1"

    def read(self) -> dict[Address, int]:
        """Return the values in the file; none without a file. StorageError for what is no such file."""
        try:
            found = json.loads(self.path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return {}
        except (OSError, ValueError) as error:
            raise StorageError(f"cannot read the saved parameters in {self.path}: {error}") from error
        return self._decoded(found)

    def write(self, values: Mapping[Address, int]) -> None:
        """Replace the file; StorageError, and the file as it was, where that fails."""
        text = json.dumps(
            {
                "format": self._format,
                "values": {str(address): value for address, value in values.items()},
            },
            indent=1,
        )
        fresh = self.path.with_name(self.path.name + ".new")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with fresh.open("w", encoding="utf-8") as file:
                file.write(text + "\n")
                file.flush()
                # Before the renaming: else a loss of power may leave the new name on an empty file.
                os.fsync(file.fileno())
            # Atomic within one file system: a reader sees the old copy or the new one.
            fresh.replace(self.path)
            _to_disk(self.path.parent)
        except OSError as error:
            raise StorageError(f"cannot save the parameters to {self.path}: {error}") from error

    def _decoded(self, found: Any) -> dict[Address, int]:
        if not isinstance(found, dict) or found.get("format") != self._format:
            raise StorageError(
                f"{self.path} is no file of saved parameters: it does not say '{self._format}'"
            )
        values: dict[Address, int] = {}
        for name, value in found.get("values", {}).items():
            index, _, subindex = name.partition(":")
            try:
                values[Address(int(index, HEX), int(subindex or "0", HEX))] = int(value)
            except (ValueError, TypeError):
                raise StorageError(f"{self.path}: '{name}': {value!r} is no object with a number") from None
        return values


def _to_disk(folder: Path) -> None:
    """Write the renaming itself to the disk."""
    # Not every system lets a folder be opened; the file itself is safe by then.
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
