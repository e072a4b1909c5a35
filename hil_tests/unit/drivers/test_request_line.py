"""One device alone on a line: one request at a time, what waits, what is repeated, and what is given up."""

from collections.abc import Callable

import pytest

from firmware_bridge.drivers.driver import Position, Power, Stop
from firmware_bridge.drivers.life_cycle import DriverState, Task, Transition
from firmware_bridge.drivers.line_driver import LOST
from firmware_bridge.drivers.request_line import TRIES
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot.table import Medium
from firmware_bridge.units import NEVER
from hil_tests.unit.drivers.request_line_bench import ANSWERS, MS, Line, Table, Word


def test_a_table_of_a_line_is_a_serial_port_with_its_latency() -> None:
    table = Table(driver=Word.MADE_UP, silent_ms=250)
    assert (table.medium, table.latency_us, table.kind) == (Medium.SERIAL, 1_000, "made-up")
    assert table.confirmed(50 * MS) == 150 * MS
    assert "9600 Bd" in table.silent_hint


def test_the_bring_up_goes_request_by_request_and_ends_with_power() -> None:
    line = Line()
    assert (line.feedback.power, line.driver.unpowered, line.driver.state) == (
        Power.UNKNOWN,
        False,
        DriverState.UNCONFIGURED,
    )
    line.is_up()
    assert line.sent == [b"q\n", b"i\n", b"off\n", b"c\n", b"q\n", b"go\n", b"on\n"]
    assert (line.feedback.power, line.driver.unpowered, line.driver.state) == (
        Power.ON,
        False,
        DriverState.ACTIVE,
    )
    assert (line.feedback.position, line.feedback.velocity) == (1.0, 0.5)
    assert line.driver.failure is None
    assert line.link.wake_at == NEVER


def test_an_answer_without_a_state_goes_on_and_another_line_does_not() -> None:
    line = Line()
    line.takes(line.driver.begin(Transition.CONFIGURE, 0, Task.IDENTIFY))
    line.receives(b"q=on")
    assert line.busy
    assert line.feedback.power is Power.UNKNOWN
    line.receives(b"i")
    assert not line.busy


def test_an_answer_without_a_state_leaves_the_one_of_before() -> None:
    line = Line().is_up()
    line.driver.command(Position(7.0))
    line.wakes()
    line.receives(b"to 7")
    line.shows(power=Power.ON)
    assert (line.feedback.position, line.feedback.velocity) == (1.0, 0.5)


def test_of_set_points_that_wait_the_newest_is_sent_before_the_sample() -> None:
    line = Line().is_up()
    line.sent.clear()
    line.takes(line.link.sample(line.now))
    for value in (1.0, 2.0, 3.0):
        line.takes(line.driver.command(Position(value)))
    assert line.sent == [b"q\n"]
    line.answers()
    assert line.sent == [b"q\n", b"to 3\n"]
    line.answers()
    assert line.sent == [b"q\n", b"to 3\n"]


def test_a_set_point_is_sent_at_the_next_wake_up_which_is_at_once() -> None:
    line = Line().is_up()
    line.driver.command(Position(7.0))
    assert line.link.wake_at <= line.now
    line.wakes()
    assert line.sent[-1] == b"to 7\n"


def test_a_sample_is_of_the_cycle_that_requested_it_and_a_late_one_is_counted() -> None:
    line = Line().is_up()
    line.now = 50 * MS
    line.takes(line.link.sample(line.now))
    line.now = 100 * MS
    line.takes(line.link.sample(line.now))
    assert line.link.late == 1
    line.answers()
    assert (line.driver.sampled_at, line.feedback.received_at) == (50 * MS, 100 * MS)


def test_a_device_is_looked_for_until_its_time_is_over_and_the_hint_names_the_port() -> None:
    line = Line()
    line.takes(line.driver.begin(Transition.RECOVER, 0))
    while line.busy:
        line.wakes()
    assert line.now >= 500 * MS
    assert set(line.sent) == {b"q\n"}
    assert len(line.sent) == -(-500 * MS // ANSWERS)
    assert "no answer to b'q'" in str(line.driver.failure)


def test_a_task_s_request_is_repeated_and_then_given_up() -> None:
    line = Line().is_up()
    line.sent.clear()
    line.takes(line.driver.begin(Transition.POWER_OFF, line.now))
    while line.busy:
        line.wakes()
    assert line.sent == [b"off\n"] * TRIES
    assert not line.driver.unpowered


def test_a_set_point_and_a_sample_without_an_answer_are_left_to_the_next_cycle() -> None:
    line = Line().is_up()
    line.driver.command(Position(7.0))
    line.wakes()
    line.wakes()
    assert line.sent[-1] == b"to 7\n"
    assert line.sent.count(b"to 7\n") == 1
    assert line.link.wake_at == NEVER


def test_power_off_counts_when_it_is_reported_and_not_once_power_was_requested() -> None:
    line = Line().is_up()
    line.driver.command(Stop.POWER_OFF)
    line.wakes()
    line.shows(unpowered=False)
    line.state = "off"
    line.answers()
    line.shows(unpowered=True)
    line.takes(line.driver.begin(Transition.ACTIVATE, line.now))
    line.shows(unpowered=False)


def test_while_tasks_are_under_way_only_a_stop_counts_and_it_ends_them() -> None:
    line = Line()
    line.takes(line.driver.begin(Transition.RECOVER, 0))
    line.driver.command(Position(1.0))
    line.driver.command(Stop.STANDSTILL)
    line.shows(busy=True)
    line.driver.command(Stop.QUICK_STOP)
    line.shows(busy=False)
    line.answers()
    assert line.sent[-1] == b"QUICK_STOP\n"


def test_no_set_point_ends_a_task_that_stops() -> None:
    line = Line().is_up()
    line.takes(line.driver.begin(Transition.POWER_OFF, line.now))
    assert line.driver.state is DriverState.STOPPING
    line.driver.command(Stop.POWER_OFF)
    assert line.busy


def test_a_device_that_was_silent_is_set_up_again_and_not_enabled() -> None:
    line = Line().is_up()
    line.now = 250 * MS
    line.sent.clear()
    line.takes(line.link.sample(line.now))
    assert (line.feedback.power, line.driver.state) == (Power.UNKNOWN, DriverState.RESTORING)
    while line.busy:
        line.answers()
    assert line.sent == [b"q\n", b"i\n", b"off\n", b"c\n"]
    assert (line.feedback.power, line.driver.unpowered) == (Power.OFF, True)
    assert line.driver.state is DriverState.INACTIVE


@pytest.mark.parametrize("busy", [False, True])
def test_a_line_that_is_lost_fails_its_tasks_and_sends_nothing_until_it_is_back(*, busy: bool) -> None:
    line = Line().is_up()
    if busy:
        line.takes(line.driver.begin(Transition.ACTIVATE, line.now))
    line.sent.clear()
    line.takes(line.link.receive(Packet("line", LINE_LOST, b""), line.now))
    assert line.link.lost == LOST
    assert (line.driver.failure is not None) is busy
    line.driver.command(Position(1.0))
    line.takes(line.link.sample(line.now))
    assert line.link.wake_at == NEVER
    assert line.sent == []
    line.takes(line.link.receive(Packet("line", LINE_BACK, b""), line.now))
    assert line.link.lost is None


@pytest.mark.parametrize("act", [lambda line: line.link.beat(0), lambda line: line.driver.release()])
def test_nothing_is_sent_that_no_answer_would_come_to(act: Callable[[Line], tuple[Packet, ...]]) -> None:
    assert act(Line().is_up()) == ()


def test_a_lost_device_is_not_activated_and_a_set_point_that_moves_is_standstill_until_it_is() -> None:
    line = Line().is_up()
    line.takes(line.driver.begin(Transition.DEACTIVATE, line.now))
    while line.busy:
        line.answers()
    line.driver.command(Position(1.0))
    line.wakes()
    assert line.sent[-1] == b"STANDSTILL\n"
    line.answers()
    line.takes(line.driver.begin(Transition.ACTIVATE, line.now))
    line.answers()
    line.takes(line.link.receive(Packet("line", LINE_LOST, b""), line.now))
    line.takes(line.link.receive(Packet("line", LINE_BACK, b""), line.now))
    assert line.driver.state is DriverState.UNCONFIGURED
    line.sent.clear()
    line.takes(line.driver.begin(Transition.ACTIVATE, line.now))
    assert line.sent == []
    assert "'activate' is refused: it is unconfigured" in str(line.driver.failure)


@pytest.mark.parametrize("transition", [Transition.HOME, Transition.SET_ZERO, Transition.RESET])
def test_a_transition_that_it_cannot_do_is_refused_by_name(transition: Transition) -> None:
    line = Line().is_up()
    line.sent.clear()
    line.takes(line.driver.begin(transition, line.now))
    assert line.sent == []
    assert f"'{transition.value}' is refused" in str(line.driver.failure)
