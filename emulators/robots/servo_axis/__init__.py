"""One axis on the bench: the inputs of a mission's step, the station's messages, and the pictures.

Signs and scales are written here again, not taken from the bridge, so that a mistake there is not repeated.
x_m is the axis's position, in its own unit.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Final, Literal, TypeAlias

from pydantic import Field

from emulators.bench.bench_setup import BenchSetup, Channel, StickAxes, TwistAxes
from emulators.bench.columns import Column, Curve, Panel
from emulators.bench.step import Finite, Holds, Positive, Presses, Sends, Slope, Step
from emulators.robots.servo_axis.cases import cases
from firmware_bridge.robot import Robot
from firmware_bridge.robots.servo_axis.geometry import AxisGeometry
from firmware_bridge.robots.servo_axis.motion import AxisMotion, AxisState
from firmware_bridge.safety.snapshot import Snapshot

ServoAxis: TypeAlias = Robot[AxisGeometry]
Seen: TypeAlias = Snapshot[AxisMotion, AxisState]
BUTTONS: Final = {"emergency_stop": 4}
_ACTUATOR: Final = 187


def _share(place: float, robot: ServoAxis) -> tuple[float]:
    """Return an actuator's share, -1 at the lower end and 1 at the upper, of a place."""
    low, high = next(axis.travel for axis in robot.axes if axis.role == "axis") or (-1.0, 1.0)
    return (2.0 * (place - low) / (high - low) - 1.0,)


class ServoAxisStep(Step):
    """The operator's input at one instant; the speed stays until a later step."""

    speed_mps: Annotated[Finite | None, Holds("speed")] = None
    """In the axis's unit a second; at once, or with `ramp_mps2`."""
    ramp_mps2: Annotated[Positive | None, Slope("speed")] = None
    """In the axis's unit a second squared."""
    stick: Annotated[
        float | None,
        Field(ge=-1, le=1),
        Holds("speed", lambda share, robot: share * robot.geometry.limits.speed),
    ] = None
    """The same as a share of the speed limit; another way to give `speed_mps`."""
    share: Annotated[
        float | None, Field(ge=0, le=1), Sends(_ACTUATOR, lambda it, _: (2.0 * it - 1.0,), -3)
    ] = None
    """Go to this share of the travel, from its lowest position on."""
    position: Annotated[Finite | None, Sends(_ACTUATOR, _share, -3)] = None
    """Go there, in the axis's unit; another way to give `share`."""
    press: Annotated[Literal["emergency_stop"] | None, Presses(BUTTONS)] = None
    """Tap a button of the stick."""


def _stick(values: Mapping[str, float], robot: ServoAxis) -> StickAxes:
    return StickAxes(x=values["speed"] / robot.geometry.limits.speed)


def _none(_seen: Seen) -> float:
    return 0.0


def _position(seen: Seen) -> float:
    position = seen.body.position
    return 0.0 if position is None else position


def _demanded(seen: Seen) -> float:
    return seen.commanded.speed


def _remarks(robot: ServoAxis) -> Mapping[str, str]:
    limits = robot.geometry.limits
    return {
        "max_speed_mps": f"limit {limits.speed:g}, in the axis's unit a second",
        "max_acceleration_mps2": f"limit {limits.acceleration:g} of what is commanded",
    }


BENCH_SETUP: Final = BenchSetup(
    step=ServoAxisStep,
    missions=Path(__file__).with_name("missions"),
    channels=(Channel("speed", lambda robot: robot.geometry.limits.speed, trembles_with="speed"),),
    stick=_stick,
    twist=lambda values, _: TwistAxes(values["speed"]),
    columns=(
        Column("x_m", "the axis's position, in its unit", "m", plant="load_angle"),
        Column("y_m", "always 0", "m", seen=_none),
        Column("heading_rad", "always 0", "rad", seen=_none),
        Column("speed_mps", "the axis's speed, in its unit a second", "m/s", plant="load_speed"),
        Column("yaw_rate_rad_s", "always 0", "rad/s", seen=_none),
        Column("odometry_x_m", "the position that the drive reports", "m", seen=_position),
        Column("odometry_y_m", "always 0", "m", seen=_none),
        Column("odometry_heading_rad", "always 0", "rad", seen=_none),
        Column("demanded_speed_mps", "the bridge's set-point of the speed", "m/s", seen=_demanded),
    ),
    panels=(
        Panel(
            "Position",
            "position [axis unit]",
            (Curve("x_m", "actual (plant)"), Curve("odometry_x_m", "reported by the drive")),
            height=2.5,
        ),
        Panel(
            "Speed",
            "speed [axis unit/s]",
            (Curve("demanded_speed_mps", "set-point", step=True), Curve("speed_mps", "actual (plant)")),
            limit=lambda robot: (robot.geometry.limits.speed, "axis unit/s"),
            shaded=True,
        ),
    ),
    remarks=_remarks,
    cases=cases,
)
