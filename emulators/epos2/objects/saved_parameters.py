"""Parameters that survive a restart: 0x1010 stores them, 0x1011 brings the defaults back.

Sources: CiA 301 v4.02, EPOS Firmware Specification (by analogy), EDS. 'load' gives up the saved copy: the
defaults count from the reset of the node or the restart that follows, and until then all stays as it is
(CiA 301). Where the copy is kept is up to the `Storage` that the drive is given. Where the sources are
silent: the factory's own values (0x1011:4) are the defaults; a save takes no time of its own; a COB-ID that
was saved stays as it is when the node's number changes, which is what 0x1011:5 is for; 0x1011:4 and
0x1011:5 read as 0x1011:1 does.
"""

from collections.abc import Mapping
from typing import Final, Protocol

from emulators.epos2.objects.device_profile import DeviceProfile
from emulators.epos2.objects.store import ObjectStore
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.wire.epos2.objects_pdo import PDOS, RECEIVE_PARAMETER, TRANSMIT_PARAMETER

SAVE: Final = int.from_bytes(b"save", "little")
LOAD: Final = int.from_bytes(b"load", "little")
STORE_ALL: Final = Address(0x1010, 1)
RESTORE_ALL: Final = Address(0x1011, 1)
RESTORE_FACTORY: Final = Address(0x1011, 4)
RESTORE_COB_IDS: Final = Address(0x1011, 5)
COMMUNICATION: Final = range(0x1000, 0x2000)
ON_COMMAND: Final = 1
"""Value of 0x1010 and 0x1011, bit 0: stores, or restores, on command, and not by itself (CiA 301)."""
POWER_STAGE: Final = 1 << 4
"""Statusword bit."""

VOLATILE_INDEXES: Final = frozenset(
    {0x1003, 0x1010, 0x1011, 0x1013, 0x2010, 0x2023, 0x2025, 0x2026, 0x2030, 0x2062, 0x206B}
    | {0x20C1, 0x2400, 0x2410, 0x2FFF, 0x6040, 0x607A, 0x60C4, 0x60FF}
)
"""Commands, set values and diagnosis: writable, but no parameters (assumed)."""
VOLATILE: Final = frozenset({Address(0x2074, 4), Address(0x2078, 1)})


def is_parameter(row: ObjectRow) -> bool:
    """Return True if an object is stored by 'save'."""
    return row.access.writable and row.address.index not in VOLATILE_INDEXES and row.address not in VOLATILE


class StorageError(Exception):
    """The copy cannot be kept, or what is kept cannot be read."""


class Storage(Protocol):
    """Storage of one drive for the copy of its parameters."""

    def read(self) -> Mapping[Address, int]:
        """Return what was written last; empty where nothing was. StorageError where it cannot be read."""

    def write(self, values: Mapping[Address, int]) -> None:
        """Keep a copy: all of it, or, when that fails with StorageError, the one before."""


class Volatile:
    """Storage that keeps the copy for the lifetime of the emulated drive."""

    def __init__(self) -> None:
        self._values: Mapping[Address, int] = {}

    def read(self) -> Mapping[Address, int]:
        """Return what was written last."""
        return self._values

    def write(self, values: Mapping[Address, int]) -> None:
        """Keep a copy."""
        self._values = dict(values)


class SavedParameters:
    """The saved parameters of one drive."""

    def __init__(self, store: ObjectStore, profile: DeviceProfile, storage: Storage) -> None:
        """Attach to the store."""
        self._store = store
        self._wrong_signature = profile.wrong_signature
        self._storage = storage
        self._saved = self._fitting(storage.read())
        self.lost = False
        """The copy could not be read at the last restart: every parameter has its default."""
        store.on_write(STORE_ALL, self._save)
        store.on_write(RESTORE_ALL, self._restore)
        store.on_write(RESTORE_FACTORY, self._restore)
        store.on_write(RESTORE_COB_IDS, self._restore_cob_ids)
        for command in (STORE_ALL, RESTORE_ALL, RESTORE_FACTORY, RESTORE_COB_IDS):
            store.on_read(command, lambda: ON_COMMAND)

    def _fitting(self, values: Mapping[Address, int]) -> dict[Address, int]:
        """Return the values that are parameters of this drive; refuse others, as of an edited copy."""
        parameters = {row.address: row.type for row, _ in self._store.numbers() if is_parameter(row)}
        for address, value in values.items():
            kind = parameters.get(address)
            if kind is None or not kind.lowest <= value <= kind.highest:
                raise StorageError(f"{address} = {value} is no saved parameter of an EPOS2")
        return dict(values)

    def saved(self, address: Address) -> int:
        """Return an object's value of power-on: saved, else default."""
        default = self._store.default(address)
        return self._saved.get(address, default if isinstance(default, int) else 0)

    def save(self, changes: Mapping[Address, int] | None = None) -> None:
        """Keep every parameter, or only `changes` beside what was kept; SdoAbort where that fails."""
        if changes is None:
            values = {row.address: value for row, value in self._store.numbers() if is_parameter(row)}
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

        Where the copy can no longer be read, it is given up (assumed: that is an internal software error).
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
        for row, _ in self._store.numbers():
            if row.address.index in COMMUNICATION and is_parameter(row):
                self._load(row)

    def _load(self, row: ObjectRow) -> None:
        saved = self._saved.get(row.address)
        if saved is None:
            self._store.load_default(row.address)
        else:
            self._store.set(row.address, saved)

    def _save(self, signature: int) -> None:
        self._check(signature, SAVE, STORE_ALL)
        self.save()

    def _restore(self, signature: int) -> None:
        self._check(signature, LOAD, RESTORE_ALL)
        if self._store.live(od.STATUSWORD) & POWER_STAGE:
            raise SdoAbort(AbortCode.DEVICE_STATE, RESTORE_ALL)
        self._keep({}, RESTORE_ALL)

    def _restore_cob_ids(self, signature: int) -> None:
        # Effective after save and reset: the objects change, the PDOs that are at work do not.
        self._check(signature, LOAD, RESTORE_COB_IDS)
        for first in (RECEIVE_PARAMETER, TRANSMIT_PARAMETER):
            for index in range(first, first + PDOS):
                self._store.load_default(Address(index, 1))

    def _check(self, signature: int, wanted: int, address: Address) -> None:
        if signature != wanted:
            raise SdoAbort(self._wrong_signature, address)
