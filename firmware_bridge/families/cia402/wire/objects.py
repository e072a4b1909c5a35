"""Objects of the servo: those of CiA 301, the drive profile's, and the few that are left to a maker.

Sources: CiA 301 v4.02; CiA 402-2, and the profile's EDS for the defaults that it has; those marked `own` are
this servo's. Units: positions in counts of the encoder, speeds in revolutions a minute, torques and currents
in thousandths of the rated ones. 0x60FE is kept, and moves nothing: no pin is described.
"""

from collections.abc import Collection, Iterator
from functools import partial
from typing import Final

from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import COB_ID_NO_REMOTE, RECEIVE_PDO, TRANSMIT_PDO
from firmware_bridge.canopen.cia402 import Mode
from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_dictionary import ObjectDictionary
from firmware_bridge.canopen.object_row import ObjectRow, Provenance
from firmware_bridge.canopen.pdo import (
    MAX_ENTRIES,
    ON_CHANGE,
    RECEIVE_MAPPING,
    RECEIVE_PARAMETER,
    TRANSMIT_MAPPING,
    TRANSMIT_PARAMETER,
)

_I8, _I16, _I32 = DataType.INTEGER8, DataType.INTEGER16, DataType.INTEGER32
_U8, _U16, _U32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32
_RO, _RW, _RWW, _CONST = Access.RO, Access.RW, Access.RWW, Access.CONST
CIA_301: Final = "CiA 301"
CIA_402: Final = "CiA 402-2"
OWN: Final = "a choice of this servo"

MODES: Final = (
    Mode.PROFILE_POSITION,
    Mode.PROFILE_VELOCITY,
    Mode.HOMING,
    Mode.CYCLIC_POSITION,
    Mode.CYCLIC_VELOCITY,
    Mode.CYCLIC_TORQUE,
)
"""The modes that it has, 0x6502."""
PDOS: Final = 4
"""Of each direction."""
INHIBIT: Final = 100
"""Units of 100 us, for PDOs with values that move by themselves."""
OFF: Final = 0xFFFF_FFFF
"""A window or a limit that does not count."""
LOWEST: Final = -(1 << 31)
HIGHEST: Final = (1 << 31) - 1


def _row(
    index: int,
    sub: int,
    name: str,
    kind: DataType,
    access: Access,
    *,
    default: int | bytes = 0,
    mapped: bool = False,
    unit: str = "",
    node: bool = False,
    low: int | None = None,
    high: int | None = None,
    source: str = CIA_402,
    own: bool = False,
) -> ObjectRow:
    """Return a row; `own`: its default is a choice of this servo."""
    return ObjectRow(
        Address(index, sub),
        name,
        kind,
        access,
        mapped,
        default,
        low,
        high,
        unit,
        node,
        source,
        Provenance.ASSUMED if source == OWN else Provenance.DOCUMENTED,
        OWN if own else source,
        Provenance.ASSUMED if own or source == OWN else Provenance.DOCUMENTED,
    )


def _count(index: int, entries: int, name: str, source: str = CIA_301) -> ObjectRow:
    return _row(index, 0, f"{name}: Number of Entries", _U8, _CONST, default=entries, source=source)


def _communication() -> Iterator[ObjectRow]:
    row = partial(_row, source=CIA_301)
    yield row(0x1000, 0, "Device Type", _U32, _CONST, default=0x0002_0192)
    yield row(0x1001, 0, "Error Register", _U8, _RO)
    yield row(0x1003, 0, "Number of Errors", _U8, _RW)
    yield from (row(0x1003, sub, f"Error History ({sub})", _U32, _RO) for sub in range(1, 9))
    yield row(0x1005, 0, "COB-ID SYNC", _U32, _RW, default=0x80)
    yield row(
        0x1008, 0, "Manufacturer Device Name", DataType.VISIBLE_STRING, _CONST, default=b"CiA 402 servo"
    )
    yield row(0x100C, 0, "Guard Time", _U16, _RW, unit="ms")
    yield row(0x100D, 0, "Life Time Factor", _U8, _RW)
    yield _count(0x1010, 1, "Store Parameters")
    yield row(0x1010, 1, "Save All Parameters", _U32, _RW)
    yield _count(0x1011, 1, "Restore Default Parameters")
    yield row(0x1011, 1, "Restore All Default Parameters", _U32, _RW)
    yield row(0x1012, 0, "COB-ID TIME", _U32, _RW, default=0x8000_0100)
    yield row(0x1014, 0, "COB-ID EMCY", _U32, _RW, default=0x80, node=True)
    yield _count(0x1016, 4, "Consumer Heartbeat Time")
    yield from (
        row(0x1016, sub, f"Consumer Heartbeat Time {sub}", _U32, _RW, unit="ms + node << 16")
        for sub in range(1, 5)
    )
    yield row(0x1017, 0, "Producer Heartbeat Time", _U16, _RW, unit="ms")
    yield _count(0x1018, 4, "Identity")
    yield row(0x1018, 1, "Vendor ID", _U32, _CONST)
    yield row(0x1018, 2, "Product Code", _U32, _CONST, default=402)
    yield row(0x1018, 3, "Revision Number", _U32, _CONST, default=1)
    yield row(0x1018, 4, "Serial Number", _U32, _CONST)
    yield _count(0x1200, 2, "SDO Server")
    yield row(0x1200, 1, "COB-ID Client to Server", _U32, _RO, default=0x600, node=True)
    yield row(0x1200, 2, "COB-ID Server to Client", _U32, _RO, default=0x580, node=True)


_CONTROLWORD: Final = 0x6040_0010
_STATUSWORD: Final = 0x6041_0010
_RECEIVED: Final = (
    (_CONTROLWORD,),
    (_CONTROLWORD, 0x6060_0008),
    (_CONTROLWORD, 0x607A_0020),
    (_CONTROLWORD, 0x60FF_0020),
)
"""Receive PDOs 1 to 4 of the drive profile's servo set."""
_SENT: Final = (
    (_STATUSWORD,),
    (_STATUSWORD, 0x6061_0008),
    (_STATUSWORD, 0x6064_0020),
    (_STATUSWORD, 0x606C_0020),
)
"""Transmit PDOs 1 to 4 likewise."""


def _pdos() -> Iterator[ObjectRow]:
    for parameter, mapping, cob_ids, entries, flag, title in (
        (RECEIVE_PARAMETER, RECEIVE_MAPPING, RECEIVE_PDO, _RECEIVED, 0, "RPDO"),
        (TRANSMIT_PARAMETER, TRANSMIT_MAPPING, TRANSMIT_PDO, _SENT, COB_ID_NO_REMOTE, "TPDO"),
    ):
        for place, (cob_id, words) in enumerate(zip(cob_ids, entries, strict=True)):
            name = f"{title} {place + 1}"
            index = parameter + place
            yield _count(index, 5, name)
            yield _row(
                index, 1, f"COB-ID of {name}", _U32, _RW, default=flag | cob_id, node=True, source=CIA_301
            )
            yield _row(index, 2, f"Transmission Type of {name}", _U8, _RW, default=ON_CHANGE, source=CIA_301)
            moves = title == "TPDO" and len(words) > 1
            inhibit = INHIBIT if moves else 0
            yield _row(
                index,
                3,
                f"Inhibit Time of {name}",
                _U16,
                _RW,
                default=inhibit,
                unit="100 us",
                source=CIA_301,
                own=moves,
            )
            yield _row(index, 5, f"Event Timer of {name}", _U16, _RW, unit="ms", source=CIA_301)
            index = mapping + place
            yield _row(
                index,
                0,
                f"Mapping of {name}: Number of Entries",
                _U8,
                _RW,
                default=len(words),
                high=MAX_ENTRIES,
            )
            for sub in range(1, MAX_ENTRIES + 1):
                word = words[sub - 1] if sub <= len(words) else 0
                yield _row(index, sub, f"Mapping of {name} ({sub})", _U32, _RW, default=word, source=CIA_301)


def _factor(index: int, sub: int, name: str, default: int = 1) -> ObjectRow:
    return _row(index, sub, name, _U32, _RW, default=default, low=1)


_PROFILE: Final = (
    _row(0x6007, 0, "Abort Connection Option Code", _I16, _RW, default=1, low=0, high=3),
    _row(0x603F, 0, "Error Code", _U16, _RO, mapped=True),
    _row(0x6040, 0, "Controlword", _U16, _RWW, mapped=True),
    _row(0x6041, 0, "Statusword", _U16, _RO, mapped=True),
    _row(0x605A, 0, "Quick Stop Option Code", _I16, _RW, default=2),
    _row(0x605B, 0, "Shutdown Option Code", _I16, _RW, default=0, low=0, high=1),
    _row(0x605C, 0, "Disable Operation Option Code", _I16, _RW, default=1, low=0, high=1),
    _row(0x605D, 0, "Halt Option Code", _I16, _RW, default=1, low=1, high=2),
    _row(0x605E, 0, "Fault Reaction Option Code", _I16, _RW, default=2, low=0, high=2),
    _row(0x6060, 0, "Modes of Operation", _I8, _RWW, mapped=True),
    _row(0x6061, 0, "Modes of Operation Display", _I8, _RO, mapped=True),
    _row(0x6062, 0, "Position Demand Value", _I32, _RO, mapped=True, unit="position units"),
    _row(0x6063, 0, "Position Actual Internal Value", _I32, _RO, mapped=True, unit="counts"),
    _row(0x6064, 0, "Position Actual Value", _I32, _RO, mapped=True, unit="position units"),
    _row(0x6065, 0, "Following Error Window", _U32, _RW, default=2000, unit="position units", own=True),
    _row(0x6066, 0, "Following Error Time Out", _U16, _RW, default=0, unit="ms"),
    _row(0x6067, 0, "Position Window", _U32, _RW, default=OFF, unit="position units", own=True),
    _row(0x6068, 0, "Position Window Time", _U16, _RW, default=0, unit="ms", own=True),
    _row(0x606B, 0, "Velocity Demand Value", _I32, _RO, mapped=True, unit="rpm"),
    _row(0x606C, 0, "Velocity Actual Value", _I32, _RO, mapped=True, unit="rpm"),
    _row(0x606D, 0, "Velocity Window", _U16, _RW, default=30, unit="rpm", own=True),
    _row(0x606E, 0, "Velocity Window Time", _U16, _RW, default=20, unit="ms", own=True),
    _row(0x606F, 0, "Velocity Threshold", _U16, _RW, default=30, unit="rpm", own=True),
    _row(0x6070, 0, "Velocity Threshold Time", _U16, _RW, default=20, unit="ms", own=True),
    _row(0x6071, 0, "Target Torque", _I16, _RWW, mapped=True, unit="1/1000"),
    _row(0x6072, 0, "Max Torque", _U16, _RWW, default=2500, mapped=True, unit="1/1000", own=True),
    _row(0x6073, 0, "Max Current", _U16, _RW, default=2500, unit="1/1000", own=True),
    _row(0x6074, 0, "Torque Demand", _I16, _RO, mapped=True, unit="1/1000"),
    _row(0x6075, 0, "Motor Rated Current", _U32, _RW, default=2000, unit="mA", own=True),
    _row(0x6076, 0, "Motor Rated Torque", _U32, _RW, default=80, unit="mN m", own=True),
    _row(0x6077, 0, "Torque Actual Value", _I16, _RO, mapped=True, unit="1/1000"),
    _row(0x6078, 0, "Current Actual Value", _I16, _RO, mapped=True, unit="1/1000"),
    _row(0x6079, 0, "DC Link Circuit Voltage", _U32, _RO, mapped=True, unit="mV"),
    _row(0x607A, 0, "Target Position", _I32, _RWW, mapped=True, unit="position units"),
    _row(0x607C, 0, "Home Offset", _I32, _RW, unit="position units"),
    _count(0x607D, 2, "Software Position Limit", CIA_402),
    _row(0x607D, 1, "Min Position Limit", _I32, _RW, default=LOWEST, unit="position units"),
    _row(0x607D, 2, "Max Position Limit", _I32, _RW, default=HIGHEST, unit="position units"),
    _row(0x607F, 0, "Max Profile Velocity", _U32, _RW, default=5000, unit="rpm", own=True),
    _row(0x6080, 0, "Max Motor Speed", _U32, _RW, default=5000, unit="rpm", own=True),
    _row(0x6081, 0, "Profile Velocity", _U32, _RWW, default=1000, mapped=True, unit="rpm", low=1, own=True),
    _row(0x6082, 0, "End Velocity", _U32, _RW, default=0, unit="rpm", high=0),
    _row(
        0x6083,
        0,
        "Profile Acceleration",
        _U32,
        _RWW,
        default=10_000,
        mapped=True,
        unit="rpm/s",
        low=1,
        own=True,
    ),
    _row(
        0x6084,
        0,
        "Profile Deceleration",
        _U32,
        _RWW,
        default=10_000,
        mapped=True,
        unit="rpm/s",
        low=1,
        own=True,
    ),
    _row(
        0x6085,
        0,
        "Quick Stop Deceleration",
        _U32,
        _RWW,
        default=50_000,
        mapped=True,
        unit="rpm/s",
        low=1,
        own=True,
    ),
    _row(0x6086, 0, "Motion Profile Type", _I16, _RW, default=0, low=0, high=1),
    _count(0x608F, 2, "Position Encoder Resolution", CIA_402),
    _factor(0x608F, 2, "Motor Revolutions"),
    _count(0x6091, 2, "Gear Ratio", CIA_402),
    _factor(0x6091, 1, "Motor Revolutions"),
    _factor(0x6091, 2, "Shaft Revolutions"),
    _count(0x6092, 2, "Feed Constant", CIA_402),
    _factor(0x6092, 2, "Shaft Revolutions"),
    _row(0x6098, 0, "Homing Method", _I8, _RW),
    _count(0x6099, 2, "Homing Speeds", CIA_402),
    _row(0x6099, 1, "Speed for Switch Search", _U32, _RW, default=100, unit="rpm", own=True),
    _row(0x6099, 2, "Speed for Zero Search", _U32, _RW, default=10, unit="rpm", own=True),
    _row(0x609A, 0, "Homing Acceleration", _U32, _RW, default=1000, unit="rpm/s", low=1, own=True),
    _row(0x60B0, 0, "Position Offset", _I32, _RWW, mapped=True, unit="position units"),
    _row(0x60B1, 0, "Velocity Offset", _I32, _RWW, mapped=True, unit="rpm"),
    _row(0x60B2, 0, "Torque Offset", _I16, _RWW, mapped=True, unit="1/1000"),
    _count(0x60C2, 2, "Interpolation Time Period", CIA_402),
    _row(0x60C2, 1, "Interpolation Time Period Value", _U8, _RW, default=1, low=1),
    _row(0x60C2, 2, "Interpolation Time Index", _I8, _RW, default=-3, low=-6, high=0),
    _row(0x60C5, 0, "Max Acceleration", _U32, _RW, default=1_000_000, unit="rpm/s", low=1, own=True),
    _row(0x60F4, 0, "Following Error Actual Value", _I32, _RO, mapped=True, unit="position units"),
    _row(0x60FD, 0, "Digital Inputs", _U32, _RO, mapped=True),
    _count(0x60FE, 2, "Digital Outputs", CIA_402),
    _row(0x60FE, 1, "Physical Outputs", _U32, _RWW, mapped=True),
    _row(0x60FE, 2, "Bit Mask", _U32, _RW),
    _row(0x60FF, 0, "Target Velocity", _I32, _RWW, mapped=True, unit="rpm"),
    _row(0x6402, 0, "Motor Type", _U16, _CONST, default=1),
    _row(0x6502, 0, "Supported Drive Modes", _U32, _CONST, default=sum(mode.supported_bit for mode in MODES)),
)


def _encoder(counts: int) -> Iterator[ObjectRow]:
    # As it comes, one unit of position is a count.
    yield _factor(0x608F, 1, "Encoder Counts", counts)
    yield _factor(0x6092, 1, "Feed", counts)


def _own() -> Iterator[ObjectRow]:
    # CiA 305 sets node number and bit rate, and leaves to a maker where they stand.
    yield _row(0x2000, 0, "Node Number", _U8, _RW, default=1, low=1, high=127, source=OWN)
    yield _row(0x2001, 0, "Bit Rate", _U8, _RW, source=OWN)
    yield _row(0x2002, 0, "Bit Rate in Use", _U8, _RO, source=OWN)


def objects_of(counts: int, absent: Collection[int] = ()) -> ObjectDictionary:
    """Return the dictionary of a servo whose encoder has so many counts in a turn, without some indexes."""
    rows = (*_communication(), *_pdos(), *_own(), *_PROFILE, *_encoder(counts))
    return ObjectDictionary(row for row in rows if row.address.index not in absent)
