"""Parameters that survive a restart: 0x1010 stores them, 0x1011 brings the defaults back.

Source: CiA 301 v4.02. 'load' gives up the saved copy: the defaults count from the reset of the node or the
restart that follows, and until then all stays as it is. Where the copy is kept is up to the `Storage` that
the device is given. Where it is silent: a save takes no time of its own.
"""

from collections.abc import Iterator, Mapping
from typing import Final, Protocol

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.product import RESTORE_ALL, Product
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_row import ObjectRow

SAVE: Final = int.from_bytes(b"save", "little")
LOAD: Final = int.from_bytes(b"load", "little")
STORE_ALL: Final = Address(0x1010, 1)
COMMUNICATION: Final = range(0x1000, 0x2000)
ON_COMMAND: Final = 1
"""Value of 0x1010 and 0x1011, bit 0: stores, or restores, on command, and not by itself (CiA 301)."""


def check_signature(signature: int, expected: int, product: Product) -> None:
    """Refuse a command whose value is not its signature; SdoAbort."""
    if signature != expected:
        raise SdoAbort(product.wrong_signature)


class StorageError(Exception):
    """The copy cannot be kept, or what is kept cannot be read."""


class Storage(Protocol):
    """Storage of one device for the copy of its parameters."""

    def read(self) -> Mapping[Address, int]:
        """Return what was written last; empty where nothing was. StorageError where it cannot be read."""

    def write(self, values: Mapping[Address, int]) -> None:
        """Keep a copy: all of it, or, when that fails with StorageError, the one before."""


class Volatile:
    """Storage that keeps the copy for the lifetime of the emulated device."""

    def __init__(self) -> None:
        self._values: Mapping[Address, int] = {}

    def read(self) -> Mapping[Address, int]:
        """Return what was written last."""
        return self._values

    def write(self, values: Mapping[Address, int]) -> None:
        """Keep a copy."""
        self._values = dict(values)


class SavedParameters:
    """The saved parameters of one device."""

    def __init__(self, store: ObjectStore, product: Product, storage: Storage) -> None:
        """Attach to the store."""
        self._store = store
        self._product = product
        self._storage = storage
        self._saved = self._fitting(storage.read())
        self.lost = False
        """The copy could not be read at the last restart: every parameter has its default."""
        store.on_write(STORE_ALL, self._save)
        for command in product.restore_commands:
            store.on_write(command, self._restore)
        for command in (STORE_ALL, *product.restore_commands):
            store.on_read(command, lambda: ON_COMMAND)

    def _fitting(self, values: Mapping[Address, int]) -> dict[Address, int]:
        """Return the values that are parameters of this device; refuse others, as of an edited copy."""
        parameters = {row.address: row.type for row, _ in self._parameters()}
        for address, value in values.items():
            kind = parameters.get(address)
            if kind is None or not kind.lowest <= value <= kind.highest:
                raise StorageError(f"{address} = {value} is no saved parameter of the {self._product.name}")
        return dict(values)

    def _parameters(self) -> Iterator[tuple[ObjectRow, int]]:
        return ((row, value) for row, value in self._store.numbers() if self._product.is_parameter(row))

    def saved(self, address: Address) -> int:
        """Return an object's value of power-on: saved, else default."""
        default = self._store.default(address)
        return self._saved.get(address, default if isinstance(default, int) else 0)

    def save(self, changes: Mapping[Address, int] | None = None) -> None:
        """Keep every parameter, or only `changes` beside what was kept; SdoAbort where that fails."""
        if changes is None:
            values = {row.address: value for row, value in self._parameters()}
        else:
            values = {**self._saved, **changes}
        self._keep(values, STORE_ALL)

    def _keep(self, values: Mapping[Address, int], command: Address) -> None:
        try:
            self._storage.write(values)
        except StorageError:
            # `_saved` stays as it was: so does the copy, by the contract of `Storage.write`.
            raise SdoAbort(AbortCode.HARDWARE, command) from None
        self._saved = dict(values)

    def load(self) -> None:
        """Give every object its value of power-on: saved, else default.

        Where the copy can no longer be read, it is given up, and `lost` until the next restart.
        """
        try:
            # The values are those of the last save; the read only shows whether the memory still works.
            self._storage.read()
        except StorageError:
            self.lost, self._saved = True, {}
        else:
            self.lost = False
        for row, _ in self._store.numbers():
            self._load(row)

    def load_communication(self) -> None:
        """Give the communication parameters their values of power-on."""
        for row, _ in self._parameters():
            if row.address.index in COMMUNICATION:
                self._load(row)

    def _load(self, row: ObjectRow) -> None:
        saved = self._saved.get(row.address)
        if saved is None:
            self._store.load_default(row.address)
        else:
            self._store.set(row.address, saved)

    def _save(self, signature: int) -> None:
        check_signature(signature, SAVE, self._product)
        self.save()

    def _restore(self, signature: int) -> None:
        check_signature(signature, LOAD, self._product)
        refused_by = self._product.restore_refused_by
        if refused_by and self._store.live(od.STATUSWORD) & refused_by:
            raise SdoAbort(AbortCode.DEVICE_STATE, RESTORE_ALL)
        self._keep({}, RESTORE_ALL)
