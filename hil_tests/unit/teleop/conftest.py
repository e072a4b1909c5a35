"""A ground station and an Operator, joined directly: what one sends, the other hears."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import pytest

from firmware_bridge import robot as robots
from firmware_bridge.intent import Arm, Disarm, EmergencyStop, Request, Verdict
from firmware_bridge.motion.odometry import Pose
from firmware_bridge.robot import Robot
from firmware_bridge.safety.snapshot import DriveSnapshot, Hold, Snapshot
from firmware_bridge.teleop.mavlink import Codec, dialect
from firmware_bridge.teleop.operator import Operator
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.cia402 import State

CYCLE = 50 * MILLISECOND


def standing(robot: Robot, now: Nanoseconds = 0) -> Snapshot:
    drives = tuple(
        DriveSnapshot(axis.name, axis.node, State.OPERATION_ENABLED, now, 0, 0.0, 0, 0) for axis in robot.axes
    )
    operator = Operator(robot)
    return Snapshot(
        now=now,
        intent=operator.intent,
        armed=False,
        emergency_stopped=False,
        drives=drives,
        steer_rad=0.0,
        lift_m=0.0,
        speed_mps=0.0,
        yaw_rate_rad_s=0.0,
        pose=Pose(),
        demanded_speed_mps=0.0,
        battery_v=24.6,
    )


@dataclass
class Bench:
    """One station (255/190), one robot (1/1), and a bridge that says yes unless told otherwise."""

    robot: Robot
    operator: Operator
    snapshot: Snapshot
    station: Codec = field(default_factory=lambda: Codec(255, 190))
    now: Nanoseconds = 0
    asked: list[Request] = field(default_factory=list)
    verdict: Verdict | None = None

    def decide(self, request: Request) -> Verdict:
        self.asked.append(request)
        verdict = self.verdict or Verdict(accepted=True, reason="")
        if verdict.accepted:
            match request:
                case Arm():
                    self.snapshot = replace(self.snapshot, armed=True)
                case Disarm():
                    self.snapshot = replace(self.snapshot, armed=False)
                case EmergencyStop():
                    self.snapshot = replace(self.snapshot, armed=False, emergency_stopped=True)
        return verdict

    def say(self, message: Any) -> list[Any]:
        """Send one message; return what comes back, decoded."""
        return self.send(self.station.encode(message))

    def send(self, datagram: bytes) -> list[Any]:
        replies = self.operator.hear(datagram, self.now, self.decide)
        return [message for reply in replies for message in self.station.decode(reply)]

    def report(self, *holds: Hold) -> list[Any]:
        """Let a cycle pass; return what the station hears of it."""
        self.now += CYCLE
        self.snapshot = replace(self.snapshot, now=self.now, intent=self.operator.intent)
        sent = self.operator.report(self.snapshot, holds, self.now)
        return [message for datagram in sent for message in self.station.decode(datagram)]

    def told(self, number: int) -> Any:
        """Let a cycle pass; ask for one message and return it."""
        self.report()
        return self.order(512, number)[0]

    def drives(self, **changes: Any) -> tuple[DriveSnapshot, ...]:
        """Return the drives of the snapshot, each with the value of its place in each list."""
        return tuple(
            replace(drive, **{name: values[place] for name, values in changes.items()})
            for place, drive in enumerate(self.snapshot.drives)
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
        rest = (0.0,) * 4
        return self.say(
            dialect.MAVLink_set_position_target_local_ned_message(
                0, 1, 1, frame, mask, 0.0, 0.0, 0.0, vx, vy, vz, *rest, yaw_rate
            )
        )


@pytest.fixture
def robot() -> Robot:
    return robots.find("rars")


@pytest.fixture
def bench(robot: Robot) -> Bench:
    return Bench(robot, Operator(robot), standing(robot))


@pytest.fixture
def make_bench(robot: Robot) -> Callable[[], Bench]:
    return lambda: Bench(robot, Operator(robot), standing(robot))
