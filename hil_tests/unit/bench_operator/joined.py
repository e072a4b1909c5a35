"""The scripted operator, joined directly to the bridge's operator link: both ends real, a short wire."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from emulators.bench import mission as missions
from emulators.bench.mission import Mission
from emulators.bench.operator import ScriptedOperator
from emulators.robots.rars import BENCH_SETUP
from firmware_bridge import robot_types
from firmware_bridge.intent import (
    Answer,
    Arm,
    ClearEmergencyStop,
    Disarm,
    EmergencyStop,
    Intent,
    Request,
)
from firmware_bridge.mavlink.frames import Codec
from firmware_bridge.motion.pose import Pose
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.safety.snapshot import ActiveInterlock, Snapshot
from firmware_bridge.teleop.operator_link import OperatorLink
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from hil_tests.safety import gate_bench

RARS = robot_types.find("rars")
CYCLE = 50 * MILLISECOND


def mission(*steps: str, head: str = "") -> Mission:
    """Make a mission of lines such as "1.0 speed_mps = 0.3; steer_deg = 20"; the keys are the title."""
    text = f'title = "t"\nduration_s = 100.0\n{head}'
    for step in steps:
        at, keys = step.split(" ", 1)
        text += f"\n[[step]]\nat_s = {at}\ntitle = '{keys}'\n" + keys.replace("; ", "\n") + "\n"
    return parse(text)


def parse(text: str, file: str = "test.toml") -> Mission:
    return missions.parse(text, file, RARS, BENCH_SETUP)


def find(name: str) -> Mission:
    return missions.find(name, RARS, BENCH_SETUP)


@dataclass
class Robotlike:
    """The bridge as far as an operator sees it: OperatorLink, an arming switch, and a cycle of 50 ms."""

    robot: AnyRobot = RARS
    armed: bool = False
    stopped: bool = False
    requests: list[Request] = field(default_factory=list)
    refusals: int = 0
    not_receiving: bool = False
    pose: Pose = field(default_factory=Pose)
    interlock_events: tuple[ActiveInterlock, ...] = ()

    def __post_init__(self) -> None:
        rolling = ROBOT_TYPE.rules(self.robot)[""].kinematics.rolling
        self.operator: OperatorLink = OperatorLink(
            self.robot, ROBOT_TYPE.station, ROBOT_TYPE.standstill, rolling=rolling
        )

    def decide(self, request: Request) -> Answer:
        self.requests.append(request)
        if self.refusals:
            self.refusals -= 1
            return Answer(accepted=False, reason="enabling the drives again, arm again", temporary=True)
        match request:
            case Arm() if self.stopped:
                return Answer(accepted=False, reason="the emergency stop is latched")
            case Arm() | Disarm():
                self.armed = isinstance(request, Arm)
            case EmergencyStop() | ClearEmergencyStop():
                self.stopped = isinstance(request, EmergencyStop)
                self.armed = self.armed and not self.stopped
        return Answer(accepted=True, reason="")

    def receive(self, payload: bytes, now: Nanoseconds) -> tuple[Packet, ...]:
        return () if self.not_receiving else self.operator.receive(payload, now, self.decide)

    def report(self, now: Nanoseconds) -> tuple[Packet, ...]:
        reported = gate_bench.well(
            self.robot,
            now,
            armed=self.armed,
            emergency_stopped=self.stopped,
            steer_rad=0.1,
            lift_m=0.2,
            speed_mps=0.3,
        )
        snapshot = Snapshot(
            facts=reported.facts,
            command=self.operator.intent.command,
            commanded=reported.commanded,
            body=replace(reported.body, yaw_rate_rad_s=0.4),
            pose=self.pose,
        )
        return self.operator.report(snapshot, self.interlock_events, now)


@dataclass
class Joined:
    """Both ends on a wire without length; every datagram of the operator is kept with its time."""

    driver: ScriptedOperator
    robotlike: Robotlike = field(default_factory=Robotlike)
    now: Nanoseconds = 0
    wake_at: Nanoseconds = 0
    cycle_at: Nanoseconds = 0
    sent: list[tuple[Nanoseconds, bytes]] = field(default_factory=list)

    def run(self, until_s: float) -> Intent:
        until = from_seconds(until_s)
        while min(self.wake_at, self.cycle_at) <= until:
            if self.wake_at <= self.cycle_at:
                self.now = self.wake_at
                self._carry(self.driver.wake(self.now))
                assert self.wake_at > self.now, "a node must let time pass"
            else:
                self.now = self.cycle_at
                self.cycle_at += CYCLE
                self._answer(self.robotlike.report(self.now))
        return self.robotlike.operator.intent

    def messages(self, kind: str) -> list[tuple[Nanoseconds, Any]]:
        codec = Codec(9, 9)
        return [
            (at, one) for at, payload in self.sent for one in codec.decode(payload) if one.get_type() == kind
        ]

    def _carry(self, reaction: Reaction) -> None:
        self.wake_at = reaction.wake_at
        for packet in reaction.sent:
            assert (packet.link, packet.address) == (OPERATOR, 0)
            self.sent.append((self.now, packet.payload))
            self._answer(self.robotlike.receive(packet.payload, self.now))

    def _answer(self, packets: tuple[Packet, ...]) -> None:
        for packet in packets:
            assert (packet.link, packet.address) == (OPERATOR, 0)
            self._carry(self.driver.receive(packet, self.now))


def join(script: Mission, seed: int = 1) -> Joined:
    return Joined(ScriptedOperator(RARS, BENCH_SETUP, script, np.random.default_rng(seed)))
