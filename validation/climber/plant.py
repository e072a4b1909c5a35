"""The climber's plant under given speeds of its wheels, beside the independent solution under the same.

The motors have flywheels in place of voltages, and nothing pulls at the robot: what is left is how it rolls.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Self, TypeAlias

import numpy as np

from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from fmu.build import ensure
from fmu.climber.parameters import PARAMETERS, SETS
from fmu.plant import FmuPlant
from validation.climber.constraints import Robot
from validation.studies.solve import Floats

UP: Final = math.pi / 2.0
LEADING: Final = math.pi
"""The caster's swivel where it is ahead of the robot, which drives tail first."""
STEP: Final[Nanoseconds] = MILLISECOND
FLYWHEEL: Final = 1e9
"""kg.m2 at a motor's shaft: its speed stays."""
LIGHT: Final[Mapping[str, float]] = MappingProxyType(
    {"gravity": 0.0, "joint_spring": 0.0, "joint_damping": 0.0, "stop_stiffness": 0.0}
)
CONTACTS: Final = ("left", "right", "caster")
NAMES: Final = (
    *(f"{what}_{contact}" for what in ("arc", "height") for contact in CONTACTS),
    *("psi_left", "psi_right", "joint"),
)
DRIVEN: Final[Mapping[str, float]] = MappingProxyType(
    {"rotor_inertia_wheel": 1.0, "gear_friction": 0.0, "coulomb_wheel": 0.0, "viscous_wheel": 0.0}
)
"""Motors that follow their voltages alone: their rotors are heavy beside the robot."""

Spins: TypeAlias = tuple[float, float]
"""rad/s of the left and the right wheel."""


def sizes(kind: str, **more: float) -> Mapping[str, float]:
    """Return all parameters of one of the plant's sets, with others in their place."""
    return {row.name: row.start for row in PARAMETERS} | dict(SETS[kind]) | more


@dataclass(frozen=True, slots=True)
class Way:
    """Path of the robot, instant by instant: the middle of both contacts on the unrolled surface."""

    arc: Floats
    """m, to the right of who looks up."""
    height: Floats
    heading: Floats
    """rad, from the arc towards the axis."""
    joint: Floats
    apart: tuple[Floats, Floats]
    """The right wheel's contact from the left one's: round the tank and up, m."""
    caster: tuple[Floats, Floats]
    """The caster's contact: round the tank and up, m."""

    @classmethod
    def of(cls, rows: list[Mapping[str, float]], tank: float) -> Self:
        """Make it from readings by name; arcs may be given within half a turn of the tank."""
        table = {name: np.array([row[name] for row in rows]) for name in NAMES}
        turns = {side: tank * np.unwrap(table[f"arc_{side}"] / tank) for side in CONTACTS}
        psi = {side: np.unwrap(table[f"psi_{side}"]) for side in ("left", "right")}
        return cls(
            (turns["left"] + turns["right"]) / 2.0,
            (table["height_left"] + table["height_right"]) / 2.0,
            (psi["left"] + psi["right"]) / 2.0 - UP,
            table["joint"],
            (turns["right"] - turns["left"], table["height_right"] - table["height_left"]),
            (turns["caster"], table["height_caster"]),
        )

    def wheel(self, sign: float) -> tuple[Floats, Floats]:
        """Return the contact of the left wheel, for -1, or of the right one, for 1: round the tank, up, m."""
        return self.arc + sign * self.apart[0] / 2.0, self.height + sign * self.apart[1] / 2.0

    def aside(self) -> Floats:
        """Return how far it is to the left of a straight line along its heading at the start, m."""
        course = self.heading[0]
        arc, height = self.arc - self.arc[0], self.height - self.height[0]
        aside: Floats = height * math.cos(course) - arc * math.sin(course)
        return aside

    def gap(self) -> float:
        """Return the distance from its first place to its last, m."""
        return math.hypot(self.arc[-1] - self.arc[0], self.height[-1] - self.height[0])

    def oblong(self) -> float:
        """Return how much higher than wide it is, m."""
        return float(np.ptp(self.height) - np.ptp(self.arc))

    def width_over_height(self) -> float:
        """Return the ratio of its extent round the tank to its extent along the axis."""
        return float(np.ptp(self.arc) / np.ptp(self.height))

    def off_circle(self, radius: float, heading: float) -> float:
        """Return how far it is at most from a circle, m; one of a positive radius bends to the left."""
        middle = self.arc[0] - radius * math.sin(heading), self.height[0] + radius * math.cos(heading)
        away = np.hypot(self.arc - middle[0], self.height - middle[1])
        return float(np.abs(away - abs(radius)).max())


def rolled(parameters: Mapping[str, float], spins: Spins, seconds: float, instants: int) -> Way:
    """Return the plant's way at so many instants, the first one at its start."""
    gear = parameters["gear_wheel"]
    turning = {f"speed_{side}": gear * spin for side, spin in zip(("left", "right"), spins, strict=True)}
    given = {**parameters, **LIGHT, **turning, "rotor_inertia_wheel": FLYWHEEL}
    steps = np.rint(np.linspace(0.0, seconds * SECOND / STEP, instants)).astype(int)
    rows: list[Mapping[str, float]] = []
    with FmuPlant(ensure("climber"), (), NAMES, given, STEP) as plant:
        for step in steps:
            while plant.steps_done < step:
                plant.step()
            rows.append(dict(zip(NAMES, map(float, plant.outputs), strict=True)))
    return Way.of(rows, parameters["tank_radius"])


def constrained(parameters: Mapping[str, float], spins: Spins, seconds: float, instants: int) -> Way:
    """Return the same by the contact's constraints."""
    robot = Robot.standing(parameters, parameters["start_heading"], parameters["start_swivel"])
    steps = instants - 1
    ways = robot.driven(lambda _: spins[0], lambda _: spins[1], seconds, seconds / steps)
    return Way.of([one.readings() for one in ways], parameters["tank_radius"])


def steered(
    parameters: Mapping[str, float], twist: tuple[float, float], seconds: float, instants: int
) -> tuple[Way, Way]:
    """Return the plant's way, then that by the constraints, under a constant motion of the chassis.

    `twist` is its speed ahead, m/s, and its turn rate about its up, rad/s. Which spins of the wheels make it,
    the constraints give at each instant; the plant's motors follow them.
    """
    robot = Robot.standing(parameters, parameters["start_heading"], parameters["start_swivel"])
    ways = robot.steered(*twist, seconds, seconds / (instants - 1))
    times = np.linspace(0.0, seconds, instants)
    spins = np.array([one.spins(*twist) for one in ways])
    other = Way.of([one.readings() for one in ways], parameters["tank_radius"])
    return _followed(parameters, times, spins), other


def _followed(parameters: Mapping[str, float], times: Floats, spins: Floats) -> Way:
    """Return the plant's way under these spins of the left and the right wheel, a row for each time."""
    gear, sides = parameters["gear_wheel"], ("left", "right")
    start = {f"speed_{side}": gear * float(spin) for side, spin in zip(sides, spins[0], strict=True)}
    given = {**parameters, **LIGHT, **DRIVEN, **start}
    steps = np.rint(times * SECOND / STEP).astype(int)
    at = np.arange(1, steps[-1] + 1) * (STEP / SECOND)
    targets = gear * np.array([np.interp(at, times, spins[:, side]) for side in (0, 1)]).T
    constant = given["torque_constant_wheel"]
    stiff = given["resistance_wheel"] * given["rotor_inertia_wheel"] * SECOND / (constant * STEP)
    rows: list[Mapping[str, float]] = []
    voltages = [f"voltage_{side}" for side in sides]
    read = (*NAMES, *(f"speed_{side}" for side in sides))
    with FmuPlant(ensure("climber"), voltages, read, given, STEP) as plant:
        for step in steps:
            while plant.steps_done < step:
                now = plant.outputs[-2:]
                # The current that reaches the next speed within one step, and what the motor generates.
                for side, target in enumerate(targets[plant.steps_done]):
                    plant.inputs[side] = constant * now[side] + stiff * (target - now[side])
                plant.step()
            rows.append(dict(zip(NAMES, map(float, plant.outputs[: len(NAMES)]), strict=True)))
    return Way.of(rows, parameters["tank_radius"])
