"""Objects of the maker on the device itself: versions, lines, recorder, inner values, 0x2000 to 0x202E.

Source: maxon EDS for the EPOS2 70/10, software 2126h; `read` is the value in a real device where it has none.
"""

from typing import Final

from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.epos2.wire.rows import count, row

_CONST: Final = Access.CONST
_RO: Final = Access.RO
_RW: Final = Access.RW
_WO: Final = Access.WO
_U8: Final = DataType.UNSIGNED8
_U16: Final = DataType.UNSIGNED16
_U32: Final = DataType.UNSIGNED32
_U64: Final = DataType.UNSIGNED64
_I16: Final = DataType.INTEGER16
_I32: Final = DataType.INTEGER32
_DOMAIN: Final = DataType.DOMAIN

SYSTEM: Final[tuple[ObjectRow, ...]] = (
    row(
        0x2000,
        0,
        "Node ID",
        _U8,
        _RW,
        default=0x00,
        node=True,
        note="effective after save and reset, while the DIP switch is 0",
    ),
    row(
        0x2001,
        0,
        "CAN Bitrate",
        _U16,
        _RW,
        low=0,
        high=7,
        note="0 to 7: 1M, 800k, 500k, 250k, 125k, -, 50k, 20k bit/s",
    ),
    row(
        0x2002,
        0,
        "RS232 Baudrate",
        _U16,
        _RW,
        read=0x0005,
        low=0,
        high=5,
        note="0 to 5: 9600, 14400, 19200, 38400, 57600, 115200 Bd",
    ),
    count(0x2003, 5, _CONST, name="Version: Number of Entries"),
    row(0x2003, 1, "Software Version", _U16, _RO, read=0x2126),
    row(0x2003, 2, "Hardware Version", _U16, _RO, read=0x6420),
    row(0x2003, 3, "Application Number", _U16, _RO, read=0x0000),
    row(0x2003, 4, "Application Version", _U16, _RO, read=0x0000),
    row(0x2003, 5, "Basesector Version", _U16, _RO, read=0x2DB6),
    row(0x2004, 0, "Serial Number", _U64, _CONST, read=0x0000662080015954),
    row(0x2005, 0, "RS232 Frame Timeout", _U16, _RW, read=0x01F4, unit="ms"),
    row(0x2006, 0, "USB Frame Timeout", _U16, _RW, unit="ms", note="a real device had 475"),
    row(0x2008, 0, "Miscellaneous Configuration", _U16, _RW, read=0x0000),
    row(0x2009, 0, "Dip Switch State", _U16, _RO),
    row(0x200A, 0, "CAN Bitrate Display", _U16, _RO),
    count(0x200C, 4, _CONST, name="Custom persistent memory: Number of Entries"),
    row(0x200C, 1, "Custom persistent memory 1", _U32, _RW, default=0x00000000),
    row(0x200C, 2, "Custom persistent memory 2", _U32, _RW, default=0x00000000),
    row(0x200C, 3, "Custom persistent memory 3", _U32, _RW, default=0x00000000),
    row(0x200C, 4, "Custom persistent memory 4", _U32, _RW, default=0x00000000),
    row(0x2010, 0, "DataRecorder Control", _U16, _RW),
    row(0x2011, 0, "DataRecorder Configuration", _U16, _RW, read=0x0003),
    row(0x2012, 0, "DataRecorder Sampling Period", _U16, _RW, read=0x000A, unit="100 us"),
    row(0x2013, 0, "DataRecorder Number of Preceding Samples", _U16, _RW, read=0x0000),
    row(0x2014, 0, "DataRecorder Number of Sampling Variables", _U16, _RW, read=0x0000),
    count(0x2015, 4, name="Internal DataRecorder Index of Variables: Number of Entries"),
    row(0x2015, 1, "DataRecorder Index of Variable 1", _U16, _RW, read=0x0000),
    row(0x2015, 2, "DataRecorder Index of Variable 2", _U16, _RW, read=0x0000),
    row(0x2015, 3, "DataRecorder Index of Variable 3", _U16, _RW, read=0x0000),
    row(0x2015, 4, "DataRecorder Index of Variable 4", _U16, _RW, read=0x0000),
    count(0x2016, 4, name="Internal DataRecorder SubIndex of Variables: Number of Entries"),
    row(0x2016, 1, "DataRecorder SubIndex of Variable 1", _U16, _RW, read=0x0000),
    row(0x2016, 2, "DataRecorder SubIndex of Variable 2", _U16, _RW, read=0x0000),
    row(0x2016, 3, "DataRecorder SubIndex of Variable 3", _U16, _RW, read=0x0000),
    row(0x2016, 4, "DataRecorder SubIndex of Variable 4", _U16, _RW, read=0x0000),
    row(0x2017, 0, "DataRecorder Status", _U16, _RO),
    row(0x2018, 0, "DataRecorder Max Number of Samples", _U16, _RO),
    row(0x2019, 0, "DataRecorder Number of Recorded Samples", _U16, _RO),
    row(0x201A, 0, "DataRecorder Vector Start Offset", _U16, _RO),
    row(0x201B, 0, "DataRecorder Data Buffer", _DOMAIN, _RW),
    row(0x2020, 0, "Incremental Encoder 1 Counter", _U32, _RO, unit="qc", mapped=True),
    row(0x2021, 0, "Incremental Encoder 1 Counter at Index Pulse", _U32, _RO, unit="qc", mapped=True),
    row(0x2022, 0, "Hall Sensor Pattern", _U16, _RO, mapped=True),
    row(0x2023, 0, "Actual Rotor Angle", _U16, _RW),
    row(0x2024, 0, "System State", _U16, _RO),
    row(0x2025, 0, "Reserved", _U32, _WO, default=0),
    count(0x2026, 2, name="Internal Object ProcessMemory: Number of Entries"),
    row(0x2026, 1, "MemoryAddress", _U32, _RW),
    row(0x2026, 2, "MemoryValue", _U16, _RW),
    row(0x2027, 0, "Current Actual Value Averaged", _I16, _RO, unit="mA", mapped=True),
    row(0x2028, 0, "Velocity Actual Value Averaged", _I32, _RO, unit="rpm", mapped=True),
    row(0x2029, 0, "Auxiliary Velocity Actual Value Averaged", _I32, _RO, unit="rpm", mapped=True),
    count(0x202C, 3, name="Internal Object Internal Parameters: Number of Entries"),
    row(0x202C, 1, "Main Position Sensor Resolution", _U32, _RO),
    row(0x202C, 2, "Maximal Velocity Limit", _U32, _RO),
    row(0x202C, 3, "Auxiliary Position Sensor Resolution", _U32, _RO),
    count(0x202D, 5, name="Internal Object Internal Values: Number of Entries"),
    row(0x202D, 1, "Maximum measured angle difference", _I16, _RO, read=0x0000),
    row(0x202D, 2, "Minimum measured angle difference", _I16, _RO, read=0x0000),
    row(0x202D, 3, "Angle difference overflow counter", _U16, _RO, read=0x0000),
    row(0x202D, 4, "Angle Error factor 2 pole motor", _U16, _RW, read=0x0064),
    row(0x202D, 5, "Angle Error factor N pole motor", _U16, _RW, read=0x00B4),
    count(0x202E, 12, name="Internal Object ADC values: Number of Entries"),
    row(0x202E, 1, "ADC NTC temperature value", _U16, _RO),
    row(0x202E, 2, "ADC current U (W1)", _I16, _RO),
    row(0x202E, 3, "ADC current V (W2)", _I16, _RO),
    row(0x202E, 4, "ADC Input voltage", _U16, _RO),
    row(0x202E, 5, "ADC Gate driver voltage", _U16, _RO),
    row(0x202E, 6, "ADC Sine entry Voltage", _U16, _RO),
    row(0x202E, 7, "ADC Cosine entry Voltage", _U16, _RO),
    row(0x202E, 8, "ADC CAN-ID Switch 1", _U16, _RO),
    row(0x202E, 9, "ADC CAN-ID Switch 2", _U16, _RO),
    row(0x202E, 10, "ADC CAN-ID Switch 3", _U16, _RO),
    row(0x202E, 11, "ADC current W (W3)", _I16, _RO),
    row(0x202E, 12, "ADC Supply Voltage Udd", _I16, _RO),
)
