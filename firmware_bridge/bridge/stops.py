"""Supervision of stops: each axis that is requested to stop, stage by stage with more force.

No set-point that was sent counts as a stop. A stop is under way until a fresh report of the device shows the
axis at standstill or without torque. A stage lasts no longer than its row in the driver's table permits,
whatever the device reports meanwhile; one that is not confirmed by then gives way to the next, and the
operator is informed. The power is off at the latest `TAKEN_WITHIN` after the stop began. A stop waits for no
start-up, no restore and no query, but for a start-up that was requested: an order that stops the robot ends
that one, and it does not go first where the axis moves.
"""

from collections.abc import Collection, Mapping
from enum import Enum
from typing import Final

from firmware_bridge.bridge.all_drivers import AllDrivers, joined, requests_stop
from firmware_bridge.drivers.all_drivers import stop_stages_of
from firmware_bridge.drivers.driver import Driver, Position, Power, SetPoint, Stop
from firmware_bridge.drivers.life_cycle import AT_REST, NOT_ENDED
from firmware_bridge.drivers.stop_stages import TAKEN_WITHIN, StopStage, gentle_within, sequence
from firmware_bridge.intent import NEVER_RECEIVED, Disarm, EmergencyStop, Pause, Request
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.snapshot import ActiveInterlock
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

AT_STANDSTILL: Final = 0.01
"""An axis is at standstill below this share of its top speed."""
SLOWED: Final = 0.75
"""Share of its speed below which an axis slows down: its stage may last its row's full time."""
RAMPED_WITHIN: Final[Nanoseconds] = 3 * SECOND
"""The bridge's own ramp down may last so long; the first stage counts from its end."""
STEADY: Final[Nanoseconds] = 500 * MILLISECOND
"""A stop that was confirmed for less than this, and is not any more, is still the same stop: reports of
standstill now and then do not put off the power-off."""
NOT_ACKNOWLEDGED: Final = "stop not acknowledged"
REMEDY: Final = "keep clear; use the hardware emergency stop if it moves"
RUNS_ON: Final = "nothing is left to try; it may go on moving"


class Progress(Enum):
    """Progress of a stop."""

    NOT_REQUESTED = "not requested"
    UNDER_WAY = "under way"
    CONFIRMED = "confirmed"
    GIVEN_UP = "given up"
    """No stage is left, and none was confirmed."""


class AxisStop:
    """The stop of one axis."""

    __slots__ = (
        "_at_standstill",
        "_due",
        "_failed_at",
        "_gentle_until",
        "_interlock",
        "_sequences",
        "_silent_after",
        "_slowing_from",
        "_standstill_below",
        "begun_at",
        "confirmed_at",
        "driver",
        "excluded",
        "link",
        "off",
        "place",
        "progress",
        "since",
        "stages",
        "until",
    )  # fmt: skip

    def __init__(self, driver: Driver, robot: AnyRobot) -> None:
        axis = driver.axis
        link = robot.links[axis.link]
        self.driver: Final = driver
        self.link: Final = axis.link
        stages = stop_stages_of(robot, axis)
        self._sequences: Final = {off: sequence(stages, off=off) for off in (False, True)}
        self._standstill_below: Final = AT_STANDSTILL * axis.top_speed
        self._silent_after: Final = link.silent_ms * MILLISECOND
        stops = None if link.stops is None else frozenset(link.stops)
        self._interlock: Final = InterlockBase(
            NOT_ACKNOWLEDGED, REMEDY, stops=stops, severity=Severity.CRITICAL, disarms=stops is None
        )
        self.progress = Progress.NOT_REQUESTED
        self.excluded = False
        """The robot's mode does without the axis: what becomes of it holds nothing back."""
        self._at_standstill = False
        """True where it was at standstill in its last report before the stop."""
        self._slowing_from = 0.0
        self.off = False
        """True where the power was ordered off."""
        self.stages: tuple[StopStage, ...] = ()
        """Of the sequence that was begun."""
        self.place = 0
        self.begun_at: Nanoseconds = 0
        """Time when the present stage was begun."""
        self._failed_at: Nanoseconds = 0
        """Time when the stage before the present one was given up."""
        self.confirmed_at: Nanoseconds = 0
        self.until: Nanoseconds = 0
        """Latest end of the present stage."""
        self._due: Nanoseconds = 0
        """Its end unless the axis is seen to slow down."""
        self.since: Nanoseconds = 0
        """Time when the stop was begun, of which the present one may be a continuation."""
        self._gentle_until: Nanoseconds = 0
        """Latest begin of the first stage that disables the power."""

    @property
    def stage(self) -> StopStage:
        """The present stage; the last one where all were tried."""
        return self.stages[min(self.place, len(self.stages) - 1)]

    @property
    def first(self) -> StopStage:
        """The gentlest stage."""
        return self._sequences[False][0]

    @property
    def escalates(self) -> bool:
        """True where a stage was not confirmed, and another one is tried."""
        return self.progress is Progress.UNDER_WAY and self.place > 0

    @property
    def ends_power(self) -> bool:
        """True while a stage is under way that disables the power, ordered or not."""
        return self.escalates and self.stage.ends_power

    def keeps_off(self, now: Nanoseconds) -> bool:
        """Return whether the power-off command stays in force: its confirmation is not steady yet."""
        off = self.progress is Progress.CONFIRMED and self.place > 0 and self.stage.ends_power
        return off and now - self.confirmed_at < STEADY

    def begin(self, now: Nanoseconds, *, off: bool) -> None:
        """Begin with the first stage, or go on where the same stop had come to."""
        feedback, before = self.driver.feedback, self.progress
        same = before is Progress.CONFIRMED and now - self.confirmed_at < STEADY
        if same and self.off == off and self.stage.ends_power:
            # Its device, which may have restarted meanwhile, is commanded again, and has its time to answer.
            until, self._failed_at = self.until, now
            self.progress = Progress.UNDER_WAY
            self._enter(self.place, now)
            self.until = max(until, min(self.until, self.since + TAKEN_WITHIN))
            return
        if not same and before in (Progress.CONFIRMED, Progress.NOT_REQUESTED):
            self.since = now
        self._at_standstill = (
            feedback.sampled_at != NEVER_RECEIVED and abs(feedback.velocity) <= self._standstill_below
        )
        self.progress, self.off = Progress.UNDER_WAY, off
        standing = self._at_standstill and not off
        # Withholding the heartbeat disables every drive of the link: on a slope the robot would roll.
        self.stages = tuple(stage for stage in self._sequences[off] if not (standing and stage.takes_all))
        self._gentle_until = self.since + gentle_within(self.stages)
        self._enter(0, now)

    def confirm(self, now: Nanoseconds) -> None:
        """Note that the device's own report confirms the stop."""
        if self.progress is not Progress.CONFIRMED:
            self.progress, self.confirmed_at = Progress.CONFIRMED, now

    def go_on(self, now: Nanoseconds) -> None:
        """Begin the next stage, if one is left; after the time of the gentle ones it disables the power."""
        following, self._failed_at = self.place + 1, now
        if now >= self._gentle_until:
            ends_power = (it for it, stage in enumerate(self.stages) if it >= following and stage.ends_power)
            following = next(ends_power, following)
        if following < len(self.stages):
            self._enter(following, now)
        else:
            self.place, self.progress = len(self.stages), Progress.GIVEN_UP

    def extend(self, now: Nanoseconds, *, ramped: bool) -> None:
        """Let a stage that brings to standstill last its row's full time, where the axis slows down.

        While the bridge itself still ramps down the stage has not begun; that does not last for ever either.
        """
        if self.stage.ends_power:
            return
        speed = self._speed(now)
        if ramped and now < self.begun_at + RAMPED_WITHIN:
            self._slows(now)
            self.until = now + self.stage.lasts(speed)
        elif speed < self._slowing_from and speed <= SLOWED * self._slowing_from:
            self._slows(now)

    def confirmed(self, now: Nanoseconds) -> bool:
        """Return whether the device's own report confirms the stop."""
        if self.driver.unpowered:
            return True
        feedback = self.driver.feedback
        # A report that left the device before the stage began proves nothing about it.
        fresh = feedback.received_at > self.begun_at and self._received(now)
        return fresh and not self.stage.ends_power and abs(feedback.velocity) <= self._standstill_below

    def changes_to(self, *, off: bool) -> bool:
        """Return whether the stop begins again because the power was ordered off, or is not any more."""
        if off:
            return not self.off and not self.ends_power
        return self.off and not self.escalates

    def waits(self, now: Nanoseconds, *, holding: bool) -> bool:
        """Return whether a start-up that was requested goes first: not where the axis reports that it moves.

        With `holding` also there, for the power is what stops it then. A start-up has a bound of its own, and
        an order that stops the robot ends it.
        """
        driver, state = self.driver, self.driver.state
        if self.escalates or state in AT_REST or state in NOT_ENDED:
            return False
        moves = self._received(now) and abs(driver.feedback.velocity) > driver.axis.standstill_below
        return holding or not moves

    def late(self, now: Nanoseconds) -> bool:
        """Return whether the present stage has had its time, or has nothing to wait for."""
        stage, driver = self.stage, self.driver
        if now >= self.until:
            return True
        if stage.ends_with_transition:
            return driver.state in AT_REST
        if stage.ends_power:
            return False
        if now >= self._gentle_until or driver.feedback.received_at >= self._due:
            return True
        # A device that reports itself as not receiving has no more than the stage's own time; none, where the
        # stage needs a device that receives.
        patience = self._silent_after
        if driver.feedback.power is Power.UNKNOWN:
            patience = 0 if stage.received else stage.judged_after(0.0)
        return now >= max(self.begun_at, driver.feedback.received_at) + patience

    def event(self) -> ActiveInterlock | None:
        """Return what the operator is informed of; None while no stage has failed."""
        if not self.escalates and self.progress is not Progress.GIVEN_UP:
            return None
        failed = self.stages[self.place - 1]
        if self.progress is Progress.GIVEN_UP:
            then = RUNS_ON
        else:
            then = f"next: {self.stage.name}" + (f", {self.stage.note}" if self.stage.note else "")
        axis = self.driver.axis
        reason = f"{axis.called}: {failed.name} not acknowledged; {then}"
        return ActiveInterlock(
            f"{NOT_ACKNOWLEDGED}: {axis.name}", reason, self._interlock, self._failed_at, stage=failed.name
        )

    def _enter(self, place: int, now: Nanoseconds) -> None:
        self.place, self.begun_at = place, now
        self._slows(now)
        self.until = now + self.stage.lasts(self._slowing_from)

    def _slows(self, now: Nanoseconds) -> None:
        """Judge from now on whether it slows down from its present speed."""
        self._slowing_from = self._speed(now)
        self._due = now + self.stage.judged_after(self._slowing_from)

    def _received(self, now: Nanoseconds) -> bool:
        return now - self.driver.feedback.received_at < self._silent_after

    def _speed(self, now: Nanoseconds) -> float:
        """Return the speed from which it has to stop, at most its highest; that where none is known."""
        top = self.driver.axis.top_speed
        return min(abs(self.driver.feedback.velocity), top) if self._received(now) else top


class Stops:
    """The stops of all axes."""

    __slots__ = ("_all_drivers", "_at_once", "_axes", "_lost", "interlock_events")

    def __init__(self, robot: AnyRobot, all_drivers: AllDrivers) -> None:
        self._all_drivers = all_drivers
        self._axes: Final = {driver.axis.name: AxisStop(driver, robot) for driver in all_drivers.drivers}
        self._at_once: Final = tuple([stop for stop in self._axes.values() if stop.first.at_once])
        self._lost: Collection[str] = ()
        """The links over which nothing reaches a device, as of the newest look."""
        self.interlock_events: tuple[ActiveInterlock, ...] = ()
        """Reports, as of the newest look."""

    @property
    def of_axes(self) -> Mapping[str, AxisStop]:
        """The stop of each axis, by its name."""
        return self._axes

    @property
    def under_way(self) -> bool:
        """True while some axis that can be reached has not confirmed its stop, and stages are left."""
        return any(stop.progress is Progress.UNDER_WAY for stop in self._reached)

    @property
    def escalating(self) -> bool:
        """True where some stop has gone beyond its first stage."""
        return any(stop.escalates and not stop.excluded for stop in self._reached)

    @property
    def given_up(self) -> tuple[Driver, ...]:
        """Drivers of the axes whose stop no stage has brought about."""
        return tuple(stop.driver for stop in self._axes.values() if stop.progress is Progress.GIVEN_UP)

    @property
    def no_axis_left(self) -> bool:
        """True where each stage was tried with every device, in vain: no device is left to hold anything."""
        return len(self.given_up) == len(self._axes)

    def ordered(self, request: Request) -> tuple[Packet, ...]:
        """Learn what was requested: an order that stops is carried out again, whatever came of the last."""
        if isinstance(request, Pause):
            self._again()
        return self.order() if isinstance(request, EmergencyStop | Disarm) else ()

    def order(self) -> tuple[Packet, ...]:
        """Begin those again that no stage has brought about; return what is sent before the next cycle."""
        self._again()
        return joined([stop.driver.command(stop.first.set_point) for stop in self._at_once])

    def _again(self) -> None:
        for stop in self._axes.values():
            if stop.progress is Progress.GIVEN_UP:
                stop.progress = Progress.NOT_REQUESTED

    def watch(
        self,
        requested: Collection[str],
        set_points: Mapping[str, SetPoint],
        now: Nanoseconds,
        without: frozenset[str] = frozenset(),
        *,
        holding: bool = False,
    ) -> tuple[tuple[Packet, ...], dict[str, SetPoint]]:
        """Look at every axis once in a cycle; `requested` are those to stop, `without` the excluded ones.

        `holding`: axes are being enabled in order to hold the robot where it is. Return the packets that a
        stage sends at once, and the set-points with those in place that a stage makes.
        """
        sent: tuple[Packet, ...] = ()
        changed = dict(set_points)
        self._lost = self._all_drivers.links_lost
        for name, stop in self._axes.items():
            set_point = set_points.get(name, Stop.STANDSTILL)
            stop.excluded = name in without
            uncommanded = name not in requested and not stop.escalates
            if uncommanded or stop.link in self._lost or stop.waits(now, holding=holding):
                # Nothing reaches a lost link; when it is back the stop begins with the first stage.
                stop.progress = Progress.NOT_REQUESTED
            else:
                sent += self._look(stop, set_point, now)
            commands_on = stop.escalates or stop.progress is Progress.GIVEN_UP or stop.keeps_off(now)
            # A command to disable the power is never replaced by a gentler one.
            if commands_on and set_point is not Stop.POWER_OFF:
                changed[name] = stop.stage.set_point
            elif stop.first.at_once and name in requested and not isinstance(set_point, Stop):
                changed[name] = stop.first.set_point
        events = [stop.event() for stop in self._axes.values() if not stop.excluded]
        self.interlock_events = tuple([event for event in events if event is not None])
        return sent, changed

    @property
    def _reached(self) -> list[AxisStop]:
        return [stop for stop in self._axes.values() if stop.link not in self._lost]

    def _look(self, stop: AxisStop, set_point: SetPoint, now: Nanoseconds) -> tuple[Packet, ...]:
        off = set_point is Stop.POWER_OFF
        if stop.progress is Progress.GIVEN_UP:
            if stop.confirmed(now):
                stop.confirm(now)
            return ()
        sent: tuple[Packet, ...] = ()
        if stop.progress is Progress.NOT_REQUESTED or stop.changes_to(off=off):
            stop.begin(now, off=off)
            if stop.stage.whole_board and not stop.confirmed(now):
                sent = self._begin(stop, now)
        # The bridge itself ramps down while its set-point is a speed other than 0.
        ramped = stop.place == 0 and not requests_stop(set_point) and not isinstance(set_point, Position)
        if not ramped and stop.confirmed(now):
            stop.confirm(now)
            return sent
        # The report is missing, or is of motion with power: the stop begins again.
        if stop.progress is Progress.CONFIRMED:
            stop.begin(now, off=stop.off)
            sent += self._begin(stop, now) if stop.ends_power else ()
        stop.extend(now, ramped=ramped)
        return sent + (self._go_on(stop, now) if stop.late(now) else ())

    def _go_on(self, stop: AxisStop, now: Nanoseconds) -> tuple[Packet, ...]:
        stop.go_on(now)
        if stop.progress is Progress.GIVEN_UP:
            return ()
        if stop.stage.silent:
            # The drives' heartbeat consumers (0x1016) stop them then, with quick stop as reaction (0x6007).
            self._all_drivers.silence(stop.link, stop.until)
        return self._begin(stop, now)

    def _begin(self, stop: AxisStop, now: Nanoseconds) -> tuple[Packet, ...]:
        return () if stop.stage.transition is None else stop.driver.begin(stop.stage.transition, now)
