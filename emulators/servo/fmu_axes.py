"""A plant from an FMU below some axes: which variables they need, and which they take where it has them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from types import MappingProxyType
from typing import Final

from emulators.servo.axis import TICK, ServoAxis
from emulators.servo.bank import ServoBank, plant_inputs, plant_outputs
from emulators.servo.pins import input_lines, output_lines, pin_inputs, pin_outputs
from emulators.servo.sensor_lines import sensor_lines, sensor_outputs
from emulators.servo.winding import set_winding
from firmware_bridge.units import Nanoseconds
from fmu.interface import units
from fmu.plant import FmuPlant, PlantError, variables_of

SUPPLY: Final = "battery_voltage"
"""The plant's output that feeds the devices, V."""
HELD: Final = "held_"
"""Prefix of an axis: the input by which something rubs at its output, N m, where the plant has it."""
GRIP_LOST: Final = "grip_lost_"
"""Prefix likewise: the input that takes its grip on the surface away, 1 for all of it."""
LIFTED: Final = "lifted_"
"""Prefix of an axis: the input that is 1 where its load is in the air, where the plant has it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantNeeds:
    """Variables of a plant that a device uses."""

    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    """Outputs in the order in which the device reads them."""
    units: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    """Required units."""
    optional_inputs: tuple[str, ...] = ()
    optional_outputs: tuple[str, ...] = ()
    """Variables that are used where the plant has them."""
    mirrored: tuple[str, ...] = ()
    """Inputs and outputs of motors that are mounted the other way round."""


_VOLTAGE: Final = "voltage_"


def axes_of(path: Path) -> tuple[str, ...]:
    """Return the axes of an FMU in its own order: those with an input `voltage_AXIS`; PlantError."""
    inputs = [it.name for it in variables_of(path) if it.causality == "input"]
    return tuple(name.removeprefix(_VOLTAGE) for name in inputs if name.startswith(_VOLTAGE))


def axis_needs(
    axes: Sequence[str], outputs: Sequence[str] = (), *, mirrored: Sequence[str] = ()
) -> PlantNeeds:
    """Return the needs of motors that are driven by voltages, with further outputs.

    The motors that are `mirrored` are mounted the other way round.
    """
    return PlantNeeds(
        inputs=plant_inputs(axes),
        # Currents, angles and speeds first, where kernel and reference expect them.
        outputs=(*plant_outputs(axes), *outputs),
        units=units(axes),
        optional_inputs=(
            *pin_inputs(axes),
            *(f"{what}{axis}" for what in (HELD, LIFTED, GRIP_LOST) for axis in axes),
        ),
        optional_outputs=(*pin_outputs(axes), *sensor_outputs(axes)),
        mirrored=(*plant_inputs(mirrored), *plant_outputs(mirrored)),
    )


def load_plant(
    path: Path,
    needs: Sequence[PlantNeeds],
    parameters: Mapping[str, float],
    outputs: Sequence[str] = (),
    step: Nanoseconds = TICK,
) -> FmuPlant:
    """Load the plant of these devices, first the one that steps it; `outputs` are shown. PlantError."""
    read = tuple(dict.fromkeys(chain(*(one.outputs for one in needs))))
    optional = chain(*(one.optional_outputs for one in needs))
    return FmuPlant(
        path,
        tuple(chain(*(one.inputs for one in needs))),
        read,
        parameters,
        step,
        units=dict(chain(*(one.units.items() for one in needs))),
        optional_inputs=tuple(chain(*(one.optional_inputs for one in needs))),
        optional_outputs=[name for name in dict.fromkeys(optional) if name not in read],
        mirrored=tuple(chain(*(one.mirrored for one in needs))),
        shown=tuple(dict.fromkeys(outputs)),
    )


def fmu_bank(
    plant: FmuPlant,
    axes: Sequence[ServoAxis],
    supply: int | None = None,
    analogue: tuple[str, float] | None = None,
    mirrored: Sequence[str] = (),
) -> ServoBank:
    """Put axes above such a plant, with the pins and sensors that it has; see `ServoBank`.

    An axis that is `mirrored` has the plant's lower limit switch at its drive's positive input.
    """
    names = [axis.name for axis in axes]
    return ServoBank(
        plant,
        axes,
        supply=supply,
        analogue=analogue,
        input_lines=input_lines(plant.output_names, names, mirrored)
        + sensor_lines(plant.output_names, names),
        output_lines=output_lines(plant.input_names, names),
    )


def set_motor(plant: FmuPlant, axis: ServoAxis) -> None:
    """Set an axis to the plant's data of its motor; missing ones stay unknown."""
    set_winding(axis, *winding_of(plant, axis.name))


def winding_of(plant: FmuPlant, axis: str) -> tuple[float, float, float]:
    """Return the plant's torque constant, resistance and inductance of a motor; 0 for unknown ones."""
    constant, resistance, inductance = (
        _start_of(plant, f"{name}_{axis}") for name in ("torque_constant", "resistance", "inductance")
    )
    return constant, resistance, inductance


def _start_of(plant: FmuPlant, parameter: str) -> float:
    try:
        return plant.read(parameter)
    except PlantError:
        return 0.0
