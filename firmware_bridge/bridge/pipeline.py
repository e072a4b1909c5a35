"""One cycle, top to bottom: snapshot, decision, ramp, set-points, pose, report. It names no robot.

The links' timing and start-up are not known here: `firmware_bridge.bridge.bridge` calls it when the devices
have sent their samples.
"""

from collections.abc import Collection, Mapping
from itertools import compress
from typing import Any, Final

from firmware_bridge.bridge.all_drivers import AllDrivers
from firmware_bridge.bridge.guide import Guide
from firmware_bridge.bridge.joint_state import Event
from firmware_bridge.bridge.led_axes import LedAxes
from firmware_bridge.bridge.locating import Locating, on_floor
from firmware_bridge.bridge.needs import Instant
from firmware_bridge.bridge.orders import carry_out, order_of
from firmware_bridge.bridge.permission import Permission
from firmware_bridge.bridge.zeros import Zeros
from firmware_bridge.drivers.driver import Feedback, Level, SetPoint, Stop
from firmware_bridge.intent import (
    NEVER_RECEIVED,
    Answer,
    Arm,
    ChangeDriver,
    ConfirmPosition,
    Request,
)
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_type import AnyRobotType
from firmware_bridge.safety.charge import Charge
from firmware_bridge.safety.gate import Gate
from firmware_bridge.safety.rules import Rules
from firmware_bridge.safety.snapshot import (
    ActiveInterlock,
    AnyDecision,
    AnySnapshot,
    Facts,
    Group,
    Snapshot,
)
from firmware_bridge.safety.tracking import Followers
from firmware_bridge.teleop.operator_link import OperatorLink
from firmware_bridge.units import NEVER, Nanoseconds

STOPPED_AFTER: Final = 3
"""Cycles without one, as of a bridge that was not run, after which no axis moves on."""
NO_LEVELS: Final[Mapping[str, Level]] = {}


class Pipeline:
    """The work of every cycle, and the state from one to the next."""

    def __init__(
        self,
        robot: AnyRobot,
        robot_type: AnyRobotType,
        *,
        rules: Mapping[str, Rules],
        all_drivers: AllDrivers,
        operator: OperatorLink,
        permission: Permission,
    ) -> None:
        self._robot = robot
        self._robot_type = robot_type
        self._all_drivers = all_drivers
        self._operator = operator
        self._permission = permission
        self._group_of: Final = {
            axis.name: group
            for group, roles in robot_type.groups.items()
            for axis in robot.axes
            if axis.role in roles
        }
        reports = {driver.axis.name: driver.reports for driver in all_drivers.drivers}
        self._gate: Gate = Gate(robot, rules, reports)
        self._charge: Final = Charge(robot)
        self._zeros: Final = Zeros(robot, robot_type.station.gauges, all_drivers)
        self._followers: Final = Followers(robot)
        self._guide: Final = Guide(robot, robot_type, operator, permission)
        self._commanded: Any = robot_type.standstill
        self._allowed: Any = robot_type.standstill
        """The motion to which the commanded one is ramped."""
        self._ramped_at: Nanoseconds | None = None
        self._led: Final = LedAxes(robot, robot_type, all_drivers)
        unrolled = robot_type.unrolled
        self._locating: Final = Locating(robot, on_floor if unrolled is None else unrolled(robot))
        self._counted: Mapping[str, Feedback] | None = None
        """The samples up to which the pose has been carried on."""
        self._ran_at: Nanoseconds | None = None
        self._bridge_stalled: Nanoseconds = 0
        self.gate_deadline: Nanoseconds = NEVER
        """Time when a timeout trips an interlock if nothing is received."""
        self.seen: AnySnapshot = self.known(0)
        """The newest cycle's snapshot."""
        self.interlock_events: tuple[ActiveInterlock, ...] = ()
        """The newest cycle's interlock events."""

    def run(self, now: Nanoseconds) -> tuple[tuple[Packet, ...], tuple[Packet, ...]]:
        """Do one cycle; return what goes to the devices and what to the operator."""
        elapsed = self._elapsed(now)
        if elapsed > STOPPED_AFTER * self._robot.cycle:
            # Devices and output guard have stopped the axes: it does not go on from the speed of before.
            rules = self._permission.rules
            self._commanded = rules.kinematics.at_standstill(self._commanded, rules.groups)
        self._lapse(now)
        known = self._guide.guided(self.known(now), elapsed)
        decision = self._gate.rule(known)
        self._watch_homing(decision.interlock_events + self._permission.stops.interlock_events, known.facts)
        # Before this cycle's events: one that begins now requires neutral again.
        if self._operator.take_returned_to_neutral() or known.facts.neutral:
            self._permission.neutral_required = False
        self._permission.part(decision.interlock_events, self._gate.clearing)
        self._permission.watch(decision.interlock_events)
        if any(event.interlock.parts for event in decision.interlock_events):
            # A target of before the timeout must not start the robot when the link is back.
            self._operator.forget()
        self.gate_deadline = self._gate.next_deadline(known.facts)
        self._ramp(decision.allowed, known.body, now)
        sent = self._stopped(
            self._stop_requested(decision.stopped), self._set_points(known), self._levels(decision), now
        )
        self._advance(known.facts)
        self._keep(known, decision.interlock_events + self._permission.interlock_events)
        return sent, self._operator.report(self.seen, self.interlock_events, now)

    def follow(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Command the axes that are led again, by a position that has come between two cycles."""
        if not self._led.due(now):
            return ()
        facts, kinematics = self.seen.facts, self._permission.rules.kinematics
        self._led.followed(now)
        body = kinematics.sensed(self._led.newest(facts.axes), facts.sensors)
        self._ramp(self._allowed, body, now)
        set_points = self._led.of(kinematics.set_points(self._commanded, body), self._all_drivers.set_points)
        sent = self._all_drivers.follow(set_points)
        self._followers.on_set_points(set_points, now)
        return sent

    def come_to_standstill(self, now: Nanoseconds) -> tuple[tuple[Packet, ...], bool]:
        """Ramp down, then power down, without the operator; return the packets, and whether it is done.

        A robot that would not stay at standstill without power keeps it until ordered. An axis whose report
        of standstill is not plausible loses its power as it would while the robot is driven.
        """
        self._permission.homing.interrupt("the bridge is ending", now)
        known = self.known(now)
        events = self._gate.rule(known).interlock_events
        self._permission.watch(tuple([event for event in events if event.interlock.disables_power]))
        rules = self._permission.rules
        rest = rules.kinematics.at_standstill(self._commanded, rules.groups)
        self._elapsed(now)
        self._ramp(rest, known.body, now)
        standstill = self._axes_stopped(known) and self._set_point_is_zero(known)
        set_points = self._without_power(known, standstill=standstill) or self._set_points_of_body(known)
        names, levels = set_points.keys() | self._group_of.keys(), self._robot_type.on_stop
        sent = self._stopped(names, set_points, levels, now)
        self._keep(known, self._permission.interlock_events)
        return sent, standstill or self._permission.powered_off

    def disable(self, names: Collection[str], now: Nanoseconds) -> tuple[Packet, ...]:
        """Carry on to disable the power of these axes, which have not confirmed that they have none."""
        off = dict.fromkeys(names, Stop.POWER_OFF)
        sent, set_points = self._permission.stops.watch(off, off, now)
        for driver in self._all_drivers.drivers:
            if driver.axis.name in off:
                sent += driver.command(set_points[driver.axis.name])
        return sent

    @property
    def places(self) -> dict[str, float]:
        """Position of each axis when it was last referenced, as read off the robot."""
        return self._zeros.last

    def offer(self, last: Mapping[str, float]) -> None:
        """Take the axes' positions in an earlier run; they are reported, and never trusted."""
        self._zeros.offer(last)

    def check(self, request: ConfirmPosition) -> None:
        """Raise ValueError where the axis of a request cannot stand there."""
        refused = self._zeros.refuses(request)
        if refused is not None:
            raise ValueError(refused)

    def decide(self, request: Request, now: Nanoseconds) -> Answer:
        """Answer one request of the operator by its row."""
        if isinstance(request, Arm | ChangeDriver):
            # A stick that was neutral before, or another station's, does not count.
            self._operator.take_returned_to_neutral()
        order, known = order_of(request), self.known(now)
        events: tuple[ActiveInterlock, ...] = ()
        if order.judged:
            events = self._gate.rule(known).interlock_events
        if isinstance(request, ConfirmPosition):
            events = self._against(request.axis, events)
        else:
            self._permission.part(events, self._gate.clearing)
        self._permission.ordered(request)
        instant = Instant(
            title=order.title,
            request=request,
            seen=known,
            events=events,
            permission=self._permission,
            zeros=self._zeros,
            guide=self._guide,
            locating=self._locating,
        )
        return carry_out(order, instant)

    def known(self, now: Nanoseconds) -> AnySnapshot:
        """Return everything known now."""
        all_drivers, permission, operator = self._all_drivers, self._permission, self._operator
        axes, sensors = all_drivers.feedback, operator.injection.seen(all_drivers.readings(now))
        facts = Facts(
            now=now,
            armed=permission.armed,
            emergency_stopped=permission.emergency_stopped,
            received_at=operator.intent.received_at,
            neutral=operator.intent.neutral,
            deflected=operator.intent.deflected,
            axes=axes,
            sensors=sensors,
            links_lost=all_drivers.links_lost,
            masters=all_drivers.masters(now),
            paused=permission.paused,
            neutral_required=permission.neutral_required,
            mode=permission.mode,
            without=permission.rules.without,
            battery_low_since=self._charge.low_since(sensors),
            stood=self._zeros.saw(axes),
            following=self._followers.saw(axes),
            sent_at=operator.intent.sent_at,
            timestamped=operator.intent.timestamped,
            age_limit=operator.age_limit,
            stood_still=max(self._bridge_stalled, 0 if self._ran_at is None else now - self._ran_at),
        )
        return Snapshot(
            facts=facts,
            command=self._guide.command,
            commanded=self._commanded,
            body=permission.rules.kinematics.sensed(axes, sensors),
            pose=self._locating.pose,
            located=self._locating.located,
        )

    def reported(self, events: tuple[ActiveInterlock, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Report without judging: before the devices are ready, and after they failed."""
        self._lapse(now)
        self.seen, self.interlock_events = self.known(now), events
        return self._operator.report(self.seen, self.interlock_events, now)

    def _lapse(self, now: Nanoseconds) -> None:
        """Let no one drive where the driver is lost and the robot at standstill; the next one arms again."""
        if self._permission.rules.at_standstill(self.seen) and self._operator.lapse(now):
            self._permission.happens(Event.DISARM)

    def _against(self, axis: str, events: tuple[ActiveInterlock, ...]) -> tuple[ActiveInterlock, ...]:
        """Return the interlock events that stop an axis."""
        group = self._group_of.get(axis)
        return tuple(one for one in events if one.interlock.stops is None or group in one.interlock.stops)

    def _watch_homing(self, events: tuple[ActiveInterlock, ...], facts: Facts) -> None:
        homing = self._permission.homing
        for axis in homing.set_points:
            events = self._against(axis, events)
        homing.watch(events, facts)

    def _stop_requested(self, stopped: frozenset[Group]) -> set[str]:
        """Return the axes that are to stop, without those that the mode excludes."""
        permission = self._permission
        requested = (permission.powered_off or group in stopped for group in self._group_of.values())
        moves = permission.homing.set_points.keys()
        return set(compress(self._group_of, requested)) - permission.rules.without - moves

    def _stopped(
        self,
        requested: Collection[str],
        set_points: Mapping[str, SetPoint],
        levels: Mapping[str, Level],
        now: Nanoseconds,
    ) -> tuple[Packet, ...]:
        """Send the set-points, and the further stop stages of axes that do not stop as requested."""
        stops = self._permission.stops
        escalated, changed = stops.watch(
            requested,
            set_points,
            now,
            self._permission.rules.without,
            holding=self._permission.power_down.held,
        )
        self._permission.watch(stops.interlock_events)
        sent = escalated + self._all_drivers.command(changed, levels, now)
        self._followers.on_set_points(self._all_drivers.set_points, now)
        return sent

    def _set_points(self, known: AnySnapshot) -> Mapping[str, SetPoint]:
        """Return each axis's set-point, in the order of the body."""
        permission = self._permission
        if permission.emergency_stopped or permission.powered_off:
            standstill = self._axes_stopped(known) and self._set_point_is_zero(known)
            return self._without_power(known, standstill=standstill) or self._set_points_of_body(known)
        permission.power_down.not_requested(known.facts.now)
        return self._set_points_of_body(known)

    def _without_power(self, known: AnySnapshot, *, standstill: bool) -> Mapping[str, SetPoint]:
        """Return the stop that disables all axes' power, or keeps it at standstill; none while they move."""
        permission, now = self._permission, known.facts.now
        if permission.powered_off:
            permission.power_down.ordered(now)
            # Not for an axis that shall have no power already: to brake would give it back.
            ordered = permission.ordered_off(now, standstill=permission.rules.stopped(known))
            return self._used(self._all(ordered))
        without = permission.rules.without
        stop = permission.power_down.stop_for(standstill=standstill, now=now, without=without)
        return {} if stop is None else self._used(self._all(stop))

    def _set_points_of_body(self, known: AnySnapshot) -> Mapping[str, SetPoint]:
        """Return what the kinematic model makes of the commanded motion."""
        kinematics, body = self._permission.rules.kinematics, known.body
        if (newest := self._led.newest(known.facts.axes)) is not known.facts.axes:
            body = kinematics.sensed(newest, known.facts.sensors)
        return self._used(kinematics.set_points(self._commanded, body))

    def _used(self, set_points: Mapping[str, SetPoint]) -> Mapping[str, SetPoint]:
        """Return the set-points; an axis that the mode excludes, or that is untrusted, has no power."""
        permission = self._permission
        unused, homed = permission.rules.without | permission.untrusted, permission.homing.set_points
        return (
            {**set_points, **homed, **dict.fromkeys(unused, Stop.POWER_OFF)}
            if unused or homed
            else set_points
        )

    def _axes_stopped(self, known: AnySnapshot) -> bool:
        """Return whether the robot is at standstill; untrusted axes, whose power is off, are not judged."""
        permission = self._permission
        if permission.rules.at_standstill(known):
            return True
        if not permission.untrusted:
            return False
        believed = permission.rules.believed(known, permission.untrusted)
        return believed is not None and permission.rules.at_standstill(believed)

    def _set_point_is_zero(self, known: AnySnapshot) -> bool:
        rules = self._permission.rules
        return not rules.kinematics.requested(self._commanded, known.body) & rules.travelling

    def _levels(self, decision: AnyDecision) -> Mapping[str, Level]:
        """Return the levels of the outputs: by the motion, or by a stop of everything."""
        if self._robot_type.switched is None:
            return NO_LEVELS
        levels = self._robot_type.switched(decision.allowed)
        stopped = decision.stopped == self._permission.rules.groups
        return {**levels, **self._robot_type.on_stop} if stopped else levels

    def _all(self, set_point: SetPoint) -> Mapping[str, SetPoint]:
        return {driver.axis.name: set_point for driver in self._all_drivers.drivers}

    def _advance(self, facts: Facts) -> None:
        """Carry the pose on where all axes that it hangs on were sampled at one new instant."""
        body, axes, locating = self._permission.rules.kinematics, facts.axes, self._locating
        at = {axes[name].sampled_at for name in body.rolling}
        if NEVER_RECEIVED in at:
            self._counted = None
            locating.interrupted()
        # Samples of different instants would look like a turn of the robot.
        elif len(at) == 1:
            before, self._counted = self._counted, axes
            pose = locating.odometry
            if before is not None and before[body.rolling[0]].sampled_at not in at:
                pose = body.advanced(pose, before, axes, facts.sensors)
            locating.rolled(pose, axes[body.rolling[0]].sampled_at, facts.sensors)

    def _keep(self, known: AnySnapshot, events: tuple[ActiveInterlock, ...]) -> None:
        """Keep this cycle's snapshot and set-points; a path follower that was held back begins again."""
        self.seen = Snapshot(
            facts=known.facts,
            command=known.command,
            commanded=self._commanded,
            body=known.body,
            pose=self._locating.pose,
            located=self._locating.located,
        )
        self.interlock_events = events
        if any(event.interlock.stops != frozenset() for event in events):
            self._guide.reset()

    def _ramp(self, allowed: Any, body: Any, now: Nanoseconds) -> None:
        """Take the commanded motion on towards the allowed one."""
        elapsed = 0 if self._ramped_at is None else now - self._ramped_at
        self._allowed, self._ramped_at = allowed, now
        self._commanded = self._permission.rules.kinematics.ramped(self._commanded, allowed, body, elapsed)

    def _elapsed(self, now: Nanoseconds) -> Nanoseconds:
        before, self._ran_at = self._ran_at, now
        self._bridge_stalled = 0 if before is None else now - before
        return self._bridge_stalled
