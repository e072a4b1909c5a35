"""ROME's interlocks at the edges of their thresholds; for the inherited tests."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TypeAlias

from emulators.bench import cases as bench
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.motion.captured import Located, Source
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robot_types import find
from firmware_bridge.robots.rome.geometry import RomeGeometry
from firmware_bridge.robots.rome.motion import RomeMotion, RomeState
from firmware_bridge.robots.rome.rules import SPIN

Case: TypeAlias = bench.Case[RomeMotion, RomeState]
Situation: TypeAlias = bench.Situation[RomeMotion, RomeState]
JUST: float = 1.0 + 1e-5
"""A limit reports what is beyond it by more than a millionth."""
DIAGONAL = math.sqrt(0.5)


def cases(robot: Robot[RomeGeometry]) -> Iterator[Case]:
    """Yield at least one case for each interlock and limit."""
    limits = robot.geometry.limits
    for side in (-1.0, 1.0):
        spin = side * SPIN * limits.turn_rate_rad_s
        yield Case(
            "turns too fast",
            trips=Situation(body=RomeState(0.0, 0.0, math.nextafter(spin, side * math.inf))),
            spares=Situation(body=RomeState(0.0, 0.0, spin)),
            reason=f"the base turns with {spin:.2f} rad/s, limit {limits.turn_rate_rad_s:.2f} rad/s",
        )
        yield from _limited(robot, side)
    yield Case(
        "turns too fast",
        trips=Situation(body=RomeState(0.0, 0.0, math.nan)),
        spares=Situation(body=RomeState(limits.speed_mps, limits.speed_mps, 0.0)),
        reason=f"the base turns with nan rad/s, limit {limits.turn_rate_rad_s:.2f} rad/s",
    )
    yield from _lost()
    step = 0.8 * limits.acceleration_mps2 * robot.cycle_ms / 1000.0
    yield Case(
        "acceleration limit",
        trips=Situation(command=RomeMotion(left_mps=2.0 * step)),
        spares=Situation(command=RomeMotion(left_mps=step)),
        reason=(
            "requested a step from (0.00, 0.00) m/s and 0.00 rad/s to "
            f"(0.00, {2.0 * step:.2f}) m/s and 0.00 rad/s at once"
        ),
    )


def _lost() -> Iterator[Case]:
    """Yield the cases of a base that cameras see: a path follower needs its place, an operator does not."""
    guided, seen = RomeMotion(path_s=1.0), Located(Pose(), Source.CAPTURED, 0.0, 0.0, 0.0, 0)
    unseen = replace(seen, source=Source.UNSEEN)
    lost = replace(seen, source=Source.LOST, uncertain_m=0.051)
    off = "the place is off by 0.051 m at most without the cameras: they "
    for trips, spares, reason in (
        (unseen, Situation(command=guided, located=seen), "the cameras have not seen the robot yet"),
        (lost, Situation(command=RomeMotion(), located=lost), off + "do not see it"),
        (
            replace(lost, refused=1, off_m=0.3, off_rad=-0.35),
            Situation(command=guided, located=replace(seen, source=Source.ODOMETRY, uncertain_m=0.05)),
            off + "show it 0.30 m and 20 degrees off",
        ),
    ):
        yield Case("pose lost", trips=Situation(command=guided, located=trips), spares=spares, reason=reason)
    # By hand, too, where only the cameras measure a wheel's motion.
    yield Case(
        "pose lost",
        trips=Situation(located=lost),
        spares=Situation(located=seen),
        reason=off + "do not see it",
        robot=over_protocol(find("rome+cameras"), "mw"),
    )
    # For every station in control, and by its own robot file: one without cameras has no bound of slip.
    under_cameras = find("rome+cameras")
    bound = under_cameras.located_by[1].slip_mps if under_cameras.located_by else math.nan
    yield Case(
        "base slips",
        trips=Situation(located=replace(seen, slip_mps=math.nextafter(bound, math.inf))),
        spares=Situation(located=replace(seen, slip_mps=bound)),
        reason=f"the base moves {bound:.2f} m/s apart from its wheels' speed, limit {bound:.2f} m/s",
        robot=under_cameras,
    )


def _limited(robot: Robot[RomeGeometry], side: float) -> Iterator[Case]:
    limits, distance = robot.geometry.limits, robot.geometry.base.wheel_distance_m
    speed, turn = 0.98 * limits.speed_mps, side * limits.turn_rate_rad_s
    straight = RomeMotion(side * DIAGONAL * speed, DIAGONAL * speed)
    faster = RomeMotion(JUST * straight.ahead_mps, JUST * straight.left_mps)
    yield _beyond("speed limit", straight, faster, f"{JUST * speed:.2f} m/s", f"{speed:.2f} m/s")
    spinning = RomeMotion(turn_rad_s=turn)
    yield _beyond(
        "turn rate limit",
        spinning,
        RomeMotion(turn_rad_s=JUST * turn),
        f"{JUST * turn:.2f} rad/s",
        f"{turn:.2f} rad/s",
    )
    # To the left with a turn to the left the wheel at 0 degrees has both, one on top of the other.
    turning = limits.turn_rate_rad_s
    left = limits.rim_mps - distance * turning
    yield Case(
        "rim limit",
        trips=Situation(command=RomeMotion(0.0, side * JUST * left, side * JUST * turning)),
        spares=Situation(
            command=RomeMotion(0.0, side * left, side * turning),
            commanded=RomeMotion(0.0, side * left, side * turning),
        ),
        reason=(f"requested {JUST * limits.rim_mps:.2f} m/s at a wheel, allowed is {limits.rim_mps:.2f} m/s"),
    )


def _beyond(interlock: str, within: RomeMotion, beyond: RomeMotion, requested: str, allowed: str) -> Case:
    """Return the case of a limit that is passed at the pace that the base has already."""
    return Case(
        interlock,
        trips=Situation(command=beyond, commanded=within),
        spares=Situation(command=within, commanded=within),
        reason=f"requested {requested}, allowed is {allowed}",
    )
