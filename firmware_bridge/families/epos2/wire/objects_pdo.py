"""Objects of the four receive and four transmit PDOs, 0x1400 to 0x1A03: regular, hence computed.

Source: maxon EDS for the EPOS2 70/10, software 2126h, which gives every default.
"""

from collections.abc import Iterator
from typing import Final

from firmware_bridge.canopen.cia301 import COB_ID_INVALID, COB_ID_NO_REMOTE, RECEIVE_PDO, TRANSMIT_PDO
from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.canopen.pdo import (
    MAX_ENTRIES,
    ON_CHANGE,
    RECEIVE_MAPPING,
    RECEIVE_PARAMETER,
    TRANSMIT_MAPPING,
    TRANSMIT_PARAMETER,
)
from firmware_bridge.families.epos2.wire.rows import count, row

PDOS: Final = 4
"""Of each direction."""

INHIBIT: Final = 10
"""Units of 100 us."""

_RW: Final = Access.RW
_RECEIVE_DEFAULTS: Final = (
    (0x6040_0010,),
    (0x6040_0010, 0x6060_0008),
    (0x6040_0010, 0x607A_0020),
    (0x6040_0010, 0x60FF_0020),
)
_TRANSMIT_DEFAULTS: Final = (
    (0x6041_0010,),
    (0x6041_0010, 0x6061_0008),
    (0x6041_0010, 0x6064_0020),
    (0x6041_0010, 0x606C_0020),
)
_TRANSMIT_FLAGS: Final = (COB_ID_NO_REMOTE, *[COB_ID_INVALID | COB_ID_NO_REMOTE] * (PDOS - 1))


def _parameter(index: int, title: str, cob_id: int, entries: int) -> Iterator[ObjectRow]:
    yield count(index, entries, name=f"{title} Parameter: Largest Sub-Index")
    yield row(index, 1, f"COB-ID of {title}", DataType.UNSIGNED32, _RW, default=cob_id, node=True)
    yield row(index, 2, f"Transmission Type of {title}", DataType.UNSIGNED8, _RW, default=ON_CHANGE)


def _mapping(index: int, title: str, mapped: tuple[int, ...]) -> Iterator[ObjectRow]:
    name = f"Number of Objects Mapped in {title}"
    yield row(index, 0, name, DataType.UNSIGNED8, _RW, default=len(mapped), low=0, high=MAX_ENTRIES)
    padded = mapped + (0,) * (MAX_ENTRIES - len(mapped))
    for place, word in enumerate(padded, start=1):
        yield row(index, place, f"Mapped Object {place} in {title}", DataType.UNSIGNED32, _RW, default=word)


def _rows() -> Iterator[ObjectRow]:
    for number in range(PDOS):
        title = f"Receive PDO {number + 1}"
        yield from _parameter(RECEIVE_PARAMETER + number, title, RECEIVE_PDO[number], entries=2)
        yield from _mapping(RECEIVE_MAPPING + number, title, _RECEIVE_DEFAULTS[number])
    for number in range(PDOS):
        title = f"Transmit PDO {number + 1}"
        index = TRANSMIT_PARAMETER + number
        yield from _parameter(index, title, TRANSMIT_PDO[number] | _TRANSMIT_FLAGS[number], entries=3)
        inhibit = f"Inhibit Time of {title}"
        yield row(index, 3, inhibit, DataType.UNSIGNED16, _RW, default=INHIBIT, unit="100 us")
        yield from _mapping(TRANSMIT_MAPPING + number, title, _TRANSMIT_DEFAULTS[number])


PROCESS_OBJECTS: Final[tuple[ObjectRow, ...]] = tuple(_rows())
