"""The climber's interlocks at the edges of their thresholds; for the inherited tests."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TypeAlias

from emulators.bench import cases as bench
from emulators.bench import differential
from firmware_bridge.motion.captured import Located, Source
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robot_types import find
from firmware_bridge.robots.climber.geometry import ClimberGeometry
from firmware_bridge.robots.climber.kinematics import CLIMBER
from firmware_bridge.robots.climber.motion import ClimberMotion, ClimberState
from firmware_bridge.robots.climber.rules import ON_WALL

Case: TypeAlias = bench.Case[ClimberMotion, ClimberState]
Situation: TypeAlias = bench.Situation[ClimberMotion, ClimberState]
WELL = ClimberState(0.0, 0.0, 0.0, 1.0)
CREEPS_MPS = 0.01
UP, ROUND = math.pi / 2.0, 0.0
SEEN = Located(Pose(), Source.CAPTURED, 0.0, 0.0, 0.0, 0)


def cases(robot: Robot[ClimberGeometry]) -> Iterator[Case]:
    """Yield at least one case for each interlock and limit."""
    # Tail first at full speed, so that the joint has no say.
    yield from differential.cases(robot, ClimberMotion, WELL, spin=CLIMBER.spin, ahead=-1.0)
    for side in (-1.0, 1.0):
        yield from _at_the_joint(robot, side)
    yield from _on_the_wall(robot)
    yield from _lost()
    yield from _bounded(robot)
    yield from _coupled(robot)


def _at_the_joint(robot: Robot[ClimberGeometry], side: float) -> Iterator[Case]:
    """Yield the cases of a joint that is turned: the way in which it grows it is slower, and stops."""
    joint, speed = robot.geometry.joint, robot.geometry.limits.speed_mps
    ahead, first = ClimberMotion(side * speed), "nose" if side > 0.0 else "tail"
    slow, bound = math.radians(joint.slow_deg), math.radians(joint.bound_deg)
    half = side * 0.5 * (slow + bound)
    for angle, spared, allowed in (
        (
            half,
            Situation(command=ahead, commanded=ahead, body=replace(WELL, joint_rad=side * slow)),
            0.5 * speed,
        ),
        (
            side * bound,
            Situation(command=ClimberMotion(-side * speed), body=replace(WELL, joint_rad=side * bound)),
            0.0,
        ),
    ):
        yield Case(
            "joint limit",
            trips=Situation(command=ahead, commanded=ahead, body=replace(WELL, joint_rad=angle)),
            spares=spared,
            reason=(
                f"the joint's angle is {math.degrees(angle):.1f} deg: requested {speed:.3f} m/s "
                f"{first} first, allowed is {allowed:.3f} m/s"
            ),
        )
    for unknown, known in ((None, "not known"), (math.nan, "nan deg")):
        yield Case(
            "joint limit",
            trips=Situation(command=ahead, commanded=ahead, body=replace(WELL, joint_rad=unknown)),
            spares=Situation(command=ClimberMotion(turn_rad_s=0.01), body=replace(WELL, joint_rad=unknown)),
            reason=(
                f"the joint's angle is {known}: requested {speed:.3f} m/s {first} first, allowed is 0.000 m/s"
            ),
        )


def _on_the_wall(robot: Robot[ClimberGeometry]) -> Iterator[Case]:
    del robot
    # The neighboring double: the threshold itself must still be accepted.
    below = math.nextafter(ON_WALL, 0.0)
    for share, reason in (
        (None, "no sensor reports whether its magnets are on the wall"),
        (math.nan, "nan% of its magnets are on the wall"),
        (below, f"{below:.0%} of its magnets are on the wall"),
    ):
        yield Case(
            "off the wall",
            trips=Situation(body=replace(WELL, on_wall=share)),
            spares=Situation(body=replace(WELL, on_wall=ON_WALL)),
            reason=reason,
        )


def _lost() -> Iterator[Case]:
    """Yield the cases of a robot that cameras see: a path follower needs its place, an operator does not."""
    guided = ClimberMotion(path_s=1.0)
    lost = replace(SEEN, source=Source.LOST, uncertain_m=0.051)
    yield Case(
        "pose lost",
        trips=Situation(command=guided, located=lost),
        spares=Situation(located=lost),
        reason="the place is off by 0.051 m at most without the cameras: they do not see it",
    )
    yield Case(
        "pose lost",
        trips=Situation(command=guided, located=replace(SEEN, source=Source.UNSEEN)),
        spares=Situation(command=guided, located=SEEN),
        reason="the cameras have not seen the robot yet",
    )
    ahead = ClimberMotion(-CREEPS_MPS)
    yield Case(
        "place unknown",
        trips=Situation(command=ahead, commanded=ahead, located=replace(SEEN, source=Source.UNSEEN)),
        spares=Situation(command=ClimberMotion(turn_rad_s=0.01), located=replace(SEEN, source=Source.UNSEEN)),
        reason=(
            f"the cameras have not seen the robot yet: requested {CREEPS_MPS:.3f} m/s, allowed is 0.000 m/s"
        ),
    )
    under_cameras = find("climber+cameras")
    bound = under_cameras.located_by[1].slip_mps if under_cameras.located_by else math.nan
    yield Case(
        "robot slips",
        trips=Situation(located=replace(SEEN, slip_mps=math.nextafter(bound, math.inf))),
        spares=Situation(located=replace(SEEN, slip_mps=bound)),
        reason=(f"the robot moves {bound:.3f} m/s apart from its wheels' speed, limit {bound:.3f} m/s"),
        robot=under_cameras,
    )


def _bounded(robot: Robot[ClimberGeometry]) -> Iterator[Case]:
    """Yield the cases of a place beyond which it may not drive: it stands there, and looks beyond or back."""
    limits, wall = robot.geometry.limits, robot.geometry.wall
    bounds = (
        ("height limit", robot, Pose(0.0, limits.highest_m, UP), limits.highest_m, ""),
        ("height limit", robot, Pose(0.0, limits.lowest_m, -UP), limits.lowest_m, ""),
        ("cable limit", robot, Pose(wall.cable_m, 0.0, ROUND), wall.cable_m, None),
    )
    for interlock, machine, place, bound, why in (*bounds, _heavy(robot)):
        there, back = replace(SEEN, pose=place), place.heading_rad + math.pi
        gone = replace(SEEN, pose=Pose(place.x_m, place.y_m, back))
        ahead = ClimberMotion(limits.speed_mps)
        yield Case(
            interlock,
            trips=Situation(command=ahead, commanded=ahead, located=there),
            spares=Situation(command=ahead, commanded=ahead, located=gone),
            reason=(
                f"{bound:.2f} m of the cable are drawn, it is {bound:.2f} m long"
                if why is None
                else f"it is {place.y_m:.2f} m high, and may not pass {bound:.2f} m{why}"
            ),
            robot=machine,
        )


def _heavy(robot: Robot[ClimberGeometry]) -> tuple[str, Robot[ClimberGeometry], Pose, float, str]:
    """Return the case of a cable so heavy that the magnets end the climb below the other bounds."""
    geometry = robot.geometry
    # A cable whose weight at half the height uses up what the magnets can hold more.
    spare = geometry.wall.heaviest_kg - geometry.wall.mass_kg
    wall = geometry.wall.model_copy(update={"cable_kg_per_m": spare / (0.5 * geometry.limits.highest_m)})
    machine = robot.model_copy(update={"geometry": geometry.model_copy(update={"wall": wall})})
    high = wall.highest_m
    held = f": the magnets hold {wall.heaviest_kg:.1f} kg, cable included"
    return "adhesion limit", machine, Pose(0.0, high, UP), high, held


def _coupled(robot: Robot[ClimberGeometry]) -> Iterator[Case]:
    base = robot.geometry.base.model_copy(update={"coupled": True})
    machine = robot.model_copy(update={"geometry": robot.geometry.model_copy(update={"base": base})})
    back = ClimberMotion(-robot.geometry.limits.speed_mps)
    yield Case(
        "coupled wheels",
        trips=Situation(command=ClimberMotion(turn_rad_s=0.1), commanded=ClimberMotion(turn_rad_s=0.1)),
        spares=Situation(command=back, commanded=back),
        reason="requested a turn of 0.10 rad/s: one shaft turns both wheels",
        robot=machine,
    )
