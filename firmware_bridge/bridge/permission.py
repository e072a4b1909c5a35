"""Motion permission: its state, the mode, the drives' power with it, and what active interlocks make of it.

Which request changes it, and what that needs, is in `firmware_bridge.bridge.orders`; it judges no motion.
"""

from collections.abc import Collection, Mapping
from typing import Final

from firmware_bridge.bridge.all_drivers import AllDrivers
from firmware_bridge.bridge.homing import HomingSequence
from firmware_bridge.bridge.joint_state import FOR_GOOD, NO_POWER, OFF, STOPS, Event, Motion, successor
from firmware_bridge.bridge.power_down import HELD, PowerDown
from firmware_bridge.bridge.stops import Stops
from firmware_bridge.drivers.driver import Driver, Power, Stop
from firmware_bridge.drivers.life_cycle import AT_REST, NOT_ENDED, DriverState, Transition
from firmware_bridge.intent import NEVER_RECEIVED, Request
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
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
        self.stops: Final = Stops(robot, all_drivers)
        """Supervision of the axes' stops."""
        self.power_down: Final = PowerDown(robot, all_drivers, outbox)
        """Check of the robot's standstill before its power is disabled."""
        self.motion = Motion.DISARMED
        """The state; only `happens` changes it."""
        self.mode = mode
        """The mode after a failed actuator; empty while the robot is whole."""
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
    def modes(self) -> Mapping[str, Rules]:
        """The rules of each mode by its name; empty for the whole robot's."""
        return self._rules

    @property
    def armed(self) -> bool:
        """True while motion commands count."""
        return self.motion is Motion.ARMED

    @property
    def emergency_stopped(self) -> bool:
        """True while an emergency stop is latched."""
        return self.motion in STOPS

    @property
    def final(self) -> bool:
        """True where only a restart of the bridge ends it."""
        return self.motion in FOR_GOOD

    @property
    def powered_off(self) -> bool:
        """True where the power was ordered off; it stays off until arming puts it on again."""
        return self.motion in OFF

    @property
    def forbids_power(self) -> bool:
        """True while no drive may be given power."""
        return self.motion in NO_POWER

    def happens(self, event: Event) -> None:
        """Go on to the state after an event."""
        self.motion = successor(self.motion, event)

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
        if not self.powered_off:
            self._brakes_until = now + BRAKED_WITHIN
        self.happens(Event.POWER_OFF)

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
                self.happens(Event.STOP)
            if event.interlock.disarms:
                self.happens(Event.DISARM)
            if event.interlock.disables_power:
                self.untrusted.add(event.axis)

    # What requests do

    def ordered(self, request: Request) -> None:
        """Take note of a request, before its answer: a stop ends a homing, and begins given-up stages."""
        self.homing.ordered(request)
        self._outbox += self.stops.ordered(request)

    def arm(self) -> None:
        """Let motion commands count."""
        self.happens(Event.ARM)
        self.paused = False
        self.untrusted.clear()

    def power_off(self, seen: AnySnapshot) -> Stop:
        """Disable all power at standstill, or brake before; return which of both is sent at once."""
        now = seen.facts.now
        self.order_off(now)
        # Its own set-point may be above zero still: what was measured counts.
        stop = self.ordered_off(now, standstill=self.rules.stopped(seen))
        taken = {name for name, one in self.stops.of_axes.items() if one.ends_power}
        self._outbox += self._all_drivers.command_all(stop, now, self.untrusted | self.rules.without | taken)
        return stop

    def set_zero(self, driver: Driver, position: float, now: Nanoseconds) -> None:
        """Have a device count from where its axis was seen to stand."""
        self._outbox += driver.set_zero(position, now)
        self._confirming = [*self.under_confirmation(now), driver]

    def home(self, driver: Driver, now: Nanoseconds) -> None:
        """Have an axis find its position by motion."""
        self._outbox += self.homing.begin(driver, now)

    def keeps_power(self, rules: Rules, now: Nanoseconds) -> str | None:
        """Return why a mode with these rules may not take the power of the axes that it does without."""
        kept = self.power_down.kept_by(rules.carriers, now)
        return None if kept is None else f"{kept}; {HELD.remedy.partition(';')[0]}"

    # Devices

    @property
    def used(self) -> list[Driver]:
        """The devices of the axes that the mode has."""
        without = self.rules.without
        return [driver for driver in self._all_drivers.drivers if driver.axis.name not in without]

    def awaken(self, asleep: list[Driver], now: Nanoseconds) -> str:
        """Begin to enable devices again; return what to do: arm again when they are."""
        self.happens(Event.ENABLE)
        self.untrusted.clear()
        named = ", ".join(f"{driver.axis.called}{_last_try(driver)}" for driver in asleep)
        for driver in asleep:
            self._enable(driver, now)
        return f"enabling {named} again, arm again"

    def prepare(self, driver: Driver, now: Nanoseconds) -> str:
        """Begin to enable one device for a request about its axis; return what to do."""
        failed = _last_try(driver)
        self._enable(driver, now)
        return f"enabling {driver.axis.called}{failed} first, repeat it then"

    def _enable(self, driver: Driver, now: Nanoseconds) -> None:
        state = driver.state
        if state in AT_REST:
            # A device that was silent may have restarted with other settings: it is set up from the
            # beginning.
            kept = state in (DriverState.INACTIVE, DriverState.ACTIVE) and not self._silent(driver, now)
            self._outbox += driver.begin(Transition.ACTIVATE if kept else Transition.RECOVER, now)

    def under_confirmation(self, now: Nanoseconds) -> list[Driver]:
        """Return the drivers that write a confirmed position; a silent one is not waited for."""
        return [
            driver
            for driver in self._confirming
            if driver.state not in AT_REST and not self._silent(driver, now)
        ]

    def ready(self, driver: Driver, now: Nanoseconds) -> bool:
        """Return whether a device may be moved: active, with power by its own fresh report, and no fault."""
        feedback = driver.feedback
        # A report from before its power was taken proves nothing about it.
        taken_at = self._all_drivers.taken_at.get(driver.axis.name, NEVER_RECEIVED)
        fresh = feedback.sampled_at > taken_at and not self._silent(driver, now)
        fit = driver.state is DriverState.ACTIVE and fresh
        return fit and feedback.power is Power.ON and not feedback.fault

    def _silent(self, driver: Driver, now: Nanoseconds) -> bool:
        return now - driver.feedback.received_at >= self._silent_after[driver.axis.name]


def _last_try(driver: Driver) -> str:
    return f" (last try: {driver.failure.problem})" if driver.failure is not None else ""
