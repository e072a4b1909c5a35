"""RARS that is well in every respect, to be made unwell in one, and the gate that judges it."""

import math
from dataclasses import replace
from typing import Any, Final, TypeAlias

from firmware_bridge.canopen import cia402
from firmware_bridge.drivers.driver import Feedback, Power, Reports
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.safety import gate, snapshot
from firmware_bridge.units import Nanoseconds

Rars: TypeAlias = Robot[RarsGeometry]
Gate: TypeAlias = gate.Gate
Snapshot: TypeAlias = snapshot.Snapshot[RarsMotion, RarsState]
Ruling: TypeAlias = snapshot.Decision[RarsMotion]

FAULTS: Final = (
    cia402.PowerState.FAULT,
    cia402.PowerState.FAULT_REACTION_DISABLED,
    cia402.PowerState.FAULT_REACTION_ENABLED,
)
_MOTION: Final = frozenset({"speed_mps", "steer_rad", "lift_m", "lift_rate_mps"})


def above(value: float) -> float:
    return math.nextafter(value, math.inf)


def gate_of(robot: Rars) -> Gate:
    """Return RARS's gate; its drives report everything."""
    return gate.Gate(robot, ROBOT_TYPE.rules(robot), {axis.name: frozenset(Reports) for axis in robot.axes})


def limited(robot: Rars, **limits: float) -> Rars:
    """Return a robot with other limits."""
    geometry = robot.geometry
    changed = geometry.model_copy(update={"limits": geometry.limits.model_copy(update=limits)})
    return robot.model_copy(update={"geometry": changed})


def stated(state: cia402.PowerState | None) -> dict[str, Any]:
    """Return what a drive in this state is known by."""
    if state is None:
        return {"power": Power.UNKNOWN, "text": ""}
    if state is cia402.PowerState.OPERATION_ENABLED:
        power = Power.ON
    elif state is cia402.PowerState.QUICK_STOP_ACTIVE:
        power = Power.STOPPED
    else:
        power = Power.FAULT if state in FAULTS else Power.OFF
    return {"power": power, "text": state.title}


def well(
    robot: Rars,
    now: Nanoseconds,
    *,
    intent: dict[str, Any] | None = None,
    drives: dict[str, dict[str, Any]] | None = None,
    demanded_speed_mps: float = 0.0,
    link_lost: str | None = None,
    **changes: Any,
) -> Snapshot:
    """Make a healthy snapshot; the command and one axis's fields are given as dictionaries."""
    changed = drives or {}
    command = dict(intent or {})
    enabled = stated(cia402.PowerState.OPERATION_ENABLED)
    axes = {
        axis.name: Feedback(axis.name, **{**enabled, "received_at": now, **changed.get(axis.name, {})})
        for axis in robot.axes
    }
    body: dict[str, Any] = {"steer_rad": 0.0, "lift_m": 0.0, "speed_mps": 0.0}
    body |= {key: changes.pop(key) for key in tuple(changes) if key in body}
    facts = {"armed": True, "emergency_stopped": False, "neutral": True} | changes
    return snapshot.Snapshot(
        facts=snapshot.Facts(
            now=now,
            received_at=command.pop("received_at", now),
            axes=axes,
            sensors={},
            links_lost={} if link_lost is None else {"drives": link_lost},
            **facts,
        ),
        command=RarsMotion(**{"steer_rad": 0.0, **command}),
        commanded=RarsMotion(demanded_speed_mps),
        body=RarsState(screw_rad_s=axes["lift"].velocity, yaw_rate_rad_s=0.0, **body),
        pose=Pose(),
    )


def with_facts(seen: Snapshot, **changes: Any) -> Snapshot:
    """Return the same snapshot with other facts."""
    return snapshot.Snapshot(
        facts=replace(seen.facts, **changes),
        command=seen.command,
        commanded=seen.commanded,
        body=seen.body,
        pose=seen.pose,
    )


def shifted(seen: Snapshot, by: Nanoseconds) -> Snapshot:
    """Return the same snapshot at a later instant, with every time of arrival as much later."""

    def later(at: Nanoseconds) -> Nanoseconds:
        return at if at == NEVER_RECEIVED else at + by

    facts = seen.facts
    axes = {name: replace(one, received_at=later(one.received_at)) for name, one in facts.axes.items()}
    sent_at = None if facts.sent_at is None else facts.sent_at + by
    return with_facts(
        seen, now=facts.now + by, received_at=later(facts.received_at), sent_at=sent_at, axes=axes
    )


def names(decision: Ruling) -> tuple[str, ...]:
    """Return the names of what holds."""
    return tuple(event.name for event in decision.interlock_events)


def base_stopped(decision: Ruling) -> bool:
    """Return whether the base is held."""
    return "base" in decision.stopped


def lift_free(decision: Ruling) -> bool:
    """Return whether the lift may move."""
    return "lift" not in decision.stopped
