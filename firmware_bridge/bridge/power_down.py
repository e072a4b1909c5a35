"""Power down: standstill without power is checked before it, and watched for a while after.

All axes lose their power together. Beforehand the current is judged that each free axis needs at standstill:
more than friction explains means a slope, and the power stays until it is ordered off. The decay of the
ramp's current does not count: only currents that arrived at standstill do, and a falling one is judged again.
An axis that moves nevertheless is given power again. The reason for the power down is not known here; an
order that disables the power does not pass here.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from enum import Enum
from math import inf, isfinite, nan
from typing import Final, NamedTuple

from firmware_bridge.bridge.all_drivers import AllDrivers
from firmware_bridge.drivers.driver import Driver, Power, Reports, Stop
from firmware_bridge.drivers.life_cycle import AT_REST, Transition
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Unpowered
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.snapshot import ActiveInterlock
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

LOOKS_FOR: Final[Nanoseconds] = 500 * MILLISECOND
"""Time of standstill before the base's currents count: they are averages, and decay from braking."""
AVERAGED: Final[Nanoseconds] = 250 * MILLISECOND
"""Over the last part of it, and over each further look."""
LOOKED_WITHIN: Final[Nanoseconds] = 2_500 * MILLISECOND
"""A current that has not arrived by then is not known, and one that still falls counts as it is."""
SETTLED: Final = 0.9
"""A current that is not below this share of what it was a look before falls no more."""
WATCHED_FOR: Final[Nanoseconds] = 2 * SECOND
"""Time without motion that proves standstill."""
SLIPS_S: Final = 0.25
"""One that goes further than in this time at the speed below which it rests does not stand."""
HELD: Final = InterlockBase(
    "held with power",
    "block the wheels, then disarm by force; at its end, Ctrl-C twice within 5 s powers down, too",
    severity=Severity.CRITICAL,
    blocks_arming=False,
)


STANDSTILL_WITHIN: Final[Nanoseconds] = 3 * SECOND
"""Time for a base to come to standstill; after it the power stays, and that is reported."""
STAYS: Final = InterlockBase(
    "power stays on",
    "keep clear; disarm by force, which disables it",
    severity=Severity.CRITICAL,
    blocks_arming=False,
)


class PowerDownStage(Enum):
    """Stage of the power down."""

    KEPT = "kept"
    """No power down is requested, or the base is not at standstill yet."""
    LOOKED_AT = "looked at"
    WATCHED = "watched"
    """Without power; a free axis that moves now gets it again."""
    POWERED_DOWN = "powered down"
    HELD = "held with power"
    """Until it is ordered off."""


@dataclass(slots=True)
class _Axis:
    """A free axis: nothing but its device keeps it where it is."""

    driver: Driver
    silent_after: Nanoseconds
    pulls: float = 0.0
    """Sum of the currents that were looked at, A."""
    looks: int = 0
    looked_at: Nanoseconds = NEVER_RECEIVED
    """Arrival of the newest current that was judged."""
    was_at: float = 0.0
    """Its position when it lost its power."""
    powered_down: bool = False

    @property
    def powered(self) -> bool:
        """True where it may have torque, as far as its device has reported."""
        return not self.driver.unpowered and self.driver.feedback.power not in (Power.OFF, Power.FAULT)

    def silent(self, now: Nanoseconds) -> bool:
        """Return whether its device has timed out."""
        return now - self.driver.feedback.received_at >= self.silent_after

    @property
    def moves(self) -> bool:
        """True where its device reports motion."""
        return abs(self.driver.feedback.velocity) > self.driver.axis.standstill_below

    @property
    def slips(self) -> bool:
        """True where it moves, or has moved, since it lost its power."""
        way = abs(self.driver.feedback.position - self.was_at)
        return self.moves or way > SLIPS_S * self.driver.axis.standstill_below

    def look(self, now: Nanoseconds, since: Nanoseconds = NEVER_RECEIVED) -> None:
        """Take the newest current, once, unless it arrived before `since`; NaN where it is not known."""
        feedback, reports_current = self.driver.feedback, Reports.CURRENT in self.driver.reports
        known = reports_current and feedback.power is not Power.UNKNOWN and not self.silent(now)
        current = feedback.current_a if known else None
        if current is None:
            # NaN spreads: one unknown current makes the sum unknown, and then the power stays.
            self.pulls, self.looks = float("nan"), self.looks + 1
        elif feedback.current_at >= since and feedback.current_at != self.looked_at:
            self.pulls, self.looks, self.looked_at = self.pulls + current, self.looks + 1, feedback.current_at

    @property
    def pulled(self) -> float:
        """The current with which it stands, A; NaN where it is not known."""
        return self.pulls / self.looks if self.looks else float("nan")


class PowerDown:
    """The way of a whole robot from rest with power to standstill without."""

    __slots__ = ("_free", "_hold", "_looks_from", "_outbox", "_pulled", "_since", "_waits_from", "stage")

    def __init__(self, robot: AnyRobot, all_drivers: AllDrivers, outbox: list[Packet]) -> None:
        """Take the drives, and where to put what is to be sent at once."""
        self._outbox = outbox
        self._free: Final = tuple(
            _Axis(driver, robot.links[driver.axis.link].silent_ms * MILLISECOND)
            for driver in all_drivers.drivers
            if driver.axis.unpowered is Unpowered.FREE
        )
        self.stage = PowerDownStage.KEPT
        self._since: Nanoseconds = 0
        """Time when the stage began."""
        self._hold: ActiveInterlock | None = None
        self._waits_from: Nanoseconds | None = None
        """Since when the power shall go and the base does not rest."""
        self._looks_from: Nanoseconds = 0
        """Earliest arrival of a current that the present look counts."""
        self._pulled = 0.0
        """Result of the look before, in shares of what friction explains; 0 before the first."""

    @property
    def interlock_events(self) -> tuple[ActiveInterlock, ...]:
        """The reports."""
        return () if self._hold is None else (self._hold,)

    @property
    def held(self) -> bool:
        """True while the robot keeps its power because it would not stay at standstill without."""
        return self.stage is PowerDownStage.HELD

    @property
    def powered_down(self) -> bool:
        """True where it has lost its power, and has been at standstill without it for long enough."""
        return self.stage is PowerDownStage.POWERED_DOWN

    @property
    def under_way(self) -> bool:
        """True from the base's standstill on, until it is proved to stay so without power."""
        return self.stage not in (PowerDownStage.KEPT, PowerDownStage.POWERED_DOWN)

    @property
    def _busy(self) -> bool:
        """True while the driver of a free axis has a transition under way."""
        return any(axis.driver.state not in AT_REST for axis in self._free)

    def stop_for(self, *, standstill: bool, now: Nanoseconds, without: Collection[str] = ()) -> Stop | None:
        """Go on where the power shall go; return what all axes shall do, None while the base does not rest.

        `without` are the axes that the robot's mode does without.
        """
        if self.stage in (PowerDownStage.KEPT, PowerDownStage.LOOKED_AT) and not standstill:
            self._wait(now)
        elif self.stage is PowerDownStage.KEPT:
            self._enter(PowerDownStage.LOOKED_AT, now)
            self._pulled = 0.0
            self._look_again(now + LOOKS_FOR - AVERAGED)
        elif self.stage is PowerDownStage.LOOKED_AT:
            self._look(now, without)
        elif self.stage is PowerDownStage.WATCHED:
            self._watch(now)
        return self._set_point()

    def not_requested(self, now: Nanoseconds) -> None:
        """Keep the power as it is; an axis that has lost its own is still watched, until it has it again."""
        if self.stage is PowerDownStage.WATCHED and not self._busy:
            self._watch(now)
        else:
            self._forget(now)

    def kept_by(self, without: Collection[str], now: Nanoseconds) -> str | None:
        """Return why the power of these axes cannot go while the others keep theirs; None where it can.

        Those that stand together are looked at as they are now: what one holds, the rest would have to.
        """
        looked: dict[str, list[_Axis]] = {}
        going = set[str]()
        for axis in self._free:
            if axis.powered and not axis.silent(now):
                standstill_group = axis.driver.axis.standstill_group or axis.driver.axis.name
                one = _Axis(axis.driver, axis.silent_after)
                one.look(now)
                looked.setdefault(standstill_group, []).append(one)
                if axis.driver.axis.name in without:
                    going.add(standstill_group)
        found = (_pulls(looked[standstill_group]) for standstill_group in sorted(going))
        return next((held.reason for held in found if held is not None), None)

    def ordered(self, now: Nanoseconds) -> None:
        """Learn that the power goes by an order: nothing is looked at, and nothing gets it again."""
        self._forget(now)

    def _forget(self, now: Nanoseconds) -> None:
        self._enter(PowerDownStage.KEPT, now)
        self._hold = self._waits_from = None

    def _wait(self, now: Nanoseconds) -> None:
        """Wait for the base's standstill, and report the axes that move where there is none."""
        self._enter(PowerDownStage.KEPT, now)
        if self._waits_from is None:
            self._waits_from = now
        moving = [axis.driver for axis in self._free if axis.moves]
        if now < self._waits_from + STANDSTILL_WITHIN or not moving:
            self._hold = None
            return
        who = " and ".join(driver.axis.called for driver in moving)
        self._hold = ActiveInterlock(
            STAYS.name, f"the robot is not at standstill: {who} moves", STAYS, self._waits_from
        )

    def _set_point(self) -> Stop | None:
        if self.stage is PowerDownStage.KEPT:
            return None
        if self.stage in (PowerDownStage.WATCHED, PowerDownStage.POWERED_DOWN):
            return Stop.POWER_OFF
        # A quick stop would end the tasks that give power again.
        return Stop.STANDSTILL if self._busy else Stop.QUICK_STOP

    def _look_again(self, since: Nanoseconds) -> None:
        self._looks_from = since
        for axis in self._free:
            axis.pulls, axis.looks, axis.looked_at = 0.0, 0, NEVER_RECEIVED

    def _look(self, now: Nanoseconds, without: Collection[str]) -> None:
        powered = [axis for axis in self._free if axis.powered and axis.driver.axis.name not in without]
        if now >= self._looks_from:
            for axis in powered:
                axis.look(now, self._looks_from)
        # A silent axis is stopped by its own watchdog: the others hold the robot, and report.
        received = [axis for axis in powered if not axis.silent(now)] or powered
        last = now >= self._since + LOOKED_WITHIN
        if now < self._looks_from + AVERAGED or (not last and any(axis.looks == 0 for axis in received)):
            return
        held = _held(received)
        if held is None:
            for axis in self._free:
                axis.powered_down, axis.was_at = axis in powered, axis.driver.feedback.position
            self._enter(PowerDownStage.WATCHED if powered else PowerDownStage.POWERED_DOWN, now)
        # The current of the braking decays; one that falls no more is that of a slope.
        elif last or not isfinite(held.pulled) or 0.0 < SETTLED * self._pulled <= held.pulled:
            self._keep(held.reason, now)
        else:
            self._pulled = held.pulled
            self._look_again(now)

    def _watch(self, now: Nanoseconds) -> None:
        free = [axis for axis in self._free if axis.powered_down]
        slips = next((axis for axis in free if axis.slips), None)
        if slips is not None:
            # All of them, as they lost it together. A fault is reset by the operator only.
            for axis in free:
                if axis.driver.feedback.power is not Power.FAULT:
                    self._outbox += axis.driver.begin(Transition.ACTIVATE, now)
                    if axis.driver.failure is not None:
                        # Its set-up is not in force: it gets its power after that, and no sooner.
                        self._outbox += axis.driver.begin(Transition.RECOVER, now)
            called = slips.driver.axis.called
            self._keep(f"on a slope: held with power; {called} moved when its power was disabled", now)
        elif now >= self._since + WATCHED_FOR:
            self._enter(PowerDownStage.POWERED_DOWN, now)

    def _keep(self, reason: str, now: Nanoseconds) -> None:
        self._enter(PowerDownStage.HELD, now)
        self._hold = ActiveInterlock(HELD.name, reason, HELD, now)

    def _enter(self, stage: PowerDownStage, now: Nanoseconds) -> None:
        if stage is not self.stage:
            self.stage, self._since, self._hold, self._waits_from = stage, now, None, None


class _Held(NamedTuple):
    """The reason why axes keep their power."""

    pulled: float
    """The current with which they stand, in shares of what friction explains; NaN where it is not known."""
    reason: str


def _held(axes: Sequence[_Axis]) -> _Held | None:
    """Return the strongest reason why axes keep their power; None without one."""
    together: dict[str, list[_Axis]] = {}
    for axis in axes:
        together.setdefault(axis.driver.axis.standstill_group or axis.driver.axis.name, []).append(axis)
    found = [held for some in together.values() if (held := _pulls(some)) is not None]
    # A current that is not known is the strongest reason of all.
    return max(found, key=lambda held: held.pulled if isfinite(held.pulled) else inf, default=None)


def _pulls(axes: Sequence[_Axis]) -> _Held | None:
    """Return why axes that stand together keep their power, as far as the looks show; None: they need not."""
    for axis in axes:
        if not isfinite(axis.pulled):
            called = axis.driver.axis.called
            return _Held(nan, f"held with power: the holding current of {called} is not known")
    # With their signs: what wheels that the floor strains against each other need cancels.
    pulled = abs(sum(axis.pulled for axis in axes))
    friction = sum(axis.driver.axis.friction for axis in axes)
    if pulled <= friction:
        return None
    called = " and ".join(axis.driver.axis.called for axis in axes)
    reason = (
        f"on a slope: held with power, {pulled:.2f} A at {called}, and friction explains {friction:.2f} A"
    )
    return _Held(pulled / friction if friction else inf, reason)
