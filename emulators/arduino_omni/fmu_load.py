"""Loads of an emulated motor shield, from an FMU.

It is independent of the board.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from emulators.arduino_omni.motors import MotorLoad
from emulators.arduino_omni.shield.motor_shield import PORTS
from emulators.servo.fmu_axes import SUPPLY, axes_of
from emulators.servo.seam import plant_inputs, plant_outputs
from fmu.errors import PlantError
from fmu.interface import PLANAR, units
from fmu.plant import FmuPlant

CONSTANT: Final = "torque_constant_"


def fmu_load(path: Path, axes: Sequence[str] = ()) -> MotorLoad:
    """Put the FMU's axes at the terminals M1, M2 and so on, in their order, or the FMU's own.

    Where it has a battery, that is the shield's supply. PlantError for an FMU that cannot be used.
    """
    names = tuple(axes) or axes_of(path)
    if not 1 <= len(names) <= len(PORTS):
        raise PlantError(
            f"{path}: a shield has {len(PORTS)} terminals, and these are {len(names)} axes"
            f" ({', '.join(names) or 'no input voltage_AXIS'}); name those that it turns"
        )
    plant = FmuPlant(
        path,
        plant_inputs(names),
        plant_outputs(names),
        units={**units(names), SUPPLY: PLANAR[SUPPLY]},
        optional_outputs=(SUPPLY,),
    )
    supply = plant.output_names.index(SUPPLY) if SUPPLY in plant.output_names else None
    return MotorLoad(plant, names, tuple(torque_constant(plant, name) for name in names), supply)


def torque_constant(plant: FmuPlant, axis: str) -> float:
    """Return a motor's torque constant, N m/A: its own, or the only one that the plant has; PlantError."""
    known = [name for name in plant.variables if name.startswith(CONSTANT)]
    own = f"{CONSTANT}{axis}"
    if own in known:
        return plant.read(own)
    # Motors of one type may share one parameter.
    if len(known) == 1:
        return plant.read(known[0])
    raise PlantError(f"{plant.path}: the FMU lacks the parameter '{own}', which a motor that runs free needs")
