"""Invariants of one kind of robot: bounds that stand in its file, measured on its plant."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import SimpleNamespace
from typing import Any, Final

from emulators.bench.columns import motor_speed
from emulators.bench.faults.plant import GripLost
from emulators.rig import Rig
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import STANDARD_GRAVITY
from fmu.plants import find as find_plant
from hil_tests.adversary.beyond import RIM, SPEEDS_UP

BEYOND_MPS: Final = 0.005
"""Allowance above its speed limit: overshoot of RARS's regulators, turning and reversing."""
MARGIN_M: Final = 0.030
"""Margin of the zero moment point within the support: A. P. Das, PhD thesis, section 2.3.1."""
OVER: Final = 10
"""Samples over which an acceleration is the mean: two cycles of 50 ms, each a step of the ramp."""
RAMP: Final = 1.1
"""Factor beside an acceleration limit: the regulators' effect on a ramp at the limit."""
ROUNDED: Final = 1.02
"""Factor beside a bound of the robot file: regulators and slip under a hand that trembles at full stick."""
CORNER: Final = 1.03
"""Factor beside the bound of speed times turn rate.

A turn overshoots where the ramp of the speed ends; 1.027 of it is measured on the flat.
"""

GIVES: Final = 0.0055
"""Share of a speed that a regulator gives way, per degree of slope: 0.5265 m/s are measured on 10."""
REAR_WHEELS: Final = frozenset({"left", "right"})
GIVES_MPS: Final = 0.0045
"""The same of RARS, as a speed: what a slope takes is a torque, however slow the robot is. Straight it gives
way by half of it; in its tightest turn the pull goes round faster than regulators learn it, and tyres slip:
0.547 m/s on 10 degrees. One wheel alone carries it for both: 0.2087 of 0.2 m/s on 1.4 degrees."""


BOTH_GIVE: Final = 0.014
"""Share of speed times turn rate, per degree of slope.

Backwards down 6.6 degrees, turning, the differential drive races by 3 % and turns by 7.5 % too much until its
regulators have caught up; 0.638 of 0.576 m/s2 are measured.
"""


MOVES: Final = 20
"""Samples over which a stepper's speed is the mean: two moves of 100 ms."""
COUNTED: Final = 1.2
"""Factor beside a speed limit of an arm that is moved in steps.

A move may begin late, two fall into it, and rotors swing by a step, which is half a millimeter at the tool;
1.164 is measured for an instant in an hour.
"""
ONE_MOVE_M: Final = 0.004
"""Allowed swing of the tool out of its workspace: a move is 3 mm long. Assumed of the rest."""
STEP_RAD: Final = math.tau / 200.0
"""A full step of a motor's shaft; two behind its field the rotor takes the next one."""
LIFTED: Final = 50
"""Samples over which a wheel's load is the mean: it is off the floor for half a second."""
BASE_AXES: Final = frozenset({"one", "two", "three"})


def joint(axis: str) -> str:
    """Return the name of the column of an arm's joint's angle."""
    return f"angle_{axis}_rad"


def mean_rate(rig: Rig, column: str) -> float:
    """Return how fast a column has changed in the mean of two moves, in its unit a second."""
    if len(rig.samples) <= MOVES:
        return 0.0
    newest, before = rig.samples[-1], rig.samples[-1 - MOVES]
    return float((newest[column] - before[column]) / ((newest.at - before.at) * 1e-9))


def degrees(robot: AnyRobot) -> float:
    """Return how steep this robot's floor is."""
    return abs(math.degrees(robot.plant.parameters.get("slope", 0.0)))


def gives(robot: AnyRobot) -> float:
    """Return the factor beside a bound of a speed on this robot's floor; 1 on the flat."""
    return 1.0 + GIVES * degrees(robot)


OMNI_BEYOND_MPS: Final = 0.04
"""Allowance above ROME's limits of base and rim.

Over MWProtocol, whose wheels are regulated at 10 Hz, 0.030 m/s are measured where the line comes back in a
turn.
"""
OMNI_TURNS: Final = 1.15
"""Factor beside its turn rate, in the same way: 1.10 is measured over MWProtocol."""
OMNI_OVER: Final = 20
"""Samples over which it speeds up: two cycles of MWProtocol."""


TRACKS: Final = 0.003
"""Allowance above the climber's limits of speed and of a rim: overshoot of its regulators, in m/s."""
STOP: Final = 0.999
"""Share of the joint's stop: a joint so near touches it."""


@dataclass(frozen=True, slots=True)
class Own:
    """A bound of one kind of robot: how near the truth is to it, above 1 beyond."""

    name: str
    ratio: Callable[[AnyRobot, Rig], float]
    lasts_s: float = 0.0
    unpowered: bool = False
    """Judged without power, too, where neither a fault nor an order took it: the bridge let it run away."""
    needs: frozenset[str] | None = None
    """The axes that must have power for it; None: those that roll without, or all."""


def limits(robot: AnyRobot, rig: Rig) -> Any:
    """Return RARS's limits: the narrow ones in a mode after a failure."""
    geometry: Any = robot.geometry
    return geometry.narrowed if rig.bridge.seen.facts.mode else geometry.limits


def _speed(robot: AnyRobot, rig: Rig) -> float:
    wheels = 1 if rig.bridge.seen.facts.without & REAR_WHEELS else 2
    gives_mps = 2 / wheels * GIVES_MPS * degrees(robot)
    top: float = limits(robot, rig).speed_mps + BEYOND_MPS + gives_mps
    return abs(float(rig.samples[-1]["speed_mps"])) / top


def _acceleration(robot: AnyRobot, rig: Rig) -> float:
    if len(rig.samples) <= OVER:
        return 0.0
    newest, before = rig.samples[-1], rig.samples[-1 - OVER]
    gained = (newest["speed_mps"] - before["speed_mps"]) / ((newest.at - before.at) * 1e-9)
    limit: float = robot.geometry.limits.acceleration_mps2
    return abs(float(gained)) / (RAMP * limit)


def _sideways(robot: AnyRobot, rig: Rig) -> float:
    row = rig.samples[-1]
    limit: float = robot.geometry.limits.sideways_mps2
    bound = CORNER * (1.0 + BOTH_GIVE * degrees(robot)) * limit
    return abs(float(row["speed_mps"] * row["yaw_rate_rad_s"])) / bound


def zero_moment_point(robot: AnyRobot, rig: Rig) -> tuple[float, float]:
    """Return where RARS's zero moment point is, in m ahead of the rear axle and away from the middle.

    Along from the loads of the plant's axles, across from what is felt: v times the yaw rate, and the slope
    (thesis, section 2.3.1, (2.4) and (2.6)).
    """
    base, row, plant = robot.geometry.base, rig.samples[-1], rig.devices.plant
    front, rear = plant.read("load_front_left"), plant.read("load_rear_left")
    slope = robot.plant.parameters.get("slope", 0.0)
    downhill = STANDARD_GRAVITY * math.sin(slope) * math.sin(row["heading_rad"])
    felt = abs(row["speed_mps"] * row["yaw_rate_rad_s"] - downhill)
    across = base.centre_of_gravity_height_m * felt / (STANDARD_GRAVITY * math.cos(slope))
    return base.wheelbase_m * front / (front + rear), float(across)


def _tipping(robot: AnyRobot, rig: Rig) -> float:
    along, across = zero_moment_point(robot, rig)
    base = robot.geometry.base
    margin: float = min(along, base.wheelbase_m - along, base.half_support_width_m - across)
    return MARGIN_M / margin if margin > 0.0 else math.inf


def _planar(robot: AnyRobot, rig: Rig) -> float:
    row = rig.samples[-1]
    speed = math.hypot(row["speed_mps"], row["speed_left_mps"])
    bound: float = robot.geometry.limits.speed_mps + OMNI_BEYOND_MPS
    return speed / bound


def _turning(robot: AnyRobot, rig: Rig) -> float:
    bound: float = OMNI_TURNS * robot.geometry.limits.turn_rate_rad_s
    return abs(float(rig.samples[-1]["yaw_rate_rad_s"])) / bound


def _rim(robot: AnyRobot, rig: Rig) -> float:
    row, radius = rig.samples[-1], robot.geometry.base.wheel_radius_m
    rims = (radius * abs(row[motor_speed(axis.name)]) / axis.ratio for axis in robot.axes)
    bound: float = robot.geometry.limits.rim_mps + RIM.bound
    return float(max(rims)) / bound


def _faster(robot: AnyRobot, rig: Rig) -> float:
    """Judge a base that speeds up; a half bridge that shorts its motor brakes as it does."""
    if len(rig.samples) <= OMNI_OVER:
        return 0.0
    newest, before = rig.samples[-1], rig.samples[-1 - OMNI_OVER]
    now, then = (math.hypot(row["speed_mps"], row["speed_left_mps"]) for row in (newest, before))
    bound: float = SPEEDS_UP.bound * robot.geometry.limits.acceleration_mps2
    gained: float = (now - then) / ((newest.at - before.at) * 1e-9)
    return gained / bound


def _climbs(robot: AnyRobot, rig: Rig) -> float:
    speed = abs(float(rig.samples[-1]["speed_mps"]))
    return _on_the_wall(rig, speed / (robot.geometry.limits.speed_mps + TRACKS))


def _climber_turns(robot: AnyRobot, rig: Rig) -> float:
    limits, half = robot.geometry.limits, robot.geometry.base.track_m / 2.0
    turn = abs(float(rig.samples[-1]["yaw_rate_rad_s"]))
    return _on_the_wall(rig, turn / (limits.turn_rate_rad_s + TRACKS / half))


def _joint(robot: AnyRobot, rig: Rig) -> float:
    rows = find_plant(robot.plant.fmu).parameters
    stop = next(row.start for row in rows if row.name == "joint_stop")
    return _on_the_wall(rig, abs(float(rig.samples[-1]["joint_rad"])) / (STOP * stop))


def _on_the_wall(rig: Rig, ratio: float) -> float:
    """Return a ratio that counts until a magnet has let go: the joint's spring alone bends it then."""
    return 0.0 if any(record.kind == GripLost.kind for record in rig.faults.records) else ratio


def _tool(robot: AnyRobot, rig: Rig) -> float:
    speed = math.hypot(*(mean_rate(rig, column) for column in TOOL))
    bound: float = COUNTED * robot.geometry.limits.speed_mps
    return speed / bound


def _workspace(robot: AnyRobot, rig: Rig) -> float:
    row, box = rig.samples[-1], robot.geometry.workspace
    ratios = []
    for column, low, high in zip(TOOL, box.lowest_m, box.highest_m, strict=True):
        middle, half = (low + high) / 2.0, (high - low) / 2.0 + ONE_MOVE_M
        ratios.append(abs(row[column] - middle) / half)
    return float(max(ratios))


def _joints(robot: AnyRobot, rig: Rig) -> float:
    axes = [axis for axis in robot.axes if axis.link in Ar2Link.all_of(robot)]
    shares = [abs(mean_rate(rig, joint(axis.name))) / (COUNTED * axis.top_speed) for axis in axes]
    return float(max(shares))


def _steps(robot: AnyRobot, rig: Rig) -> float:
    axes = [axis.name for axis in robot.axes if axis.link in Ar2Link.all_of(robot)]
    return max(abs(float(rig.samples[-1][f"lag_{name}_rad"])) / (2.0 * STEP_RAD) for name in axes)


def _lifted(_robot: AnyRobot, rig: Rig) -> float:
    rows = rig.samples[-LIFTED:]
    loads = (sum(row[f"load_{name}_n"] for row in rows) for name in BASE_AXES)
    return 2.0 * bool(min(loads) <= 0.0)


TOOL: Final = ("x_m", "tool_y_m", "y_m")
"""The columns of the tool of an arm that stands alone: ahead, left, up, from its foot."""
ALWAYS: Final = frozenset[str]()
"""Axes that need no power: a stepper keeps its current."""
ARM: Final = (
    Own("a joint faster than its top speed", _joints, needs=ALWAYS),
    Own("steps lost", _steps, needs=ALWAYS),
)


ROME: Final = (
    Own("speed beyond its limit", _planar, 0.1),
    Own("turn rate beyond its limit", _turning, 0.1),
    Own("a wheel's speed beyond its limit", _rim, 0.1),
    Own("speeding up beyond its limit", _faster),
)


def _on_the_base(rows: tuple[Own, ...]) -> tuple[Own, ...]:
    """Return ROME's rows where they judge the base of a larger robot."""
    return tuple(replace(row, ratio=partial(_of_the_base, row.ratio), needs=BASE_AXES) for row in rows)


def _of_the_base(ratio: Callable[[Any, Rig], float], robot: AnyRobot, rig: Rig) -> float:
    """Judge the base alone: its geometry, and the axes on its board."""
    axes = tuple(axis for axis in robot.axes if axis.name in BASE_AXES)
    seen: float = ratio(SimpleNamespace(geometry=robot.geometry.base, axes=axes), rig)
    return seen


OWN: Final[Mapping[str, tuple[Own, ...]]] = {
    "rars": (
        Own("speed beyond its limit", _speed, unpowered=True),
        Own("acceleration beyond its limit", _acceleration),
        Own("less than 30 mm from tipping", _tipping),
    ),
    "diff_drive": (
        Own("acceleration beyond its limit", _acceleration),
        Own("sideways acceleration beyond its limit", _sideways, 0.1),
    ),
    "rome": ROME,
    "ar2": (
        *ARM,
        Own("the tool's speed beyond its limit", _tool, needs=ALWAYS),
        Own("the tool outside its workspace", _workspace, needs=ALWAYS),
    ),
    "rome_arm": (*ARM, *_on_the_base(ROME), Own("a wheel off the floor", _lifted, needs=ALWAYS)),
    "climber": (
        Own("speed beyond its limit", _climbs, 0.1),
        Own("turn rate beyond its limit", _climber_turns, 0.1),
        Own("its joint at the stop", _joint),
    ),
}
