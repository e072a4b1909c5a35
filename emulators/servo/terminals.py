"""Motors at half bridges that stay as they are for some ticks, turned by the library with the kernel in C.

The readable form of a tick is in `emulators.arduino_omni.motors`, which also serves where there is no
library, or something at the motors is broken. It is independent of chips, boards and encoders' pins.
"""

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Protocol

from emulators.servo.kernel import ACTIONS, Ended, NativePlant, choose
from emulators.servo.seam import ServoPlant, no_measurement


class TerminalsRecord(ctypes.Structure):
    """Half bridges, encoders, plant and progress, as the library sees them."""

    _fields_: ClassVar = [
        ("count", ctypes.c_int64),
        # Motors with an encoder: the first ones.
        ("seen", ctypes.c_int64),
        # Of each motor, in counts of a PWM period: forwards less backwards, all that conducts, and open.
        ("driven", ctypes.c_void_p),
        ("conducting", ctypes.c_void_p),
        ("open", ctypes.c_void_p),
        ("period", ctypes.c_int64),
        ("on_resistance", ctypes.c_double),
        ("torque_constants", ctypes.c_void_p),
        # Which of the plant's outputs is the supply, or -1 for one that is constant.
        ("supply", ctypes.c_int64),
        ("constant_supply", ctypes.c_double),
        # How many of the plant's outputs each tick needs, from the first on.
        ("sampled", ctypes.c_int64),
        ("counts_per_radian", ctypes.c_double),
        # Edges in a tick that the processor counts, of all encoders together.
        ("most", ctypes.c_int64),
        ("places", ctypes.c_void_p),
        ("turned", ctypes.c_void_p),
        ("edges", ctypes.c_void_p),
        ("plant", ctypes.c_void_p),
        ("tick", ctypes.c_int64),
        # As in a bank's record.
        ("fault_axis", ctypes.c_int64),
        ("fault_status", ctypes.c_int64),
        ("fault_value", ctypes.c_double),
    ]


class Counts(Protocol):
    """An `array.array` of 64 bits: its type takes no parameter before Python 3.12."""

    def buffer_info(self) -> tuple[int, int]:
        """Address and length of its memory."""


class HalfBridge(Protocol):
    """Shares of a PWM period, in counts."""

    @property
    def cw(self) -> int:
        """Forwards."""

    @property
    def ccw(self) -> int:
        """Backwards."""

    @property
    def brake(self) -> int:
        """Shorted."""

    @property
    def open(self) -> int:
        """Free."""


@dataclass(frozen=True, slots=True)
class Wired:
    """Wiring of motors, shield and plant; see `TerminalsRecord`."""

    names: tuple[str, ...]
    torque_constants: tuple[float, ...]
    seen: int
    period: int
    on_resistance: float
    supply: int | None
    constant_supply: float
    counts_per_radian: float
    most: int


class Terminals:
    """Motors and plant, run by the library while nothing at their terminals changes."""

    def __init__(
        self,
        run: Callable[[int, int], int],
        plant: NativePlant,
        wired: Wired,
        places: Counts,
        edges: Counts,
    ) -> None:
        self._names: Final = wired.names
        self._plant: Final = plant
        count = len(wired.names)
        numbers, seen = ctypes.c_int64 * count, ctypes.c_int64 * wired.seen
        self._driven, self._conducting, self._open = numbers(), numbers(), numbers()
        self._turned = seen()
        constants, calls = (ctypes.c_double * count)(*wired.torque_constants), plant.record
        # The record holds bare addresses: what they point to must live as long as it does.
        self._held: Final = (constants, calls, places, edges)
        supply = -1 if wired.supply is None else wired.supply
        self._record: Final = TerminalsRecord(
            count=count,
            seen=wired.seen,
            driven=ctypes.addressof(self._driven),
            conducting=ctypes.addressof(self._conducting),
            open=ctypes.addressof(self._open),
            period=wired.period,
            on_resistance=wired.on_resistance,
            torque_constants=ctypes.addressof(constants),
            supply=supply,
            constant_supply=wired.constant_supply,
            sampled=max(3 * count, supply + 1),
            counts_per_radian=wired.counts_per_radian,
            most=wired.most,
            places=places.buffer_info()[0],
            turned=ctypes.addressof(self._turned),
            edges=edges.buffer_info()[0],
            plant=ctypes.addressof(calls),
        )
        self._run: Final = run
        self._address: Final = ctypes.addressof(self._record)

    def connect(self, bridges: Sequence[HalfBridge]) -> None:
        """Take what the half bridges do from here on, motor by motor."""
        self._driven[:] = [it.cw - it.ccw for it in bridges]
        self._conducting[:] = [it.cw + it.ccw + it.brake for it in bridges]
        self._open[:] = [it.open for it in bridges]

    @property
    def tick(self) -> int:
        """Tick up to which the last run has come."""
        return int(self._record.tick)

    def run(self, tick: int, last: int) -> None:
        """Run ticks from `tick` up to `last`, and bring places and edges up to there.

        ServoError for an angle that is none, and what the plant raises where it fails.
        """
        record = self._record
        record.tick = tick
        ended = self._run(self._address, last)
        if ended in ACTIONS:
            self._plant.failed(ACTIONS[Ended(ended)], record.fault_status)
        if ended:
            no_measurement("angle", self._names[record.fault_axis], record.fault_value, record.tick)


def terminals(plant: ServoPlant, wired: Wired, places: Counts, edges: Counts) -> Terminals | None:
    """Return what runs this plant's motors in C; None where there is no library, or no FMI functions.

    `places` and `edges` are each encoder's, of 64 bits, and never get longer: C writes them where they are.
    """
    library = choose().library
    if library is None or not isinstance(plant, NativePlant):
        return None
    return Terminals(library.servo_turn, plant, wired, places, edges)
