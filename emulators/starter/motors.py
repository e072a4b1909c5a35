"""Motors by name, as the catalogue has them, and any other one from a small TOML file of the same keys."""

import tomllib
from pathlib import Path
from typing import Final

from pydantic import ValidationError

from firmware_bridge.robot.problems import near, problems_of
from firmware_bridge.robot.table import Positive, Table
from fmu.parts.catalogue import RE25, RE40, RE50, Sheet


class MotorError(Exception):
    """A motor that is not known, or whose data are wrong: one message."""


class Motor(Table):
    """A brushed motor's data sheet; SI."""

    title: str
    resistance_ohm: Positive
    inductance_h: Positive
    torque_constant_nm_a: Positive
    rotor_inertia_kg_m2: Positive
    no_load_current_a: Positive
    continuous_current_a: Positive

    def no_load_speed(self, voltage_v: float) -> float:
        """Return its speed without load in rad/s."""
        return (voltage_v - self.resistance_ohm * self.no_load_current_a) / self.torque_constant_nm_a


def _of(title: str, sheet: Sheet, continuous_current_a: float) -> Motor:
    return Motor(
        title=title,
        resistance_ohm=sheet["resistance"],
        inductance_h=sheet["inductance"],
        torque_constant_nm_a=sheet["torque_constant"],
        rotor_inertia_kg_m2=sheet["rotor_inertia"],
        no_load_current_a=sheet["no_load_current"],
        continuous_current_a=continuous_current_a,
    )


MOTORS: Final = {
    "RE25": _of("maxon RE25 20 W 24 V", RE25, 1.2),
    "RE40": _of("maxon RE40 150 W 24 V (148867)", RE40, 5.77),
    "RE50": _of("maxon RE50 200 W 24 V (370354)", RE50, 10.0),
}
"""ASSUME, from the catalogue, unchecked: compare with the data sheet of the motor that is there."""


def motor(name: str) -> Motor:
    """Return a motor by its name, or from a path that ends in .toml; MotorError."""
    if name.endswith(".toml"):
        try:
            return Motor.model_validate(tomllib.loads(Path(name).read_text(encoding="utf-8")))
        except ValidationError as error:
            wrong = "; ".join(f"{key}: {problem}" for key, problem in problems_of(error, Motor))
            raise MotorError(f"{name}: {wrong}") from error
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise MotorError(f"{name}: cannot be read: {error}") from error
    if name not in MOTORS:
        raise MotorError(
            f"--motor: no motor '{name}' is known; {near(name, MOTORS)} a .toml file with its data will do"
        )
    return MOTORS[name]


def names() -> list[str]:
    """Return the names of the motors that are known."""
    return list(MOTORS)
