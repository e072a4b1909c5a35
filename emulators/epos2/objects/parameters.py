"""The EPOS2's parameters: what is stored by 0x1010, and what 0x1011 brings back beside all of them.

Sources: EPOS Firmware Specification (by analogy), EDS. Where they are silent: the factory's own values
(0x1011:4) are the defaults; a COB-ID that was saved stays as it is when the node's number changes, which is
what 0x1011:5 is for; 0x1011:4 and 0x1011:5 read as 0x1011:1 does.
"""

from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.product import RESTORE_ALL, Product
from emulators.canopen.saved_parameters import LOAD, ON_COMMAND, check_signature
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.canopen.pdo import RECEIVE_PARAMETER, TRANSMIT_PARAMETER
from firmware_bridge.families.epos2.wire.objects_pdo import PDOS

RESTORE_FACTORY: Final = Address(0x1011, 4)
RESTORE_COB_IDS: Final = Address(0x1011, 5)
RESTORE_COMMANDS: Final = (RESTORE_ALL, RESTORE_FACTORY)

VOLATILE_INDEXES: Final = frozenset(
    {0x1003, 0x1010, 0x1011, 0x1013, 0x2010, 0x2023, 0x2025, 0x2026, 0x2030, 0x2062, 0x206B}
    | {0x20C1, 0x2400, 0x2410, 0x2FFF, 0x6040, 0x607A, 0x60C4, 0x60FF}
)
"""Commands, set values and diagnosis: writable, but no parameters (assumed)."""
VOLATILE: Final = frozenset({Address(0x2074, 4), Address(0x2078, 1)})


def is_parameter(row: ObjectRow) -> bool:
    """Return True if an object is stored by 'save'."""
    return row.access.writable and row.address.index not in VOLATILE_INDEXES and row.address not in VOLATILE


def restore_cob_ids(store: ObjectStore, product: Product) -> None:
    """Make the store's 0x1011:5 bring the COB-IDs of the PDOs back to their defaults."""

    def restore(signature: int) -> None:
        # Effective after save and reset: the objects change, the PDOs that are at work do not.
        check_signature(signature, LOAD, product)
        for first in (RECEIVE_PARAMETER, TRANSMIT_PARAMETER):
            for index in range(first, first + PDOS):
                store.load_default(Address(index, 1))

    store.on_write(RESTORE_COB_IDS, restore)
    store.on_read(RESTORE_COB_IDS, lambda: ON_COMMAND)
