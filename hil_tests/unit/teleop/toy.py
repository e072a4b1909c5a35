"""A robot of no folder: three wheels that move it any way, a boom, a gripper, two valves; nothing like RARS.

Its signs are its own, too: it counts to the right and clockwise, and its drive's stick is turned about.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, Final

from firmware_bridge.robot import Robot, Table
from firmware_bridge.teleop.station import (
    USUAL_AXES,
    Actuator,
    Fixed,
    StationRows,
    Stick,
    StickAxis,
    Switch,
    Twist,
    Unusable,
    Value,
    Velocity,
)
from firmware_bridge.units import SECOND
from hil_tests.unit.teleop.bench import Bench, rars_file

WHEELS: Final = ("front", "port", "starboard")
MODES: Final = ("without_port", "without_boom")


class Sizes(Table):
    """The toy's geometry."""

    roller_m: float
    top_mps: float


@dataclass(frozen=True, slots=True)
class Glide:
    """The toy's motion: along, to the right, clockwise."""

    ahead: float = 0.0
    right: float = 0.0
    spin: float = 0.0
    boom: float | None = None
    grip: float | None = None
    raising: float = 0.0
    water: bool = False
    air: bool = False


@dataclass(frozen=True, slots=True)
class Felt:
    """Sensed state of the toy."""

    ahead: float = 0.0
    right: float = 0.0
    spin: float = 0.0
    reach: float | None = None


def _stick(stick: Stick, command: Glide, robot: Robot[Sizes]) -> Glide:
    top = robot.geometry.top_mps
    return replace(
        command,
        ahead=(stick.forward or 0.0) * top,
        right=-(stick.left or 0.0) * top,
        spin=-(stick.turn or 0.0),
        raising=stick.up or 0.0,
    )


def _target(velocity: Velocity, command: Glide, _: Robot[Sizes]) -> Glide | Unusable:
    if velocity.yaw_rate_rad_s is None:
        return Unusable("turn", "this robot wants to know how fast it shall turn")
    return replace(
        command, ahead=velocity.forward_mps, right=-velocity.left_mps, spin=-velocity.yaw_rate_rad_s
    )


ROWS: Final[StationRows[Sizes, Glide, Felt]] = StationRows(
    stick=_stick,
    target=_target,
    twist=lambda felt: Twist(felt.ahead, -felt.right, -felt.spin),
    forgotten=lambda command: replace(command, boom=None, grip=None),
    largest=lambda robot: Twist(robot.geometry.top_mps, robot.geometry.top_mps, math.pi),
    meters_rolled=lambda robot: robot.geometry.roller_m,
    stop_button=15,
    dead_band=0.2,
    axes=(*USUAL_AXES, StickAxis.UP),
    switches=(
        Switch(
            "water",
            read=lambda command: command.water,
            write=lambda command, on: replace(command, water=on),
            relay=7,
            telemetry="WATER",
        ),
        Switch(
            "air",
            read=lambda command: command.air,
            write=lambda command, on: replace(command, air=on),
            relay=3,
            button=9,
        ),
    ),
    actuators=(
        Actuator(
            "boom", lambda command, share, robot: replace(command, boom=share * robot.geometry.roller_m)
        ),
        Actuator("gripper", lambda command, share, _: replace(command, grip=1.0 - share)),
    ),
    values=(Value("REACH", SECOND // 10, lambda seen: seen.body.reach, "m of the boom"),),
    parameters=(Fixed("ROLLER_R", lambda robot: robot.geometry.roller_m, "m"),),
)


class ToyBench(Bench[Sizes, Glide, Felt]):
    """The toy and its operator."""


def toy_file(**changes: Any) -> Robot[Sizes]:
    """Return the toy's robot file, made from RARS's with other axes."""
    table = rars_file().model_dump()
    names = (*WHEELS, "boom")
    axes = [dict(axis, name=name, role=name) for axis, name in zip(table["axes"], names, strict=True)]
    sizes = {"roller_m": 0.25, "top_mps": 2.0}
    own = {"name": "toy", "kind": "toy", "geometry": sizes, "axes": axes, "battery": None, "sensors": []}
    return Robot[Sizes].model_validate(table | own | changes)


def toy(**changes: Any) -> ToyBench:
    """Return the toy, standing."""
    return ToyBench(toy_file(**changes), ROWS, Glide(), Felt(), WHEELS, MODES)
