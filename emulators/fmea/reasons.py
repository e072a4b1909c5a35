"""Reasons for which a failure may go unnoticed although the robot moves: a row each, and no others."""

from dataclasses import dataclass
from typing import Final

from emulators.bench.faults.failures import Failure
from emulators.fmea.effect import Effect
from firmware_bridge.drivers.all_drivers import reports_of
from firmware_bridge.drivers.driver import Reports
from firmware_bridge.robot import AnyRobot

ALONE: Final = frozenset({"bridge_ends"})
"""Failures that end the bridge, so that it detects nothing."""


@dataclass(frozen=True, slots=True)
class Reason:
    """One examined kind of fault."""

    kind: str
    why: str
    state: str = ""
    """The only state in which it holds; empty: all of them."""
    watched: bool = False
    """Good only where each device stops by itself, and did."""
    unmeasured: bool = False
    """Good only of an axis whose encoder the firmware does not read."""

    def fits(self, robot: AnyRobot, failure: Failure, state: str, found: Effect) -> bool:
        """Return whether it is good for a cell."""
        if self.kind != failure.kind or self.state not in {"", state}:
            return False
        if self.watched:
            alone = not any(link.unwatched for link in robot.links.values())
            return alone and found.standstill_after_ms is not None
        axes = [axis for axis in robot.axes if axis.name == failure.place]
        return not self.unmeasured or any(Reports.VELOCITY not in reports_of(robot, axis) for axis in axes)


REASONS: Final = (
    Reason(
        "bridge_ends", "no bridge is left to report it: each device stops by its own watchdog", watched=True
    ),
    Reason(
        "bridge_suspended",
        "a bridge that is not run reports it when it runs again: each device stops by its own watchdog",
        watched=True,
    ),
    Reason(
        "load_lifted",
        "a motor whose load is off the floor turns as commanded: only cameras detect it, and only when the"
        " base deviates from its motors' odometry by more than `base slips` allows",
    ),
    Reason("grip_lost", "off the wall it falls in any case: only its tether holds it"),
    *(
        Reason(
            kind, "the firmware does not read this motor's encoder: only cameras detect it", unmeasured=True
        )
        for kind in ("motor_cable_off", "motor_leads_swapped", "shaft_blocked")
    ),
    Reason("motor_supply_sag", "it turns slower, within the plausibility limits of the axis"),
    Reason(
        "encoder_frozen",
        "at small speeds it takes half a second until its backlog exceeds the limit",
        state="stopping",
    ),
)


def reason(robot: AnyRobot, failure: Failure, state: str, found: Effect) -> str:
    """Return why this failure may go unnoticed in this state; empty where it may not."""
    return next((row.why for row in REASONS if row.fits(robot, failure, state, found)), "")
