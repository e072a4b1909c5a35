"""Objects of the maker on sensors, gear, outer set-points and tuning, 0x2210 to 0x2FFF.

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
_I8: Final = DataType.INTEGER8
_I16: Final = DataType.INTEGER16
_I32: Final = DataType.INTEGER32
_DOMAIN: Final = DataType.DOMAIN

SENSORS: Final[tuple[ObjectRow, ...]] = (
    count(0x2210, 4, name="Sensor Configuration: Number of Entries"),
    row(
        0x2210,
        1,
        "Pulse Number Incremental Encoder 1",
        _U32,
        _RW,
        default=500,
        low=16,
        high=2500000,
        unit="pulses/turn",
    ),
    row(0x2210, 2, "Position Sensor Type", _U16, _RW, default=1),
    row(0x2210, 3, "Absolute Position Offset", _U16, _RW, default=0),
    row(0x2210, 4, "Position Sensor Polarity", _U16, _RW, default=0x0000),
    count(0x2211, 4, name="SSI Encoder Configuration: Number of Entries"),
    row(0x2211, 1, "SSI Encoder Data Rate", _U16, _RW, read=0x01F4, unit="kbit/s"),
    row(0x2211, 2, "SSI Encoder Number of Data Bits", _U16, _RW, read=0x0C0D),
    row(0x2211, 3, "SSI Encoder Actual Position", _I32, _RO),
    row(0x2211, 4, "SSI Encoder Encoding Type", _U16, _RW, read=0x0000),
    count(0x2212, 3, name="Incremental Encoder 2 Configuration: Number of Entries"),
    row(
        0x2212,
        1,
        "Incremental Encoder 2 Pulse Number",
        _U32,
        _RW,
        read=500,
        low=16,
        high=2500000,
        unit="pulses/turn",
    ),
    row(0x2212, 2, "Incremental Encoder 2 Counter", _U32, _RO, mapped=True),
    row(0x2212, 3, "Incremental Encoder 2 Counter at Index Pulse", _U32, _RO, mapped=True),
    count(0x2213, 3, name="Sinus Incremental Encoder 2 Configuration: Number of Entries"),
    row(
        0x2213,
        1,
        "Sinus Incremental Encoder 2 Resolution",
        _U32,
        _RW,
        read=524292,
        low=64,
        high=10000000,
        unit="pulses/turn",
    ),
    row(0x2213, 2, "Sinus Incremental Encoder 2 Actual Position", _I32, _RO),
    row(0x2213, 3, "Sinus Incremental Encoder 2 Actual Angle", _U16, _RO),
    row(0x2220, 0, "Controller Structure", _U16, _RW, default=0),
    count(0x2230, 3, name="Gear Configuration: Number of Entries"),
    row(0x2230, 1, "Gear Ratio Numerator", _U32, _RW, read=0x00000000),
    row(0x2230, 2, "Gear Ratio Denominator", _U16, _RW, read=0x0001),
    row(0x2230, 3, "Gear Maximal Speed", _U32, _RW, read=0x000186A0, unit="rpm"),
    count(0x2240, 2, name="Internal SSI Encoder Configuration: Number of Entries"),
    row(0x2240, 1, "SSI Encoder State", _U16, _RW, read=0x0000),
    row(0x2240, 2, "SSI Encoder Zero Position Reference", _I32, _RO, read=0x00000000),
    count(0x2300, 5, name="Digital Position Input: Number of Entries"),
    row(0x2300, 1, "Digital Position Desired Value", _I32, _RO, unit="qc"),
    row(0x2300, 2, "Digital Position Scaling Numerator", _U16, _RW, default=1),
    row(0x2300, 3, "Digital Position Scaling Denominator", _U16, _RW, default=1),
    row(0x2300, 4, "Digital Position Polarity", _U8, _RW, default=0),
    row(0x2300, 5, "Digital Position Offset", _I32, _RW, read=0, unit="qc"),
    count(0x2301, 4, name="Analog Current Setpoint Configuration: Number of Entries"),
    row(0x2301, 1, "Analog Current Setpoint Scaling", _I16, _RW, read=0x0000),
    row(0x2301, 2, "Analog Current Setpoint Offset", _I16, _RW, read=0x0000),
    row(0x2301, 3, "Analog Current Setpoint Notation Index", _I8, _RW, read=0x00),
    row(0x2301, 4, "Analog Current Setpoint", _I16, _RO),
    count(0x2302, 4, name="Analog Velocity Setpoint Configuration: Number of Entries"),
    row(0x2302, 1, "Analog Velocity Setpoint Scaling", _I16, _RW, read=0x0000),
    row(0x2302, 2, "Analog Velocity Setpoint Offset", _I32, _RW, read=0x00000000),
    row(0x2302, 3, "Analog Velocity Setpoint Notation Index", _I8, _RW, read=0x00),
    row(0x2302, 4, "Analog Velocity Setpoint", _I32, _RO),
    count(0x2303, 4, name="Analog Position Setpoint Configuration: Number of Entries"),
    row(0x2303, 1, "Analog Position Setpoint Scaling", _I16, _RW, read=0x0000),
    row(0x2303, 2, "Analog Position Setpoint Offset", _I32, _RW, read=0x00000000),
    row(0x2303, 3, "Analog Position Setpoint Notation Index", _I8, _RW, read=0x00),
    row(0x2303, 4, "Analog Position Setpoint", _I32, _RO),
    count(0x2400, 3, name="Internal P Autotuning Parameters: Number of Entries"),
    row(0x2400, 1, "Cut-off Frequency of Oscillator", _U16, _RW),
    row(0x2400, 2, "Target Amplitude of Oscillation", _U32, _RW),
    row(0x2400, 3, "Oscillation Control", _U16, _RW),
    count(0x2401, 9, name="Internal P Autotuning Values: Number of Entries"),
    row(0x2401, 1, "Cycle Duration", _U32, _RO),
    row(0x2401, 2, "Phase Delay", _U32, _RO),
    row(0x2401, 3, "Set Value Ramp Current", _U16, _RO),
    row(0x2401, 4, "Actual Position Peak Value", _U32, _RO),
    row(0x2401, 5, "Actual Value of Dynamic Friction", _U32, _RO),
    row(0x2401, 6, "Number of Oscillation Cycles", _U16, _RO),
    row(0x2401, 7, "Maximum Friction Current", _U16, _RO),
    row(0x2401, 8, "Actual Position Peak Value Aux", _U32, _RO),
    row(0x2401, 9, "Actual Position Peak Value Difference", _U32, _RO),
    count(0x2410, 2, name="Internal LR Identification: Number of Entries"),
    row(0x2410, 1, "LR Identification Control", _U16, _RW),
    row(0x2410, 2, "LR Identification Current", _U16, _RW),
    count(0x2411, 3, name="Internal LR Identification: Number of Entries"),
    row(0x2411, 1, "Resistance", _U16, _RO),
    row(0x2411, 2, "Inductivity", _U16, _RO),
    row(0x2411, 3, "Frequency", _U16, _RO),
    count(0x2FFF, 6, name="Internal Firmware Download: Number of Entries"),
    row(0x2FFF, 1, "Download Start", _U32, _WO, default=0),
    row(0x2FFF, 2, "Download Number of SubSections", _U16, _RW),
    row(0x2FFF, 3, "Download Code SubSection", _DOMAIN, _WO),
    row(0x2FFF, 4, "Download Boot Code Version", _U16, _RO, read=0x2DB6),
    row(0x2FFF, 5, "Download Serial Number HighWord", _U32, _CONST, read=0x00006620),
    row(0x2FFF, 6, "Download Serial Number LowWord", _U32, _CONST, read=0x80015954),
)
