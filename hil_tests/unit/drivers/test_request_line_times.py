"""One device alone on a line: its time-outs, its feedback, and what each task does to power and set-up."""

import pytest

from firmware_bridge.drivers.driver import Position, Power, Reports, Stop
from firmware_bridge.drivers.life_cycle import DriverState, Task, Transition
from firmware_bridge.drivers.request_line import UNFOUND
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.units import NEVER
from hil_tests.unit.drivers.request_line_bench import ANSWERS, MS, Line

GONE = Packet("line", LINE_LOST, b"")
BACK = Packet("line", LINE_BACK, b"")


def gone_and_back(line: Line) -> None:
    line.takes(line.link.receive(GONE, line.now))
    line.takes(line.link.receive(BACK, line.now))


# Feedback


def test_feedback_before_the_first_answer_is_unknown_and_has_no_zero() -> None:
    line = Line()
    line.shows(power=Power.UNKNOWN)
    assert line.feedback.received_at == line.feedback.current_at == NEVER_RECEIVED
    # The device reports no zero of its own: its position never counts as referenced.
    assert Reports.ZERO not in line.driver.reports
    assert line.driver.reports == {Reports.POWER}
    assert line.feedback.reference_lost


def test_feedback_has_every_part_of_the_report_with_its_times() -> None:
    line = Line().is_up()
    line.now = 50 * MS
    line.takes(line.link.sample(line.now))
    line.now = 70 * MS
    line.receives(b"q=on,0.25,hot")
    feedback = line.feedback
    assert (feedback.axis, feedback.power, feedback.fault) == (line.driver.axis.name, Power.ON, "hot")
    assert (feedback.current_a, feedback.current_at, feedback.text) == (0.25, 70 * MS, "shows on")
    assert (feedback.sampled_at, feedback.received_at, feedback.reference_lost) == (50 * MS, 70 * MS, True)
    line.receives(b"q=on")
    assert line.feedback.current_a == 0.25, "an answer to no request is ignored"
    line.now = 100 * MS
    line.takes(line.link.sample(line.now))
    line.receives(b"q=on")
    newest = line.feedback
    assert (newest.current_a, newest.current_at) == (None, NEVER_RECEIVED)


def test_an_answer_to_no_cycle_leaves_the_time_of_the_newest_sample() -> None:
    line = Line().is_up()
    line.now = 50 * MS
    line.takes(line.link.sample(line.now))
    line.answers()
    line.now = 60 * MS
    line.driver.command(Position(1.0))
    line.wakes()
    line.answers()
    assert (line.driver.sampled_at, line.feedback.received_at) == (50 * MS, 60 * MS)


# Time-outs


def test_a_request_has_no_answer_at_its_time_and_not_before() -> None:
    line = Line()
    line.takes(line.driver.begin(Transition.RECOVER, 0))
    assert line.link.wake_at == ANSWERS
    line.takes(line.link.wake(ANSWERS - 1))
    assert line.sent == [b"q\n"]
    line.takes(line.link.wake(ANSWERS))
    assert line.sent == [b"q\n", b"q\n"]
    assert line.link.wake_at == 2 * ANSWERS


def test_three_requests_without_an_answer_are_the_end_of_a_task_and_an_answer_begins_the_count_again() -> (
    None
):
    line = Line()
    line.takes(line.driver.begin(Transition.CONFIGURE, line.now))
    line.answers()
    for _ in range(2):
        line.wakes()
    assert (line.busy, line.sent.count(b"i\n")) == (True, 3)
    line.receives(b"i")
    for _ in range(2):
        line.wakes()
    assert (line.busy, line.sent.count(b"off\n")) == (True, 3)
    line.wakes()
    assert not line.busy
    assert "no answer to b'off'" in str(line.driver.failure)


def test_a_device_that_is_looked_for_may_be_as_late_as_its_table_has_it() -> None:
    line = Line()
    line.takes(line.driver.begin(Transition.RECOVER, 0))
    while line.link.wake_at < 500 * MS:
        line.wakes()
        assert line.busy
    line.wakes()
    assert (line.now, line.busy) == (540 * MS, False)


def test_the_search_ends_at_its_very_time() -> None:
    line = Line(found_within_ms=120)
    line.takes(line.driver.begin(Transition.RECOVER, 0))
    line.wakes()
    assert line.busy
    line.wakes()
    assert (line.now, line.busy) == (120 * MS, False)


def test_the_time_to_find_it_begins_with_each_search() -> None:
    line = Line().is_up()
    line.now = 10_000 * MS
    line.takes(line.driver.begin(Transition.RECOVER, line.now))
    line.wakes()
    assert line.busy


def test_a_hint_names_what_to_check_when_it_is_missed_and_only_while_it_is_looked_for() -> None:
    line = Line(found_within_ms=5_000)
    assert line.link.hint(10_000 * MS) == ""
    line.takes(line.driver.begin(Transition.RECOVER, 0))
    assert line.link.hint(2_900 * MS - 1) == ""
    assert line.link.hint(2_900 * MS).startswith("line: ")
    assert "9600 Bd" in line.link.hint(2_900 * MS)
    line.answers()
    assert line.link.hint(4_000 * MS) == ""


def test_a_device_is_silent_at_its_time_and_not_before() -> None:
    line = Line().is_up()
    line.takes(line.link.sample(250 * MS - 1))
    line.shows(DriverState.ACTIVE)
    line.takes(line.link.sample(250 * MS))
    line.shows(DriverState.UNCONFIGURED)
    line.shows(power=Power.UNKNOWN)
    # A sample is under way: the set-up begins with the cycle after it.
    line.wakes()
    line.takes(line.link.sample(300 * MS))
    line.shows(DriverState.RESTORING)


def test_a_device_that_falls_silent_before_it_gets_power_gets_none() -> None:
    line = Line(silent_ms=100)
    for _ in range(2):
        line.takes(line.driver.begin(Transition.RECOVER, line.now))
        while line.sent[-1] != b"go\n":
            line.answers()
        line.wakes()
        line.now += 50 * MS
        line.takes(line.link.sample(line.now))
        line.answers()
        assert b"on\n" not in line.sent
        assert UNFOUND in str(line.driver.failure)
        line.shows(DriverState.UNCONFIGURED, Power.UNKNOWN)


def test_a_stop_for_a_device_without_set_up_is_sent_however_long_it_was_silent() -> None:
    line = Line()
    line.driver.command(Stop.QUICK_STOP)
    line.takes(line.link.sample(10_000 * MS))
    assert line.sent == [b"QUICK_STOP\n"]


def test_nothing_is_looked_for_on_a_line_that_is_gone() -> None:
    line = Line().is_up()
    line.now = 50 * MS
    line.takes(line.link.sample(line.now))
    line.takes(line.link.receive(GONE, line.now))
    line.takes(line.link.sample(100 * MS))
    line.shows(DriverState.UNCONFIGURED)
    assert line.link.late == 0
    # No bytes are no news.
    line.takes(line.link.receive(Packet("line", 0, b""), line.now))
    assert line.link.lost is not None


def test_a_wake_up_without_a_request_changes_nothing() -> None:
    line = Line().is_up()
    busy = line.link.busy
    line.takes(line.link.wake(10_000 * MS))
    assert (line.link.busy, line.busy) == (busy, False)


def test_a_task_without_requests_is_done_at_once() -> None:
    line = Line().is_up()
    line.sent.clear()
    for _ in range(3):
        line.takes(line.driver.begin(Transition.LISTEN, line.now))
        line.shows(DriverState.ACTIVE, busy=False)
    assert (line.sent, line.link.wake_at) == ([], NEVER)


def test_silence_counts_from_the_newest_answer() -> None:
    line = Line().is_up()
    line.now = 200 * MS
    line.takes(line.link.sample(line.now))
    line.answers()
    line.now = 449 * MS
    line.takes(line.link.sample(line.now))
    line.shows(DriverState.ACTIVE)


def test_a_device_that_was_never_found_is_not_set_up_by_itself() -> None:
    line = Line()
    line.takes(line.link.sample(1_000 * MS))
    assert (line.sent, line.driver.state) == ([], DriverState.UNCONFIGURED)
    assert line.link.late == 0


def test_a_search_that_is_under_way_is_not_begun_again_by_the_cycle() -> None:
    line = Line().is_up()
    gone_and_back(line)
    line.takes(line.driver.begin(Transition.CONFIGURE, line.now))
    line.answers()
    line.sent.clear()
    line.takes(line.link.sample(line.now + 50 * MS))
    assert (line.sent, line.driver.state) == ([], DriverState.CONFIGURING)
    line.receives(b"i")
    assert line.sent == [b"off\n"]


# Cycles


def test_every_late_cycle_counts_whether_its_sample_waits_or_is_under_way() -> None:
    line = Line().is_up()
    line.driver.command(Position(1.0))
    line.wakes()
    # A set-point is under way: the sample waits for it, which is not late.
    line.takes(line.link.sample(10 * MS))
    assert line.link.late == 0
    line.takes(line.link.sample(20 * MS))
    assert line.link.late == 1
    line.answers()
    # Now it is under way.
    line.takes(line.link.sample(30 * MS))
    line.takes(line.link.sample(40 * MS))
    assert line.link.late == 3


def test_the_longest_cycle_and_the_busy_time_of_the_line_are_measured() -> None:
    line = Line().is_up()
    before = line.link.busy, line.link.commands
    for start, end in ((50, 54), (100, 105), (150, 157), (200, 202)):
        line.now = start * MS
        line.takes(line.link.sample(line.now))
        line.now = end * MS
        line.answers()
    assert line.link.longest_cycle == 7 * MS
    assert (line.link.busy - before[0], line.link.commands - before[1]) == (18 * MS, 4)
    line.now = 250 * MS
    for missed in (1, 2):
        line.driver.command(Position(1.0))
        line.wakes()
        line.wakes()
        assert line.link.busy - before[0] == 18 * MS + missed * ANSWERS
    assert line.link.longest_cycle == 7 * MS


def test_a_request_is_a_packet_of_its_line_with_its_end() -> None:
    line = Line()
    (packet,) = line.driver.begin(Transition.RECOVER, 0)
    assert packet == Packet("line", 0, b"q\n")


def test_half_a_line_of_before_does_not_spoil_an_answer() -> None:
    line = Line()
    for _ in range(2):
        line.takes(line.link.receive(Packet("line", 0, b"gar"), 0))
        line.takes(line.driver.begin(Transition.RECOVER, 0))
        line.receives(b"q=off")
        assert line.sent[-1] == b"i\n"
        line.receives(b"i")
        line.takes(line.driver.begin(Transition.END, 0))
        line.receives(b"off=off")


def test_two_lines_at_once_are_both_taken() -> None:
    line = Line()
    line.takes(line.driver.begin(Transition.RECOVER, 0))
    line.receives(b"noise\nq=off")
    assert line.sent[-1] == b"i\n"


# Tasks, power and set-points


@pytest.mark.parametrize("transition", [Transition.DEACTIVATE, Transition.POWER_OFF])
def test_a_transition_to_a_device_without_power_clears_the_request_for_power(transition: Transition) -> None:
    line = Line().is_up()
    line.takes(line.driver.begin(transition, line.now))
    while line.busy:
        line.answers()
    assert (line.driver.unpowered, line.driver.state) == (True, DriverState.INACTIVE)
    # What moves is standstill from here on, each time.
    for _ in range(2):
        line.driver.command(Position(1.0))
        line.wakes()
        assert line.sent[-1] == b"STANDSTILL\n"
        line.answers()


def test_every_loss_drops_what_waits_and_needs_a_new_set_up() -> None:
    line = Line().is_up()
    for _ in range(2):
        line.driver.command(Position(1.0))
        gone_and_back(line)
        assert (line.driver.state, line.link.wake_at) == (DriverState.UNCONFIGURED, NEVER)
        line.takes(line.link.sample(line.now))
        while line.busy:
            line.answers()
        line.takes(line.driver.begin(Transition.ACTIVATE, line.now))
        line.answers()
        line.shows(DriverState.ACTIVE)


def test_a_line_that_is_lost_again_fails_the_tasks_again() -> None:
    line = Line()
    for _ in range(2):
        line.takes(line.driver.begin(Transition.RECOVER, line.now))
        line.takes(line.link.receive(GONE, line.now))
        assert "the serial line is gone" in str(line.driver.failure)
        assert not line.busy
        line.takes(line.link.receive(BACK, line.now))


def test_bytes_are_no_news_of_the_line() -> None:
    line = Line().is_up()
    line.takes(line.link.receive(Packet("line", LINE_LOST, b"x"), line.now))
    assert line.link.lost is None
    line.takes(line.link.receive(GONE, line.now))
    line.takes(line.link.receive(Packet("line", LINE_BACK, b"x"), line.now))
    assert line.link.lost is not None


def test_a_transition_takes_the_place_of_a_set_point_and_of_the_tasks_before_it() -> None:
    line = Line().is_up()
    for _ in range(2):
        line.driver.command(Position(1.0))
        line.takes(line.driver.begin(Transition.POWER_OFF, line.now))
        assert line.sent[-1] == b"off\n"
        while line.busy:
            line.answers()
        line.wakes() if line.link.wake_at != NEVER else None
        assert b"to 1\n" not in line.sent
        line.takes(line.driver.begin(Transition.ACTIVATE, line.now))
        line.takes(line.driver.begin(Transition.ACTIVATE, line.now))
        # The answer to the first one ends nothing: the request of the second is its own.
        line.answers()
        line.shows(DriverState.ACTIVATING)
        line.answers()
        line.shows(DriverState.ACTIVE)


def test_a_search_ends_the_set_up_until_it_is_done_again() -> None:
    line = Line().is_up()
    for _ in range(2):
        line.takes(line.driver.begin(Transition.RECOVER, line.now))
        line.shows(power=Power.UNKNOWN)
        while line.busy:
            line.answers()
        line.shows(power=Power.ON)


def test_a_stop_that_ends_a_task_leaves_no_request_of_it() -> None:
    line = Line().is_up()
    for _ in range(2):
        line.takes(line.driver.begin(Transition.ACTIVATE, line.now))
        line.takes(line.driver.begin(Transition.ACTIVATE, line.now))
        line.driver.command(Stop.QUICK_STOP)
        line.shows(busy=False)
        line.answers()
        assert line.sent[-1] == b"QUICK_STOP\n"
        line.answers()
        assert (line.busy, line.link.wake_at) == (False, NEVER)


@pytest.mark.parametrize("task", [Task.CONFIGURE, Task.LEAVE, Task.DISABLE])
def test_each_task_that_takes_the_power_clears_the_request_for_it(task: Task) -> None:
    driver = Line().is_up().driver
    enabled = [driver.enabled]
    for each in (Task.IDENTIFY, task, Task.ENABLE, task):
        driver.opened(each)
        enabled.append(driver.enabled)
    assert enabled == [True, True, False, True, False]
