"""ROME's interlocks at the edges of their thresholds: those of its halves, and those between them."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final, TypeAlias

from emulators.bench import cases as bench
from emulators.robots.ar2.cases import BENT
from emulators.robots.ar2.cases import cases as cases_of_arm
from emulators.robots.rome.cases import cases as cases_of_base
from firmware_bridge.robot import Robot
from firmware_bridge.robot_types import find
from firmware_bridge.robots.ar2 import motion as arm
from firmware_bridge.robots.ar2.rules import tool
from firmware_bridge.robots.rome import motion as base
from firmware_bridge.robots.rome_arm.balance import balance
from firmware_bridge.robots.rome_arm.geometry import RomeArmGeometry
from firmware_bridge.robots.rome_arm.halves import ARM, BASE, Half
from firmware_bridge.robots.rome_arm.motion import RomeArmMotion, RomeArmState

Case: TypeAlias = bench.Case[RomeArmMotion, RomeArmState]
Situation: TypeAlias = bench.Situation[RomeArmMotion, RomeArmState]
STANDSTILL: Final = base.RomeState(0.0, 0.0, 0.0)
WHOLE: Final = RomeArmState(STANDSTILL, BENT)
AHEAD: Final = RomeArmState(
    STANDSTILL, arm.Ar2State((0.0, BENT.angles[1] + 1e-5, *BENT.angles[2:]), arm.STILL)
)
"""A little further forward."""


def cases(robot: Robot[RomeArmGeometry]) -> Iterator[Case]:
    """Yield at least one case for each interlock and limit."""
    for of_base in cases_of_base(BASE.robot(robot)):
        yield _whole(BASE, of_base, None if of_base.robot is None else _with_board(of_base.robot))
    for of_arm in cases_of_arm(ARM.robot(robot)):
        interlock = of_arm.interlock if of_arm.interlock.startswith("tool") else f"tool {of_arm.interlock}"
        other = of_arm.robot
        if other is not None:
            geometry = robot.geometry.model_copy(update={"arm": other.geometry})
            axes = {axis.name: axis for axis in (*robot.axes, *other.axes)}
            other = robot.model_copy(update={"geometry": geometry, "axes": tuple(axes.values())})
        yield replace(_whole(ARM, of_arm, other), interlock=interlock)
    yield from _between(robot)


def _whole(half: Half, case: bench.Case[Any, Any], robot: Robot[RomeArmGeometry] | None) -> Case:
    return Case(
        case.interlock,
        trips=_both(half, case.trips),
        spares=_both(half, case.spares),
        reason=case.reason,
        robot=robot,
    )


def _both(half: Half, of_half: bench.Situation[Any, Any]) -> Situation:
    """Return the situation of both, in which the other half rests."""
    put = {"command": of_half.command, "commanded": of_half.commanded}
    body = WHOLE if of_half.body is None else replace(WHOLE, **{half.name: of_half.body})
    motions = {key: None if it is None else half.put(RomeArmMotion(), it) for key, it in put.items()}
    return Situation(body=body, located=of_half.located, **motions)


def _with_board(base_alone: Robot[Any]) -> Robot[RomeArmGeometry]:
    """Return the whole robot under cameras, with the board of another one's base."""
    whole: Robot[RomeArmGeometry] = find("rome_arm+cameras")
    return whole.model_copy(update={"links": {**whole.links, "board": base_alone.links["board"]}})


def _balanced(robot: Robot[RomeArmGeometry], **values: float) -> Robot[RomeArmGeometry]:
    table = robot.geometry.balance.model_copy(update=values)
    return robot.model_copy(update={"geometry": robot.geometry.model_copy(update={"balance": table})})


def _between(robot: Robot[RomeArmGeometry]) -> Iterator[Case]:
    x, y, _ = tool(BENT)
    away = math.hypot(x, y) + 1e-9
    yield Case(
        "arm out",
        trips=Situation(body=AHEAD),
        spares=Situation(body=WHOLE),
        reason=f"the tool is {away:.2f} m away, the base drives with {away:.2f} m at most",
        robot=_balanced(robot, tool_distance_m=away),
    )
    room = balance(robot.geometry, BENT.angles).room_m
    kept = f"{1000.0 * room:.0f} mm"
    yield Case(
        "off balance",
        trips=Situation(body=AHEAD),
        spares=Situation(body=WHOLE),
        reason=f"the center of gravity is {kept} inside the wheels, least is {kept}",
        robot=_balanced(robot, margin_m=room),
    )
    slow = 0.001
    ahead, back = (RomeArmMotion(arm=arm.Ar2Motion(ahead_mps=speed)) for speed in (slow, -slow))
    yield Case(
        "tool balance",
        trips=Situation(command=ahead, commanded=ahead, body=WHOLE),
        spares=Situation(command=back, commanded=back, body=WHOLE),
        reason=f"the center of gravity would be {kept} inside the wheels",
        robot=_balanced(robot, margin_m=room),
    )
    yield Case(
        "time stretched",
        trips=Situation(command=RomeArmMotion(path_rate=1.0 / 1.5), body=WHOLE),
        spares=Situation(command=RomeArmMotion(), body=WHOLE),
        reason="the path takes 1.50 times its time: the base could not follow it",
    )
