"""Saved parameters of emulated drives in files: one file for each drive, replaced as a whole or not at all.

Not known here: what the parameters do. The file is JSON, for people to read, and to edit with care.
"""

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from emulators.canopen.saved_parameters import Storage, StorageError
from firmware_bridge.canopen.address import Address

FORMAT: Final = "EPOS2 parameters 1"
HEX: Final = 16


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
    """The copy that one drive keeps on disk.

    A new copy is written beside the old one, brought to the disk, and renamed over it: a process killed under
    way leaves the old copy behind, whole, and a file `*.new` that the next write replaces.
    """

    def __init__(self, path: Path) -> None:
        self.path: Final = path

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
            {"format": FORMAT, "values": {str(address): value for address, value in values.items()}}, indent=1
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
        if not isinstance(found, dict) or found.get("format") != FORMAT:
            raise StorageError(f"{self.path} is no file of saved parameters: it does not say '{FORMAT}'")
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
