"""Motors by name or order number, and any other one from a small TOML file of the same keys.

`motors.csv` has those whose published figures agree with each other within 5 %, each with its source; stalled
at its nominal voltage, turning without load and at its constants. EC motors stand there as the DC motors that
they are equivalent to.
"""

import csv
import tomllib
from functools import cache
from pathlib import Path
from typing import Annotated, Final, Literal, TypeAlias

from pydantic import Field, ValidationError

from firmware_bridge.robot.problems import near, nearest, problems_of
from firmware_bridge.robot.table import NonNegative, Positive, Table
from fmu.parts.catalogue import RE25, RE40, RE50, MotorSheet

FILE: Final = Path(__file__).with_name("motors.csv")
MOST_SHOWN: Final = 12


MotorType: TypeAlias = Literal["dc", "ec"]
"""Brushed, or with three phases."""


class MotorError(Exception):
    """A motor that is not known, or whose data are wrong: one message."""


class Motor(Table):
    """A motor's data sheet; SI."""

    title: str
    resistance_ohm: Positive
    inductance_h: Positive
    torque_constant_nm_a: Positive
    rotor_inertia_kg_m2: Positive
    no_load_current_a: Positive
    continuous_current_a: Positive
    kind: MotorType = "dc"
    """Brushed, or with three phases and hall sensors, as the DC motor that it is equivalent to."""
    pole_pairs: Annotated[int | None, Field(ge=1, le=255)] = None
    """Number of pole pairs; None where no source gives it."""
    friction_nm: NonNegative | None = None
    """Friction at the shaft; None: that which the no-load current overcomes."""
    source: str = ""

    @property
    def friction(self) -> float:
        """The friction at its shaft, N m."""
        if self.friction_nm is not None:
            return self.friction_nm
        return self.torque_constant_nm_a * self.no_load_current_a

    def no_load_speed(self, voltage_v: float) -> float:
        """Return its speed without load in rad/s."""
        # The no-load current's voltage drop is not available for the back-EMF.
        return (voltage_v - self.resistance_ohm * self.no_load_current_a) / self.torque_constant_nm_a


def _of(title: str, sheet: MotorSheet, continuous_current_a: float) -> Motor:
    return Motor(
        title=title,
        resistance_ohm=sheet["resistance"],
        inductance_h=sheet["inductance"],
        torque_constant_nm_a=sheet["torque_constant"],
        rotor_inertia_kg_m2=sheet["rotor_inertia"],
        no_load_current_a=sheet["no_load_current"],
        continuous_current_a=continuous_current_a,
        source="assumed, from the catalog, unchecked",
    )


MOTORS: Final = {
    "RE25": _of("maxon RE25 20 W 24 V", RE25, 1.2),
    "RE40": _of("maxon RE40 150 W 24 V (148867)", RE40, 5.77),
    "RE50": _of("maxon RE50 200 W 24 V (370354)", RE50, 10.0),
}
"""Assumed, from the catalog, unchecked: compare with the data sheet of the motor that is there."""


@cache
def catalogue() -> dict[str, Motor]:
    """Return every motor of the file by its order number, or by its name where no source gives one."""
    numbers = ("resistance_ohm", "inductance_h", "torque_constant_nm_a", "rotor_inertia_kg_m2")
    currents = ("no_load_current_a", "continuous_current_a")
    found = {}
    with FILE.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            order, name = row["order_number"], row["name"]
            found[order or name] = Motor.model_validate(
                {
                    "title": f"{name} ({order})" if order and order not in name else name,
                    **{key: float(row[key]) for key in (*numbers, *currents)},
                    "kind": row["kind"],
                    "pole_pairs": int(row["pole_pairs"]) if row["pole_pairs"] else None,
                    "source": row["source"],
                }
            )
    return found


def motor(name: str) -> Motor:
    """Return a motor by its order number or name, or from a path that ends in .toml; MotorError.

    A part of a name will do where one motor has it.
    """
    if name.endswith(".toml"):
        return _from_file(name)
    if name in MOTORS:
        return MOTORS[name]
    known = catalogue()
    for number, one in known.items():
        if name.casefold() in {number.casefold(), one.title.casefold()}:
            return one
    words = name.casefold().split()
    found = [one for one in known.values() if words and all(word in one.title.casefold() for word in words)]
    if len(found) == 1:
        return found[0]
    if found:
        raise MotorError(f"--motor {name}: {len(found)} motors have it in their names: {_listed(found)}")
    short = ", ".join(MOTORS)
    known_names = f"there are {short}, and {len(known)} by order number or a part of the name"
    hint = near(name, names()) if nearest(name, names()) else known_names
    raise MotorError(f"--motor: no motor '{name}' is known; {hint} (a .toml file with its data will do, too)")


def _listed(found: list[Motor]) -> str:
    shown = "; ".join(one.title for one in found[:MOST_SHOWN])
    return shown + ("; ..." if len(found) > MOST_SHOWN else "")


def _from_file(name: str) -> Motor:
    try:
        return Motor.model_validate(tomllib.loads(Path(name).read_text(encoding="utf-8")))
    except ValidationError as error:
        wrong = "; ".join(f"{key}: {problem}" for key, problem in problems_of(error, Motor))
        raise MotorError(f"{name}: {wrong}") from error
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise MotorError(f"{name}: cannot be read: {error}") from error


def names() -> list[str]:
    """Return what a motor that is known can be called: the three short names, and the order numbers."""
    return [*MOTORS, *catalogue()]
