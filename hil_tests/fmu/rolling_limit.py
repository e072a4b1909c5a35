"""RARS without slip: the plant's own equations, its tyres' pulls chosen so that the rear wheels keep rolling.

What the model without slip had in closed form must come out of the model with tyres, exactly, in this limit.
"""

from collections.abc import Callable, Mapping
from functools import cache

import numpy as np

from fmu.rars.equations import model
from fmu.rars.parameters import PARAMETERS
from hil_tests.fmu.model_bench import rates

RIGID: Mapping[str, float] = {
    "floor_friction": 1e12,  # nothing is wiped off, so a tyre's force is its spring's alone
    "tyre_damping": 0.0,
    "rolling_resistance": 0.0,
    "cg_height": 0.0,
}
REAR = ("tyre_ahead_rear_left", "tyre_ahead_rear_right", "tyre_left_rear_left")
Rates = Callable[..., dict[str, float]]


_model = cache(model)


def rolling(parameters: Mapping[str, float]) -> Rates:
    """Return the rates of all states by name for given shaft speeds and currents; front tyres off."""
    function = rates(_model(), {**RIGID, **parameters})
    p = {row.name: row.start for row in PARAMETERS} | dict(parameters)
    radius, half = p["wheel_radius"], p["rear_track"] / 2

    def slipping(found: Mapping[str, float]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        left, right = (radius * found[f"speed_{side}"] / p[f"gear_{side}"] for side in ("left", "right"))
        ahead, turning = found["speed"], half * found["yaw_rate"]
        return np.array([left - ahead + turning, right - ahead - turning, found["drift"]])

    def limit(**given: float) -> dict[str, float]:
        wheels = [radius * given.get(f"speed_{side}", 0.0) / p[f"gear_{side}"] for side in ("left", "right")]
        moving = {"speed": sum(wheels) / 2, "yaw_rate": (wheels[1] - wheels[0]) / (2 * half)} | given
        # Accelerations are linear in the pulls: three unit pulls show which ones leave no slip.
        free = slipping(function(**moving))
        unit = 1e-4
        pulled = [slipping(function(**moving, **{name: unit})) - free for name in REAR]
        pulls = np.linalg.solve(np.array(pulled).T, -free) * unit
        found: dict[str, float] = function(**moving, **dict(zip(REAR, map(float, pulls), strict=True)))
        return found

    return limit
