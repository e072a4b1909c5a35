"""The drives' reports of their power, and the guard's conclusion: in doubt a drive has it."""

from typing import Final

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire.power_states import STATUSWORDS
from firmware_bridge.packet import Packet
from firmware_bridge.units import SECOND
from hil_tests.safety.guard_bench import (
    LINK,
    Bench,
    aborted,
    frame,
    position,
    sample,
    status,
    status_read,
    wheel,
    write,
)
from hil_tests.safety.serial_bench import SerialBench, done, number, reading, speed, value, word

ENABLED, QUICK_STOPPED, READY, OFF, FAULT = 0x0137, 0x0117, 0x0121, 0x0140, 0x0108
POWERED: Final = {
    PowerState.REFRESH,
    PowerState.MEASURE_INIT,
    PowerState.OPERATION_ENABLED,
    PowerState.QUICK_STOP_ACTIVE,
    PowerState.FAULT_REACTION_ENABLED,
}
ENDS_WATCH: Final = write(1, 0x1016, 1, bytes(4))
UNLISTED: Final = frame(0x123, "")
REPORTS: Final = (status, sample, status_read)


@pytest.mark.parametrize("report", REPORTS)
@pytest.mark.parametrize("state", PowerState)
def test_power_is_what_the_newest_statusword_states(bench: Bench, state: PowerState, report: type) -> None:
    bench.receives(report(1, STATUSWORDS[state] | 0x8200))
    powered = state in POWERED
    assert (bench.states(ENDS_WATCH) == (ENDS_WATCH,)) is not powered
    assert bench.refuses(UNLISTED)[1] == ((wheel(1, 0x000B, 0),) if powered else ())
    bench.receives(report(1, ENABLED), report(1, OFF))
    assert bench.states(ENDS_WATCH) == (ENDS_WATCH,)


@pytest.mark.parametrize("statusword", [0x0000 | 0x0001, 0x017F, 0x4137])
def test_a_statusword_that_is_no_state_sends_nothing(bench: Bench, statusword: int) -> None:
    bench.receives(status(1, ENABLED), status(1, statusword))
    assert bench.refuses(ENDS_WATCH)[1] == aborted(1, 0x1016, 1)
    bench.receives(status(1, OFF), status(1, statusword))
    assert bench.states(ENDS_WATCH) == (ENDS_WATCH,)


@pytest.mark.parametrize(
    "packet",
    [
        Packet(LINK, 0x181, b"\x37"),
        Packet(LINK, 0x281, b""),
        Packet(LINK, 0x281, b"\x37\x01\0\0\0"),
        Packet(LINK, 0x182, b"\x37\x01"),
        Packet(LINK, 0x381, b"\x37\x01"),
        Packet(LINK, 0x701, b"\x37\x01"),
        Packet(LINK, 0x1_0181, b"\x37\x01"),
        Packet("other", 0x181, b"\x37\x01"),
        Packet(LINK, 0x581, bytes.fromhex("4b4060003701 0000")),
        Packet(LINK, 0x581, bytes.fromhex("4b4160013701 0000")),
        Packet(LINK, 0x581, bytes.fromhex("8041600037010000")),
        Packet(LINK, 0x581, bytes.fromhex("6041600037010000")),
        Packet(LINK, 0x581, bytes.fromhex("4b416000370100")),
        Packet(LINK, 0x581, b""),
        Packet(LINK, 0x582, bytes.fromhex("4b4160003701 0000")),
    ],
    ids=str,
)
def test_what_is_no_statusword_of_the_drive_sends_nothing_of_its_power(bench: Bench, packet: Packet) -> None:
    bench.receives(status(1, OFF), packet)
    assert bench.states(ENDS_WATCH) == (ENDS_WATCH,)


@pytest.mark.parametrize("reported", [0x0000, 0x0002, 0x0006, 0x0007, 0x000B, 0x0080])
def test_a_drive_that_has_power_though_it_was_sent_none_counts_as_powered(
    bench: Bench, reported: int
) -> None:
    """After any refusal, the command that was not obeyed is sent again; and the drive stays watched."""
    bench.states(
        wheel(1, 0x000F, 500), wheel(1, reported, 0), position(3, 0x003F, 70), position(3, reported, 70)
    )
    bench.receives(status(1, ENABLED), status(3, ENABLED))
    assert bench.refuses(UNLISTED)[1] == (wheel(1, reported, 0), position(3, reported, 70))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, reported, 0),)
    assert bench.refuses(ENDS_WATCH)[1] == aborted(1, 0x1016, 1)
    bench.receives(status(1, OFF), status(3, OFF))
    assert bench.refuses(UNLISTED)[1] == ()


def test_a_drive_that_no_one_has_sent_a_word_is_stopped_and_keeps_its_power(bench: Bench) -> None:
    """An earlier run has left it: a quick stop gives no power and takes none."""
    bench.receives(status(1, ENABLED), status(4, ENABLED))
    assert bench.refuses(UNLISTED)[1] == (wheel(1, 0x000B, 0), position(4, 0x000B, 0))
    bench.receives(status(1, OFF))
    assert bench.refuses(UNLISTED)[1] == (position(4, 0x000B, 0),)


@pytest.mark.parametrize("report", REPORTS)
@pytest.mark.parametrize(
    "state", [state for state in PowerState if state is not PowerState.OPERATION_ENABLED]
)
def test_a_drive_that_stopped_by_itself_is_not_put_on_again(
    bench: Bench, state: PowerState, report: type
) -> None:
    bench.states(wheel(1, 0x000F, 500), position(3, 0x003F, 70))
    bench.receives(report(1, STATUSWORDS[state]), report(3, STATUSWORDS[state]))
    assert bench.refuses(wheel(1, 0x000F, 9999))[1] == (wheel(1, 0x000B, 0),)
    assert bench.refuses(position(3, 0x003F, 2**30))[1] == (position(3, 0x000B, 70),)


def test_a_drive_that_reports_that_it_is_enabled_keeps_its_power(bench: Bench) -> None:
    bench.states(wheel(1, 0x000F, 500), position(3, 0x003F, 70))
    bench.receives(status(1, ENABLED), status(3, ENABLED))
    assert bench.refuses(UNLISTED)[1] == (wheel(1, 0x000F, 0), position(3, 0x010F, 70))


@pytest.mark.parametrize(("command", "forgotten"), [(0x81, True), (0x82, True), (0x80, False), (0x01, False)])
def test_a_reset_makes_a_report_old_and_nothing_else_does(
    bench: Bench, command: int, *, forgotten: bool
) -> None:
    """In pre-operational a drive keeps its power; one that goes on reporting it after a reset has it, too."""
    if command != 0x81:
        bench.receives(status(1, OFF))
    else:
        bench.states(wheel(1, 0x0000, 0))
    reported = Packet(LINK, 0x000, bytes((command, 1)))
    assert bench.states(reported, now=SECOND) == (reported,)
    assert (bench.states(ENDS_WATCH, now=SECOND) != (ENDS_WATCH,)) is forgotten
    bench.receives(status(1, ENABLED), now=SECOND)
    assert bench.refuses(ENDS_WATCH, SECOND)[1] == aborted(1, 0x1016, 1)
    bench.receives(status(1, OFF), now=SECOND)
    assert bench.states(ENDS_WATCH, now=SECOND) == (ENDS_WATCH,)


def test_a_drive_that_has_stated_nothing_of_its_power_keeps_its_watch(bench: Bench) -> None:
    assert bench.refuses(ENDS_WATCH)[1] == aborted(1, 0x1016, 1)


@pytest.mark.parametrize("takes", [0x0000, 0x0006, 0x000B])
def test_no_power_is_confirmed_by_a_word_after_the_last_that_gave_it(bench: Bench, takes: int) -> None:
    """Neither the bridge's word nor a report from before or under it is one."""
    bench.receives(status(1, OFF))
    bench.states(wheel(1, 0x000F, 0))
    bench.receives(status(1, OFF))
    bench.states(wheel(1, takes, 0))
    assert bench.refuses(ENDS_WATCH)[1] == aborted(1, 0x1016, 1)
    bench.receives(status(1, READY))
    assert bench.states(ENDS_WATCH) == (ENDS_WATCH,)


def test_what_a_drive_reports_reaches_the_node(bench: Bench) -> None:
    packets = (status(1, ENABLED), sample(2, OFF), status_read(3, FAULT))
    bench.receives(*packets)
    assert [packet for packet, _ in bench.scripted.received] == list(packets)


WATCH_OFF: Final = number(1, od.CONSUMER_HEARTBEAT_1, 0)
REQUESTED: Final = reading(1, od.STATUSWORD)


def test_on_a_serial_line_the_answer_to_a_read_statusword_reports_of_power() -> None:
    desk = SerialBench()
    desk.states(REQUESTED)
    assert desk.receives(value(REQUESTED, b"\x37\x01"))
    assert WATCH_OFF not in desk.states(WATCH_OFF)
    desk.states(REQUESTED)
    for own in (speed(0), word(1, 0x000B)):
        assert not desk.receives(done(own))
    desk.receives(value(REQUESTED, b"\x40\x01"))
    assert desk.states(WATCH_OFF) == (WATCH_OFF,)


@pytest.mark.parametrize(
    ("requested", "answer"),
    [
        (reading(2, od.STATUSWORD), value(REQUESTED, b"\x37\x01")),
        (reading(1, od.CONTROLWORD), value(REQUESTED, b"\x37\x01")),
        (number(1, od.MODE, 3), value(REQUESTED, b"\x37\x01")),
        (REQUESTED, value(REQUESTED, b"\x37\x01", error=0x0504_0000)),
        (REQUESTED, Packet(LINK, 0x110, b"silence")),
        (REQUESTED, Packet(LINK, 0x10, b"")),
        (REQUESTED, Packet(LINK, 0x10, bytes(4))),
    ],
)
def test_other_answers_say_nothing_of_power(requested: Packet, answer: Packet) -> None:
    desk = SerialBench()
    desk.states(REQUESTED, requested)
    desk.receives(value(REQUESTED, b"\x40\x01"))
    assert desk.receives(answer)
    assert desk.states(WATCH_OFF) == (WATCH_OFF,)


def test_answers_are_taken_in_the_order_of_their_commands() -> None:
    desk = SerialBench()
    desk.states(REQUESTED, reading(1, od.CONTROLWORD), REQUESTED)
    desk.receives(value(REQUESTED, b"\x37\x01"))
    desk.receives(value(REQUESTED, b"\x40\x01"))
    assert WATCH_OFF not in desk.states(WATCH_OFF)
    desk.receives(value(REQUESTED, b"\x40\x01"))
    desk = SerialBench()
    desk.states(REQUESTED, REQUESTED)
    desk.receives(value(REQUESTED, b"\x37\x01"))
    desk.receives(value(REQUESTED, b"\x40\x01"))
    assert desk.states(WATCH_OFF) == (WATCH_OFF,)


def test_on_a_serial_line_a_drive_that_stopped_by_itself_is_not_put_on_again() -> None:
    desk = SerialBench()
    desk.states(speed(100), word(1, 0x000F), REQUESTED)
    for packet in (done(speed(100)), done(word(1, 0x000F)), value(REQUESTED, b"\x17\x01")):
        desk.receives(packet)
    assert desk.states(speed(9999)) == (speed(0), word(1, 0x000B))


def test_a_target_alone_leaves_an_earlier_run_s_drive_to_the_quick_stop() -> None:
    desk = SerialBench()
    desk.states(REQUESTED)
    desk.receives(value(REQUESTED, b"\x37\x01"))
    desk.states(speed(0))
    assert desk.states(speed(9999)) == (speed(0), word(1, 0x000B))
