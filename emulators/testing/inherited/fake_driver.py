"""Any installed robot that is well, to be made unwell in one respect; and one whose axes obey at once."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final, TypeAlias

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.cases import Case, Situation
from firmware_bridge.drivers.driver import Feedback, Position, Power, Reading, Reports, SetPoint, Speed
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_type import AnyRobotType
from firmware_bridge.robot_types import find, robot_type_of
from firmware_bridge.safety.gate import Gate
from firmware_bridge.safety.snapshot import Decision, Facts, Snapshot
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, to_seconds

START: Final = 100 * SECOND
AnyCase: TypeAlias = Case[Any, Any]
AnySituation: TypeAlias = Situation[Any, Any]
WELL: Final[AnySituation] = Situation()


def gate_of(robot: AnyRobot) -> Gate:
    """Return the robot's gate; its drives report everything."""
    reports = {axis.name: frozenset(Reports) for axis in robot.axes}
    return Gate(robot, robot_type_of(robot).rules(robot), reports)


def axes_of(robot: AnyRobot, now: Nanoseconds) -> dict[str, Feedback]:
    """Return all axes where the bench begins with them, with power, received now."""
    gauges = {gauge.role: gauge for gauge in robot_type_of(robot).station.gauges}
    start_positions = bench_setup_of(robot).start_positions

    def place(role: str) -> float:
        read = start_positions.get(role, 0.0)
        return read if role not in gauges else gauges[role].position(read, robot)

    return {
        axis.name: Feedback(
            axis.name, position=place(axis.role), power=Power.ON, received_at=now, sampled_at=now
        )
        for axis in robot.axes
    }


def well(robot: AnyRobot, now: Nanoseconds) -> dict[str, Reading]:
    """Return the sensor values of a robot that is well."""
    return {name: Reading(value, now, now) for name, value in bench_setup_of(robot).well.items()}


def seen(
    robot: AnyRobot,
    now: Nanoseconds = START,
    situation: AnySituation = WELL,
    axes: Mapping[str, Feedback] | None = None,
    **facts: Any,
) -> Snapshot[Any, Any]:
    """Return the robot armed and well, but for the given facts."""
    robot_type = robot_type_of(robot)
    feedback = dict(axes_of(robot, now) if axes is None else axes)
    body = (
        robot_type.kinematics(robot).sensed(feedback, well(robot, now))
        if situation.body is None
        else situation.body
    )
    known: dict[str, Any] = {
        "now": now,
        "armed": True,
        "emergency_stopped": False,
        "received_at": now,
        "neutral": True,
        "axes": feedback,
        "sensors": {},
        "links_lost": {},
    }
    return Snapshot(
        facts=Facts(**(known | facts)),
        command=robot_type.standstill if situation.command is None else situation.command,
        commanded=robot_type.standstill if situation.commanded is None else situation.commanded,
        body=body,
        pose=Pose(),
        located=situation.located,
    )


def active(decision: Decision[Any]) -> dict[str, str]:
    """Return the reasons of all that holds, by name."""
    return {event.name: event.reason for event in decision.interlock_events}


def cases_of(name: str) -> list[AnyCase]:
    """Return the boundary cases that a robot's package declares."""
    robot = find(name)
    return list(bench_setup_of(robot).cases(robot))


def full_motions(robot_type: AnyRobotType, robot: AnyRobot) -> list[Any]:
    """Return motions that ask for as much as the robot may do."""
    return [motion for motion, _ in robot_type.reach(robot)]


class FakeDriver:
    """A robot without drives: each axis follows its set-point of the cycle, within its top speed."""

    def __init__(self, robot: AnyRobot) -> None:
        self.robot: Final = robot
        self.robot_type: Final = robot_type_of(robot)
        self.rules: Final = self.robot_type.rules(robot)[""]
        self.gate: Final = gate_of(robot)
        self.axes: Final = axes_of(robot, START)
        self.before: Mapping[str, Feedback] = dict(self.axes)
        """The axes as the newest set-points found them."""
        self.commanded: Any = self.robot_type.standstill
        self.set_points: Mapping[str, SetPoint] = {}
        self.now: Nanoseconds = START

    def cycle(self, command: Any, **facts: Any) -> Decision[Any]:
        """Do one cycle of the bridge, as `firmware_bridge.bridge.pipeline` does it."""
        self.now += self.robot.cycle
        for name, axis in self.axes.items():
            self.axes[name] = replace(axis, received_at=self.now, sampled_at=self.now)
        situation: AnySituation = Situation(command=command, commanded=self.commanded)
        known = seen(self.robot, self.now, situation, self.axes, **facts)
        # The order is that of the bridge's pipeline: evaluate, ramp, then set-points from the ramp's result.
        decision = self.gate.rule(known)
        self.commanded = self.rules.kinematics.ramped(
            self.commanded, decision.allowed, known.body, self.robot.cycle
        )
        self.set_points = self.rules.kinematics.set_points(self.commanded, known.body)
        self._obey()
        return decision

    def _obey(self) -> None:
        self.before = dict(self.axes)
        seconds = to_seconds(self.robot.cycle)
        for axis in self.robot.axes:
            before, set_point = self.axes[axis.name], self.set_points.get(axis.name)
            velocity = 0.0
            if isinstance(set_point, Speed):
                velocity = set_point.value
            elif isinstance(set_point, Position):
                # Bounded, so that a set-point that jumps shows as a speed, and not as a jump of the axis.
                reach = axis.top_speed * seconds
                way = min(max(set_point.value - before.position, -reach), reach)
                velocity = way / seconds
            position = before.position + velocity * seconds
            self.axes[axis.name] = replace(before, position=position, velocity=velocity)

    def speeds(self) -> dict[str, float]:
        """Return what is demanded of the axes that are commanded by speed."""
        return {name: one.value for name, one in self.set_points.items() if isinstance(one, Speed)}


def silence_of(robot: AnyRobot, link: str) -> Nanoseconds:
    """Return how long an axis on a link may be silent."""
    return robot.links[link].silent_ms * MILLISECOND
