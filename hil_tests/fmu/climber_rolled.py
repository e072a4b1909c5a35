"""The climber's FMU under given wheel speeds, without its motors: its rates, integrated here."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt

from fmu.build import ensure
from fmu.climber.parameters import PARAMETERS
from hil_tests.fmu.instance import Instance

Vector = npt.NDArray[np.float64]
LIGHT: Mapping[str, float] = {
    "gravity": 0.0,
    "joint_spring": 0.0,
    "joint_damping": 0.0,
    "stop_stiffness": 0.0,
}
"""Nothing pulls at its wheels, so nothing slides."""
NUMBERS: Mapping[str, float] = {row.name: row.start for row in PARAMETERS}


class Rolled:
    """An instance for model exchange with these parameters; `start` is what it stands at."""

    def __init__(self, folder: Path, parameters: Mapping[str, float], *, light: bool = True) -> None:
        self.numbers = {**NUMBERS, **parameters, **(LIGHT if light else {})}
        self._instance = Instance(ensure("climber", 3), folder, "model")
        self._instance.write(**{**parameters, **(LIGHT if light else {})})
        self._instance.initialize()
        self.names = self._instance.state_names
        self.start = dict(zip(self.names, self._instance.states(), strict=True))

    def close(self) -> None:
        self._instance.fmu.freeInstance()

    def rates(self, state: Mapping[str, float]) -> dict[str, float]:
        """Return the rates of all states there."""
        self._instance.set_states([state[name] for name in self.names])
        return dict(zip(self.names, self._instance.rates(), strict=True))

    def driven(
        self,
        left: Callable[[float], float],
        right: Callable[[float], float],
        seconds: float,
        step: float = 0.02,
    ) -> list[dict[str, float]]:
        """Return the states at every step of a run at these wheel speeds in rad/s."""
        gear = self.numbers["gear_wheel"]
        speeds = [self.names.index(f"speed_{side}") for side in ("left", "right")]
        instance = self._instance

        def slope(t: float, at: Vector) -> Vector:
            at[speeds] = gear * left(t), gear * right(t)
            instance.set_states(list(at))
            found = np.array(instance.rates())
            found[speeds] = 0.0
            # Currents are not looked at, and they are quick.
            found[[self.names.index(f"current_{side}") for side in ("left", "right")]] = 0.0
            return found

        x = np.array([self.start[name] for name in self.names])
        rows = [dict(zip(self.names, map(float, x), strict=True))]
        for count in range(round(seconds / step)):
            t = count * step
            a = slope(t, x.copy())
            b = slope(t + step / 2, x + step / 2 * a)
            c = slope(t + step / 2, x + step / 2 * b)
            d = slope(t + step, x + step * c)
            x = x + step / 6 * (a + 2 * b + 2 * c + d)
            rows.append(dict(zip(self.names, map(float, x), strict=True)))
        return rows
