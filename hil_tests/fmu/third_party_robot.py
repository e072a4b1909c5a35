"""A third party's robot for PythonFMU, written without a look at our plant: four motors and plain kinematics.

It has the names and nothing else: no units, no saved states, no friction, no slip.
"""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

AXES = ("left", "right", "steer", "lift")
RESISTANCE = {"left": 0.103, "right": 0.103, "steer": 2.32, "lift": 9.0}
INDUCTANCE = {"left": 72e-6, "right": 72e-6, "steer": 238e-6, "lift": 0.6e-3}
CONSTANT = {"left": 0.0385, "right": 0.0385, "steer": 0.0234, "lift": 0.025}
INERTIA = {"left": 3e-4, "right": 3e-4, "steer": 2e-6, "lift": 1e-6}
READINGS = ("x", "y", "heading", "speed", "yaw_rate", "rack", "steer", "lift_height")


class ThirdParty(Fmi2Slave):  # type: ignore[misc] # PythonFMU has no type information
    """Motors with inertia alone; wheels that roll; a rack that turns the wheels as arctan does."""

    def __init__(self, **options: object) -> None:
        super().__init__(**options)
        self.fails_at = 1e9
        self.battery_voltage = 24.0
        for name in READINGS:
            setattr(self, name, 0.0)
        for axis in AXES:
            for quantity in ("voltage", "current", "angle", "speed"):
                setattr(self, f"{quantity}_{axis}", 0.0)
            self.register_variable(Real(f"voltage_{axis}", causality=Fmi2Causality.input))
        for name in (
            *(f"{quantity}_{axis}" for quantity in ("current", "angle", "speed") for axis in AXES),
            *READINGS,
            "battery_voltage",
        ):
            self.register_variable(Real(name, causality=Fmi2Causality.output))
        self.register_variable(
            Real("fails_at", causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed)
        )

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Move on; from `fails_at` on it gives up."""
        if current_time >= self.fails_at:
            return False
        values = self.__dict__
        for axis in AXES:
            speed = values[f"speed_{axis}"]
            steady = (values[f"voltage_{axis}"] - CONSTANT[axis] * speed) / RESISTANCE[axis]
            fade = math.exp(-step_size * RESISTANCE[axis] / INDUCTANCE[axis])
            current = steady + (values[f"current_{axis}"] - steady) * fade
            speed += step_size * CONSTANT[axis] * current / INERTIA[axis]
            values[f"current_{axis}"] = current
            values[f"speed_{axis}"] = speed
            values[f"angle_{axis}"] += step_size * speed
        self._roll(step_size)
        return True

    def _roll(self, step_size: float) -> None:
        left, right = (0.05 * self.__dict__[f"speed_{axis}"] / 26.0 for axis in ("left", "right"))
        self.speed = (left + right) / 2
        self.yaw_rate = (right - left) / 0.4
        self.heading += step_size * self.yaw_rate
        self.x += step_size * self.speed * math.cos(self.heading)
        self.y += step_size * self.speed * math.sin(self.heading)
        self.rack = 0.015 * self.__dict__["angle_steer"] / 159.0
        self.steer = math.atan(self.rack / 0.03)
        self.lift_height = max(0.0, 0.0015 * self.__dict__["angle_lift"] / (2 * math.pi * 25.0))
