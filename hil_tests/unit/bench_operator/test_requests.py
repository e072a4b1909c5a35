"""Requests: each reaches the bridge once, is repeated until it is answered, and is given up in the end."""

import pytest

from emulators.bench.foreign_datagrams import Stray
from emulators.bench.log import Subject
from firmware_bridge.intent import Arm, ClearEmergencyStop, Disarm, EmergencyStop, Request
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.robots.rars.motion import RarsMotion
from firmware_bridge.units import SECOND, from_seconds
from hil_tests.unit.bench_operator.joined import join, mission


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


def test_a_command_without_an_answer_is_repeated_and_given_up() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.robotlike.not_receiving = True
    joined.run(10.0)
    orders = joined.messages("COMMAND_LONG")
    assert [(at, one.confirmation) for at, one in orders] == [
        (from_seconds(1.0), 0), (from_seconds(1.5), 1), (from_seconds(2.0), 2), (from_seconds(2.5), 3),
    ]  # fmt: skip
    assert joined.driver.diary.texts(Subject.UNANSWERED) == ["arm"]


def test_what_is_rejected_for_the_moment_is_requested_again_as_new() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.robotlike.refusals = 3
    joined.run(4.0)
    assert joined.robotlike.armed
    assert [one.confirmation for _, one in joined.messages("COMMAND_LONG")] == [0, 0, 0, 0]
    assert joined.driver.diary.texts(Subject.ANSWERED) == ["arm: temporarily rejected", "arm: accepted"]


def test_an_operator_gives_up_what_is_rejected_for_ever() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.robotlike.refusals = 1000
    joined.run(30.0)
    assert len(joined.robotlike.requests) == 21


def test_an_answer_to_another_station_is_not_ours() -> None:
    joined = join(mission("1.0 arm = true"))
    robot = Codec(1, 1)
    joined.robotlike.not_receiving = True
    joined.run(1.1)
    other = robot.encode(dialect.MAVLink_command_ack_message(400, 0, 0, 0, 254, 190))
    joined.driver.receive(Packet(OPERATOR, 0, other), joined.now)
    joined.run(2.0)
    assert len(joined.messages("COMMAND_LONG")) == 3


@pytest.mark.parametrize("stray", list(Stray))
def test_a_stray_moves_nothing(stray: Stray) -> None:
    joined = join(mission(f'1.02 stray = "{stray}"'))
    intent = joined.run(1.04)
    # Since the hand's stick, which has come before it and holds the steering straight on.
    assert (intent.command, intent.received_at) == (RarsMotion(steer_rad=0.0), SECOND)
    assert joined.robotlike.requests == []
    operator = joined.robotlike.operator
    reported = joined.driver.diary.texts(Subject.REPORTED) + joined.driver.diary.texts(Subject.ANSWERED)
    assert reported or operator.counters.corrupt or operator.dropped.foreign
