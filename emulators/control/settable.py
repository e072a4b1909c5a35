"""What may be set on running devices: inputs, supplies, and what the plant declares tunable; a row each."""

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from operator import setitem
from typing import Final

from emulators.family import Devices
from emulators.servo.axis import ServoAxis
from emulators.servo.pins import INPUT_PINS
from firmware_bridge.robot.problems import near
from fmu.plant import FmuPlant

MILLI: Final = 1000
HIGHEST_V: Final = 100.0
"""A drive's supply and its analog inputs: beyond every product's range."""


class SettingError(Exception):
    """A name that cannot be set, or a value that it cannot have."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One name of each axis, as `left.supply_v`."""

    name: str
    text: str
    least: float
    most: float
    put: Callable[[ServoAxis, float], None]


def _pin(number: int) -> Callable[[ServoAxis, float], None]:
    mask = 1 << (number - 1)

    def put(axis: ServoAxis, value: float) -> None:
        axis.pins = axis.pins | mask if value else axis.pins & ~mask

    return put


def _supply(axis: ServoAxis, volts: float) -> None:
    axis.force_supply(round(volts * MILLI))


def _analog_1(axis: ServoAxis, volts: float) -> None:
    axis.analogue_1_mv = round(volts * MILLI)


def _analog_2(axis: ServoAxis, volts: float) -> None:
    axis.analogue_2_mv = round(volts * MILLI)


ROWS: Final = (
    Setting("supply_v", "voltage at the drive's supply, in V; 0 gives its own back", 0.0, HIGHEST_V, _supply),
    Setting("analog1_v", "voltage at analog input 1, in V", -HIGHEST_V, HIGHEST_V, _analog_1),
    Setting("analog2_v", "voltage at analog input 2, in V", -HIGHEST_V, HIGHEST_V, _analog_2),
    *(
        Setting(f"input{number}", f"level of digital input {number}: 0 or 1", 0.0, 1.0, _pin(number))
        for number in range(1, INPUT_PINS + 1)
    ),
)
"""Names of a drive's axis. A level that the plant itself has is overwritten by the plant within 1 ms."""


class Settable:
    """Everything that can be set on these devices."""

    def __init__(self, devices: Devices, plant: FmuPlant | None) -> None:
        """Take the devices, and the plant that they move where it is an FMU."""
        self._axes: Final = devices.motors(ServoAxis)
        self._plant: Final = plant
        driven = re.compile(r"^(voltage|held|lifted|grip_lost)_")
        inputs = () if self._plant is None else self._plant.input_names
        self._inputs: Final = tuple(name for name in inputs if not driven.match(name))

    @property
    def names(self) -> tuple[str, ...]:
        """The names, those of the axes first."""
        return tuple(self._names())

    def setting(self, name: str, value: float) -> Callable[[], None]:
        """Return what sets a value, or raises PlantError; SettingError for what is not possible."""
        if not math.isfinite(value):
            raise SettingError(f"{name}: give a number, not {value}")
        axis_name, _, own = name.rpartition(".")
        axis = self._axes.get(axis_name)
        row = next((row for row in ROWS if row.name == own), None)
        if axis is not None and row is not None:
            if not row.least <= value <= row.most:
                raise SettingError(f"{name}={value:g}: give {row.least:g} to {row.most:g}: {row.text}")
            return partial(row.put, axis, value)
        if self._plant is not None and name in self._inputs:
            return partial(setitem, self._plant.inputs, self._plant.input_names.index(name), value)
        if self._plant is not None and name in self._plant.tunable:
            return partial(self._plant.change, name, value)
        raise SettingError(f"no such setting as '{name}'; {near(name, self.names, most=len(self.names))}")

    def _names(self) -> Iterator[str]:
        for axis in self._axes:
            yield from (f"{axis}.{row.name}" for row in ROWS)
        yield from self._inputs
        yield from () if self._plant is None else self._plant.tunable
