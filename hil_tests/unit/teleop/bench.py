"""A ground station and an OperatorLink, joined directly: each receives the other's messages."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, Generic, TypeVar

from firmware_bridge import robot_types
from firmware_bridge.drivers.driver import Feedback, Power, Reading
from firmware_bridge.intent import (
    NEVER_RECEIVED,
    Answer,
    Arm,
    Disarm,
    EmergencyStop,
    EnterMode,
    Request,
)
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.mavlink.trust import ANY_STATION, Trust
from firmware_bridge.motion.pose import Pose
from firmware_bridge.robot import Robot, Table
from firmware_bridge.robots.rars.geometry import RarsGeometry
from firmware_bridge.robots.rars.motion import RarsMotion, RarsState
from firmware_bridge.robots.rars.station import STATION
from firmware_bridge.safety.interlock_base import InterlockBase, Severity
from firmware_bridge.safety.snapshot import ActiveInterlock, Facts, Snapshot
from firmware_bridge.teleop.incoming import Station
from firmware_bridge.teleop.operator_link import OperatorLink
from firmware_bridge.teleop.station import StationRows
from firmware_bridge.units import MILLISECOND, Nanoseconds

G = TypeVar("G", bound=Table)
M = TypeVar("M")
S = TypeVar("S")

CYCLE = 50 * MILLISECOND


def event(name: str, reason: str, remedy: str = "", severity: Severity = Severity.WARNING) -> ActiveInterlock:
    """Return a hold that began at once."""
    return ActiveInterlock(name, reason, InterlockBase(name, remedy, severity=severity), 0)


@dataclass
class Bench(Generic[G, M, S]):
    """One station (255/190), one robot (1/1), and a bridge that accepts unless set otherwise."""

    robot: Robot[G]
    rows: StationRows[G, M, S]
    rest: M
    body: S
    rolling: tuple[str, ...]
    modes: tuple[str, ...] = ()
    facts: Facts = field(init=False)
    pose: Pose = field(default_factory=Pose)
    operator: OperatorLink = field(init=False)
    station: Codec = field(default_factory=lambda: Codec(255, 190))
    now: Nanoseconds = 0
    requested: list[Request] = field(default_factory=list)
    verdict: Answer | None = None
    trust: Trust = ANY_STATION
    injects: bool = False
    received: list[Any] = field(default_factory=list)
    """All reported messages."""

    def __post_init__(self) -> None:
        self.restart()
        sensors = {} if self.robot.battery is None else {self.robot.battery.sensor: Reading(24.6, 0, 0)}
        self.facts = Facts(
            now=0,
            armed=False,
            emergency_stopped=False,
            received_at=NEVER_RECEIVED,
            neutral=True,
            axes={axis.name: standing(axis.name) for axis in self.robot.axes},
            sensors=sensors,
            links_lost={},
        )

    def restart(self) -> None:
        """Begin with an operator that has received nothing."""
        self.operator = OperatorLink(
            self.robot,
            self.rows,
            self.rest,
            rolling=self.rolling,
            modes=self.modes,
            trust=self.trust,
            injects=self.injects,
        )

    @property
    def command(self) -> M:
        """The operator's present command."""
        present: M = self.operator.intent.command
        return present

    def decide(self, request: Request) -> Answer:
        self.requested.append(request)
        verdict = self.verdict or Answer(accepted=True, reason="")
        if verdict.accepted:
            match request:
                case Arm():
                    self.facts = replace(self.facts, armed=True)
                case Disarm():
                    self.facts = replace(self.facts, armed=False)
                case EmergencyStop():
                    self.facts = replace(self.facts, armed=False, emergency_stopped=True)
                case EnterMode(mode=mode):
                    self.facts = replace(self.facts, mode=mode)
        return verdict

    def say(self, message: Any) -> list[Any]:
        """Send one message; return what comes back, decoded."""
        return self.send(self.station.encode(message))

    def send(self, datagram: bytes) -> list[Any]:
        replies = self.operator.receive(datagram, self.now, self.decide)
        return [message for reply in replies for message in self.station.decode(reply.payload)]

    def snapshot(self) -> Snapshot[M, S]:
        """Return what the bridge knows now."""
        return Snapshot(
            facts=self.facts, command=self.command, commanded=self.rest, body=self.body, pose=self.pose
        )

    def report(self, *events: ActiveInterlock) -> list[Any]:
        """Let a cycle pass; return the messages that the station receives of it."""
        self.now += CYCLE
        self.facts = replace(self.facts, now=self.now, received_at=self.operator.intent.received_at)
        sent = self.operator.report(self.snapshot(), events, self.now)
        own = [packet.payload for packet in sent if packet.address == 0]
        received = [message for datagram in own for message in self.station.decode(datagram)]
        self.received += received
        return received

    def reported(self, number: int) -> Any:
        """Let a cycle pass; ask for one message and return it."""
        self.report()
        return self.order(512, number)[0]

    def axes(self, **changes: list[Any]) -> None:
        """Give each axis the value of its place in each list."""
        self.facts = replace(
            self.facts,
            axes={
                name: replace(axis, **{key: values[place] for key, values in changes.items()})
                for place, (name, axis) in enumerate(self.facts.axes.items())
            },
        )

    def sensors(self, values: Mapping[str, float]) -> None:
        """Set these sensor values; the other sensors report nothing."""
        self.facts = replace(
            self.facts, sensors={name: Reading(value, self.now, self.now) for name, value in values.items()}
        )

    def order(
        self, command: int, *params: float, confirmation: int = 0, target: tuple[int, int] = (1, 1)
    ) -> list[Any]:
        seven = (*params, *(0.0,) * (7 - len(params)))
        return self.say(dialect.MAVLink_command_long_message(*target, command, confirmation, *seven))

    def stick(
        self, *, x: int = 0, y: int = 0x7FFF, z: int = 0, r: int = 0, buttons: int = 0, target: int = 1
    ) -> list[Any]:
        return self.say(dialect.MAVLink_manual_control_message(target, x, y, z, r, buttons))

    def target(
        self,
        vx: float = 0.0,
        yaw_rate: float = 0.0,
        *,
        vy: float = 0.0,
        vz: float = 0.0,
        mask: int = 1511,
        frame: int = 8,
    ) -> list[Any]:
        return self.say(target_message(vx, yaw_rate, vy=vy, vz=vz, mask=mask, frame=frame))


def target_message(
    vx: float = 0.0,
    yaw_rate: float = 0.0,
    *,
    vy: float = 0.0,
    vz: float = 0.0,
    mask: int = 1511,
    frame: int = 8,
) -> Any:
    """Return a SET_POSITION_TARGET_LOCAL_NED, by default of velocity and yaw rate along the robot."""
    rest = (0.0,) * 4
    return dialect.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, frame, mask, 0.0, 0.0, 0.0, vx, vy, vz, *rest, yaw_rate
    )


def standing(axis: str) -> Feedback:
    """Return an axis that has power and stands at its zero."""
    return Feedback(axis, Power.ON, received_at=0, sampled_at=0, current_a=0.0)


class RarsBench(Bench[RarsGeometry, RarsMotion, RarsState]):
    """RARS and its operator."""


@cache
def rars_file() -> Robot[RarsGeometry]:
    """Return RARS's robot file, read once."""
    return robot_types.find("rars")


def rars() -> RarsBench:
    """Return RARS, standing, lift collapsed."""
    body = RarsState(steer_rad=0.0, lift_m=0.0, screw_rad_s=0.0, speed_mps=0.0, yaw_rate_rad_s=0.0)
    return RarsBench(rars_file(), STATION, RarsMotion(), body, ("left", "right"))


def acks(messages: list[Any]) -> list[tuple[int, int]]:
    """Return command and result of each COMMAND_ACK."""
    return [(one.command, one.result) for one in messages if one.get_type() == "COMMAND_ACK"]


def bench_of(name: str) -> Bench[Any, Any, Any]:
    """Return a bench of an installed robot, whose kinematic model reports nothing."""
    robot = robot_types.find(name)
    kind = robot_types.robot_type_of(robot)
    return Bench(robot, kind.station, kind.standstill, None, ())


def in_control(bench: Bench[Any, Any, Any]) -> Station:
    """Return the station that drives."""
    station = bench.operator.stations.in_control
    assert station is not None
    return station
