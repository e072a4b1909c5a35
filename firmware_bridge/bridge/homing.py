"""Homing of one axis at a time, by motion: its supervision, its permission, its report.

It ends as a stop of any axis does: the axis is commanded to standstill, and stays so. The device's search and
the choice of interlocks for an axis are not known here.
"""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.drivers.driver import Driver, Homed, SetPoint
from firmware_bridge.drivers.life_cycle import AT_REST, Transition
from firmware_bridge.intent import (
    NEVER_RECEIVED,
    ChangeDriver,
    Disarm,
    EmergencyStop,
    EnterMode,
    Pause,
    Request,
)
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.snapshot import ActiveInterlock, Facts
from firmware_bridge.safety.tracking import DEVIATION
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds, to_seconds

STOPS: Final = (Disarm, EmergencyStop, EnterMode, Pause, ChangeDriver)
"""Requests that end a homing."""
MEANWHILE: Final = ("not armed", "stick not neutral", "reference lost", "axis restarted")
"""Rows that keep no axis from its homing: it is what they wait for, or no stick moves it."""
PREPARED_WITHIN: Final[Nanoseconds] = 2 * SECOND
"""Time for reading back before the start, and after the end, beside the one in the robot file."""
UNDER_WAY: Final = InterlockBase(
    "homing", "wait; or disarm, that stops it", stops=frozenset(), severity=Severity.NOTICE
)
FAILED: Final = InterlockBase(
    "not homed",
    "look what held it, then home it again, or confirm its position",
    stops=frozenset(),
    severity=Severity.CRITICAL,
)


class HomingSequence:
    """The homing of one axis after the other."""

    __slots__ = ("_driver", "_high", "_low", "_place", "_reason", "_sampled_at", "_since", "interlock_events")

    def __init__(self) -> None:
        self._driver: Driver | None = None
        """Driver of the axis that is homed; None without one."""
        self._reason = ""
        """The reason why it has to end; empty while it may go on."""
        self._since: Nanoseconds = 0
        self._place = self._low = self._high = 0.0
        """Position, with its lowest and highest value, in its unit: its own count jumps at the end."""
        self._sampled_at: Nanoseconds = NEVER_RECEIVED
        self.interlock_events: tuple[ActiveInterlock, ...] = ()
        """Reports: one under way, or the reason why the last one failed."""

    @property
    def under_way(self) -> tuple[ActiveInterlock, ...]:
        """The hold of the homing that is under way; it keeps whatever else would move."""
        return () if self._driver is None else self.interlock_events

    @property
    def set_points(self) -> Mapping[str, SetPoint]:
        """The set-point of the axis whose homing may go on; empty without one."""
        return {} if self._driver is None else {self._driver.axis.name: Homed()}

    def kept_by(self, axis: Axis, events: tuple[ActiveInterlock, ...]) -> ActiveInterlock | None:
        """Return the first of the holds that stop an axis which keeps it from being homed; or None."""
        homing = axis.zero.homing
        first = () if homing is None else homing.after
        return next(
            (event for event in events if event.axis in first or event.interlock.name not in MEANWHILE), None
        )

    def begin(self, driver: Driver, now: Nanoseconds) -> tuple[Packet, ...]:
        """Home an axis; return what is sent for it."""
        self._driver, self._reason, self._since = driver, "", now
        self._place = self._low = self._high = 0.0
        self._sampled_at = NEVER_RECEIVED
        self._report(UNDER_WAY, f"{driver.axis.called} is homing", now)
        return driver.begin(Transition.HOME, now)

    def ordered(self, request: Request) -> None:
        """Take note of a request: one for a stop ends the homing."""
        if isinstance(request, STOPS):
            self._reason = "it was stopped by an order"

    def watch(self, events: tuple[ActiveInterlock, ...], facts: Facts) -> None:
        """Look once in a cycle whether it may go on; `holds` are those that stop its axis."""
        driver, now = self._driver, facts.now
        if driver is None:
            self._forget(facts)
            return
        if driver.state in AT_REST:
            self._ended(driver, now)
            return
        kept = self.kept_by(driver.axis, events)
        if kept is not None:
            # The first reason counts: others are often its consequences.
            self._reason = self._reason or kept.reason
        self._go(driver, facts)
        if self._reason:
            self.interrupt(self._reason, now)

    def interrupt(self, reason: str, now: Nanoseconds) -> None:
        """End the one that is under way, if any: its axis is commanded to standstill from now on."""
        if self._driver is not None:
            self._report(FAILED, f"{self._driver.axis.called} was not homed: {reason}", now)
            self._driver = None

    def _ended(self, driver: Driver, now: Nanoseconds) -> None:
        self.interlock_events = ()
        if driver.failure is not None:
            self.interrupt(driver.failure.problem, now)
        elif driver.feedback.reference_lost:
            self.interrupt(self._reason or "its drive was stopped", now)
        self._driver = None

    def _go(self, driver: Driver, facts: Facts) -> None:
        """Judge how far it has gone, and for how long."""
        axis, feedback = driver.axis, facts.axes[driver.axis.name]
        homing, travel = axis.zero.homing, axis.travel
        if homing is None or travel is None:
            return
        if NEVER_RECEIVED not in (self._sampled_at, feedback.sampled_at):
            self._place += feedback.velocity * to_seconds(feedback.sampled_at - self._sampled_at)
            self._low, self._high = min(self._low, self._place), max(self._high, self._place)
        self._sampled_at = feedback.sampled_at
        furthest = homing.furthest(travel, axis.motor_turn) + 2.0 * DEVIATION * axis.top_speed
        if self._high - self._low > furthest:
            self._reason = f"it went further than {furthest:.4g} {axis.unit}, from end to end and beyond"
        elif facts.now > self._since + from_seconds(homing.within_s) + PREPARED_WITHIN:
            self._reason = f"it took longer than {homing.within_s:g} s"

    def _forget(self, facts: Facts) -> None:
        """Report no failure any more of an axis whose zero is known."""
        self.interlock_events = tuple(
            event for event in self.interlock_events if facts.axes[event.axis].reference_lost
        )

    def _report(self, interlock: InterlockBase, reason: str, now: Nanoseconds) -> None:
        name = "" if self._driver is None else self._driver.axis.name
        self.interlock_events = (ActiveInterlock(f"{interlock.name}: {name}", reason, interlock, now, name),)
