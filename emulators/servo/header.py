"""Generator of the kernel's header from the tables in Python: the records and the constants, declared once.

Run as `python -m emulators.servo.header`; a test fails while the file is out of step.
"""

import ctypes
from collections.abc import Iterator, Mapping
from types import MappingProxyType, ModuleType
from typing import Final

from emulators.servo import (
    axis,
    compare,
    electronic_gear,
    loops,
    recorder,
    scaling,
    seam,
    sensor_lines,
    sensors,
    setpoint,
    signals,
    sine,
    winding,
)
from emulators.servo.axis import ServoAxis
from emulators.servo.kernel import NATIVE_FOLDER, BankRecord, Ended, LineRecord
from emulators.servo.recorder import Recorder
from emulators.servo.terminals import TerminalsRecord
from fmu.calls import PlantRecord

PATH: Final = NATIVE_FOLDER / "record.h"

CONSTANTS: Final[tuple[tuple[ModuleType, tuple[str, ...]], ...]] = (
    (
        axis,
        (
            "TICK",
            "TICKS_PER_MILLISECOND",
            "IDLE",
            "CURRENT",
            "VELOCITY",
            "POSITION",
            "DIRECT",
            "RAMP",
            "MOVE",
            "SPLINE",
            "ELECTRONIC_GEAR",
            "SINE",
            "FASTEST_RPM",
        ),
    ),
    (axis, ("PROFILE_DONE", "TARGET_REACHED", "AT_REST", "CURRENT_LIMITED", "FOLLOWING_ERROR")),
    (axis, ("OVER_CURRENT", "UNDER_VOLTAGE", "OVER_VOLTAGE", "CURRENT_REACHED")),
    (axis, ("POSITION_LIMIT_PASSED", "OVER_TEMPERATURE", "LOGIC_SUPPLY_LOW", "GATE_SUPPLY_LOW")),
    (axis, ("ENCODER_BROKEN", "INDEX_LOST", "INDEX_DISTANCE_WRONG", "HALL_IMPOSSIBLE")),
    (axis, ("HALL_ANGLE_APART", "ENCODER_AGAINST_MOTOR", "AUXILIARY_AGAINST_MAIN")),
    (loops, ("HEATING", "HOTTEST_MC", "COOLED_MC", "LEAST_LOGIC_MV", "LEAST_GATE_MV")),
    (sensors, ("BROKEN", "SWAPPED", "INDEX_MISSING", "INDEX_SPURIOUS", "AUXILIARY_SWAPPED")),
    (sensors, ("HALL_HIGH", "HALL_LOW", "HALL_LINES", "HALL_SEQUENCE", "SECTORS", "SPURIOUS_PART")),
    (sensors, ("INDEX_TOLERANCE", "INDEX_SOONEST", "INDEX_TURNS", "PER_MILLE", "CONTRARY_MS")),
    (loops, ("AVERAGE", "WIDEST_SPEED", "WIDEST_WAY")),
    (signals, ("WRAP", "HALF")),
    (compare, ("DOWNWARDS", "UPWARDS")),
    (recorder, ("MOVEMENT_START", "INPUT_EDGE", "MOVEMENT_END")),
    (scaling, ("VELOCITY_PLACES", "POSITION_P_PLACES", "POSITION_I_PLACES", "POSITION_D_PLACES")),
    (scaling, ("SPEED_FORWARD_PLACES", "ACCELERATION_FORWARD_PLACES", "FILTER_PLACES")),
    (winding, ("RESTING", "LEARNING", "SLOWING", "MOST_LEARNING", "BACK_EMF_PLACES", "WIDEST_BACK_EMF")),
    (winding, ("CURRENT_PLACES", "RESISTANCE_PLACES", "DIODES_MV", "DOUBTED_MA", "FADED")),
    (winding, ("SETTLING_MS", "RECOVERING_MS", "MOST_LEFT_MA")),
    (axis, ("JUST_OPENED", "LEAST_LEARNING")),
    (axis, ("AVERAGE_PLACES",)),
    (sine, ("SHARE_PLACES", *(f"SINE_{term}" for term in range(1, 8)))),
    (sensor_lines, ("MASTER", "ANALOGUE_1", "ANALOGUE_2")),
    (electronic_gear, ("FASTEST_INPUT",)),
    (setpoint, ("WIDEST_VOLTAGE", "WIDEST_SETPOINT", "MILLISECONDS_PER_MINUTE")),
    (seam, ("CLOSED", "WIDEST_READING", "WIDEST_ANGLE", "WIDEST_STEP")),
)
"""Constants that the kernel knows by name, and the module that declares them."""

_TYPES: Final[Mapping[type, str]] = MappingProxyType(
    {ctypes.c_int64: "int64_t ", ctypes.c_double: "double ", ctypes.c_void_p: "void *"}
)


def text() -> str:
    """Return the header."""
    return "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    yield "/* Written by emulators.servo.header from the tables in Python. Do not edit. */"
    yield "#ifndef SERVO_RECORD_H"
    yield "#define SERVO_RECORD_H"
    yield "#include <stdint.h>"
    yield ""
    for module, names in CONSTANTS:
        for name in names:
            yield f"#define {name} INT64_C({getattr(module, name)})"
    yield ""
    for ended in Ended:
        yield f"#define ENDED_{ended.name} {ended.value}"
    for title, record in (
        ("servo_axis", ServoAxis),
        ("plant_calls", PlantRecord),
        ("servo_recorder", Recorder),
        ("servo_line", LineRecord),
        ("servo_bank", BankRecord),
        ("servo_terminals", TerminalsRecord),
    ):
        yield ""
        yield "typedef struct {"
        # The order of the fields is the layout: C and ctypes read the same memory.
        for field in record._fields_:
            yield f"    {_TYPES[field[1]]}{field[0]};"
        yield f"}} {title};"
    yield ""
    yield "#endif"


if __name__ == "__main__":
    PATH.write_text(text(), encoding="ascii")
