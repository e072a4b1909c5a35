"""Writes the kernel's header from the tables in Python: the records and the constants, declared once.

Run as `python -m emulators.servo.header`; a test fails while the file is out of step.
"""

import ctypes
from collections.abc import Iterator, Mapping
from types import MappingProxyType, ModuleType
from typing import Final

from emulators.servo import axis, loops, scaling, seam, winding
from emulators.servo.axis import ServoAxis
from emulators.servo.kernel import NATIVE_FOLDER, BankRecord, Ended
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
        ),
    ),
    (axis, ("PROFILE_DONE", "TARGET_REACHED", "AT_REST", "CURRENT_LIMITED", "FOLLOWING_ERROR")),
    (axis, ("OVER_CURRENT", "UNDER_VOLTAGE", "OVER_VOLTAGE")),
    (loops, ("AVERAGE", "WRAP", "HALF", "WIDEST_SPEED", "WIDEST_WAY")),
    (scaling, ("VELOCITY_PLACES", "POSITION_P_PLACES", "POSITION_I_PLACES", "POSITION_D_PLACES")),
    (scaling, ("SPEED_FORWARD_PLACES", "ACCELERATION_FORWARD_PLACES", "FILTER_PLACES")),
    (winding, ("RESTING", "LEARNING", "LEARNING_RATE", "BACK_EMF_PLACES", "WIDEST_BACK_EMF", "FADED")),
    (winding, ("CURRENT_PLACES", "AVERAGE_PLACES")),
    (seam, ("WIDEST_READING", "WIDEST_ANGLE", "WIDEST_STEP")),
)
"""What the kernel knows by name, and the module that declares it."""

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
        ("servo_bank", BankRecord),
    ):
        yield ""
        yield "typedef struct {"
        for field in record._fields_:
            yield f"    {_TYPES[field[1]]}{field[0]};"
        yield f"}} {title};"
    yield ""
    yield "#endif"


if __name__ == "__main__":
    PATH.write_text(text(), encoding="ascii")
