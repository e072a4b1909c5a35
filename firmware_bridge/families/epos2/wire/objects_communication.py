"""Objects of the communication profile, 0x1000 to 0x1FFF, without the PDOs.

Source: maxon EDS for the EPOS2 70/10, software 2126h; `read` is the value in a real device where it has none.
"""

from typing import Final

from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.epos2.wire.rows import count, row

_CONST: Final = Access.CONST
_RO: Final = Access.RO
_RW: Final = Access.RW
_RWW: Final = Access.RWW
_U8: Final = DataType.UNSIGNED8
_U16: Final = DataType.UNSIGNED16
_U32: Final = DataType.UNSIGNED32
_TEXT: Final = DataType.VISIBLE_STRING

COMMUNICATION: Final[tuple[ObjectRow, ...]] = (
    row(0x1000, 0, "Device Type", _U32, _RO, read=0x00020192),
    row(0x1001, 0, "Error Register", _U8, _RO, read=0x00),
    row(0x1003, 0, "Number of Errors", _U8, _RW, default=0, note="0 clears the history"),
    row(0x1003, 1, "Error History (1)", _U32, _RO, read=0x00000000),
    row(0x1003, 2, "Error History (2)", _U32, _RO, read=0x00000000),
    row(0x1003, 3, "Error History (3)", _U32, _RO, read=0x00000000),
    row(0x1003, 4, "Error History (4)", _U32, _RO, read=0x00000000),
    row(0x1003, 5, "Error History (5)", _U32, _RO, read=0x00000000),
    row(0x1005, 0, "COB-ID SYNC", _U32, _RW, default=0x80, low=0x80, high=0x80),
    row(0x1008, 0, "Manufacturer Device Name", _TEXT, _CONST, read=b"EPOS2"),
    row(0x100C, 0, "Guard Time", _U16, _RW, default=0, unit="ms"),
    row(0x100D, 0, "Lifetime Factor", _U8, _RW, default=0),
    count(0x1010, 1, name="Store Parameters: Largest Sub-Index"),
    row(0x1010, 1, "Save All Parameters", _U32, _RW, standard=1, note="'save'"),
    count(0x1011, 5, name="Restore Default Parameters: Largest Sub-Index"),
    row(0x1011, 1, "Restore All Default Parameters", _U32, _RW, standard=1, note="'load', power stage off"),
    row(0x1011, 4, "Restore Factory Default Parameters", _U32, _RW, standard=1, note="factory values"),
    row(
        0x1011, 5, "Restore Default PDO COB-IDs", _U32, _RW, standard=1, note="effective after save and reset"
    ),
    row(0x1012, 0, "COB-ID Time Stamp Object", _U32, _RW, default=0x0100),
    row(0x1013, 0, "High Resolution Time Stamp", _U32, _RWW, read=0x00000000, unit="us", mapped=True),
    row(0x1014, 0, "COB-ID EMCY", _U32, _RW, default=0x80, node=True),
    count(0x1016, 2, name="Consumer Heartbeat Time: Number of Entries"),
    row(0x1016, 1, "Consumer 1 Heartbeat Time", _U32, _RW, default=0, unit="ms + node << 16"),
    row(0x1016, 2, "Consumer 2 Heartbeat Time", _U32, _RW, default=0, unit="ms + node << 16"),
    row(0x1017, 0, "Producer Heartbeat Time", _U16, _RW, default=0, unit="ms"),
    count(0x1018, 4, name="Identity Object: Number of Entries"),
    row(0x1018, 1, "Vendor ID", _U32, _RO, read=0x000000FB),
    row(0x1018, 2, "Product Code", _U32, _RO, read=0x64200000),
    row(0x1018, 3, "Revision Number", _U32, _RO, read=0x21260000),
    row(0x1018, 4, "Serial Number", _U32, _RO, read=0x80015954),
    count(0x1020, 2, name="Verify configuration: Number of Entries"),
    row(0x1020, 1, "Configuration Date", _U32, _RW, read=0x00000000),
    row(0x1020, 2, "Configuration Time", _U32, _RW, read=0x00000000),
    count(0x1200, 2, name="SDO Server Parameter: Number of Entries"),
    row(0x1200, 1, "SDO COB-ID Client->Server (rx)", _U32, _RO, default=0x600, node=True),
    row(0x1200, 2, "SDO COB-ID Server->Client (tx)", _U32, _RO, default=0x580, node=True),
)
