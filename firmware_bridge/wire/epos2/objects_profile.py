"""Objects of the device profile CiA 402, 0x6000 to 0x6502.

Source: maxon EDS for the EPOS2 70/10, software 2126h; `read` is the value in a real 70/10 where the EDS has none.
"""

from typing import Final

from firmware_bridge.wire.epos2.rows import Access, DataType, ObjectRow, count, row

_CONST: Final = Access.CONST
_RO: Final = Access.RO
_RW: Final = Access.RW
_RWW: Final = Access.RWW
_WO: Final = Access.WO
_U8: Final = DataType.UNSIGNED8
_U16: Final = DataType.UNSIGNED16
_U32: Final = DataType.UNSIGNED32
_I8: Final = DataType.INTEGER8
_I16: Final = DataType.INTEGER16
_I32: Final = DataType.INTEGER32

DEVICE_PROFILE: Final[tuple[ObjectRow, ...]] = (
    row(0x6007, 0, "Abort Connection Option Code", _I16, _RW, read=0x0003),
    row(0x6040, 0, "Controlword", _U16, _RWW, read=0x0000, mapped=True),
    row(0x6041, 0, "Statusword", _U16, _RO, mapped=True),
    row(0x605B, 0, "Shutdown Option Code", _I16, _RW, 0),
    row(0x605C, 0, "Disable Operation Option Code", _I16, _RW, 1),
    row(0x605E, 0, "Fault Reaction Option Code", _I16, _RW, 2),
    row(0x6060, 0, "Modes of Operation", _I8, _RWW, 1, mapped=True),
    row(0x6061, 0, "Modes of Operation Display", _I8, _RO, read=0x01, mapped=True),
    row(0x6062, 0, "Position Demand Value", _I32, _RO, unit="qc", mapped=True),
    row(0x6064, 0, "Position Actual Value", _I32, _RO, unit="qc", mapped=True),
    row(
        0x6065,
        0,
        "Max Following Error",
        _U32,
        _RWW,
        2000,
        unit="qc",
        mapped=True,
        note="2^32-1: no supervision",
    ),
    row(0x6067, 0, "Position Window", _U32, _RW, 4294967295, unit="qc", note="2^32-1: no window"),
    row(0x6068, 0, "Position Window Time", _U16, _RW, 0, unit="ms"),
    row(0x6069, 0, "Velocity Sensor Actual Value", _I32, _RO, mapped=True, note="unit not known"),
    row(0x606B, 0, "Velocity Demand Value", _I32, _RO, unit="rpm", mapped=True),
    row(0x606C, 0, "Velocity Actual Value", _I32, _RO, unit="rpm", mapped=True),
    row(0x606D, 0, "Velocity Window", _U32, _RW, read=0xFFFFFFFF, unit="rpm", note="2^32-1: no window"),
    row(0x606E, 0, "Velocity Window Time", _U16, _RW, 0, unit="ms"),
    row(0x6078, 0, "Current Actual Value", _I16, _RO, unit="mA", mapped=True),
    row(0x607A, 0, "Target Position", _I32, _RWW, unit="qc", mapped=True),
    row(0x607C, 0, "Home Offset", _I32, _RWW, 0, unit="qc", mapped=True),
    count(0x607D, 2, _CONST, name="Software Position Limit: Number of Entries"),
    row(0x607D, 1, "Min Position Limit", _I32, _RW, -2147483648, unit="qc"),
    row(0x607D, 2, "Max Position Limit", _I32, _RW, 2147483647, unit="qc"),
    row(0x607F, 0, "Max Profile Velocity", _U32, _RW, 25000, low=0, high=25000, unit="rpm"),
    row(0x6081, 0, "Profile Velocity", _U32, _RWW, 1000, unit="rpm", mapped=True),
    row(0x6083, 0, "Profile Acceleration", _U32, _RWW, 10000, unit="rpm/s", mapped=True),
    row(0x6084, 0, "Profile Deceleration", _U32, _RWW, 10000, unit="rpm/s", mapped=True),
    row(0x6085, 0, "QuickStop Deceleration", _U32, _RWW, 10000, unit="rpm/s", mapped=True),
    row(0x6086, 0, "Motion Profile Type", _I16, _RWW, 0, mapped=True, note="0 trapezoidal, 1 sin2"),
    row(0x6089, 0, "Position Notation Index", _I8, _RW, 0x00),
    row(0x608A, 0, "Position Dimension Index", _U8, _RW, 0xAC),
    row(0x608B, 0, "Velocity Notation Index", _I8, _RW, 0x00),
    row(0x608C, 0, "Velocity Dimension Index", _U8, _RW, 0xA4),
    row(0x608D, 0, "Acceleration Notation Index", _I8, _RW, 0x00),
    row(0x608E, 0, "Acceleration Dimension Index", _U8, _RW, 0xA4),
    row(0x6098, 0, "Homing Method", _I8, _RWW, 7, mapped=True),
    count(0x6099, 2, _CONST, name="Homing Speeds: Number of Entries"),
    row(0x6099, 1, "Speed for Switch Search", _U32, _RWW, 100, unit="rpm", mapped=True),
    row(0x6099, 2, "Speed for Zero Search", _U32, _RWW, 10, unit="rpm", mapped=True),
    row(0x609A, 0, "Homing Acceleration", _U32, _RWW, 1000, unit="rpm/s", mapped=True),
    row(0x60C0, 0, "Interpolation Sub Mode Selection", _I16, _RW, -1, low=-1, high=-1),
    count(0x60C2, 2, _CONST, name="Interpolation Time Period: Number of Entries"),
    row(0x60C2, 1, "Interpolation Time Periode Value", _U8, _RW, 1, low=1, high=1),
    row(0x60C2, 2, "Interpolation Time Index", _I8, _RW, -3, low=-3, high=-3),
    count(0x60C4, 6, _CONST, name="Interpolation Data Configuration: Number of Entries"),
    row(0x60C4, 1, "Maximum Buffer Size", _U32, _RO),
    row(0x60C4, 2, "Actual Buffer Size", _U32, _RO),
    row(0x60C4, 3, "Buffer Organisation", _U8, _RW, 0, low=0, high=0),
    row(0x60C4, 4, "Buffer Position", _U16, _RW, 0, low=0, high=64),
    row(0x60C4, 5, "Size Of Data Record", _U8, _WO, 8, low=8, high=8),
    row(0x60C4, 6, "Buffer Clear", _U8, _WO, 0, low=0, high=1, mapped=True),
    row(0x60C5, 0, "Max Acceleration", _U32, _RW, 4294967295, unit="rpm/s"),
    count(0x60F6, 2, _CONST, name="Current Control Parameter Set: Number of Entries"),
    row(0x60F6, 1, "Current Regulator P-Gain", _I16, _RWW, 300, unit="1/256 Ohm", mapped=True),
    row(0x60F6, 2, "Current Regulator I-Gain", _I16, _RWW, 100, unit="1/256 Ohm per 0.1 ms", mapped=True),
    count(0x60F9, 5, _CONST, name="Velocity Control Parameter Set: Number of Entries"),
    row(0x60F9, 1, "Speed Regulator P-Gain", _I16, _RWW, 1000, unit="A/(rad/s) / (16000 pi)", mapped=True),
    row(0x60F9, 2, "Speed Regulator I-Gain", _I16, _RWW, 100, unit="A/s/(rad/s) / (64 pi)", mapped=True),
    row(
        0x60F9,
        4,
        "Velocity Feedforward Factor in Speed Regulator",
        _U16,
        _RWW,
        read=0x0000,
        unit="1 uA/(rad/s)",
        mapped=True,
    ),
    row(
        0x60F9,
        5,
        "Acceleration Feedforward Factor in Speed Regulator",
        _U16,
        _RWW,
        unit="1 uA/(rad/s^2)",
        mapped=True,
    ),
    count(0x60FB, 5, _CONST, name="Position Control Parameter Set: Number of Entries"),
    row(0x60FB, 1, "Position Regulator P-Gain", _I16, _RWW, 150, unit="A/rad / (32 pi)", mapped=True),
    row(0x60FB, 2, "Position Regulator I-Gain", _I16, _RWW, 10, unit="A/s/rad / (4.096 pi)", mapped=True),
    row(0x60FB, 3, "Position Regulator D-Gain", _I16, _RWW, 200, unit="A s/rad / (4000 pi)", mapped=True),
    row(
        0x60FB,
        4,
        "Velocity Feedforward Factor in Position Regulator",
        _U16,
        _RWW,
        0,
        unit="1 uA/(rad/s)",
        mapped=True,
    ),
    row(
        0x60FB,
        5,
        "Acceleration Feedforward Factor in Position Regulator",
        _U16,
        _RWW,
        0,
        unit="1 uA/(rad/s^2)",
        mapped=True,
    ),
    row(0x60FF, 0, "Target Velocity", _I32, _RWW, unit="rpm", mapped=True),
    row(0x6402, 0, "Motor Type", _U16, _RW, 10, note="1 DC, 10 EC sinus, 11 EC block"),
    count(0x6410, 5, _CONST, name="Motor Data: Number of Entries"),
    row(0x6410, 1, "Continuous Current Limit", _U16, _RWW, 10000, low=0, high=10000, unit="mA", mapped=True),
    row(0x6410, 2, "Output Current Limit", _U16, _RWW, 25000, low=0, high=25000, unit="mA", mapped=True),
    row(0x6410, 3, "Pole Pair Number", _U8, _RW, 1),
    row(0x6410, 4, "Maximal Motor Speed", _U32, _RWW, 25000, unit="rpm", mapped=True),
    row(0x6410, 5, "Thermal Time Constant Winding", _U16, _RW, 40, low=1, high=5400, unit="100 ms"),
    row(0x6502, 0, "Supported Drive Modes", _U32, _RO, read=0x003F0065),
)
