"""Objects of the maker on set values, pins, marker, interpolation and brake, 0x2030 to 0x2101.

Source: maxon EDS for the EPOS2 70/10, software 2126h; `read` is the value in a real device where it has none.
"""

from typing import Final

from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.epos2.wire.rows import count, row

_RO: Final = Access.RO
_RW: Final = Access.RW
_RWW: Final = Access.RWW
_WO: Final = Access.WO
_U8: Final = DataType.UNSIGNED8
_U16: Final = DataType.UNSIGNED16
_U64: Final = DataType.UNSIGNED64
_I16: Final = DataType.INTEGER16
_I32: Final = DataType.INTEGER32

INPUTS_OUTPUTS: Final[tuple[ObjectRow, ...]] = (
    row(0x2030, 0, "Current Mode Setting Value", _I16, _RWW, unit="mA", mapped=True),
    row(0x2031, 0, "Current Demand Value", _I16, _RO, unit="mA", mapped=True),
    row(0x2062, 0, "Position Mode Setting Value", _I32, _RWW, unit="qc", mapped=True),
    row(0x2069, 0, "Auxiliary Velocity Sensor Actual Value", _I32, _RO, mapped=True, note="unit not known"),
    row(0x206B, 0, "Velocity Mode Setting Value", _I32, _RWW, unit="rpm", mapped=True),
    row(0x206C, 0, "Auxiliary Velocity Actual Value", _I32, _RO, unit="rpm", mapped=True),
    count(0x2070, 9, name="Configuration of Digital Inputs: Number of Entries"),
    row(0x2070, 1, "Configuration of Digital Input1", _U16, _RW, default=15),
    row(0x2070, 2, "Configuration of Digital Input2", _U16, _RW, default=14),
    row(0x2070, 3, "Configuration of Digital Input3", _U16, _RW, default=13),
    row(0x2070, 4, "Configuration of Digital Input4", _U16, _RW, default=2),
    row(0x2070, 5, "Configuration of Digital Input5", _U16, _RW, default=1),
    row(0x2070, 6, "Configuration of Digital Input6", _U16, _RW, default=0),
    row(0x2070, 7, "Configuration of Digital Input7", _U16, _RW, default=9),
    row(0x2070, 8, "Configuration of Digital Input8", _U16, _RW, default=8),
    row(0x2070, 9, "Configuration of Digital Input9", _U16, _RW, default=7),
    count(0x2071, 4, name="Digital Input Functionalities: Number of Entries"),
    row(0x2071, 1, "Digital Input Functionalities State", _U16, _RO, mapped=True),
    row(0x2071, 2, "Digital Input Functionalities Mask", _U16, _RW, default=0xE387),
    row(0x2071, 3, "Digital Input Functionalities Polarity", _U16, _RW, default=0x0000),
    row(0x2071, 4, "Digital Input Functionalities Execution Mask", _U16, _RW, default=0x0008),
    count(0x2074, 6, name="Position Marker: Number of Entries"),
    row(0x2074, 1, "Position Marker Captured Position", _I32, _RO, unit="qc", mapped=True),
    row(0x2074, 2, "Position Marker Edge Type", _U8, _RW, default=0),
    row(0x2074, 3, "Position Marker Mode", _U8, _RW, default=0),
    row(0x2074, 4, "Position Marker Counter", _U16, _RW),
    row(0x2074, 5, "Position Marker History (1)", _I32, _RO, unit="qc"),
    row(0x2074, 6, "Position Marker History (2)", _I32, _RO, unit="qc"),
    count(0x2078, 3, name="Digital Output Functionalities: Number of Entries"),
    row(0x2078, 1, "Digital Output State", _U16, _RWW, mapped=True),
    row(0x2078, 2, "Digital Output Mask", _U16, _RW, default=0x0),
    row(0x2078, 3, "Digital Output Polarity", _U16, _RW, default=0x0),
    count(0x2079, 5, name="Configuration of Digital Outputs: Number of Entries"),
    row(0x2079, 1, "Configuration of Digital Output1", _U16, _RW, default=15),
    row(0x2079, 2, "Configuration of Digital Output2", _U16, _RW, default=14),
    row(0x2079, 3, "Configuration of Digital Output3", _U16, _RW, default=13),
    row(0x2079, 4, "Configuration of Digital Output4", _U16, _RW, default=12),
    row(0x2079, 5, "Configuration of Digital Output5", _U16, _RW, default=11),
    count(0x207A, 5, name="Position Compare: Number of Entries"),
    row(0x207A, 1, "Position Compare Configuration", _U16, _RWW, read=0x0000, mapped=True),
    row(
        0x207A, 2, "Position Compare Reference Position", _I32, _RWW, read=0x00000000, unit="qc", mapped=True
    ),
    row(0x207A, 3, "Position Compare Interval Width", _I32, _RW, read=0x00000000, unit="qc"),
    row(0x207A, 4, "Position Compare Interval Repetitions", _U16, _RW, read=0x0000),
    row(0x207A, 5, "Position Compare Pulse Width", _U16, _RW, read=0x0000, note="unit not known"),
    count(0x207B, 2, name="Configuration of Analog Inputs: Number of Entries"),
    row(0x207B, 1, "Configuration of Analog Input1", _U16, _RW, default=15),
    row(0x207B, 2, "Configuration of Analog Input2", _U16, _RW, default=14),
    count(0x207C, 2, name="Analog Inputs: Number of Entries"),
    row(0x207C, 1, "Analog Input 1", _I16, _RO, unit="mV", mapped=True),
    row(0x207C, 2, "Analog Input 2", _I16, _RO, unit="mV", mapped=True),
    row(0x207D, 0, "Analog Input Functionalities Execution Mask", _U16, _RW, default=0),
    row(0x2080, 0, "Current Threshold for Homing Mode", _U16, _RWW, default=500, unit="mA", mapped=True),
    row(0x2081, 0, "Home Position", _I32, _RWW, default=0, unit="qc", mapped=True),
    row(0x2082, 0, "Home Position Displacement", _I32, _RO, read=0, unit="qc"),
    row(
        0x20C1,
        0,
        "Interpolation Data Record",
        _U64,
        _WO,
        default=0,
        mapped=True,
        note="into the queue: bits 0-31 position, 32-55 velocity, 56-63 time in ms",
    ),
    count(0x20C4, 3, name="Interpolation Buffer: Number of Entries"),
    row(0x20C4, 1, "Interpolation Buffer Status", _U16, _RO, read=0x0000, mapped=True),
    row(0x20C4, 2, "Interpolation Buffer Underflow Warning", _U16, _RW, default=4, low=0, high=63),
    row(0x20C4, 3, "Interpolation Buffer Overflow Warning", _U16, _RW, default=60, low=1, high=64),
    row(0x20F4, 0, "Following Error Actual Value", _I16, _RO, unit="qc", mapped=True),
    count(0x2100, 3, name="Holding Brake Configuration: Number of Entries"),
    row(0x2100, 1, "Brake Reaction Rise Time", _U16, _RW, default=10, unit="ms"),
    row(0x2100, 2, "Brake Reaction Fall Time", _U16, _RW, default=10, unit="ms"),
    row(0x2100, 3, "Brake Timeout", _U16, _RW, default=65535, unit="ms"),
    count(0x2101, 3, name="Standstill Window Configuration: Number of Entries"),
    row(0x2101, 1, "Standstill Window", _U16, _RW, default=30, unit="rpm"),
    row(0x2101, 2, "Standstill Window Time", _U16, _RW, default=50, unit="ms"),
    row(0x2101, 3, "Standstill Timeout", _U16, _RW, default=1000, unit="ms"),
)
