"""The interlocks: small predicates in tables, each with its name, its reason in numbers, and its remedy.

A predicate tells the reason why it holds, or None. It is told whether it holds already, so that the threshold
at which it lets go may lie below the one at which it trips. It keeps no state: time-outs are computed from
instants in the snapshot, and `firmware_bridge.safety.gate` keeps the clear times. What is not a number or not
known never counts as safe: comparisons are written so that a NaN trips.

Sources: A. P. Das, PhD thesis, IIT Delhi, 2018, 2.3.1 and 4.2.1 for speed, acceleration, tipping, lift and
turn; the times are choices of this project.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.intent import NEVER_HEARD
from firmware_bridge.robot import Axis, Robot, Role
from firmware_bridge.safety.snapshot import DriveSnapshot, Snapshot
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds
from firmware_bridge.wire.cia402 import State

LINK_CLEARS_AFTER: Final[Nanoseconds] = 200 * MILLISECOND
"""A silent operator or drive is back when it has been heard for this long: four cycles, no stray packet."""
LIFT_CLEARS_AFTER: Final[Nanoseconds] = 200 * MILLISECOND
"""Longer than a set-point takes to become a measured speed, so that lift and wheels never overlap."""
RETRACTED_SHARE: Final = 0.8
"""An extended lift counts as retracted again below this share of the height at which it tripped."""
LIFT_MOVES_RAD_S: Final = 0.10
"""Speed of the screw that counts as moving: one turn a minute, 24 um/s at the foot."""
LIFT_RESTS_RAD_S: Final = 0.05
BASE_MOVES_MPS: Final = 0.010
"""Speed at which the base counts as driving; its encoders resolve 0.1 mm/s."""
BASE_RESTS_MPS: Final = 0.005

_FAULT_STATES: Final = (State.FAULT, State.FAULT_REACTION_DISABLED, State.FAULT_REACTION_ENABLED)


class View:
    """What an interlock may look at: the robot, the snapshot, and what the gate itself has let through."""

    __slots__ = ("holding", "lift_let_go", "robot", "seen", "speed_let_go_mps")

    def __init__(
        self,
        robot: Robot,
        seen: Snapshot,
        *,
        lift_let_go: bool,
        holding: bool = False,
        speed_let_go_mps: float = 0.0,
    ) -> None:
        self.robot: Final = robot
        self.seen: Final = seen
        self.lift_let_go: Final = lift_let_go
        """The gate's ruling before this one let the lift move."""
        self.holding: Final = holding
        """The interlock that looks holds already."""
        self.speed_let_go_mps: Final = speed_let_go_mps
        """The base speed of this ruling."""

    def held(self) -> "View":
        """Return the same for an interlock that holds already."""
        return View(
            self.robot,
            self.seen,
            lift_let_go=self.lift_let_go,
            holding=True,
            speed_let_go_mps=self.speed_let_go_mps,
        )


Judge: TypeAlias = Callable[[View], str | None]
DriveJudge: TypeAlias = Callable[[Robot, Axis, DriveSnapshot, Nanoseconds], str | None]


@dataclass(frozen=True, slots=True)
class Interlock:
    """Stops the base and the steering while it holds, and the lift, too, unless `lift_is_free`."""

    name: str
    judge: Judge
    remedy: str
    clear_after: Nanoseconds = 0
    lift_is_free: bool = False


@dataclass(frozen=True, slots=True)
class DriveInterlock:
    """Stops everything while it holds for one drive; the axis's name is added to its name."""

    name: str
    judge: DriveJudge
    remedy: str
    clear_after: Nanoseconds = 0


def operator_silent_after(robot: Robot) -> Nanoseconds:
    """Return the silence of the operator that trips."""
    return robot.operator.silent_ms * MILLISECOND


def drive_silent_after(robot: Robot) -> Nanoseconds:
    """Return the silence of a drive that trips."""
    return robot.bus.drive_silent_ms * MILLISECOND


def _emergency_stop(view: View) -> str | None:
    return "the emergency stop is latched" if view.seen.emergency_stopped else None


def _link_lost(view: View) -> str | None:
    return view.seen.link_lost


def _not_armed(view: View) -> str | None:
    return None if view.seen.armed else "the robot is not armed"


def _operator_silent(view: View) -> str | None:
    limit = operator_silent_after(view.robot)
    heard_at = view.seen.intent.heard_at
    if heard_at == NEVER_HEARD:
        return "no motion command has come yet"
    silence = view.seen.now - heard_at
    if silence < limit:
        return None
    return f"no motion command for {to_seconds(silence):.2f} s, limit {to_seconds(limit):.2f} s"


def _wish_unusable(view: View) -> str | None:
    wish = view.seen.intent
    for title, value in (
        ("speed", wish.speed_mps),
        ("steer angle", wish.steer_rad),
        ("lift height", wish.lift_m),
        ("lift rate", wish.lift_rate_mps),
    ):
        if value is not None and not math.isfinite(value):
            return f"the {title} asked for is {value}"
    return None


def _steer_unknown(view: View) -> str | None:
    return "the actual steer angle is not known" if _unknown(view.seen.steer_rad) else None


def _lift_unknown(view: View) -> str | None:
    return "the actual lift height is not known" if _unknown(view.seen.lift_m) else None


def _lift_extended(view: View) -> str | None:
    height, limit = view.seen.lift_m, view.robot.limits.lift_retracted_m
    if height is None or height <= (RETRACTED_SHARE * limit if view.holding else limit):
        return None
    return f"the lift stands at {_millimetres(height)}, retracted is below {_millimetres(limit)}"


def _lift_moves(view: View) -> str | None:
    if view.lift_let_go:
        return "the lift has been told to move"
    limit = LIFT_RESTS_RAD_S if view.holding else LIFT_MOVES_RAD_S
    axis = view.robot.axis(Role.LIFT)
    for drive in view.seen.drives:
        if drive.axis == axis.name and not abs(drive.speed_rad_s) <= limit:
            return f"the lift's screw turns with {drive.speed_rad_s:.2f} rad/s"
    return None


STOPS: Final = (
    Interlock("emergency stop", _emergency_stop, "clear the emergency stop, then arm"),
    Interlock("drives out of reach", _link_lost, "plug the adapter in again, then arm", LINK_CLEARS_AFTER),
    Interlock("not armed", _not_armed, "arm the robot"),
    Interlock("operator silent", _operator_silent, "send motion commands", LINK_CLEARS_AFTER),
    Interlock("wish unusable", _wish_unusable, "send finite numbers"),
    Interlock("steer angle unknown", _steer_unknown, "wait for the steering drive's position"),
    Interlock("lift height unknown", _lift_unknown, "wait for the lift drive's position"),
    Interlock("lift extended", _lift_extended, "retract the lift", lift_is_free=True),
    Interlock(
        "lift moving",
        _lift_moves,
        "let the lift come to rest at the height asked for",
        LIFT_CLEARS_AFTER,
        lift_is_free=True,
    ),
)
"""Whole-robot interlocks that make the demand 0, in the order in which they are reported."""


def _drive_silent(robot: Robot, axis: Axis, drive: DriveSnapshot, now: Nanoseconds) -> str | None:
    limit = drive_silent_after(robot)
    if drive.heard_at == NEVER_HEARD:
        return f"{_called(axis)} has never been heard"
    silence = now - drive.heard_at
    if silence < limit:
        return None
    return f"{_called(axis)} silent for {to_seconds(silence):.2f} s, limit {to_seconds(limit):.2f} s"


def _drive_fault(_robot: Robot, axis: Axis, drive: DriveSnapshot, _now: Nanoseconds) -> str | None:
    if drive.fault != 0:
        return f"{_called(axis)} reports fault 0x{drive.fault:04X}"
    return f"{_called(axis)} is in fault, code unknown" if drive.state in _FAULT_STATES else None


def _drive_disabled(_robot: Robot, axis: Axis, drive: DriveSnapshot, _now: Nanoseconds) -> str | None:
    # A drive that was never heard is silent, one in a fault state is faulted: one cause, one hold.
    if drive.heard_at == NEVER_HEARD or drive.state in _FAULT_STATES:
        return None
    if drive.state is State.OPERATION_ENABLED:
        return None
    state = "state unknown" if drive.state is None else drive.state.title
    return f"{_called(axis)} is not enabled: {state}"


DRIVE_STOPS: Final = (
    DriveInterlock("drive silent", _drive_silent, "check its power and the CAN cable", LINK_CLEARS_AFTER),
    DriveInterlock("drive fault", _drive_fault, "remove the cause, then disarm and arm to reset the fault"),
    DriveInterlock("drive not enabled", _drive_disabled, "wait for it, or disarm and arm"),
)
"""Interlocks of each drive that make the demand 0."""


def _base_drives(view: View) -> str | None:
    speed = view.seen.speed_mps
    if not abs(speed) <= (BASE_RESTS_MPS if view.holding else BASE_MOVES_MPS):
        return f"the robot drives with {speed:.2f} m/s"
    if view.seen.demanded_speed_mps != 0.0:
        return f"the robot is told to drive with {view.seen.demanded_speed_mps:.2f} m/s"
    if view.speed_let_go_mps != 0.0:
        return f"the robot is asked to drive with {view.speed_let_go_mps:.2f} m/s"
    return None


LIFT_REFUSED: Final = Interlock(
    "lift refused", _base_drives, "stop the robot before the lift moves", LIFT_CLEARS_AFTER
)
"""The one interlock that holds the lift alone; judged while a lift motion is wished."""


def _called(axis: Axis) -> str:
    return f"node {axis.node} ({axis.title})"


def _millimetres(length_m: float) -> str:
    return f"{1000.0 * length_m:.0f} mm"


def _unknown(value: float | None) -> bool:
    return value is None or not math.isfinite(value)
