"""The bridge as one node: its phases and timing; a cycle's content is in `firmware_bridge.bridge.pipeline`.

A cycle: the devices of all links that are due are sampled, on CAN by SYNC; when they have answered, or after
the links' time for it (on CAN 10 ms), the pipeline runs and its set-points leave; half a cycle after its
begin the handshakes of new positions end. An exception passes through to the node's carrier; `stop` then
brings the drives to standstill by a path without interlocks and operator. An axis that does not confirm
standstill, or at the end power off, is stopped by further stop stages.
"""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.bridge.all_drivers import AllDrivers
from firmware_bridge.bridge.confirmed_at_start import ConfirmedAtStart
from firmware_bridge.bridge.joint_state import Event, Life, Motion
from firmware_bridge.bridge.orders import ALREADY_OFF, order_of
from firmware_bridge.bridge.permission import Permission
from firmware_bridge.bridge.pipeline import Pipeline
from firmware_bridge.bridge.stops import AxisStop
from firmware_bridge.drivers.all_drivers import all_drivers_of
from firmware_bridge.drivers.driver import Stop
from firmware_bridge.drivers.life_cycle import Task, Transition
from firmware_bridge.intent import Answer, ConfirmPosition, Request
from firmware_bridge.mavlink.trust import ANY_STATION, Trust
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_type import AnyRobotType
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.snapshot import ActiveInterlock, AnySnapshot
from firmware_bridge.teleop.operator_link import OperatorLink
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

STANDSTILL_WITHIN: Final[Nanoseconds] = 3 * SECOND
"""Longest time to standstill at an orderly end; then the power goes off, unless a stop still escalates."""
SECOND_REQUEST_WITHIN: Final[Nanoseconds] = 5 * SECOND
"""Time after a hold on a slope began, or after a command to end, in which the next one disables the power."""
LEFT_WITHIN: Final[Nanoseconds] = 3 * SECOND
"""The longest that taking the power off in order may last; then it is taken off step by step."""
PLACE_DIGITS: Final = 4
"""Of a place that is kept for the next run."""
HELD: Final = "the robot would not stand without power: Ctrl-C within 5 s powers down"
ENDING: Final = "the bridge is ending; only an emergency stop or a forced disarm is obeyed now"
STARTING: Final = InterlockBase("starting", "wait")
ENDS: Final = InterlockBase("ending", "start the bridge again", severity=Severity.NOTICE)
FAILED: Final = InterlockBase("start-up failed", "correct it and start the bridge again")


class Bridge:
    """Between the links of the devices and "operator"; a `firmware_bridge.node.Node`."""

    def __init__(
        self,
        robot: AnyRobot,
        robot_type: AnyRobotType,
        trust: Trust = ANY_STATION,
        confirmed: tuple[ConfirmPosition, ...] = (),
        mode: str = "",
        *,
        injects: bool = False,
    ) -> None:
        """Take a robot file, its kind, the trusted stations, where axes stand, and the mode to begin in.

        `injects` allows the station in control to inject failures of the operator's link and of a sensor.
        PlanError where a cycle does not fit on a link, ValueError where an axis cannot stand there.
        """
        self._cycle: Final = robot.cycle
        self._outbox: list[Packet] = []
        self._idle = Reaction()
        """The newest reaction that sent nothing; most are the same."""
        self._all_drivers: Final = AllDrivers(all_drivers_of(robot))
        rules = robot_type.rules(robot)
        self._operator: OperatorLink = OperatorLink(
            robot,
            robot_type.station,
            robot_type.standstill,
            rolling=rules[""].kinematics.rolling,
            modes=tuple(robot_type.modes),
            path_followers=tuple(robot_type.path_followers),
            trust=trust,
            injects=injects,
        )
        self._permission: Permission = Permission(robot, rules, self._all_drivers, self._outbox, mode)
        self._pipeline: Pipeline = Pipeline(
            robot,
            robot_type,
            rules=rules,
            all_drivers=self._all_drivers,
            operator=self._operator,
            permission=self._permission,
        )
        for request in confirmed:
            self._pipeline.check(request)
        self._confirmed = ConfirmedAtStart(confirmed)
        self._cycle_at: Nanoseconds | None = None
        """None before the first wake."""
        self._cycles = 0
        """Count of the cycles begun."""
        self._synchronized_at: Nanoseconds = 0
        self._collect_until: Nanoseconds = NEVER
        self._release_at: Nanoseconds = NEVER
        self._standstill_until: Nanoseconds = NEVER
        self._began_at: Nanoseconds = 0
        self._listens_until: Nanoseconds = 0
        """Until then nothing is sent to the devices: another bridge may be driving them."""
        self._requested_at: Nanoseconds = NEVER
        """Time of the last command to end a robot that is held with power, or of the hold's start."""
        self._leave_until: Nanoseconds = NEVER
        self._stop_began = False
        """An emergency stop was latched by the newest datagram."""
        self._left: set[str] | None = None
        """The axes that did not confirm that they are without power; None while they are not known."""
        self.phase = Life.STARTING
        self.failure: str | None = None
        """The reason why start-up failed, one line for each drive; None where it did not."""

    @property
    def finished(self) -> bool:
        """True where the orderly end is over and the carrier may drop the node."""
        return self.phase is Life.FINISHED

    @property
    def motion(self) -> Motion:
        """State of the motion permission."""
        return self._permission.motion

    @property
    def holding(self) -> bool:
        """True after a command to end, while it keeps a robot from moving until a second one."""
        return self.phase is Life.STOPPING and self._permission.power_down.held

    @property
    def not_acknowledged(self) -> tuple[str, ...]:
        """The axes, as text, whose devices did not confirm at the end that they are without power."""
        drivers = [driver for driver in self._all_drivers.drivers if driver.axis.name in (self._left or ())]
        return tuple(driver.axis.called for driver in drivers if not driver.unpowered)

    @property
    def all_drivers(self) -> AllDrivers:
        """The ways to the devices."""
        return self._all_drivers

    @property
    def stops(self) -> Mapping[str, AxisStop]:
        """Progress of each axis' stop, by the axis' name."""
        return self._permission.stops.of_axes

    @property
    def places(self) -> dict[str, float]:
        """Last known positions of the axes that need confirmation, as read off the robot."""
        return {axis: round(place, PLACE_DIGITS) for axis, place in self._pipeline.places.items()}

    def offer(self, last: Mapping[str, float]) -> None:
        """Take the axes' positions in an earlier run; they are reported, and never trusted."""
        self._pipeline.offer(last)

    @property
    def operator(self) -> OperatorLink:
        """The operators' side of it."""
        return self._operator

    @property
    def seen(self) -> AnySnapshot:
        """The snapshot of the newest report."""
        return self._pipeline.seen

    @property
    def interlock_events(self) -> tuple[ActiveInterlock, ...]:
        """The interlock events of the newest report."""
        return self._pipeline.interlock_events

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a packet of a link, or an operator's datagram."""
        if self.phase is Life.FINISHED:
            return self._reaction(now)
        if packet.link != OPERATOR:
            self._outbox += (self._all_drivers.receive(packet, now) or ()) + self._pipeline.follow(now)
        else:
            self._receive_operator(packet, now)
        return self._reaction(now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Act on the time; the first call starts the bridge."""
        if self.phase is not Life.FINISHED:
            if self._cycle_at is None:
                self._cycle_at = self._began_at = now
                self._listens_until = now + self._all_drivers.listens_for
                self._all_drivers.begin_beats(self._listens_until)
            self._outbox += self._all_drivers.wake(now)
            self._keep_time(now, self._cycle_at)
        return self._reaction(now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Begin the orderly end: ramp to standstill, power off, leave; done when `finished`.

        While it is `holding`, a command within 5 s of its begin, or of the one before, disables the power.
        """
        if self.holding:
            if now < self._requested_at + SECOND_REQUEST_WITHIN:
                self._permission.order_off(now)
            self._requested_at = now
        elif self.phase is Life.RUNNING:
            self._permission.happens(Event.DISARM)
            self._outbox += self._permission.stops.order()
            self._outbox += self._permission.end_start_ups(now)
            self._collect_until = NEVER
            self._standstill_until = now + STANDSTILL_WITHIN
            self.phase = Life.STOPPING
        elif self._all_drivers.task is None:
            # It has sent nothing to any device, and leaves them as they are.
            self.phase = Life.FINISHED
        elif self.phase in (Life.STARTING, Life.FAILED):
            self._leave(now)
        return self._reaction(now)

    def _keep_time(self, now: Nanoseconds, cycle_at: Nanoseconds) -> None:
        if now >= cycle_at:
            # A late wake skips the cycles that it missed: two in a row would be worse than one too few.
            self._cycle_at = cycle_at + ((now - cycle_at) // self._cycle + 1) * self._cycle
            self._begin_cycle(now)
        if not self._refused(now):
            self._outbox += self._all_drivers.beat(now)
        if now >= self._release_at:
            self._release_at = NEVER
            self._outbox += self._all_drivers.release()
        late = now >= self._collect_until
        if late:
            self._collect_until = NEVER
        if late or now >= self._gate_deadline():
            self._run(now)

    def _begin_cycle(self, now: Nanoseconds) -> None:
        if self._all_drivers.task in (Task.START, Task.ENABLE):
            self._synchronized_at = now
            self._outbox += self._all_drivers.sample(self._cycles, now)
        self._cycles += 1
        if self.phase is Life.RUNNING:
            self._collect_until = now + self._all_drivers.answers_within()
            self._release_at = now + self._cycle // 2
            self._outbox += self._all_drivers.measure(now)
            if self._permission.homing.under_way:
                self._confirmed.wait()
            else:
                self._confirmed.confirm(lambda request: self._pipeline.decide(request, now), now)
        elif self.phase is Life.STOPPING:
            self._come_to_standstill(now)
        else:
            if self.phase is not Life.STARTING and self._all_drivers.task is not None:
                self._disable_unconfirmed(now)
            self._outbox += self._pipeline.reported(
                (self._waiting(now), *self._permission.interlock_events), now
            )

    def _reaction(self, now: Nanoseconds) -> Reaction:
        """Carry on what the newest packet or instant made possible, and hand out what is to be sent."""
        listened = self._cycle_at is not None and now >= self._listens_until
        if self.phase is Life.STARTING and listened and not self._all_drivers.busy:
            self._start_up(now)
        elif self._collect_until != NEVER and self._all_drivers.sampled(self._synchronized_at):
            self._collect_until = NEVER
            self._run(now)
        elif self.phase is Life.LEAVING and self._left is None:
            self._disable_unconfirmed(now)
        wake_at = self._wake_at()
        if not self._outbox:
            if self._idle.wake_at != wake_at:
                self._idle = Reaction((), wake_at)
            return self._idle
        sent = tuple(self._outbox)
        self._outbox.clear()
        return Reaction(sent, wake_at)

    def _wake_at(self) -> Nanoseconds:
        if self.phase is Life.FINISHED or self._cycle_at is None:
            return NEVER
        if self.phase is Life.FAILED and self._all_drivers.task is None:
            return self._cycle_at
        first = min(self._cycle_at, self._collect_until)
        first = min(first, self._release_at)
        first = min(first, self._gate_deadline())
        return min(first, self._all_drivers.wake_at)

    def _gate_deadline(self) -> Nanoseconds:
        return self._pipeline.gate_deadline if self.phase is Life.RUNNING else NEVER

    def _run(self, now: Nanoseconds) -> None:
        """Run the pipeline once, for the samples of this cycle or at a deadline in between."""
        commanded, reported = self._pipeline.run(now)
        self._outbox += commanded
        self._outbox += reported

    def _start_up(self, now: Nanoseconds) -> None:
        """Take all drives to the next task; where one failed, switch all of them off and say so."""
        if self._refused(now):
            return
        permission, failures = self._permission, self._all_drivers.failures
        if failures:
            self.failure = "; ".join(failures)
            self.phase = Life.FAILED
            self._begin_to_leave(now)
            return
        sent = self._all_drivers.start(now, permission.rules.without, power=not permission.forbids_power)
        if sent is not None:
            self._outbox += sent
        else:
            self.phase = Life.RUNNING
            self._operator.note(self._all_drivers.remarks)

    def _refused(self, now: Nanoseconds) -> bool:
        """Return whether a second controller was received before anything was sent; it stays silent then."""
        starts = self._all_drivers.task is None and self.phase is Life.STARTING
        if starts and (masters := self._all_drivers.masters(now)):
            self.failure = "; ".join(f"link '{name}': {what}" for name, what in masters.items())
            self.phase = Life.FAILED
        return self._all_drivers.task is None and self.phase is Life.FAILED

    def _come_to_standstill(self, now: Nanoseconds) -> None:
        (commanded, at_standstill), permission = self._pipeline.come_to_standstill(now), self._permission
        self._outbox += commanded
        if not self.holding:
            self._requested_at = NEVER
        elif self._requested_at == NEVER:
            self._requested_at = now
        self._outbox += self._pipeline.reported((self._waiting(now), *permission.interlock_events), now)
        done = at_standstill and permission.powered_down and not permission.stops.under_way
        late = now >= self._standstill_until and not permission.power_down.under_way
        gone = self.holding and permission.stops.no_axis_left
        if done or gone or (late and not permission.stops.escalating):
            self._leave(now)

    def _leave(self, now: Nanoseconds) -> None:
        self.phase = Life.LEAVING
        self._collect_until = self._release_at = NEVER
        self._begin_to_leave(now)

    def _begin_to_leave(self, now: Nanoseconds) -> None:
        self._left, self._leave_until = None, now + LEFT_WITHIN
        self._permission.power_down.ordered(now)
        given_up = self._permission.stops.given_up
        for driver in self._all_drivers.drivers:
            if driver not in given_up:
                self._outbox += driver.begin(Transition.DEACTIVATE, now)

    def _disable_unconfirmed(self, now: Nanoseconds) -> None:
        """Take the power from those that have not confirmed that it is off, until all steps were tried."""
        stops = self._permission.stops
        if self._left is None:
            if self._all_drivers.busy and now < self._leave_until:
                return
            slow = self._all_drivers.busy
            failed = [driver for driver in self._all_drivers.drivers if driver.failure is not None]
            self._left = {driver.axis.name for driver in (*slow, *failed, *stops.given_up)}
            for driver in slow:
                self._outbox += driver.begin(Transition.END, now)
        self._outbox += self._pipeline.disable(self._left, now)
        if self.phase is Life.LEAVING and not stops.under_way:
            self.phase = Life.FINISHED

    def _receive_operator(self, packet: Packet, now: Nanoseconds) -> None:
        self._stop_began = False
        self._outbox += self._operator.receive(
            packet.payload, now, lambda request: self._decide(request, now), packet.address
        )
        permission, drivers = self._permission, self._all_drivers
        if self.phase is Life.RUNNING and self._stop_began and permission.emergency_stopped:
            self._outbox += permission.end_start_ups(now)
            self._run(now)
        elif permission.forbids_power and self.phase is Life.STARTING and drivers.task is Task.ENABLE:
            # That ends activating, and the start-up goes on without it.
            self._outbox += drivers.command_all(Stop.POWER_OFF, now)

    def _decide(self, request: Request, now: Nanoseconds) -> Answer:
        order = order_of(request)
        if self.phase in order.going_off:
            return ALREADY_OFF
        if self.phase not in order.lives:
            reason, temporary = self._waiting(now).reason, self.phase is Life.STARTING
            return Answer(accepted=False, reason=reason, temporary=temporary)
        stopped = self._permission.emergency_stopped
        answer = self._pipeline.decide(request, now)
        self._stop_began = self._stop_began or (self._permission.emergency_stopped and not stopped)
        if self._all_drivers.task is None:
            # It is remembered: no power comes on. Nothing is sent to the devices while it only listens.
            self._outbox[:] = [packet for packet in self._outbox if packet.link == OPERATOR]
        return answer

    def _waiting(self, now: Nanoseconds) -> ActiveInterlock:
        """Say why nothing moves before the drives are ready, or after they failed."""
        if self.failure is not None:
            return ActiveInterlock(FAILED.name, self.failure, FAILED, self._began_at)
        if self.phase is not Life.STARTING:
            again = self._requested_at <= now < self._requested_at + SECOND_REQUEST_WITHIN
            return ActiveInterlock(ENDS.name, HELD if again else ENDING, ENDS, self._began_at)
        task, waiting = self._all_drivers.task, [driver.axis.title for driver in self._all_drivers.busy]
        step = "" if task is None else f" ({task.value}: {', '.join(waiting)})"
        hints = "".join(f"; {hint}" for hint in self._all_drivers.hints(now))
        reason = f"the drives are being set up{step}{hints}"
        return ActiveInterlock(STARTING.name, reason, STARTING, self._began_at)
