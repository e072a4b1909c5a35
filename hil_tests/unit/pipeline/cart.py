"""A robot of no folder: two wheels on one link, a brush on another; and what no shipped robot uses yet.

A hold that latches, a link that stops only its own group, a link of every second cycle, a mode without the
brush, a path follower.
"""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from firmware_bridge.bridge.all_drivers import AllDrivers
from firmware_bridge.bridge.permission import Permission
from firmware_bridge.bridge.pipeline import Pipeline
from firmware_bridge.drivers.driver import (
    Between,
    Feedback,
    Power,
    Reading,
    Reports,
    SetPoint,
    Speed,
    StartupError,
)
from firmware_bridge.drivers.life_cycle import AT_REST, TABLE, DriverState, Task, Transition
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.intent import Answer, Arm, Request
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.motion.odometry import moved
from firmware_bridge.motion.pose import Pose
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, Robot, Table
from firmware_bridge.robot.file import robot_of, table_of
from firmware_bridge.robot_type import RobotMode, RobotType
from firmware_bridge.robot_types import robot_type_named
from firmware_bridge.safety.interlock import Interlock, View
from firmware_bridge.safety.snapshot import Snapshot
from firmware_bridge.teleop.operator_link import OperatorLink
from firmware_bridge.teleop.station import StationRows, Stick, Twist, Unusable, Velocity
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds, to_seconds

WHEELS: Final = "drives"
"""The link of the two wheels, called as RARS's."""
TOOL: Final = "tool"
"""The link of the brush."""
RADIUS_M: Final = 0.1
TRACK_M: Final = 0.5
BRUSH_TOP: Final = 10.0
"""rad/s at full stick."""
RACES_AT: Final = 8.0
"""Speed of the brush above which the robot stops and latches; rad/s."""
GUIDED_MPS: Final = 0.2
ARM: Final = Arm()


class Sizes(Table):
    """The cart's geometry."""

    top_mps: float


@dataclass(frozen=True, slots=True)
class Sweep:
    """The cart's motion."""

    ahead: float = 0.0
    """m/s."""
    brush: float = 0.0
    """rad/s."""


@dataclass(frozen=True, slots=True)
class Sensed:
    """Sensed state of the cart."""

    ahead: float
    brush: float


class Cart:
    """A `firmware_bridge.safety.kinematic_model.KinematicModel`."""

    rolling: tuple[str, ...] = ("left", "right")

    def sensed(self, axes: Mapping[str, Feedback], _sensors: Mapping[str, Reading]) -> Sensed:
        mean = (axes["left"].velocity + axes["right"].velocity) / 2.0
        return Sensed(mean * RADIUS_M, axes["brush"].velocity)

    def requested(self, motion: Sweep, _state: Sensed) -> frozenset[str]:
        return frozenset(
            group for group, speed in (("base", motion.ahead), ("tool", motion.brush)) if speed != 0.0
        )

    def moving(self, state: Sensed) -> frozenset[str]:
        return frozenset({"base"}) if abs(state.ahead) > 0.01 else frozenset()

    def at_standstill(self, motion: Sweep, groups: frozenset[str]) -> Sweep:
        if "base" in groups:
            motion = replace(motion, ahead=0.0)
        return replace(motion, brush=0.0) if "tool" in groups else motion

    def ramped(self, commanded: Sweep, allowed: Sweep, _state: Sensed, elapsed: Nanoseconds) -> Sweep:
        """Ramp the wheels with 2 m/s2; the brush follows at once."""
        reach = 2.0 * to_seconds(elapsed)
        return replace(
            allowed, ahead=min(max(allowed.ahead, commanded.ahead - reach), commanded.ahead + reach)
        )

    def set_points(self, motion: Sweep, _state: Sensed) -> Mapping[str, SetPoint]:
        wheel = Speed(motion.ahead / RADIUS_M)
        return {"left": wheel, "right": wheel, "brush": Speed(motion.brush)}

    def advanced(
        self,
        pose: Pose,
        before: Mapping[str, Feedback],
        after: Mapping[str, Feedback],
        _sensors: Mapping[str, Reading],
    ) -> Pose:
        left, right = (RADIUS_M * (after[name].position - before[name].position) for name in self.rolling)
        return moved(pose, left, right, TRACK_M)


class Unbrushed(Cart):
    """The cart after its brush has failed."""

    def set_points(self, motion: Sweep, state: Sensed) -> Mapping[str, SetPoint]:
        return {
            name: set_point
            for name, set_point in super().set_points(motion, state).items()
            if name != "brush"
        }


class Ahead:
    """A `firmware_bridge.robot_type.PathFollower`: half a second of rest, then straight on."""

    def __init__(self, _robot: Robot[Sizes]) -> None:
        self._elapsed: Nanoseconds = 0

    def command(self, _seen: Snapshot[Sweep, Sensed], elapsed: Nanoseconds) -> Sweep:
        self._elapsed += elapsed
        return Sweep(GUIDED_MPS) if self._elapsed >= 500 * MILLISECOND else Sweep()

    def reset(self) -> None:
        self._elapsed = 0


def _races(view: View[Sizes, Sweep, Sensed]) -> str | None:
    return None if abs(view.body.brush) <= RACES_AT else f"the brush turns at {view.body.brush:.1f} rad/s"


RACES: Final[Interlock[Sizes, Sweep, Sensed]] = Interlock(
    "brush races", _races, "clear the emergency stop when it stands", latches=True
)


def _stick(stick: Stick, command: Sweep, robot: Robot[Sizes]) -> Sweep:
    del command
    return Sweep((stick.forward or 0.0) * robot.geometry.top_mps, (stick.turn or 0.0) * BRUSH_TOP)


def _target(velocity: Velocity, command: Sweep, _robot: Robot[Sizes]) -> Sweep | Unusable:
    return replace(command, ahead=velocity.forward_mps)


ROBOT_TYPE: Final[RobotType[Sizes, Sweep, Sensed]] = RobotType(
    name="cart",
    file=Path("cart.toml"),
    geometry=Sizes,
    standstill=Sweep(),
    numbers={"speed": lambda motion: motion.ahead, "brush": lambda motion: motion.brush},
    kinematics=lambda _robot: Cart(),
    groups={"base": frozenset({"left", "right"}), "tool": frozenset({"brush"})},
    travelling=frozenset({"base"}),
    interlocks=(RACES,),
    limits=(),
    reach=lambda robot: ((Sweep(robot.geometry.top_mps, BRUSH_TOP), Sensed(0.0, 0.0)),),
    station=StationRows(
        stick=_stick,
        target=_target,
        twist=lambda state: Twist(state.ahead, 0.0, 0.0),
        forgotten=lambda command: command,
        largest=lambda robot: Twist(robot.geometry.top_mps, 0.0, 1.0),
    ),
    path_followers={"ahead": Ahead},
    modes={
        "brushless": RobotMode(
            without=frozenset({"brush"}), kinematics=lambda _robot: Unbrushed(), interlocks=(), limits=()
        )
    },
)


def cart(change: Callable[[dict[str, Any]], None] = lambda _table: None) -> Robot[Sizes]:
    """Return the cart's robot file, made from RARS's, with its table changed, checked."""
    file = robot_type_named("rars").file
    table: dict[str, Any] = table_of(file.read_text(encoding="utf-8"), file.name)
    motor = table["axes"][0]
    axes = [
        motor
        | {
            "name": name,
            "role": name,
            "title": name,
            "link": TOOL if name == "brush" else WHEELS,
            "top_speed": 12.0,
            "settings": motor["settings"] | {"node": node},
        }
        for name, node in (("left", 1), ("right", 2), ("brush", 1))
    ]
    links = {WHEELS: table["links"][WHEELS], TOOL: table["links"][WHEELS] | {"bridge_node": 101}}
    own = {"name": "cart", "kind": "cart", "links": links, "geometry": {"top_mps": 1.0}, "axes": axes}
    table = deepcopy({**table, **own, "guard": {}})
    del table["battery"], table["sensors"]
    change(table)
    return robot_of(table, "cart.toml", Sizes, ROBOT_TYPE.groups)


class FakeDriver:
    """A `firmware_bridge.drivers.driver.Driver` that executes each command at once, and keeps it."""

    reports = frozenset(Reports)
    failure: StartupError | None = None
    state = DriverState.ACTIVE
    unpowered = False
    wake_at: Nanoseconds = NEVER
    between: Between | None = None

    def __init__(self, axis: Axis) -> None:
        self.axis: Final = axis
        self.feedback = Feedback(axis.name, Power.ON, received_at=0, sampled_at=0)
        self.set_points: list[SetPoint] = []
        self.begun: list[Transition] = []
        self.zeros: list[float] = []

    @property
    def sampled_at(self) -> Nanoseconds:
        return self.feedback.sampled_at

    def begin(
        self, transition: Transition, _now: Nanoseconds, _task: Task | None = None
    ) -> tuple[Packet, ...]:
        self.begun.append(transition)
        known = self.state not in AT_REST or (self.state, transition) in TABLE
        refused = not known and transition is not Transition.END
        self.failure = StartupError(self.axis, "refused") if refused else None
        return ()

    def set_zero(self, position: float, _now: Nanoseconds) -> tuple[Packet, ...]:
        self.zeros.append(position)
        return ()

    def command(self, set_point: SetPoint) -> tuple[Packet, ...]:
        self.set_points.append(set_point)
        speed = set_point.value if isinstance(set_point, Speed) else 0.0
        self.feedback = replace(self.feedback, velocity=speed)
        return (Packet(self.axis.link, Epos2Axis.of(self.axis).node, repr(set_point).encode()),)

    def release(self) -> tuple[Packet, ...]:
        return ()

    def wake(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        return ()

    def received(self, now: Nanoseconds) -> None:
        """Report a sample."""
        way = self.feedback.velocity * to_seconds(now - self.feedback.sampled_at)
        position = self.feedback.position + way
        self.feedback = replace(self.feedback, received_at=now, sampled_at=now, position=position)


class FakeLink:
    """A `firmware_bridge.drivers.link_drivers.DeviceLink` that carries nothing, and may be lost."""

    answers_within: Nanoseconds = 10 * MILLISECOND
    beat_every: Nanoseconds = 50 * MILLISECOND
    remark: str = ""
    listens_for: Nanoseconds = 0
    late = 0
    wake_at: Nanoseconds = NEVER

    def __init__(self, name: str) -> None:
        self.name = name
        self.lost: str | None = None
        self.received_master: str | None = None
        self.beats: list[Nanoseconds] = []

    def hint(self, _now: Nanoseconds) -> str:
        return ""

    def master(self, _now: Nanoseconds) -> str | None:
        return self.received_master

    def sample(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        return ()

    def beat(self, now: Nanoseconds) -> tuple[Packet, ...]:
        self.beats.append(now)
        return ()

    def receive(self, _packet: Packet, _now: Nanoseconds) -> tuple[Packet, ...]:
        return ()

    def wake(self, _now: Nanoseconds) -> tuple[Packet, ...]:
        return ()


class FakeCart:
    """The pipeline of a cart above paper devices, cycle by cycle, and a station in the test's hand."""

    def __init__(self, robot: Robot[Sizes] | None = None) -> None:
        self.robot: Final = robot or cart()
        self.links: Final = {name: FakeLink(name) for name in self.robot.links}
        self.drivers: Final = {axis.name: FakeDriver(axis) for axis in self.robot.axes}
        self.all_drivers: Final = AllDrivers(
            tuple(
                LinkDrivers(
                    self.links[name], table, [self.drivers[axis.name] for axis in self.robot.axes_on(name)]
                )
                for name, table in self.robot.links.items()
            )
        )
        rules = ROBOT_TYPE.rules(self.robot)
        self._codec = Codec(255, 190)
        self._operator: OperatorLink = OperatorLink(
            self.robot,
            ROBOT_TYPE.station,
            ROBOT_TYPE.standstill,
            rolling=rules[""].kinematics.rolling,
            modes=tuple(ROBOT_TYPE.modes),
        )
        self.permission: Final[Permission] = Permission(self.robot, rules, self.all_drivers, [])
        self.pipeline: Final[Pipeline] = Pipeline(
            self.robot,
            ROBOT_TYPE,
            rules=rules,
            all_drivers=self.all_drivers,
            operator=self._operator,
            permission=self.permission,
        )
        self.now: Nanoseconds = 0
        self.cycle = 0
        self.talks = True
        self.silent: set[str] = set()
        """The axes whose devices say nothing."""
        self.ahead = 0.0
        """Share of full stick, as `brush`."""
        self.brush = 0.0

    def runs(self, cycles: int = 1) -> None:
        """Let cycles pass: the station sends, the devices of due links report, the pipeline runs."""
        for _ in range(cycles):
            self.now += self.robot.cycle
            if self.talks:
                self.speaks()
            self.all_drivers.sample(self.cycle, self.now)
            self.cycle += 1
            for name, driver in self.drivers.items():
                if self.links[driver.axis.link].lost is None and name not in self.silent:
                    driver.received(self.now)
            self.pipeline.run(self.now)

    def arms(self) -> None:
        """Let the operator's messages arrive for a while, then arm."""
        self.runs(10)
        verdict = self.requests(ARM)
        assert verdict.accepted, verdict.reason

    def requests(self, request: Request) -> Answer:
        return self.pipeline.decide(request, self.now)

    def held(self) -> set[str]:
        """Return what holds now, by name."""
        return {event.name for event in self.pipeline.interlock_events}

    def newest(self, axis: str) -> SetPoint:
        """Return the axis' last set-point."""
        return self.drivers[axis].set_points[-1]

    def reported(self) -> dict[str, int]:
        """Return the number of set-points of each axis."""
        return {name: len(driver.set_points) for name, driver in self.drivers.items()}

    def speaks(self) -> None:
        x, r = round(self.ahead * 1000), round(-self.brush * 1000)
        message = dialect.MAVLink_manual_control_message(1, x, 0x7FFF, 0x7FFF, r, 0)
        self._operator.receive(
            self._codec.encode(message), self.now, lambda request: self.pipeline.decide(request, self.now)
        )
