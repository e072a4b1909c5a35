"""A plant from an FMU below some axes: which variables they need, and which they take where it has them."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank, plant_inputs, plant_outputs
from emulators.servo.pins import input_lines, output_lines, pin_inputs, pin_outputs
from emulators.servo.sensor_lines import sensor_lines, sensor_outputs
from emulators.servo.winding import set_winding
from fmu.interface import units
from fmu.plant import FmuPlant, PlantError

HELD: Final = "held_"
"""Prefix of an axis: the input by which something rubs at its output, N m, where the plant has it."""
GRIP_LOST: Final = "grip_lost_"
"""Prefix likewise: the input that takes its grip on the surface away, 1 for all of it."""
LIFTED: Final = "lifted_"
"""Prefix of an axis: the input that is 1 where its load is in the air, where the plant has it."""


def fmu_plant(
    path: Path,
    axes: Sequence[str],
    parameters: Mapping[str, float],
    more: Sequence[str] = (),
    optional: Sequence[str] = (),
    *,
    set_by_plant: Sequence[str] = (),
    mirrored: Sequence[str] = (),
) -> FmuPlant:
    """Load the plant of these axes; PlantError.

    `set_by_plant` are inputs needed beside theirs, `more` outputs; `optional` are outputs that are read
    where it has them. `mirrored` are inputs and outputs of motors that are mounted the other way round.
    """
    own = plant_outputs(axes)
    return FmuPlant(
        path,
        (*plant_inputs(axes), *set_by_plant),
        # Currents, angles and speeds first, where kernel and reference expect them.
        (*own, *(name for name in dict.fromkeys(more) if name not in own)),
        parameters,
        units=units(axes),
        optional_inputs=(
            *pin_inputs(axes),
            *(f"{what}{axis}" for what in (HELD, LIFTED, GRIP_LOST) for axis in axes),
        ),
        optional_outputs=(
            *pin_outputs(axes),
            *sensor_outputs(axes),
            *(it for it in optional if it not in more),
        ),
        mirrored=mirrored,
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
    constant, resistance, inductance = (
        _start_of(plant, f"{name}_{axis.name}") for name in ("torque_constant", "resistance", "inductance")
    )
    set_winding(axis, constant, resistance, inductance)


def _start_of(plant: FmuPlant, parameter: str) -> float:
    try:
        return plant.read(parameter)
    except PlantError:
        return 0.0
