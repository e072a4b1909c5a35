"""Another kind of robot on the same operator's side: nothing of RARS is left in it."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge.intent import Answer, EmergencyStop, EnterMode, Pause
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.motion.pose import Pose
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.teleop.incoming import UNUSED
from firmware_bridge.teleop.station import Actuator, Fixed, StationRows, Switch, Value
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import examples
from hil_tests.unit.teleop.bench import acks, event
from hil_tests.unit.teleop.received import texts, types
from hil_tests.unit.teleop.toy import MODES, ROWS, Felt, Glide, ToyBench, toy

ACCEPTED, DENIED, UNSUPPORTED = 0, 2, 3
NAN = math.nan
shares = st.integers(-1000, 1000)


@pytest.fixture
def bench() -> ToyBench:
    return toy()


@given(shares, shares, shares)
def test_a_stick_moves_it_any_way(x: int, y: int, r: int) -> None:
    bench = toy()
    assert bench.stick(x=x, y=y, r=r) == []
    command = bench.command
    assert (command.ahead, command.right, command.spin) == pytest.approx((2e-3 * x, 2e-3 * y, 1e-3 * r))


@pytest.mark.parametrize(
    ("z", "raising"), [(1000, 1.0), (-201, -0.201), (200, 0.0), (-200, 0.0), (0, 0.0), (UNUSED, 0.0)]
)
def test_z_counts_without_a_button_beyond_this_robots_dead_band(
    bench: ToyBench, z: int, raising: float
) -> None:
    bench.stick(z=z)
    assert bench.command.raising == pytest.approx(raising)
    assert texts(bench.stick(z=1001))


def test_a_velocity_goes_sideways_too(bench: ToyBench) -> None:
    assert bench.target(0.5, 0.25, vy=-1.5) == []
    assert bench.command == Glide(0.5, -1.5, 0.25)


@pytest.mark.parametrize(
    ("vx", "vy", "yaw_rate", "fine"),
    [(20.0, 20.0, 0.0, True), (28.3, 0.0, 0.0, False), (0.0, 28.3, 0.0, False), (0.0, 0.0, 31.5, False)],
)
def test_what_is_absurd_hangs_on_its_own_limits(
    bench: ToyBench, vx: float, vy: float, yaw_rate: float, *, fine: bool
) -> None:
    assert bool(texts(bench.target(vx, yaw_rate, vy=vy))) is not fine


def test_its_own_refusal_reaches_the_operator(bench: ToyBench) -> None:
    [text] = texts(bench.target(0.5, mask=3559))[:1]
    assert "SET_POSITION_TARGET_LOCAL_NED refused: this" in text
    assert bench.command == Glide()


def test_its_stop_button_is_another(bench: ToyBench) -> None:
    bench.stick(buttons=0x7FFF)
    assert bench.requested == []
    bench.stick(buttons=0x8000)
    assert bench.requested == [EmergencyStop()]


def test_a_switch_without_a_button_is_switched_by_its_relay_alone(bench: ToyBench) -> None:
    bench.stick()
    bench.stick(buttons=0x7FFF)
    assert (bench.command.water, bench.command.air) == (False, True)
    assert acks(bench.order(181, 7, 1)) == [(181, ACCEPTED)]
    assert acks(bench.order(181, 3, 0)) == [(181, ACCEPTED)]
    assert (bench.command.water, bench.command.air) == (True, False)


@pytest.mark.parametrize("relay", [0, 1, 2, 8, -1, 3.5, NAN, math.inf])
def test_other_relays_are_denied_and_those_that_exist_named(bench: ToyBench, relay: float) -> None:
    replies = bench.order(181, relay, 1)
    assert acks(replies) == [(181, DENIED)]
    assert texts(replies) == ["relay: 7 water, 3 air; there are no others"]
    assert bench.command == Glide()


def test_what_it_lacks_is_unsupported(bench: ToyBench) -> None:
    assert acks(bench.order(405, 1)) == [(405, UNSUPPORTED)]
    bare = StationRows(
        stick=ROWS.stick,
        target=ROWS.target,
        twist=ROWS.twist,
        forgotten=ROWS.forgotten,
        largest=ROWS.largest,
        axes=ROWS.axes,
    )
    bench.rows = bare
    bench.restart()
    assert acks(bench.order(181, 0, 1)) == [(181, UNSUPPORTED)]
    assert acks(bench.order(187, 0)) == [(187, UNSUPPORTED)]
    bench.stick()
    bench.stick(x=100, z=1000, buttons=0xFFFF)
    assert bench.requested == []
    assert bench.command.raising == 1.0
    assert not {"NAMED_VALUE_INT", "WHEEL_DISTANCE"} & set(types(bench.report()))


@pytest.mark.parametrize(
    ("params", "boom", "grip"),
    [
        ((1, 1), 0.25, 0.0),
        ((-1, -1), 0.0, 1.0),
        ((0, NAN), 0.125, None),
        ((NAN, 0.5), None, 0.25),
        ((0, 0, NAN, NAN, 0, 0), 0.125, 0.5),
    ],
)
def test_two_actuators(
    bench: ToyBench, params: tuple[float, ...], boom: float | None, grip: float | None
) -> None:
    bench.order(400, 1)
    bench.report()
    assert acks(bench.order(187, *params)) == [(187, ACCEPTED)]
    assert (bench.command.boom, bench.command.grip) == (boom, grip)


@pytest.mark.parametrize(
    ("params", "named"),
    [
        ((0, 1.01), "gripper: parameter 2"),
        ((1.01, 0), "boom: parameter 1"),
        ((NAN, NAN), "boom: parameter 1"),
        ((0, 0, 0.5), "boom, gripper"),
        ((0, 0, 0, 0, 0, 0, 1), "boom, gripper"),
        ((0, math.inf), "gripper: parameter 2"),
    ],
)
def test_one_part_of_an_actuator_command_that_cannot_be_meant_denies_it_whole(
    bench: ToyBench, params: tuple[float, ...], named: str
) -> None:
    bench.order(400, 1)
    bench.report()
    replies = bench.order(187, *params)
    assert acks(replies) == [(187, DENIED)]
    assert named in "".join(texts(replies))
    assert (bench.command.boom, bench.command.grip) == (None, None)


def test_a_disarmed_robot_moves_no_actuator(bench: ToyBench) -> None:
    bench.report()
    replies = bench.order(187, NAN, 0)
    assert acks(replies) == [(187, DENIED)]
    assert "gripper: arm first" in "".join(texts(replies))


def test_a_change_of_state_forgets_what_the_station_states_and_no_more(bench: ToyBench) -> None:
    bench.order(400, 1)
    bench.report()
    received_at = bench.now
    bench.stick(x=500)
    bench.order(181, 7, 1)
    bench.order(187, 1, 1)
    bench.now += SECOND
    bench.order(179, 1)
    assert bench.command == Glide(ahead=1.0, boom=0.25, grip=0.0, water=True)
    bench.order(400, 0)
    assert bench.command == Glide(ahead=1.0, water=True)
    assert bench.operator.intent.received_at == received_at


@pytest.mark.parametrize(("number", "mode"), [(0, ""), (20, MODES[0]), (21, MODES[1])])
def test_modes_are_requested_by_their_number_and_reported(bench: ToyBench, number: int, mode: str) -> None:
    assert acks(bench.order(176, 1, number)) == [(176, ACCEPTED)]
    assert bench.requested == [EnterMode(mode)]
    assert bench.reported(0).custom_mode == number
    assert acks(bench.say(dialect.MAVLink_set_mode_message(1, 1, number))) == [(11, ACCEPTED)]
    assert bench.requested == [EnterMode(mode)] * 2


@pytest.mark.parametrize("number", [5, -1, 0.5, NAN, math.inf, 1e30])
def test_modes_that_it_lacks_are_denied(bench: ToyBench, number: float) -> None:
    replies = bench.order(176, 1, number)
    assert acks(replies) == [(176, DENIED)]
    assert (
        "".join(texts(replies)).rstrip()
        == "mode: 0 Manual, 15 Guided, 4 Hold, 20 without_port, 21 without_boom; "
        "there are no others; it is paused"
    )
    assert bench.requested == [Pause()]


def test_a_refused_mode_keeps_its_reason(bench: ToyBench) -> None:
    bench.verdict = Answer(accepted=False, reason="disarm first", temporary=True)
    replies = bench.order(176, 1, 1)
    assert (acks(replies), texts(replies)) == ([(176, 1)], ["disarm first"])


def test_its_place_and_speed_are_reported_with_mavlinks_signs(bench: ToyBench) -> None:
    bench.pose = Pose(1.0, 2.0, math.radians(30))
    bench.body = Felt(ahead=0.4, right=0.3, spin=0.2)
    odometry, position = bench.reported(331), bench.reported(32)
    assert (odometry.vx, odometry.vy, odometry.yawspeed) == pytest.approx((0.4, 0.3, 0.2))
    # to the right of a heading of 30 degrees to the left: 60 degrees east of north
    north, east = (math.cos(math.radians(60)), math.sin(math.radians(60)))
    assert position.vx == pytest.approx(0.4 * math.cos(math.radians(30)) + 0.3 * north)
    assert position.vy == pytest.approx(-0.4 * math.sin(math.radians(30)) + 0.3 * east)


def test_its_wheels_values_and_switches_are_reported(bench: ToyBench) -> None:
    bench.axes(
        velocity=[1.0, 2.0, 3.0, 4.0], position=[1.0, -2.0, 4.0, 9.0], current_a=[0.5, None, -1.0, 0.0]
    )
    bench.body = Felt(reach=0.75)
    bench.order(181, 7, 1)
    assert bench.reported(350).data[:4] == [1.0, 2.0, 3.0, 0.0]
    distance = bench.reported(9000)
    assert (distance.count, distance.distance[:4]) == (3, [0.25, -0.5, 1.0, 0.0])
    values = {
        one.name: one.value
        for one in bench.order(512, 251) + bench.order(512, 252)
        if "NAMED" in one.get_type()
    }
    assert values == {"REACH": 0.75, "I1": 0.5, "I3": -1.0, "I4": 0.0, "WATER": 1}
    assert bench.reported(1).current_battery == 150


def test_what_no_device_measures_is_unknown(bench: ToyBench) -> None:
    bench.axes(current_a=[None] * 4)
    system = bench.reported(1)
    assert (system.current_battery, system.voltage_battery) == (-1, 0xFFFF)
    assert not system.onboard_control_sensors_present & dialect.MAV_SYS_STATUS_SENSOR_BATTERY
    assert acks(bench.order(512, 147)) == [(512, UNSUPPORTED)]


def test_its_parameters_are_its_own_and_the_common_ones(bench: ToyBench) -> None:
    bench.say(dialect.MAVLink_param_request_list_message(1, 1))
    listed = [one.param_id for _ in range(10) for one in bench.report() if one.get_type() == "PARAM_VALUE"]
    assert listed == [
        "ROLLER_R", "CMD_TMO", "CYCLE", "MAV_SYSID", "MAV_COMPID", "RATE_ODOM", "RATE_POS", "RATE_ATT",
    ]  # fmt: skip


def test_a_hold_of_its_own_is_as_loud_as_its_row(bench: ToyBench) -> None:
    [text] = [
        one
        for one in bench.report(event("boom out", "it is out", "in", Severity.ALERT))
        if types([one]) == ["STATUSTEXT"]
    ]
    assert (text.severity, text.text) == (1, "it is out; in")


def test_a_fault_in_any_words_is_reported_by_the_axis_and_its_device(bench: ToyBench) -> None:
    bench.axes(fault=["", "", "stalled", ""])
    assert texts(bench.report()) == ["node 3 (steering): fault stalled"]


SWITCH: Any = {"read": lambda command: command.air, "write": lambda command, _: command}


@pytest.mark.parametrize(
    ("rows", "stated"),
    [
        ({"stop_button": 3, "up_button": 3}, "buttons stand twice: 3"),
        ({"stop_button": 16}, "counted from 0 to 15"),
        ({"up_button": -1}, "counted from 0 to 15"),
        (
            {"switches": (Switch("a", relay=1, **SWITCH), Switch("b", relay=1, **SWITCH))},
            "relays stand twice: 1",
        ),
        ({"switches": (Switch("a", relay=1, telemetry="ELEVEN_LONG", **SWITCH),)}, "ELEVEN_LONG"),
        ({"values": (Value("", SECOND, lambda _: 0.0, ""),)}, "1 to 10 letters"),
        ({"values": (Value("h\u00f6he", SECOND, lambda _: 0.0, ""),)}, "ASCII"),
        ({"values": (Value("X", SECOND, lambda _: 0.0, ""),) * 2}, "values stand twice: X"),
        ({"values": (Value("X", 19 * MILLISECOND, lambda _: 0.0, ""),)}, "more often than each 20 ms"),
        ({"parameters": (Fixed("P" * 17, lambda _: 0.0, ""),)}, "1 to 16 letters"),
        ({"actuators": (Actuator("a", lambda command, _share, _robot: command),) * 7}, "at most 6"),
    ],
)
def test_rows_that_mavlink_cannot_carry_are_refused_where_they_are_made(
    rows: dict[str, Any], stated: str
) -> None:
    plain: dict[str, Any] = {
        name: getattr(ROWS, name) for name in ("stick", "target", "twist", "forgotten", "largest")
    }
    with pytest.raises(ValueError, match=stated):
        StationRows(**(plain | rows))


def test_a_parameter_that_all_robots_have_is_not_a_kinds_own(bench: ToyBench) -> None:
    bench.rows = StationRows(
        stick=ROWS.stick,
        target=ROWS.target,
        twist=ROWS.twist,
        forgotten=ROWS.forgotten,
        largest=ROWS.largest,
        parameters=(Fixed("CYCLE", lambda _: 1.0, "s"),),
    )
    with pytest.raises(ValueError, match="CYCLE"):
        bench.restart()


@given(
    st.lists(
        st.one_of(
            st.tuples(st.just("stick"), *[st.integers(-0x8000, 0x7FFF)] * 4, st.integers(0, 0xFFFF)),
            st.tuples(st.just("target"), *[st.floats(width=32)] * 4, st.integers(0, 0xFFFF)),
            st.tuples(
                st.just("order"), *[st.floats(width=32)] * 4, st.sampled_from([176, 181, 187, 405, 400])
            ),
        ),
        max_size=8,
    )
)
@settings(max_examples=examples(200))
def test_whatever_is_stated_it_has_a_command_of_numbers_and_every_command_an_answer(
    stated: list[tuple[Any, ...]],
) -> None:
    bench = toy()
    bench.order(400, 1)
    for kind, *values, word in stated:
        bench.report()
        if kind == "order":
            assert acks(bench.order(word, *values))[0][0] == word
        elif kind == "stick":
            bench.stick(**dict(zip("xyzr", values, strict=True)), buttons=word)
        else:
            vx, yaw_rate, vy, vz = values
            bench.target(vx, yaw_rate, vy=vy, vz=vz, mask=1511 if word & 1 else word)
        command = bench.command
        numbers = (
            command.ahead,
            command.right,
            command.spin,
            command.raising,
            command.boom or 0.0,
            command.grip or 0.0,
        )
        assert all(map(math.isfinite, numbers))
