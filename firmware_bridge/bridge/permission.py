"""Motion permission: armed or not, the emergency stop's latch, the mode, and the effect of a request.

It answers every request with a reason. The interlocks' decision comes in with their events; it judges no
motion.
"""

from collections.abc import Collection
from typing import Final

from firmware_bridge.bridge.all_drivers import AllDrivers
from firmware_bridge.bridge.homing import HomingSequence
from firmware_bridge.bridge.power_down import HELD, PowerDown
from firmware_bridge.bridge.stops import Stops
from firmware_bridge.drivers.driver import Driver, Power, Stop
from firmware_bridge.drivers.life_cycle import AT_REST, NOT_ENDED, DriverState, Transition
from firmware_bridge.intent import (
    NEVER_RECEIVED,
    Answer,
    Arm,
    ClearEmergencyStop,
    Disarm,
    EmergencyStop,
    EnterMode,
    Pause,
    Request,
    Resume,
)
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.safety.rules import Rules
from firmware_bridge.safety.snapshot import ActiveInterlock, AnySnapshot
from firmware_bridge.units import SECOND, Nanoseconds

BRAKED_WITHIN: Final[Nanoseconds] = 3 * SECOND
"""The longest time to standstill before an ordered power-off."""


class Permission:
    """The motion permission, and the requests that change it."""

    def __init__(
        self,
        robot: AnyRobot,
        rules: dict[str, Rules],
        all_drivers: AllDrivers,
        outbox: list[Packet],
        mode: str = "",
    ) -> None:
        """Take the drives that a request may switch, and where to put what is to be sent at once.

        `mode`: the one that the robot is in from the start.
        """
        self._rules: Final = rules
        self._all_drivers = all_drivers
        self.homing: Final = HomingSequence()
        """Homing of one axis now."""
        self._outbox = outbox
        self._silent_after = robot.silent_after
        self._final = False
        self.stops: Final = Stops(robot, all_drivers)
        """Supervision of the axes' stops."""
        self.power_down: Final = PowerDown(robot, all_drivers, outbox)
        """Check of the robot's standstill before its power is disabled."""
        self.armed = False
        self.emergency_stopped = False
        self.mode = mode
        """The mode after a failed actuator; empty while the robot is whole."""
        self.powered_off = False
        """A forced disarm disables the power at standstill; it stays off until arming puts it on again."""
        self._brakes_until: Nanoseconds = NEVER_RECEIVED
        """So long the robot may take to come to standstill for that; over as soon as it has."""
        self.paused = False
        self.neutral_required = True
        """The operator was away, or another one drives, and has not let his controls go since."""
        self._confirming: list[Driver] = []
        """Drivers that were requested to count from a position; some may have done so."""
        self.untrusted: set[str] = set()
        """The axes whose power an interlock has disabled; they get it back in the same way."""

    @property
    def rules(self) -> Rules:
        """Those of the mode."""
        return self._rules[self.mode]

    @property
    def forbids_power(self) -> bool:
        """True while no drive may be given power."""
        return self.emergency_stopped or self.powered_off

    @property
    def interlock_events(self) -> tuple[ActiveInterlock, ...]:
        """The reports about stops, power down and homing."""
        return self.stops.interlock_events + self.power_down.interlock_events + self.homing.interlock_events

    @property
    def powered_down(self) -> bool:
        """True where the power goes for good: ordered off at standstill, or proved unnecessary for it."""
        return self.power_down.powered_down or (self.powered_off and self._brakes_until == NEVER_RECEIVED)

    def ordered_off(self, now: Nanoseconds, *, standstill: bool) -> Stop:
        """Return a forced disarm's set-points for all axes: brake first, and no power from standstill on."""
        # After 3 s at the latest: the order must reach a robot that does not come to standstill, too.
        if standstill or now >= self._brakes_until:
            self._brakes_until = NEVER_RECEIVED
        return Stop.POWER_OFF if self._brakes_until == NEVER_RECEIVED else Stop.QUICK_STOP

    def order_off(self, now: Nanoseconds) -> None:
        """Disarm, and disable the power as soon as the robot is at standstill."""
        self.armed = False
        if not self.powered_off:
            self.powered_off, self._brakes_until = True, now + BRAKED_WITHIN

    def end_start_ups(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """End the start-ups that were requested: a stop was ordered. Not those by which a slope is held."""
        if self.power_down.under_way:
            return ()
        waiting = [driver for driver in self._all_drivers.busy if driver.state not in NOT_ENDED]
        return tuple([packet for driver in waiting for packet in driver.begin(Transition.END, now)])

    def part(self, events: tuple[ActiveInterlock, ...], clearing: Collection[str]) -> None:
        """Require neutral controls where an active interlock needs it.

        One that is `clearing` does not: an operator whose stick has been neutral since its cause ended has
        done so.
        """
        if any(event.interlock.parts and event.name not in clearing for event in events):
            self.neutral_required = True

    def watch(self, events: tuple[ActiveInterlock, ...]) -> None:
        """Do what active interlocks require: disarm, latch the emergency stop, disable an axis's power."""
        # A driver that has ended is forgotten: later it may be busy with something else.
        self._confirming = [driver for driver in self._confirming if driver.state not in AT_REST]
        for event in events:
            if event.interlock.latches:
                self.emergency_stopped = True
            if event.interlock.disarms or event.interlock.latches:
                self.armed = False
            if event.interlock.disables_power:
                self.untrusted.add(event.axis)

    def set_zero(
        self, driver: Driver, position: float | None, seen: AnySnapshot, events: tuple[ActiveInterlock, ...]
    ) -> Answer:
        """Have a device count from where its axis was seen to stand, or home it where no one has looked.

        One without power is enabled before. `holds` are those that stop this axis.
        """
        kept = self._keeps_zeros(seen) or self._keeps_zero(driver.axis)
        if kept is not None:
            # An excluded axis has no power, which a new reference takes: waiting changes nothing.
            waits = driver.axis.name not in self.rules.without
            return Answer(accepted=False, reason=f"zero: {kept}", temporary=waits)
        now, feedback = seen.facts.now, driver.feedback
        if not self._ready(driver, now):
            failed = f" (last try: {driver.failure.problem})" if driver.failure is not None else ""
            self._enable(driver, now)
            reason = f"zero: enabling {driver.axis.called}{failed} first, repeat it then"
            return Answer(accepted=False, reason=reason, temporary=True)
        if abs(feedback.velocity) > driver.axis.standstill_below:
            return Answer(accepted=False, reason=f"zero: {driver.axis.called} moves", temporary=True)
        if position is None:
            return self._home(driver, events, now)
        self._outbox += driver.set_zero(position, now)
        self._confirming = [*self._under_confirmation(now), driver]
        return Answer(accepted=True, reason=f"zero: {driver.axis.called} counts from there")

    def _keeps_zero(self, axis: Axis) -> str | None:
        """Return why this axis' position may not be confirmed, or None."""
        if axis.name in self.rules.without:
            return f"this mode excludes {axis.called}; leave it, confirm, then enter it again"
        if axis.name in self.untrusted:
            return f"the power of {axis.called} was disabled; arm once, that enables it"
        return None

    def _home(self, driver: Driver, events: tuple[ActiveInterlock, ...], now: Nanoseconds) -> Answer:
        axis = driver.axis
        event = self.homing.kept_by(axis, events)
        if event is not None:
            return Answer(accepted=False, reason=f"home: {event.reason}; {event.remedy}", temporary=True)
        self._outbox += self.homing.begin(driver, now)
        return Answer(accepted=True, reason=f"home: {axis.called} is homing")

    def _keeps_zeros(self, seen: AnySnapshot) -> str | None:
        """Return why no axis' position may be confirmed, or None."""
        if self.armed:
            return "disarm first"
        for event in self.homing.under_way:
            return event.reason
        if self.emergency_stopped:
            return "the emergency stop is latched; clear it first"
        if self.powered_off:
            return "the power was disabled by force; arm once, that enables it"
        if not self.rules.at_standstill(seen):
            return "the robot still moves"
        return self.stops.interlock_events[0].reason if self.stops.escalating else None

    def decide(self, request: Request, seen: AnySnapshot, events: tuple[ActiveInterlock, ...]) -> Answer:
        """Answer one request; `seen` and `holds` are of this instant."""
        verdict = Answer(accepted=True, reason="")
        # Before the answer: a stop ends a homing and begins given-up stages again, whatever the answer is.
        self.homing.ordered(request)
        self._outbox += self.stops.ordered(request)
        match request:
            case Arm():
                verdict = self._arm(seen, events)
            case Disarm(force=force):
                verdict = self._disarm_by_force(seen) if force else self._disarm(seen)
            case EmergencyStop(final=final):
                verdict = self._stop(final=final)
            case ClearEmergencyStop():
                verdict = self._clear(seen)
            case EnterMode(mode=mode):
                verdict = self._enter(mode, seen)
            case Pause():
                self.paused = True
                verdict = Answer(accepted=True, reason="paused: the robot comes to rest, and waits")
            case Resume():
                verdict = self._resume(seen)
        return verdict

    def _stop(self, *, final: bool) -> Answer:
        # EN 60204-1, stop category 1: the axes keep their power until the robot is at standstill.
        self.emergency_stopped = True
        self._final = self._final or final
        self.armed = False
        return Answer(accepted=True, reason="emergency stop: it stays until it is cleared")

    def _disarm_by_force(self, seen: AnySnapshot) -> Answer:
        now = seen.facts.now
        self.order_off(now)
        # Its own set-point may be above zero still: what was measured counts.
        stop = self.ordered_off(now, standstill=self.rules.stopped(seen))
        taken = {name for name, one in self.stops.of_axes.items() if one.ends_power}
        self._outbox += self._all_drivers.command_all(stop, self.untrusted | self.rules.without | taken)
        does = (
            "the drives are without power"
            if stop is Stop.POWER_OFF
            else "it brakes, then the power is disabled"
        )
        return Answer(accepted=True, reason=f"disarmed by force: {does}")

    def _arm(self, seen: AnySnapshot, events: tuple[ActiveInterlock, ...]) -> Answer:
        if self.armed:
            return Answer(accepted=True, reason="armed already")
        premature = self._premature(seen)
        if premature is not None:
            return premature
        now = seen.facts.now
        asleep = [driver for driver in self._used() if not self._ready(driver, now)]
        # Enabling is all that this request does: motion needs another one, made when the drives are ready.
        if asleep:
            return self._awaken(asleep, now)
        for event in events:
            if event.interlock.blocks_arming:
                return Answer(accepted=False, reason=f"arm: {event.reason}; {event.remedy}", temporary=True)
        self.armed = True
        self.paused = False
        self.untrusted.clear()
        return Answer(accepted=True, reason="armed")

    def _premature(self, seen: AnySnapshot) -> Answer | None:
        if self.emergency_stopped:
            return Answer(accepted=False, reason="arm: the emergency stop is latched; clear it first")
        for event in self.stops.interlock_events if self.stops.escalating else ():
            return Answer(accepted=False, reason=f"arm: {event.reason}", temporary=True)
        for event in self.homing.under_way:
            return Answer(accepted=False, reason=f"arm: {event.reason}; {event.remedy}", temporary=True)
        for lost in seen.facts.links_lost.values():
            return Answer(accepted=False, reason=f"arm: {lost}; plug it in again", temporary=True)
        if not self.rules.at_standstill(seen):
            return Answer(accepted=False, reason="arm: the robot still moves", temporary=True)
        return self._requested(seen)

    def _requested(self, seen: AnySnapshot) -> Answer | None:
        """Refuse where something would move as soon as the robot is armed."""
        if not seen.facts.neutral:
            return Answer(accepted=False, reason=f"arm: {seen.facts.deflected or 'the stick is not neutral'}")
        requested = self.rules.kinematics.requested(seen.command, seen.body)
        if requested:
            moved = " and ".join(sorted(requested))
            reason = f"arm: the {moved} would move at once; return the stick to neutral, or disarm"
            return Answer(accepted=False, reason=reason)
        return None

    def _used(self) -> list[Driver]:
        without = self.rules.without
        return [driver for driver in self._all_drivers.drivers if driver.axis.name not in without]

    def _awaken(self, asleep: list[Driver], now: Nanoseconds) -> Answer:
        """Begin to enable drives again; the operator arms again when they are."""
        self.powered_off = False
        self.untrusted.clear()
        named = []
        for driver in asleep:
            before = f" (last try: {driver.failure.problem})" if driver.failure is not None else ""
            named.append(f"{driver.axis.called}{before}")
            self._enable(driver, now)
        return Answer(accepted=False, reason=f"enabling {', '.join(named)} again, arm again", temporary=True)

    def _enable(self, driver: Driver, now: Nanoseconds) -> None:
        state = driver.state
        if state in AT_REST:
            # A device that was silent may have restarted with other settings: it is set up from the
            # beginning.
            kept = state in (DriverState.INACTIVE, DriverState.ACTIVE) and not self._silent(driver, now)
            self._outbox += driver.begin(Transition.ACTIVATE if kept else Transition.RECOVER, now)

    def _disarm(self, seen: AnySnapshot) -> Answer:
        # EN 60204-1, stop category 2: the drives keep their power at standstill, on a slope too.
        self.armed = False
        moves = "" if self.rules.at_standstill(seen) else "the robot comes to rest, "
        return Answer(accepted=True, reason=f"disarmed: {moves}the drives hold still")

    def _resume(self, seen: AnySnapshot) -> Answer:
        if self.paused and not seen.facts.neutral:
            return Answer(
                accepted=False, reason=f"continue: {seen.facts.deflected or 'the stick is not neutral'}"
            )
        self.paused = False
        return Answer(accepted=True, reason="the robot goes on")

    def _clear(self, seen: AnySnapshot) -> Answer:
        if not self.emergency_stopped:
            return Answer(accepted=True, reason="no emergency stop is latched")
        if self._final:
            return Answer(
                accepted=False, reason="this emergency stop is cleared by a restart of the bridge only"
            )
        if not self.rules.at_standstill(seen):
            return Answer(accepted=False, reason="clear: the robot still moves", temporary=True)
        # ISO 13850: the reset starts nothing; the robot moves only after it was armed again.
        self.emergency_stopped = False
        return Answer(accepted=True, reason="emergency stop cleared; arm to move")

    def _enter(self, mode: str, seen: AnySnapshot) -> Answer:
        if mode not in self._rules:
            known = ", ".join(name for name in self._rules if name) or "none"
            return Answer(accepted=False, reason=f"mode: this robot has no '{mode}'; it has {known}")
        if mode == self.mode:
            return self._resume(seen)
        kept = self._keeps_mode(self._rules[mode], seen)
        if kept is not None:
            return Answer(accepted=False, reason=f"mode: {kept}", temporary=True)
        self.mode = mode
        return Answer(accepted=True, reason=f"mode: {mode or 'the whole robot'}; arm to move")

    def _keeps_mode(self, rules: Rules, seen: AnySnapshot) -> str | None:
        """Return why a mode with these rules may not be entered now, or None."""
        # By the mode's own body: an axis that it does without, and that reports nothing, is not known to be
        # still.
        if self.armed or not rules.at_standstill(rules.sensed(seen)):
            return "stop and disarm first"
        # An axis that the mode does without loses its power, and with it the position that is being written.
        for driver in self._under_confirmation(seen.facts.now):
            return f"the position of {driver.axis.called} is being confirmed; wait"
        for event in self.homing.under_way:
            return event.reason
        kept = self.power_down.kept_by(rules.carriers, seen.facts.now)
        return None if kept is None else f"{kept}; {HELD.remedy.partition(';')[0]}"

    def _under_confirmation(self, now: Nanoseconds) -> list[Driver]:
        """Return the drivers that write a confirmed position; a silent one is not waited for."""
        return [
            driver
            for driver in self._confirming
            if driver.state not in AT_REST and not self._silent(driver, now)
        ]

    def _ready(self, driver: Driver, now: Nanoseconds) -> bool:
        feedback = driver.feedback
        fit = driver.state is DriverState.ACTIVE and not self._silent(driver, now)
        return fit and feedback.power is Power.ON and not feedback.fault

    def _silent(self, driver: Driver, now: Nanoseconds) -> bool:
        return now - driver.feedback.received_at >= self._silent_after[driver.axis.name]
