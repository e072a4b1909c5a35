"""The servo kernel in C: found beside this file, checked, and run on the axes' own memory.

The package's build makes the library; without it, or with one that is older than its source, the reference
implementation serves. It reaches the plant through the addresses of FMI functions, in an FMU from any tool.
"""

import ctypes
import hashlib
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from pathlib import Path
from typing import ClassVar, Final, NoReturn, Protocol, runtime_checkable

from emulators.servo.axis import ServoAxis
from emulators.servo.pins import PinWire
from emulators.servo.seam import ServoError, ServoPlant, Wiring, no_measurement
from firmware_bridge import renamed
from fmu.calls import PlantRecord

VARIABLE: Final = "FIRMWARE_BRIDGE_SERVO"
"""Environment variable that chooses: `native`, `reference`, or empty for the best there is."""
NATIVE: Final = "native"
REFERENCE: Final = "reference"
LIBRARY: Final = "libservo" + (".dll" if sys.platform == "win32" else ".so")
_HERE: Final = Path(__file__).parent
NATIVE_FOLDER: Final = _HERE / "native"


class Ended(IntEnum):
    """Result of a run of the kernel; from CURRENT on it broke off in the midst."""

    REACHED = 0
    EVENT = 1
    CURRENT = 2
    ANGLE = 3
    SPEED = 4
    SUPPLY = 5
    WRITE = 6
    STEP = 7
    READ = 8
    PIN = 9
    SENSOR = 10


_QUANTITIES: Final = {
    Ended.CURRENT: "current",
    Ended.ANGLE: "angle",
    Ended.SPEED: "speed",
    Ended.SUPPLY: "supply voltage",
    Ended.PIN: "pin",
    Ended.SENSOR: "sensor",
}
ACTIONS: Final = {
    Ended.WRITE: "setting the inputs",
    Ended.STEP: "doStep",
    Ended.READ: "reading the outputs",
}
"""Call to the plant that failed."""


@runtime_checkable
class NativePlant(ServoPlant, Protocol):
    """A plant whose step is three functions of the FMI at known addresses."""

    @property
    def record(self) -> PlantRecord:
        """The functions, their arguments and the count of steps."""

    def failed(self, action: str, status: int) -> NoReturn:
        """Raise the plant's own error for a call that gave this status."""


class LineRecord(ctypes.Structure):
    """One wire between a pin and the plant: `emulators.servo.pins.PinWire`."""

    _fields_: ClassVar = [
        ("axis", ctypes.c_int64),
        ("mask", ctypes.c_int64),
        ("variable", ctypes.c_int64),
    ]


class BankRecord(ctypes.Structure):
    """Axes, plant and progress of one bank, as the kernel in C sees them."""

    _fields_: ClassVar = [
        ("count", ctypes.c_int64),
        ("axes", ctypes.c_void_p),
        ("recorders", ctypes.c_void_p),
        ("counts_per_radian", ctypes.c_void_p),
        ("dividers", ctypes.c_void_p),
        ("supply", ctypes.c_int64),
        # How many of the plant's outputs each tick needs, from the first on.
        ("sampled", ctypes.c_int64),
        ("input_lines", ctypes.c_void_p),
        ("input_line_count", ctypes.c_int64),
        ("output_lines", ctypes.c_void_p),
        ("output_line_count", ctypes.c_int64),
        ("plant", ctypes.c_void_p),
        ("tick", ctypes.c_int64),
        # Where and why a run broke off: an axis' number or -1; an FMI status; what was read, in SI.
        ("fault_axis", ctypes.c_int64),
        ("fault_status", ctypes.c_int64),
        ("fault_value", ctypes.c_double),
    ]


@dataclass(frozen=True, slots=True)
class KernelLibrary:
    """The kernel's library, or why there is none to use."""

    library: ctypes.CDLL | None
    reason: str = ""


def choose(command: str | None = None) -> KernelLibrary:
    """Return the kernel, or why the reference is to serve; where none is chosen the environment decides.

    `native` insists on the kernel: ServoError where there is none. `reference` does without. Empty: the best.
    """
    if command is None:
        command = renamed.current(os.environ.get(VARIABLE, ""), renamed.SERVO, VARIABLE)
    if command not in {"", NATIVE, REFERENCE}:
        raise ServoError(
            f"{VARIABLE}={command}: give '{NATIVE}', '{REFERENCE}', or nothing for the best there is"
        )
    if command == REFERENCE:
        return KernelLibrary(None, "the reference was requested")
    found = find()
    if command == NATIVE and found.library is None:
        raise ServoError(f"the native servo cannot serve: {found.reason}")
    return found


@cache
def find() -> KernelLibrary:
    """Load the library beside this file."""
    path = _HERE / LIBRARY
    if not path.exists():
        return KernelLibrary(None, "its kernel was not built (install a C compiler, then this package again)")
    return load(path)


def load(path: Path) -> KernelLibrary:
    """Load a library; one that was built from other sources, and so for other records, is not used."""
    try:
        library = ctypes.CDLL(str(path))
        # ctypes takes an int of 32 bits otherwise, and half of the digest would be lost.
        library.servo_source.restype = ctypes.c_uint64
        built_from = library.servo_source()
        for run in (library.servo_run, library.servo_turn):
            run.argtypes, run.restype = (ctypes.c_void_p, ctypes.c_int64), ctypes.c_int64
    except (OSError, AttributeError) as error:
        return KernelLibrary(None, f"its kernel cannot be loaded: {error}")
    if built_from != source():
        return KernelLibrary(None, "its kernel was built from other sources (install this package again)")
    return KernelLibrary(library)


def source() -> int:
    """Return the first 64 bits of the sources' SHA-256, which the build leaves in the library."""
    digest = hashlib.sha256()
    for file in sorted(NATIVE_FOLDER.glob("*.[ch]")):
        digest.update(file.read_bytes())
    return int(digest.hexdigest()[:16], 16)


class Kernel:
    """Axes and plant, run by the library from one event to the next."""

    def __init__(
        self,
        library: ctypes.CDLL,
        plant: NativePlant,
        axes: Sequence[ServoAxis],
        wiring: Wiring,
    ) -> None:
        self._axes: Final = tuple(axes)
        self._plant: Final = plant
        count, supply = len(self._axes), -1 if wiring.supply is None else wiring.supply
        doubles = ctypes.c_double * count
        pointers = (ctypes.c_void_p * count)(*map(ctypes.addressof, self._axes))
        recorders = (ctypes.c_void_p * count)(*(ctypes.addressof(axis.recorder) for axis in self._axes))
        scales, parts, calls = doubles(*wiring.counts_per_radian), doubles(*wiring.dividers), plant.record
        into, out_of = _line_records(wiring.input_lines), _line_records(wiring.output_lines)
        # The record holds bare addresses: what they point to must live as long as it does.
        self._held: Final = (pointers, recorders, scales, parts, calls, into, out_of)
        self._record: Final = BankRecord(
            count=count,
            axes=ctypes.addressof(pointers),
            recorders=ctypes.addressof(recorders),
            counts_per_radian=ctypes.addressof(scales),
            dividers=ctypes.addressof(parts),
            supply=supply,
            sampled=max(3 * count, supply + 1, *(line.variable + 1 for line in wiring.input_lines)),
            input_lines=ctypes.addressof(into),
            input_line_count=len(into),
            output_lines=ctypes.addressof(out_of),
            output_line_count=len(out_of),
            plant=ctypes.addressof(calls),
        )
        self._run: Final = library.servo_run
        self._address: Final = ctypes.addressof(self._record)

    @property
    def tick(self) -> int:
        """Number of ticks that have been run."""
        return int(self._record.tick)

    def run(self, last: int) -> bool:
        """Run ticks up to number `last`, or to the end of the first one with an event; say which."""
        ended = self._run(self._address, last)
        if ended == 0:  # mostly: `Ended.REACHED`
            return False
        if ended != Ended.EVENT:
            self._break_off(Ended(ended))
        return True

    def _break_off(self, ended: Ended) -> NoReturn:
        record = self._record
        if ended in ACTIONS:
            self._plant.failed(ACTIONS[ended], record.fault_status)
        name = self._axes[record.fault_axis].name if record.fault_axis >= 0 else ""
        no_measurement(_QUANTITIES[ended], name, record.fault_value, record.tick)


def _line_records(lines: Sequence[PinWire]) -> "ctypes.Array[LineRecord]":
    return (LineRecord * len(lines))(*(LineRecord(line.axis, line.mask, line.variable) for line in lines))
