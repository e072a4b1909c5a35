"""The robot on the bench: what a step may ask of it, how a station says it, what is drawn.

Signs and scales are written here anew, not taken from the bridge's half: a mistake there is not repeated.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Final, Literal, TypeAlias

from emulators.bench.columns import PLANAR, Column, Curve, Panel
from emulators.bench.rehearsal import Channel, Rehearsal, StickAxes, Twist
from emulators.bench.step import Finite, Holds, Positive, Presses, Sends, Slope, Step
from firmware_bridge.robot import Robot
from firmware_bridge.safety.snapshot import Snapshot

from carrier.cases import cases
from carrier.geometry import Geometry
from carrier.motion import Motion, State

Machine: TypeAlias = Robot[Geometry]
Seen: TypeAlias = Snapshot[Motion, State]
BUTTONS: Final = {"lamp": 1, "emergency_stop": 4}
_RELAY: Final = 181


class OwnStep(Step):
    """What the operator does at one instant. Speed and turn stay until a later step.

    A mission's input is one field: its annotation says what the hand does about it.
    """

    speed_mps: Annotated[Finite | None, Holds("speed")] = None
    """Forward positive; at once, or with `ramp_mps2`."""
    ramp_mps2: Annotated[Positive | None, Slope("speed")] = None
    turn_deg_s: Annotated[Finite | None, Holds("turn", lambda turn, _: math.radians(turn))] = None
    """To the left positive."""
    lamp: Annotated[bool | None, Sends(_RELAY, lambda on, _: (0.0, float(on)), -1)] = None
    press: Annotated[Literal["lamp", "emergency_stop"] | None, Presses(BUTTONS)] = None
    """Tap a button of the stick."""


def _stick(values: Mapping[str, float], robot: Machine) -> StickAxes:
    limits = robot.geometry.limits
    return StickAxes(x=values["speed"] / limits.speed_mps, r=-values["turn"] / limits.turn_rate_rad_s)


def _demanded_speed(seen: Seen) -> float:
    return seen.demanded.speed_mps


def _demanded_turn(seen: Seen) -> float:
    return seen.demanded.turn_rad_s


def _remarks(robot: Machine) -> Mapping[str, str]:
    limits = robot.geometry.limits
    return {
        "max_speed_mps": f"limit {limits.speed_mps:g}",
        "max_acceleration_mps2": f"limit {limits.acceleration_mps2:g}",
    }


REHEARSAL: Final = Rehearsal(
    step=OwnStep,
    missions=Path(__file__).with_name("missions"),
    channels=(
        Channel("speed", lambda robot: robot.geometry.limits.speed_mps, trembles_with="speed"),
        Channel("turn", lambda robot: robot.geometry.limits.turn_rate_rad_s, trembles_with="speed"),
    ),
    stick=_stick,
    twist=lambda values, _: Twist(values["speed"], yaw_rate=-values["turn"]),
    columns=(
        *PLANAR,
        Column("demanded_speed_mps", "what the bridge asks of the wheels", "m/s", seen=_demanded_speed),
        Column("demanded_turn_rad_s", "what the bridge asks of the wheels", "rad/s", seen=_demanded_turn),
        Column("battery_v", "at the drives", "V", plant="battery_voltage"),
    ),
    panels=(
        Panel(
            "Forward speed",
            "speed [m/s]",
            (Curve("demanded_speed_mps", "demanded", step=True), Curve("speed_mps", "plant")),
            limit=lambda robot: (robot.geometry.limits.speed_mps, "m/s"),
            shaded=True,
            height=2.5,
        ),
        Panel(
            "Turn rate, left is positive",
            "turn rate [rad/s]",
            (Curve("demanded_turn_rad_s", "demanded", step=True), Curve("yaw_rate_rad_s", "plant")),
            limit=lambda robot: (robot.geometry.limits.turn_rate_rad_s, "rad/s"),
            shaded=True,
            height=2.5,
        ),
    ),
    remarks=_remarks,
    cases=cases,
)
