"""ROME's interlocks: those of its base, those of its arm, and those between them."""

from typing import Final

import numpy as np

from firmware_bridge.robots import ar2, rome
from firmware_bridge.robots.ar2.kinematics import Ar2Kinematics as Arm
from firmware_bridge.robots.ar2.motion import STILL
from firmware_bridge.robots.ar2.rules import HORIZON, tool
from firmware_bridge.robots.rome.kinematics import BASE as BASE_GROUP
from firmware_bridge.robots.rome_arm.balance import balance
from firmware_bridge.robots.rome_arm.halves import ARM, BASE, Interlock, Limit, View
from firmware_bridge.robots.rome_arm.motion import RomeArmMotion
from firmware_bridge.safety import interlock
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

CLEARS_AFTER: Final[Nanoseconds] = 300 * MILLISECOND
IN_TIME: Final = 1.0 - 1e-6
"""Least rate at which a path follower's path keeps its time."""


def _unknown(view: View) -> bool:
    """Return whether no one knows where the arm is: the common interlock "reference lost" is active then."""
    return any(axis.reference_lost for axis in view.facts.axes.values())


def _arm_out(view: View) -> str | None:
    if _unknown(view):
        return None
    x, y, _ = tool(view.body.arm)
    away, most = float(np.hypot(x, y)), view.geometry.balance.tool_distance_m
    if away <= most:
        return None
    return f"the tool is {away:.2f} m away, the base drives with {most:.2f} m at most"


def _off_balance(view: View) -> str | None:
    if _unknown(view):
        return None
    keeps = view.geometry.balance.margin_m
    room = balance(view.geometry, view.body.arm.angles).room_m
    if room >= keeps:
        return None
    inside, least = 1000.0 * room, 1000.0 * keeps
    return f"the center of gravity is {inside:.0f} mm inside the wheels, least is {least:.0f} mm"


def _tips(view: View) -> tuple[RomeArmMotion, str | None]:
    """Take away a motion of the tool that leaves less room than is kept, where it makes it less."""
    motion, geometry = view.allowed, view.geometry
    if motion.arm.twist == STILL or _unknown(view):
        return motion, None
    half = ARM.view(view)
    arm = Arm(half.robot)
    # From where the set-point has the joints, as they are there at the end of the move.
    angles = arm.begin(half.seen.commanded, half.body)
    rates, share = arm.rates(angles, motion.arm.twist)
    later = np.array(angles) + HORIZON * to_seconds(view.robot.cycle) * share * rates.joints
    now = balance(geometry, angles).room_m
    then = balance(geometry, tuple(map(float, later))).room_m
    # A motion that makes room is permitted, also where too little is left.
    if then >= geometry.balance.margin_m or then >= now:
        return motion, None
    # Only the arm rests: the base goes on, and may be what makes room.
    parked = arm.at_standstill(motion.arm, frozenset(ar2.ROBOT_TYPE.groups))
    return ARM.put(motion, parked), f"the center of gravity would be {1000.0 * then:.0f} mm inside the wheels"


def _stretched(view: View) -> tuple[RomeArmMotion, str | None]:
    """Clip nothing, the path follower has; report that its path takes longer than intended."""
    rate = view.allowed.path_rate
    if rate >= IN_TIME:
        return view.allowed, None
    return view.allowed, f"the path takes {1.0 / rate:.2f} times its time: the base could not follow it"


INTERLOCKS: Final[tuple[Interlock, ...]] = (
    *BASE.interlocks(rome.ROBOT_TYPE),
    *ARM.interlocks(ar2.ROBOT_TYPE),
    interlock.Interlock(
        "arm out",
        _arm_out,
        "take the tool nearer to the base, which drives then",
        stops=frozenset({BASE_GROUP}),
        clear_after=CLEARS_AFTER,
        blocks_arming=False,
    ),
    interlock.Interlock(
        "off balance",
        _off_balance,
        "take the tool nearer to the base; look what it carries",
        stops=frozenset({BASE_GROUP}),
        clear_after=CLEARS_AFTER,
        severity=Severity.CRITICAL,
        blocks_arming=False,
    ),
)

LIMITS: Final[tuple[Limit, ...]] = (
    *BASE.limits(rome.ROBOT_TYPE),
    *ARM.limits(ar2.ROBOT_TYPE),
    interlock.Limit("tool balance", _tips, "take the tool nearer to the base", clear_after=CLEARS_AFTER),
    interlock.Limit(
        "time stretched",
        _stretched,
        "make the orbit smaller, or let it take its time",
        clear_after=CLEARS_AFTER,
    ),
)
"""Applied in this order; a later one sees what an earlier one left."""


def slowed(view: View, share: float) -> tuple[RomeArmMotion, str | None]:
    """Clip both halves to a share of their top speeds."""
    base, base_text = rome.rules.slowed(BASE.view(view), share)
    arm, arm_text = ar2.rules.slowed(ARM.view(view), share)
    motion = ARM.put(BASE.put(view.allowed, base), arm)
    return motion, " and ".join(filter(None, (base_text, arm_text))) or None
