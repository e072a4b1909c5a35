"""Whether each axis that is asked to stop does: by its device's own word, or step by step with more force.

It believes no demand that was sent. A stop is under way until a fresh word of the device says that the axis
rests or has no torque; a step that is not confirmed in its time gives way to the next one of the driver's
table, and the operator is told. A confirmed stop is begun anew where the word is not heard any more, or says
that the axis moves with power. It refuses to know why a stop is asked for, and it knows no robot's word.
"""

from collections.abc import Collection, Mapping
from enum import Enum
from typing import Final

from firmware_bridge.bridge.fleets import Fleets, asks_to_stop
from firmware_bridge.drivers.driver import Demand, Driver, Position, Power, Stop
from firmware_bridge.drivers.fleets import STOP_STEPS
from firmware_bridge.drivers.stop_steps import StopStep, way
from firmware_bridge.intent import NEVER_HEARD
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.row import Row, Severity
from firmware_bridge.safety.snapshot import Hold
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

RESTS: Final = 0.01
"""An axis rests below this share of its top speed."""
SLOWED: Final = 0.75
"""Down to this share of its speed, and an axis is given the time of a ramp from there: it does stop."""
RAMPED_WITHIN: Final[Nanoseconds] = 3 * SECOND
"""The bridge's own ramp down, and a regulator that creeps to rest, may last so long."""
REMEDY: Final = "keep clear; use the hardware emergency stop if it moves"


class Progress(Enum):
    """How far a stop has come."""

    NOT_ASKED = "not asked for"
    UNDER_WAY = "under way"
    CONFIRMED = "confirmed"
    GIVEN_UP = "given up"
    """No step is left, and none was confirmed."""


class AxisStop:
    """The stop of one axis."""

    __slots__ = (
        "_rested", "_rests_below", "_rows", "_silent_after", "_slowing_from", "_ways", "begun_at", "driver",
        "left_out", "link", "off", "place", "progress", "steps", "until",
    )  # fmt: skip

    def __init__(self, driver: Driver, robot: AnyRobot) -> None:
        axis = driver.axis
        link = robot.links[axis.link]
        self.driver: Final = driver
        self.link: Final = axis.link
        steps = STOP_STEPS[link.driver](robot, axis)
        self._ways: Final = {off: way(steps, off=off) for off in (False, True)}
        self._rests_below: Final = RESTS * axis.top_speed
        self._silent_after: Final = link.silent_ms * MILLISECOND
        stops = None if link.stops is None else frozenset(link.stops)
        self._rows: Final = {
            step.name: Row(
                f"{step.name} unconfirmed",
                REMEDY,
                stops=stops,
                severity=Severity.CRITICAL,
                disarms=stops is None,
            )
            for step in steps
        }
        self.progress = Progress.NOT_ASKED
        self.left_out = False
        """The robot's mode does without the axis: what becomes of it holds nothing back."""
        self._rested = False
        """Whether it rested when it was last heard before the stop."""
        self._slowing_from = 0.0
        self.off = False
        """Whether the power was ordered off."""
        self.steps: tuple[StopStep, ...] = ()
        """Of the way that was begun."""
        self.place = 0
        self.begun_at: Nanoseconds = 0
        """When the present step was begun."""
        self.until: Nanoseconds = 0

    @property
    def step(self) -> StopStep:
        """The present step; the last one where all were tried."""
        return self.steps[min(self.place, len(self.steps) - 1)]

    @property
    def escalates(self) -> bool:
        """Whether a step was not confirmed, and another one is tried."""
        return self.progress is Progress.UNDER_WAY and self.place > 0

    @property
    def ends_power(self) -> bool:
        """Whether a step is under way that takes the power, ordered or not."""
        return self.escalates and self.step.ends_power

    def begin(self, now: Nanoseconds, *, off: bool) -> None:
        """Begin with the first step."""
        feedback = self.driver.feedback
        self._rested = feedback.sampled_at != NEVER_HEARD and abs(feedback.velocity) <= self._rests_below
        self.progress, self.off = Progress.UNDER_WAY, off
        rested = self._rested and not off
        self.steps = tuple(step for step in self._ways[off] if not (rested and step.takes_all))
        self._enter(0, now)

    def go_on(self, now: Nanoseconds) -> None:
        """Begin the next step, where one is left."""
        if self.place + 1 < len(self.steps):
            self._enter(self.place + 1, now)
        else:
            self.place, self.progress = len(self.steps), Progress.GIVEN_UP

    def extend(self, now: Nanoseconds, *, ramped: bool) -> None:
        """Let the ramp of the device count from now: while the bridge still ramps, or where it slows down."""
        speed = abs(self._speed(now))
        if now < self.begun_at + RAMPED_WITHIN and (ramped or speed <= SLOWED * self._slowing_from):
            self._slowing_from, self.until = speed, now + self.step.lasts(speed)

    def confirmed(self, now: Nanoseconds) -> bool:
        """Return whether the device's own word says that the stop is done."""
        if self.driver.unpowered:
            return True
        feedback = self.driver.feedback
        fresh = feedback.heard_at > self.begun_at and self._heard(now)
        return fresh and not self.step.ends_power and abs(feedback.velocity) <= self._rests_below

    def late(self, now: Nanoseconds) -> bool:
        """Return whether the present step has had its time, or has nothing to wait for."""
        step, driver, heard_at = self.step, self.driver, self.driver.feedback.heard_at
        if step.ends_with_task:
            return now >= self.until or not driver.busy
        if step.ends_power:
            return now >= self.until
        # A ramp is judged by what is heard: that it goes on after its time, or nothing. A device that says
        # itself that it does not listen is given no more than the step's own time; none, where the step needs
        # a device that does.
        patience = self._silent_after
        if driver.feedback.power is Power.UNKNOWN:
            patience = 0 if step.heard else step.within
        return heard_at >= self.until or now >= max(self.begun_at, heard_at) + patience

    def hold(self) -> Hold | None:
        """Return what the operator is told; None while no step has failed."""
        if not self.escalates and self.progress is not Progress.GIVEN_UP:
            return None
        failed = self.steps[self.place - 1]
        if self.progress is Progress.GIVEN_UP:
            then = "nothing is left to try"
        else:
            then = f"next: {self.step.name}" + (f", {self.step.note}" if self.step.note else "")
        axis = self.driver.axis
        row = self._rows[failed.name]
        return Hold(f"{row.name}: {axis.name}", f"{axis.called}: {row.name}; {then}", row, self.begun_at)

    def _enter(self, place: int, now: Nanoseconds) -> None:
        self.place, self.begun_at = place, now
        self._slowing_from = abs(self._speed(now))
        self.until = now + self.step.lasts(self._slowing_from)

    def _heard(self, now: Nanoseconds) -> bool:
        return now - self.driver.feedback.heard_at < self._silent_after

    def _speed(self, now: Nanoseconds) -> float:
        """Return the speed from which it has to stop; the highest of all where none is known."""
        return self.driver.feedback.velocity if self._heard(now) else self.driver.axis.top_speed


class Stops:
    """The stops of all axes."""

    __slots__ = ("_axes", "_fleets", "holds")

    def __init__(self, robot: AnyRobot, fleets: Fleets) -> None:
        self._fleets = fleets
        self._axes: Final = {driver.axis.name: AxisStop(driver, robot) for driver in fleets.drivers}
        self.holds: tuple[Hold, ...] = ()
        """What is to be told, as of the newest look."""

    @property
    def under_way(self) -> bool:
        """Whether some axis has not confirmed its stop, and steps are left."""
        return any(stop.progress is Progress.UNDER_WAY for stop in self._axes.values())

    @property
    def escalating(self) -> bool:
        """Whether some stop has gone beyond its first step."""
        return any(stop.escalates and not stop.left_out for stop in self._axes.values())

    @property
    def given_up(self) -> tuple[Driver, ...]:
        """Whose stop no step has brought about."""
        return tuple(stop.driver for stop in self._axes.values() if stop.progress is Progress.GIVEN_UP)

    def watch(
        self,
        asked: Collection[str],
        demands: Mapping[str, Demand],
        now: Nanoseconds,
        without: frozenset[str] = frozenset(),
    ) -> tuple[tuple[Packet, ...], dict[str, Demand]]:
        """Look at every axis once in a cycle; `asked` are those that are to stop, `without` the left out.

        Return what a step sends at once, and the demands with those in place that a step makes.
        """
        sent: tuple[Packet, ...] = ()
        changed = dict(demands)
        lost = self._fleets.links_lost
        for name, stop in self._axes.items():
            demand = demands.get(name, Stop.REST)
            stop.left_out = name in without
            if name not in asked and not stop.escalates:
                stop.progress = Progress.NOT_ASKED
            elif stop.link not in lost and (stop.escalates or not stop.driver.busy):
                # No word reaches a lost link; tasks under way have time-outs of their own.
                sent += self._look(stop, demand, now)
            if (stop.escalates or stop.progress is Progress.GIVEN_UP) and demand is not Stop.POWER_OFF:
                changed[name] = stop.step.demand
        holds = [stop.hold() for stop in self._axes.values() if not stop.left_out]
        self.holds = tuple([hold for hold in holds if hold is not None])
        return sent, changed

    def _look(self, stop: AxisStop, demand: Demand, now: Nanoseconds) -> tuple[Packet, ...]:
        off = demand is Stop.POWER_OFF
        if stop.progress is Progress.GIVEN_UP:
            stop.progress = Progress.CONFIRMED if stop.confirmed(now) else stop.progress
            return ()
        if stop.progress is Progress.NOT_ASKED or (off is not stop.off and not stop.ends_power):
            stop.begin(now, off=off)
        ramped = stop.place == 0 and not asks_to_stop(demand) and not isinstance(demand, Position)
        if not ramped and stop.confirmed(now):
            stop.progress = Progress.CONFIRMED
            return ()
        if stop.progress is Progress.CONFIRMED:
            stop.begin(now, off=stop.off)
        stop.extend(now, ramped=ramped)
        return self._go_on(stop, now) if stop.late(now) else ()

    def _go_on(self, stop: AxisStop, now: Nanoseconds) -> tuple[Packet, ...]:
        stop.go_on(now)
        if stop.progress is Progress.GIVEN_UP:
            return ()
        if stop.step.silent:
            self._fleets.silence(stop.link, stop.until)
        return () if stop.step.task is None else stop.driver.begin((stop.step.task,), now)
