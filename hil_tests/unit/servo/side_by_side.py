"""Reference and kernel side by side: one plant in C, the same commands, both states compared to the bit."""

import ctypes
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NoReturn, TypeAlias

from emulators.servo import kernel
from emulators.servo.axis import CURRENT, DIRECT, MOVE, POSITION, RAMP, TICK, TRAPEZOID, VELOCITY, ServoAxis
from emulators.servo.bank import ServoBank, ServoError
from emulators.servo.commands import brake, judge_again, regulate_position, regulate_velocity
from emulators.servo.pins import PinWire
from emulators.servo.profile import stopping_distance
from emulators.servo.record import FIELDS
from emulators.servo.scaling import Settings, acceleration_units, configure, speed_units
from emulators.servo.winding import set_winding
from firmware_bridge.units import Nanoseconds
from fmu.calls import OK_OR_WARNING, Calls, PlantRecord, prepare
from fmu.errors import PlantError
from hil_tests.unit.servo.planned_orders import FIRST_PLANNED, obey_planned

KERNEL: Final = tuple(sorted(kernel.NATIVE_FOLDER.glob("*.c")))
PLANT: Final = (Path(__file__).parent / "plant.c",)
FLAGS: Final = ("-std=c99", "-ffp-contract=off", "-fPIC", "-shared")
COMPILERS: Final = tuple(path for name in ("gcc", "clang") if (path := shutil.which(name)))
COUNT: Final = 4
SANE: Final = Settings(
    current_p=180,
    current_i=60,
    velocity_p=1200,
    velocity_i=150,
    position_p=300,
    position_i=500,
    position_d=300,
)
MADE: Final = "a motor of the test"
REFERENCE: Final = kernel.KernelLibrary(None, "the other side")


def compiled(folder: Path, sources: Sequence[Path], *flags: str, compiler: str = COMPILERS[0]) -> Path:
    target = folder / f"{sources[0].stem}-{Path(compiler).name}{''.join(flags)}.so".replace("=", "")
    command = [
        compiler,
        *FLAGS,
        f"-DSERVO_SOURCE={kernel.source()}u",
        *flags,
        "-o",
        str(target),
        *map(str, sources),
    ]
    subprocess.run(command, check=True, capture_output=True)
    return target


class Motors:
    """Motors in C behind FMI functions; reference and kernel step them alike."""

    def __init__(
        self, library: ctypes.CDLL, fmi: int = 3, *, count: int = COUNT, seed: int = 1, noise: float = 0.02
    ) -> None:
        self._library = library
        library.plant_new.argtypes = (ctypes.c_int64, ctypes.c_uint32, ctypes.c_double)
        library.plant_new.restype = ctypes.c_void_p
        self._instance: int = library.plant_new(count, seed, noise)
        self._calls: Calls = prepare(
            library, self._instance, fmi, range(2 * count), range(3 * count + 1), step=TICK
        )
        self.inputs, self.outputs = self._calls.inputs, self._calls.outputs
        self._calls.read(*self._calls.read_arguments)

    @property
    def record(self) -> PlantRecord:
        return self._calls.record

    def step(self) -> None:
        calls, record = self._calls, self._calls.record
        calls.time.value = record.steps_done * TICK / 1e9
        if (status := calls.write(*calls.write_arguments)) > OK_OR_WARNING:
            self.failed("setting the inputs", status)
        if (status := calls.step(*calls.step_arguments)) > OK_OR_WARNING:
            self.failed("doStep", status)
        record.steps_done += 1
        if (status := calls.read(*calls.read_arguments)) > OK_OR_WARNING:
            self.failed("reading the outputs", status)

    def failed(self, action: str, status: int) -> NoReturn:
        raise PlantError(f"{MADE}: {action} failed after {self.record.steps_done} steps with {status}")

    def breaks(self, at: int, failing: int, replaced: int = 0, replacement: float = 0.0) -> None:
        call = self._library.plant_break
        call.argtypes = (*(ctypes.c_void_p,), *(ctypes.c_int64,) * 3, ctypes.c_double)
        call.restype = None
        call(self._instance, at, failing, replaced, replacement)


@dataclass(frozen=True, slots=True)
class Order:
    """Action on one axis before an advance."""

    axis: int
    kind: int
    """0 power, 1 velocity, 2 position, 3 current, 4 brake, 5 call, 6 to 7 direct modes, 8 watches.

    From 10 on: `hil_tests.unit.servo.planned_orders`.
    """
    value: int
    speed: int
    up: int
    down: int


@dataclass(frozen=True, slots=True)
class Leg:
    """Orders, then an advance of so many ticks."""

    orders: tuple[Order, ...]
    ticks: int


Event: TypeAlias = tuple[Nanoseconds, tuple[str, ...]]


def obey(axis: ServoAxis, order: Order) -> None:
    if order.kind == 0:
        if axis.powered:
            axis.switch_off()
        else:
            axis.switch_on()
    elif order.kind == 5:
        axis.call = 1
    elif order.kind == 8:
        axis.pins_watched, axis.index_watched = order.value & 7, order.value >> 3 & 1
        axis.current_watched_ma, axis.outputs = order.up & 0xFFF, order.down
    elif order.kind >= FIRST_PLANNED:
        obey_planned(axis, order.kind, order.value, order.speed, (order.up, order.down))
    elif axis.powered:
        _move(axis, order)


def _move(axis: ServoAxis, order: Order) -> None:
    axis.acceleration = acceleration_units(axis, order.up)
    axis.deceleration = acceleration_units(axis, order.down)
    axis.profile, axis.shape, axis.analogue_input = DIRECT, TRAPEZOID, 0
    if order.kind == 1:
        regulate_velocity(axis)
        axis.profile, axis.target_velocity = RAMP, speed_units(axis, order.speed)
    elif order.kind == 2:
        regulate_position(axis)
        axis.profile, axis.target_position = MOVE, order.value << axis.fraction
        axis.cruise = speed_units(axis, abs(order.speed))
        axis.stopping_distance = stopping_distance(axis.cruise, axis.deceleration)
    elif order.kind == 3:
        axis.regulator, axis.current_setting_ma = CURRENT, order.value
    elif order.kind == 4:
        brake(axis, order.down)
    elif order.kind == 6:
        regulate_velocity(axis)
        axis.regulator = VELOCITY
        axis.velocity_demand = axis.target_velocity = speed_units(axis, order.speed)
    else:
        regulate_position(axis)
        axis.regulator = POSITION
        axis.position_demand = axis.target_position = order.value << axis.fraction
        axis.velocity_demand = 0
    judge_again(axis, there=False)


class Side:
    """One of the two: its plant, its axes, its bank."""

    def __init__(self, plant: Motors, settings: tuple[Settings, ...], servo: kernel.KernelLibrary) -> None:
        self.plant = plant
        self.axes = [ServoAxis(f"axis{k}", 4 * raw.encoder_pulses) for k, raw in enumerate(settings)]
        for axis, raw in zip(self.axes, settings, strict=True):
            configure(axis, raw)
        # The motors of plant.c: one fully known, one by its constant, the others unknown.
        set_winding(self.axes[0], 0.04, 0.6, 1 / 3000)
        if len(self.axes) > 1:
            set_winding(self.axes[1], 0.04)
        count = len(self.axes)
        supply = 3 * count
        # Whatever rises above 0.5 closes a switch: the currents in A, the speeds in rad/s.
        switches = [PinWire(k, 1 << row, row * count + k) for k in range(count) for row in (0, 2)]
        self.bank = ServoBank(
            plant,
            self.axes,
            supply=supply,
            analogue=("axis0", 6.0),
            input_lines=switches,
            output_lines=[PinWire(k, 1 << k, count + k) for k in range(count)],
            servo=servo,
        )

    def runs(self, leg: Leg) -> list[Event]:
        """Obey, and advance to the end of the leg; return every event on the way."""
        for order in leg.orders:
            obey(self.axes[order.axis], order)
        until = self.bank.now + leg.ticks * TICK
        events = [self.bank.advance(until)]
        while events[-1][0] < until:
            events.append(self.bank.advance(until))
        return events

    def lives(self, leg: Leg) -> list[Event] | str:
        """Run on; where wild gains drive the motors out of all bounds, return the bank's error text."""
        try:
            return self.runs(leg)
        except ServoError as refusal:
            return str(refusal)

    def bits(self) -> bytes:
        plant = bytes(memoryview(self.plant.inputs)) + bytes(memoryview(self.plant.outputs))
        return b"".join(bytes(axis) for axis in self.axes) + plant


def difference(one: Side, other: Side) -> str:
    """Name the first field that differs; empty where both are the same to the bit."""
    if one.bits() == other.bits():
        return ""
    for left, right in zip(one.axes, other.axes, strict=True):
        for field in FIELDS:
            a, b = getattr(left, field), getattr(right, field)
            if a != b:
                return f"{left.name}.{field}: {a} and {b} at tick {one.bank.now // TICK}"
    return f"the plants differ at tick {one.bank.now // TICK}"
