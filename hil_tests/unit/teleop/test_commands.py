"""Each row of the command table: its request to the bridge, and its answer."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from firmware_bridge.intent import (
    Answer,
    Arm,
    ChangeDriver,
    ClearEmergencyStop,
    ConfirmPosition,
    Disarm,
    EmergencyStop,
    EnterMode,
    Pause,
    Request,
    ResetOdometry,
    Resume,
)
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.teleop.commands import ROWS
from hil_tests.unit.teleop.bench import acks, bench_of
from hil_tests.unit.teleop.received import texts

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench

ACCEPTED, TEMPORARILY_REJECTED, DENIED, UNSUPPORTED = 0, 1, 2, 3
NAN = math.nan

# command, parameters, result, requests to the bridge
TABLE: list[tuple[int, tuple[float, ...], int, list[Request]]] = [
    (400, (1,), ACCEPTED, [Arm()]),
    (400, (1, 21196), DENIED, []),
    (400, (1, 5), ACCEPTED, [Arm()]),
    (400, (0,), ACCEPTED, [Disarm()]),
    (400, (0, 21196), ACCEPTED, [Disarm(force=True)]),
    (400, (0, NAN), ACCEPTED, [Disarm()]),
    (400, (2,), DENIED, []),
    (400, (0.5,), DENIED, []),
    (400, (NAN,), DENIED, []),
    (185, (1,), ACCEPTED, [EmergencyStop(final=True)]),
    (185, (0.6,), ACCEPTED, [EmergencyStop(final=True)]),
    (185, (0.5,), DENIED, []),
    (185, (0,), DENIED, []),
    (185, (NAN,), DENIED, []),
    (5300, (0,), ACCEPTED, [EmergencyStop()]),
    (5300, (1,), ACCEPTED, [ClearEmergencyStop()]),
    (5300, (2,), DENIED, []),
    (5300, (NAN,), DENIED, []),
    (179, (1,), ACCEPTED, [ResetOdometry()]),
    (179, (0,), DENIED, []),
    (193, (0,), ACCEPTED, [Pause()]),
    (193, (1,), ACCEPTED, [Resume()]),
    (193, (2,), DENIED, []),
    (193, (NAN,), DENIED, []),
    (252, (0, 2), ACCEPTED, [Pause()]),
    (252, (1,), ACCEPTED, [Resume()]),
    (176, (1, 0), ACCEPTED, [EnterMode("")]),
    (176, (1, 4), ACCEPTED, [Pause()]),
    (176, (1, 4, 3), ACCEPTED, [Pause()]),
    (176, (1, 15), ACCEPTED, [EnterMode("")]),
    (176, (1, 11), DENIED, [Pause()]),
    (410, (), TEMPORARILY_REJECTED, []),
    (176, (1, NAN), DENIED, [Pause()]),
    (31010, (3, 45), ACCEPTED, [ConfirmPosition("steer", 45.0)]),
    (31010, (4, 0.25), ACCEPTED, [ConfirmPosition("lift", 0.25)]),
    (31010, (1, 0), ACCEPTED, [ConfirmPosition("left", 0.0)]),
    (31010, (), ACCEPTED, [ConfirmPosition("axis 0", 0.0)]),
    (31010, (5, 0), ACCEPTED, [ConfirmPosition("axis 5", 0.0)]),
    (31010, (-1, 0), ACCEPTED, [ConfirmPosition("axis -1", 0.0)]),
    (31010, (3.5, 0), ACCEPTED, [ConfirmPosition("axis 3.5", 0.0)]),
    (31010, (NAN, 0), ACCEPTED, [ConfirmPosition("axis nan", 0.0)]),
    (262, (1,), ACCEPTED, [Pause()]),
    (262, (5,), DENIED, [Pause()]),
    (262, (NAN,), DENIED, [Pause()]),
    (246, (1,), UNSUPPORTED, []),
    (420, (105, 1), DENIED, []),
    (420, (NAN, NAN), DENIED, []),
    (32100, (1,), ACCEPTED, [ChangeDriver()]),
    (32100, (0,), DENIED, []),
    (32100, (2,), DENIED, []),
    (20, (), UNSUPPORTED, []),
    (519, (1,), UNSUPPORTED, []),
    (0, (), UNSUPPORTED, []),
    (65535, (), UNSUPPORTED, []),
]


@pytest.mark.parametrize(("command", "params", "result", "requested"), TABLE)
def test_a_command_is_answered_once_and_requests_this(
    bench: RarsBench, command: int, params: tuple[float, ...], result: int, requested: list[Request]
) -> None:
    replies = bench.order(command, *params)
    assert acks(replies) == [(command, result)]
    assert bench.requested == requested
    assert bool(texts(replies)) is (result in (DENIED, TEMPORARILY_REJECTED) or command == 246)


@pytest.mark.parametrize(("command", "params", "result", "requested"), TABLE)
def test_the_other_message_for_commands_does_the_same(
    bench: RarsBench, command: int, params: tuple[float, ...], result: int, requested: list[Request]
) -> None:
    four = (*params, *(0.0,) * (4 - len(params)))
    replies = bench.say(dialect.MAVLink_command_int_message(1, 1, 0, command, 0, 0, *four, 0, 0, 0.0))
    assert acks(replies) == [(command, result)]
    assert bench.requested == requested


def test_every_row_is_tested_here() -> None:
    reported = {row[0] for row in TABLE} | {181, 187, 405, 510, 511, 512, 520}
    assert {row.command for row in ROWS} <= reported


@pytest.mark.parametrize(
    ("verdict", "result"),
    [
        (Answer(accepted=True, reason="armed"), ACCEPTED),
        (Answer(accepted=False, reason="the emergency stop is latched"), DENIED),
        (
            Answer(accepted=False, reason="enabling the drives again", temporary=True),
            TEMPORARILY_REJECTED,
        ),
    ],
)
def test_the_bridges_verdict_and_its_reason_reach_the_operator(
    bench: RarsBench, verdict: Answer, result: int
) -> None:
    bench.verdict = verdict
    replies = bench.order(400, 1)
    assert acks(replies) == [(400, result)]
    assert "".join(texts(replies)) == ("" if verdict.accepted else verdict.reason)


def test_an_ack_names_the_one_who_requested(bench: RarsBench) -> None:
    [ack] = bench.order(400, 1)
    assert (ack.target_system, ack.target_component) == (255, 190)
    assert (ack.get_srcSystem(), ack.get_srcComponent()) == (1, 1)


def test_a_repetition_is_answered_and_not_obeyed_again(bench: RarsBench) -> None:
    first = bench.order(400, 1, confirmation=0)
    again = bench.order(400, 1, confirmation=1)
    assert acks(first) == acks(again) == [(400, ACCEPTED)]
    assert bench.requested == [Arm()]


@pytest.mark.parametrize(
    ("command", "params", "request_"),
    [
        pytest.param(400, (0,), Disarm(), id="disarm"),
        pytest.param(400, (0, 21196), Disarm(force=True), id="forced disarm"),
        pytest.param(185, (1,), EmergencyStop(final=True), id="termination"),
        pytest.param(5300, (0,), EmergencyStop(), id="safety switch"),
        pytest.param(193, (0,), Pause(), id="pause"),
        pytest.param(252, (0,), Pause(), id="override goto"),
        pytest.param(176, (1, 4), Pause(), id="Hold"),
        pytest.param(176, (1, 4, 3), Pause(), id="Hold by PX4's numbers"),
        pytest.param(262, (1,), Pause(), id="standard mode"),
    ],
)
def test_a_repetition_that_stops_is_obeyed_again(
    bench: RarsBench, command: int, params: tuple[float, ...], request_: Request
) -> None:
    """Someone may have cleared the stop, or armed, in between."""
    for confirmation in range(3):
        assert acks(bench.order(command, *params, confirmation=confirmation)) == [(command, ACCEPTED)]
    assert bench.requested == [request_] * 3


def test_a_repetition_whose_first_was_lost_is_obeyed(bench: RarsBench) -> None:
    assert acks(bench.order(400, 1, confirmation=1)) == [(400, ACCEPTED)]
    assert bench.requested == [Arm()]


@pytest.mark.parametrize(
    ("later_ns", "params"), [(3_000_000_000, (1.0,)), (0, (0.0,))], ids=["too late", "other parameters"]
)
def test_what_is_no_repetition_is_obeyed(bench: RarsBench, later_ns: int, params: tuple[float, ...]) -> None:
    bench.order(400, 1, confirmation=0)
    bench.now += later_ns
    bench.order(400, *params, confirmation=1)
    assert len(bench.requested) == 2


def test_the_same_command_requested_again_is_obeyed_again(bench: RarsBench) -> None:
    bench.order(400, 1)
    bench.order(400, 1)
    assert bench.requested == [Arm(), Arm()]


@pytest.mark.parametrize(
    ("command", "params", "result", "lamp_and_detector"),
    [
        (405, (1,), ACCEPTED, (True, False)),
        (405, (0,), ACCEPTED, (False, False)),
        (405, (2,), DENIED, (False, False)),
        (181, (0, 1), ACCEPTED, (False, True)),
        (181, (1, 1), ACCEPTED, (True, False)),
        (181, (2, 1), DENIED, (False, False)),
        (181, (0, 2), DENIED, (False, False)),
        (181, (0, NAN), DENIED, (False, False)),
    ],
)
def test_lamp_and_detector(
    bench: RarsBench,
    command: int,
    params: tuple[float, ...],
    result: int,
    lamp_and_detector: tuple[bool, bool],
) -> None:
    assert acks(bench.order(command, *params)) == [(command, result)]
    assert (bench.command.headlamp, bench.command.detector) == lamp_and_detector


# N l (sin 45 - sin 5) = 6 x 0.3 m x 0.61995 (thesis 2.16)
TRAVEL = 1.11591


@pytest.mark.parametrize(("share", "height"), [(-1, 0.0), (0, TRAVEL / 2), (1, TRAVEL), (-0.5, TRAVEL / 4)])
def test_the_lift_goes_to_a_share_of_its_travel(bench: RarsBench, share: float, height: float) -> None:
    bench.order(400, 1)
    bench.report()
    assert acks(bench.order(187, share)) == [(187, ACCEPTED)]
    assert bench.command.lift_m == pytest.approx(height, abs=1e-5)


@pytest.mark.parametrize(
    "params", [(1.001,), (-1.001,), (NAN,), (0, 0, 0, 0, 0, 0, 1), (0, 0, 0, 0, 0, 0, NAN)]
)
def test_a_lift_command_that_cannot_be_meant_is_denied(bench: RarsBench, params: tuple[float, ...]) -> None:
    bench.order(400, 1)
    bench.report()
    assert acks(bench.order(187, *params)) == [(187, DENIED)]
    assert bench.command.lift_m is None


def test_a_disarmed_robot_keeps_no_lift_target_for_later(bench: RarsBench) -> None:
    bench.report()
    assert acks(bench.order(187, 0.5)) == [(187, DENIED)]
    bench.order(400, 1)
    bench.report()
    bench.order(187, 0.5)
    bench.order(5300, 0)
    assert bench.command.lift_m is None


def test_a_reboot_from_afar_does_not_happen(bench: RarsBench) -> None:
    bench.order(400, 1)
    bench.report()
    assert acks(bench.order(246, 1)) == [(246, DENIED)]


@pytest.mark.parametrize(
    "number", [0, 1, 24, 30, 32, 33, 74, 147, 148, 242, 245, 251, 252, 331, 350, 435, 436, 437, 9000]
)
def test_a_message_is_sent_on_request(bench: RarsBench, number: int) -> None:
    bench.report()
    replies = bench.order(512, number)
    assert replies[0].get_msgId() == number
    assert acks(replies) == [(512, ACCEPTED)]


@pytest.mark.parametrize("number", [2, 300, 397, 999_999, -1, 0.5, NAN, math.inf])
def test_a_message_that_we_lack_is_unsupported(bench: RarsBench, number: float) -> None:
    bench.report()
    assert [one.get_type() for one in bench.order(512, number)] == ["COMMAND_ACK"]
    assert acks(bench.order(512, number)) == [(512, UNSUPPORTED)]


def test_capabilities_are_reported_on_request(bench: RarsBench) -> None:
    version, ack = bench.order(520, 1)
    # COMMAND_INT, SET_POSITION_TARGET_LOCAL_NED, FLIGHT_TERMINATION, MAVLINK2, C-cast parameters
    assert version.capabilities == 8 + 128 + 2048 + 8192 + 131072
    assert version.flight_sw_version >> 8 == 0x000100
    assert ack.result == ACCEPTED
    assert acks(bench.order(520, 0)) == [(520, ACCEPTED)]


def test_the_rate_of_a_message_can_be_changed(bench: RarsBench) -> None:
    def count() -> int:
        return sum(one.get_msgId() == 331 for _ in range(20) for one in bench.report())

    assert count() == 20
    assert acks(bench.order(511, 331, 500_000)) == [(511, ACCEPTED)]
    assert count() == 3  # at once, after 0.5 s and after 1 s
    assert acks(bench.order(511, 331, -1)) == [(511, ACCEPTED)]
    assert count() == 0
    assert acks(bench.order(511, 331, 0)) == [(511, ACCEPTED)]
    assert count() == 20


@pytest.mark.parametrize(
    ("params", "result"),
    [
        ((331, NAN), DENIED),
        ((331, -2), DENIED),
        ((331, math.inf), DENIED),
        ((0, -1), DENIED),
        ((0, 0), ACCEPTED),
        ((331, 1), ACCEPTED),
        ((2, 1000), UNSUPPORTED),
        ((NAN, 1000), UNSUPPORTED),
    ],
)
def test_rates_that_make_no_sense_are_refused(
    bench: RarsBench, params: tuple[float, ...], result: int
) -> None:
    assert acks(bench.order(511, *params)) == [(511, result)]


@pytest.mark.parametrize(("number", "interval_us"), [(331, 50_000), (0, 1_000_000), (147, 2_000_000), (2, 0)])
def test_the_rate_of_a_message_is_reported(bench: RarsBench, number: int, interval_us: int) -> None:
    reported, ack = bench.order(510, number)
    assert (reported.get_type(), reported.message_id, reported.interval_us) == (
        "MESSAGE_INTERVAL",
        number,
        interval_us,
    )
    assert ack.result == ACCEPTED


def test_a_message_that_is_off_is_reported_as_off(bench: RarsBench) -> None:
    bench.order(511, 331, -1)
    assert bench.order(510, 331)[0].interval_us == -1
    bench.order(511, 331, 1e30)
    assert bench.order(510, 331)[0].interval_us == 0x7FFF_FFFF
    assert acks(bench.order(510, 70_000)) == [(510, DENIED)]


def test_old_mode_messages_are_answered_under_their_own_number(bench: RarsBench) -> None:
    assert acks(bench.say(dialect.MAVLink_set_mode_message(1, 1, 0))) == [(11, ACCEPTED)]
    assert acks(bench.say(dialect.MAVLink_set_mode_message(1, 0x81, 16))) == [(11, DENIED)]
    assert acks(bench.say(dialect.MAVLink_set_mode_message(1, 1, 4))) == [(11, ACCEPTED)]
    assert bench.requested == [EnterMode(""), Pause(), Pause()]


def test_a_mode_that_cannot_be_entered_now_stops_the_robot_nevertheless(bench: RarsBench) -> None:
    bench.verdict = Answer(accepted=False, reason="mode: stop and disarm first", temporary=True)
    assert acks(bench.order(176, 1, 0)) == [(176, TEMPORARILY_REJECTED)]
    assert bench.requested == [EnterMode(""), Pause()]


@pytest.mark.parametrize("target", [(2, 1), (1, 2), (255, 0)])
def test_commands_for_others_are_left_alone(bench: RarsBench, target: tuple[int, int]) -> None:
    assert bench.order(400, 1, target=target) == []
    assert bench.requested == []
    assert bench.operator.dropped.foreign == 1


@pytest.mark.parametrize("target", [(0, 0), (1, 0), (0, 1), (1, 1)])
def test_commands_for_everybody_are_for_us(bench: RarsBench, target: tuple[int, int]) -> None:
    assert acks(bench.order(400, 1, target=target)) == [(400, ACCEPTED)]


def test_a_mode_that_set_mode_requests_in_vain_comes_with_the_reason(bench: RarsBench) -> None:
    replies = bench.say(dialect.MAVLink_set_mode_message(1, 1, 999))
    assert acks(replies) == [(11, DENIED)]
    assert "".join(texts(replies)) == "".join(texts(bench_of("rars").order(176, 1, 999)))
    assert "there are no others" in "".join(texts(replies))
