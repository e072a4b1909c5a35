"""The scripted operator, joined directly to the bridge's Operator: both ends real, only the wire is short."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from emulators.bench.diary import Kind
from emulators.bench.hand import Ramp, Tremor
from emulators.bench.mission import Mission, find, parse
from emulators.bench.operator import ScriptedOperator
from emulators.bench.strays import Stray
from firmware_bridge import robot as robots
from firmware_bridge.intent import Arm, ClearEmergencyStop, Disarm, EmergencyStop, Intent, Request, Verdict
from firmware_bridge.motion.odometry import Pose
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Robot
from firmware_bridge.safety.snapshot import DriveSnapshot, Hold, Snapshot
from firmware_bridge.teleop.mavlink import Codec, dialect
from firmware_bridge.teleop.operator import Operator
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, from_seconds
from firmware_bridge.wire.cia402 import State

RARS = robots.find("rars")
CYCLE = 50 * MILLISECOND


def mission(*steps: str, head: str = "") -> Mission:
    """Make a mission of lines such as "1.0 speed_mps = 0.3; steer_deg = 20"; the keys are the title."""
    text = f'title = "t"\nduration_s = 100.0\n{head}'
    for step in steps:
        at, keys = step.split(" ", 1)
        text += f"\n[[step]]\nat_s = {at}\ntitle = '{keys}'\n" + keys.replace("; ", "\n") + "\n"
    return parse(text, "test.toml", RARS)


@dataclass
class Robotlike:
    """The bridge as far as an operator sees it: Operator, an arming switch, and a cycle of 50 ms."""

    robot: Robot = RARS
    armed: bool = False
    stopped: bool = False
    requests: list[Request] = field(default_factory=list)
    refusals: int = 0
    deaf: bool = False
    pose: Pose = field(default_factory=Pose)
    holds: tuple[Hold, ...] = ()

    def __post_init__(self) -> None:
        self.operator = Operator(self.robot)

    def decide(self, request: Request) -> Verdict:
        self.requests.append(request)
        if self.refusals:
            self.refusals -= 1
            return Verdict(accepted=False, reason="enabling the drives again, arm again", temporary=True)
        match request:
            case Arm() if self.stopped:
                return Verdict(accepted=False, reason="the emergency stop is latched")
            case Arm() | Disarm():
                self.armed = isinstance(request, Arm)
            case EmergencyStop() | ClearEmergencyStop():
                self.stopped = isinstance(request, EmergencyStop)
                self.armed = self.armed and not self.stopped
        return Verdict(accepted=True, reason="")

    def hear(self, payload: bytes, now: Nanoseconds) -> tuple[bytes, ...]:
        return () if self.deaf else self.operator.hear(payload, now, self.decide)

    def report(self, now: Nanoseconds) -> tuple[bytes, ...]:
        drives = tuple(
            DriveSnapshot(axis.name, axis.node, State.OPERATION_ENABLED, now, 0, 0.0, 0, 0)
            for axis in self.robot.axes
        )
        snapshot = Snapshot(
            now=now,
            intent=self.operator.intent,
            armed=self.armed,
            emergency_stopped=self.stopped,
            drives=drives,
            steer_rad=0.1,
            lift_m=0.2,
            speed_mps=0.3,
            yaw_rate_rad_s=0.4,
            pose=self.pose,
            demanded_speed_mps=0.0,
            battery_v=24.0,
        )
        return self.operator.report(snapshot, self.holds, now)


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
            self._answer(self.robotlike.hear(packet.payload, self.now))

    def _answer(self, payloads: tuple[bytes, ...]) -> None:
        for payload in payloads:
            self._carry(self.driver.receive(Packet(OPERATOR, 0, payload), self.now))


def join(script: Mission, seed: int = 1) -> Joined:
    return Joined(ScriptedOperator(RARS, script, np.random.default_rng(seed)))


@pytest.fixture
def generators() -> Iterator[np.random.Generator]:
    return (np.random.default_rng(seed) for seed in range(10))


def test_heartbeats_and_sticks_come_at_their_rates() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.run(4.99)
    assert [at for at, _ in joined.messages("HEARTBEAT")] == [n * SECOND for n in range(5)]
    assert [at for at, _ in joined.messages("MANUAL_CONTROL")] == [n * CYCLE for n in range(100)]


def test_the_station_is_a_station() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.run(0.5)
    [(_, heartbeat)] = joined.messages("HEARTBEAT")
    assert (heartbeat.type, heartbeat.autopilot, heartbeat.get_srcSystem(), heartbeat.get_srcComponent()) == (
        6,
        8,
        255,
        190,
    )


@pytest.mark.parametrize("how", ["stick", "twist"])
@pytest.mark.parametrize(
    ("speed", "steer_deg"), [(0.3, 20.0), (0.3, -20.0), (-0.3, 20.0), (-0.3, -20.0), (0.5, 0.0)]
)
def test_what_the_mission_says_is_what_the_bridge_understands(
    how: str, speed: float, steer_deg: float
) -> None:
    joined = join(mission(f"1.0 speed_mps = {speed}; steer_deg = {steer_deg}", head=f'input = "{how}"\n'))
    assert joined.run(0.99).speed_mps == 0.0
    intent = joined.run(1.0)
    assert intent.speed_mps == pytest.approx(speed, abs=0.00026)
    assert math.degrees(intent.steer_rad) == pytest.approx(steer_deg, abs=0.031)


@pytest.mark.parametrize("how", ["stick", "twist"])
@pytest.mark.parametrize("radius", [1.5, -0.8])
def test_a_radius_is_steered(how: str, radius: float) -> None:
    joined = join(mission(f"1.0 speed_mps = 0.3; radius_m = {radius}", head=f'input = "{how}"\n'))
    steer = joined.run(2.0).steer_rad
    # R = a_k / 2 + w cot(theta) (thesis 2.13)
    assert 0.105 + 0.515 / math.tan(abs(steer)) == pytest.approx(abs(radius), rel=2e-3)
    assert math.copysign(1.0, steer) == math.copysign(1.0, radius)


def test_a_twist_can_ask_for_more_than_the_limits() -> None:
    joined = join(mission("1.0 speed_mps = 0.8; steer_deg = 80.0", head='input = "twist"\n'))
    intent = joined.run(2.0)
    assert intent.speed_mps == pytest.approx(0.8)
    assert math.degrees(intent.steer_rad) == pytest.approx(80.0, abs=0.01)


def test_the_line_accelerates_as_in_the_thesis() -> None:
    joined = join(find("line", RARS))
    speeds = {at: joined.run(at).speed_mps for at in (4.0, 9.0, 14.0, 18.9, 24.0, 29.0, 31.0)}
    expected = {4.0: 0.0, 9.0: 0.12, 14.0: 0.24, 18.9: 0.24, 24.0: 0.12, 29.0: 0.0, 31.0: 0.0}
    assert speeds == pytest.approx(expected, abs=0.00026)
    assert joined.robotlike.requests == [Arm(), Disarm()]


@pytest.mark.parametrize(
    ("step", "request_"),
    [
        ("arm = true", Arm()),
        ("disarm = true", Disarm()),
        ("force_disarm = true", Disarm(force=True)),
        ("emergency_stop = true", EmergencyStop()),
        ("clear = true", ClearEmergencyStop()),
        ("terminate = true", EmergencyStop(final=True)),
        ('press = "emergency_stop"', EmergencyStop()),
    ],
)
def test_each_request_reaches_the_bridge_once(step: str, request_: Request) -> None:
    joined = join(mission(f"1.0 {step}"))
    joined.run(3.0)
    assert set(joined.robotlike.requests) == {request_}
    assert len(joined.robotlike.requests) == 1


def test_lift_lamp_and_detector() -> None:
    joined = join(mission("1.0 arm = true", "2.0 lift_m = 0.4; headlamp = true; detector = true"))
    intent = joined.run(2.1)
    assert intent.lift_m == pytest.approx(0.4, abs=1e-6)
    assert (intent.headlamp, intent.detector) == (True, True)
    assert joined.driver.diary.texts(Kind.ANSWERED) == [
        "arm: accepted", "headlamp: accepted", "detector: accepted", "lift: accepted",
    ]  # fmt: skip


def test_buttons_are_tapped() -> None:
    joined = join(mission('1.0 press = "headlamp"', '2.0 press = "detector"'))
    assert (joined.run(1.5).headlamp, joined.run(1.5).detector) == (True, False)
    assert (joined.run(2.5).headlamp, joined.run(2.5).detector) == (True, True)


def test_the_lift_moves_by_stick_until_told_otherwise() -> None:
    joined = join(mission("1.0 lift_rate_mps = -0.05", "2.0 lift_rate_mps = 0.0"))
    assert joined.run(1.5).lift_rate_mps == pytest.approx(-0.05)
    assert joined.run(2.5).lift_rate_mps == 0.0


def test_silence_is_total_and_ends() -> None:
    joined = join(mission("1.0 speed_mps = 0.3", "2.0 silent_s = 1.5", "2.5 arm = true"))
    assert joined.run(3.4).heard_at == from_seconds(1.95)
    assert not [at for at, _ in joined.sent if 2 * SECOND <= at < from_seconds(3.5)]
    assert joined.run(3.5).heard_at == from_seconds(3.5)
    joined.run(5.0)
    assert joined.robotlike.requests == [Arm()]
    assert [at for at, _ in joined.messages("HEARTBEAT")] == [n * SECOND for n in (0, 1, 4, 5)]


def test_a_command_without_an_answer_is_repeated_and_given_up() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.robotlike.deaf = True
    joined.run(10.0)
    orders = joined.messages("COMMAND_LONG")
    assert [(at, one.confirmation) for at, one in orders] == [
        (from_seconds(1.0), 0), (from_seconds(1.5), 1), (from_seconds(2.0), 2), (from_seconds(2.5), 3),
    ]  # fmt: skip
    assert joined.driver.diary.texts(Kind.UNANSWERED) == ["arm"]


def test_what_is_rejected_for_the_moment_is_asked_again_as_new() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.robotlike.refusals = 3
    joined.run(4.0)
    assert joined.robotlike.armed
    assert [one.confirmation for _, one in joined.messages("COMMAND_LONG")] == [0, 0, 0, 0]
    assert joined.driver.diary.texts(Kind.ANSWERED) == ["arm: temporarily rejected", "arm: accepted"]


def test_an_operator_gives_up_what_is_rejected_for_ever() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.robotlike.refusals = 1000
    joined.run(30.0)
    assert len(joined.robotlike.requests) == 21


def test_a_refusal_and_its_reason_are_in_the_diary() -> None:
    joined = join(mission("1.0 emergency_stop = true", "2.0 arm = true"))
    joined.run(3.0)
    diary = joined.driver.diary
    assert diary.texts(Kind.STEP) == ["emergency_stop = true", "arm = true"]
    assert diary.texts(Kind.ANSWERED) == ["emergency stop: accepted", "arm: denied"]
    [told] = [entry for entry in diary.entries if entry.kind is Kind.TOLD]
    assert (told.at, told.text, told.severity) == (2 * SECOND, "the emergency stop is latched", 4)


def test_long_texts_are_read_whole() -> None:
    joined = join(mission("1.0 arm = true"))
    reason = "a reason that is much longer than the fifty characters of one STATUSTEXT, to be sure"
    joined.robotlike.holds = (Hold("long", reason, "", 0),)
    joined.run(0.1)
    assert joined.driver.diary.texts(Kind.TOLD) == [reason]


def test_arming_shows_in_the_heartbeat() -> None:
    joined = join(mission("1.5 arm = true"))
    seen = []
    for until_s in (1.0, 2.1):
        joined.run(until_s)
        seen.append(joined.driver.diary.armed)
    assert seen == [False, True]
    assert joined.driver.diary.texts(Kind.STATUS) == ["disarmed", "armed"]


def test_odometry_arrives_in_the_robots_own_signs() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.robotlike.pose = Pose(1.0, 2.0, 0.5)
    joined.run(0.1)
    place = joined.driver.diary.odometry[-1]
    assert (place.measured_at, place.x_m, place.y_m) == (100 * MILLISECOND, 1.0, 2.0)
    assert (place.heading_rad, place.speed_mps, place.yaw_rate_rad_s) == pytest.approx(
        (0.5, 0.3, 0.4), abs=1e-6
    )


def test_values_and_parameters_are_read() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.run(1.0)
    diary = joined.driver.diary
    assert diary.values["STEER"] == pytest.approx(math.degrees(0.1), abs=1e-5)
    assert diary.values["ZPOS"] == pytest.approx(0.2)
    assert diary.parameters["SPD_MAX"] == 0.5
    assert len(diary.parameters) == 18


def test_an_answer_to_another_station_is_not_ours() -> None:
    joined = join(mission("1.0 arm = true"))
    robot = Codec(1, 1)
    joined.robotlike.deaf = True
    joined.run(1.1)
    other = robot.encode(dialect.MAVLink_command_ack_message(400, 0, 0, 0, 254, 190))
    joined.driver.receive(Packet(OPERATOR, 0, other), joined.now)
    joined.run(2.0)
    assert len(joined.messages("COMMAND_LONG")) == 3


def test_another_system_is_not_our_robot() -> None:
    joined = join(mission("1.0 arm = true"))
    stranger = Codec(7, 1).encode(dialect.MAVLink_statustext_message(2, b"boo"))
    joined.driver.receive(Packet(OPERATOR, 0, stranger), 0)
    joined.driver.receive(Packet(OPERATOR, 0, b"\xfd junk"), 0)
    assert joined.driver.diary.entries == []


@pytest.mark.parametrize("stray", list(Stray))
def test_a_stray_moves_nothing(stray: Stray) -> None:
    joined = join(mission(f'1.02 stray = "{stray}"'))
    intent = joined.run(1.04)
    assert replace(intent, heard_at=0) == Intent(heard_at=0)
    assert joined.robotlike.requests == []
    operator = joined.robotlike.operator
    told = joined.driver.diary.texts(Kind.TOLD) + joined.driver.diary.texts(Kind.ANSWERED)
    assert told or operator.counters.corrupt or operator.dropped.foreign


def test_the_hand_trembles_only_while_it_drives_and_by_the_seed() -> None:
    def sticks(seed: int) -> list[tuple[int, int]]:
        joined = join(mission("1.0 speed_mps = 0.3", head="[noise]\nstick = 0.01\n"), seed)
        joined.run(60.0)
        return [(one.x, one.r) for _, one in joined.messages("MANUAL_CONTROL")]

    assert sticks(1) == sticks(1)
    assert sticks(1) != sticks(2)
    still, moving = sticks(1)[:20], sticks(1)[20:]
    assert set(still) == {(0, 0)}
    assert abs(np.corrcoef([x for x, _ in moving], [r for _, r in moving])[0, 1]) < 0.5
    assert np.mean([x for x, _ in moving]) == pytest.approx(600, abs=5)
    assert np.std([x for x, _ in moving]) == pytest.approx(10, rel=0.35)
    assert np.std([r for _, r in moving]) == pytest.approx(10, rel=0.35)


def test_without_noise_no_random_number_is_drawn() -> None:
    generator = np.random.default_rng(1)
    before = generator.bit_generator.state
    joined = Joined(ScriptedOperator(RARS, find("line", RARS), generator))
    joined.run(30.0)
    assert generator.bit_generator.state == before


def test_two_runs_send_the_same_bytes() -> None:
    def run() -> list[tuple[Nanoseconds, bytes]]:
        joined = join(find("interlocks", RARS), seed=3)
        joined.run(102.0)
        return joined.sent

    assert run() == run()


def test_every_shipped_mission_runs_to_its_end() -> None:
    for name in ("line", "circles", "interlocks"):
        script = find(name, RARS)
        joined = join(script)
        joined.run(script.duration_s)
        assert len(joined.driver.diary.texts(Kind.STEP)) == len(script.step)


def test_a_ramp_changes_its_mind_without_a_jump() -> None:
    ramp = Ramp()
    ramp.go(1.0, 0.1, 0)
    assert ramp.at(5 * SECOND) == pytest.approx(0.5)
    ramp.go(0.0, 0.2, 5 * SECOND)
    assert ramp.at(6 * SECOND) == pytest.approx(0.3)
    assert ramp.at(60 * SECOND) == 0.0
    ramp.go(-1.0, None, 60 * SECOND)
    assert ramp.at(60 * SECOND) == -1.0


def test_a_tremor_keeps_its_deviation_at_any_rate(generators: Iterator[np.random.Generator]) -> None:
    for period in (10 * MILLISECOND, 50 * MILLISECOND, SECOND):
        tremor = Tremor(0.01, period, next(generators))
        assert np.std([tremor.step() for _ in range(20_000)]) == pytest.approx(0.01, rel=0.1)
