"""The plant of RARS alone, without drives and bridge: for studies that turn its wheels by torque."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final, Self

from firmware_bridge.units import SECOND, Nanoseconds
from fmu.build import ensure
from fmu.plant import FmuPlant
from fmu.rars.interface import INPUTS, OUTPUTS
from fmu.rars.parameters import PARAMETERS

P: Final[Mapping[str, float]] = MappingProxyType({row.name: row.start for row in PARAMETERS})
"""The plant's parameters, as it starts with them."""
WHEELS: Final = ("left", "right")
PLAIN: Final[Mapping[str, float]] = MappingProxyType(
    {f"{part}_{axis}": 0.0 for part in ("coulomb", "viscous") for axis in WHEELS}
    | {"rolling_resistance": 0.0}
)
"""Wheels without friction in motor and bearing: the study is about the torque at the rim."""
STEP: Final[Nanoseconds] = 100_000


class Plant:
    """A plant that is stepped by hand; use it in a `with`. Torques in N.m at the wheel, angles in rad."""

    def __init__(self, **parameters: float) -> None:
        self._names = tuple(OUTPUTS)
        self._plant = FmuPlant(ensure("rars"), tuple(INPUTS), self._names, parameters, STEP)
        self._values = {**P, **parameters}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._plant.close()

    def __getitem__(self, name: str) -> float:
        """Return an output of the last step, or any other variable of the plant."""
        if name in OUTPUTS:
            return float(self._plant.outputs[self._names.index(name)])
        return self._plant.read(name)

    def turn(self, torque_left: float, torque_right: float) -> None:
        """Set the voltages that give these torques at the wheels at their present speeds, and take a step.

        The winding lags by 0.7 ms; its resistance and voltage of motion are made up for.
        """
        for place, (axis, torque) in enumerate(zip(WHEELS, (torque_left, torque_right), strict=True)):
            constant = self._values[f"torque_constant_{axis}"]
            current = torque / (constant * self._values[f"gear_{axis}"])
            speed = self[f"speed_{axis}"]
            self._plant.inputs[place] = self._values[f"resistance_{axis}"] * current + constant * speed
        self._plant.step()

    def steer(self, volts: float) -> None:
        """Set the steering motor's voltage from the next step on."""
        self._plant.inputs[2] = volts

    def lift(self, volts: float) -> None:
        """Set the lift motor's voltage from the next step on."""
        self._plant.inputs[3] = volts

    def rests(self, seconds: float) -> None:
        """Run on with the motors' voltages as they are, s."""
        for _ in range(round(seconds * SECOND / STEP)):
            self._plant.step()
