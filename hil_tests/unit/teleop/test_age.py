"""Age of commands on the wire: the requests and their receivers, valid answers, and the deciding row."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from firmware_bridge.intent import Arm, ClearEmergencyStop, Disarm, EmergencyStop, Pause, Resume
from firmware_bridge.mavlink.age import BOOT_WRAPS, ROWS
from firmware_bridge.mavlink.frames import LOSS_OVER, Codec, Losses, dialect
from firmware_bridge.mavlink.round_trips import EVERY, MOST_OPEN, RoundTrips
from firmware_bridge.mavlink.trust import Trust
from firmware_bridge.robot import UnknownAge
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.teleop.bench import CYCLE, in_control, rars, target_message
from hil_tests.unit.teleop.received import texts
from hil_tests.unit.teleop.timestamped import BEAT, HERE, NOW, QUESTIONS, THERE, Station, age_of, driving

if TYPE_CHECKING:
    from collections.abc import Iterable

KEY = bytes(range(32))


def test_there_is_a_row_for_each_way_to_report_the_best_first() -> None:
    assert [row.timestamped for row in ROWS] == [True, True, False, False, False]


def test_only_who_drives_is_requested_and_twice_a_second() -> None:
    bench = rars()
    station, other = Station(bench), Station(bench, THERE)
    other.codec = Codec(254, 190)
    other.sends(BEAT)
    for _ in range(40):
        bench.now += CYCLE
        sent = bench.operator.report(bench.snapshot(), (), bench.now)
        assert not any(_kinds([packet.payload]) & QUESTIONS for packet in sent), "no one drives"
    station.orders(400, 1.0)
    requested: dict[int, int] = {}
    for _ in range(40):
        bench.now += CYCLE
        for packet in bench.operator.report(bench.snapshot(), (), bench.now):
            if _kinds([packet.payload]) & QUESTIONS:
                requested[packet.address] = requested.get(packet.address, 0) + len(packet.payload)
    assert set(requested) == {HERE}
    assert requested[HERE] <= 2 * 150


def _kinds(payloads: Iterable[bytes]) -> set[str]:
    return {one.get_type() for payload in payloads for one in Codec(9, 9).decode(payload)}


@pytest.mark.parametrize("late_ms", [0, 120, 480, 3_000])
@pytest.mark.parametrize("ahead", [-5 * SECOND, 0, 7 * SECOND, 10**18])
def test_a_set_points_time_reports_its_age_by_timesync(ahead: int, late_ms: int) -> None:
    station = driving(ahead=ahead + 100 * SECOND)
    station.late = late_ms * MILLISECOND
    station.goes()
    age, timestamped = age_of(station)
    assert timestamped
    assert age == pytest.approx(late_ms / 1000, abs=0.003)


def test_a_set_points_time_may_wrap() -> None:
    station = driving(ahead=(BOOT_WRAPS - 1_487) * MILLISECOND, seconds=1.2)
    for _ in range(20):
        station.drives(0.05)
        assert age_of(station) == (pytest.approx(0.0, abs=0.003), True)
    station.late = 80 * MILLISECOND
    station.goes()
    assert age_of(station) == (pytest.approx(0.08, abs=0.003), True)


@pytest.mark.parametrize("clock", [0, "none"])
def test_a_set_point_without_a_time_is_undated(clock: int | str) -> None:
    station = driving()
    message = target_message(0.1)
    if clock == "none":
        message = dialect.MAVLink_manual_control_message(1, 200, 0, 0, 0, 0)
    station.sends(message)
    assert age_of(station) == (0.0, False), "half a round trip of nothing"


def test_set_points_of_another_clock_than_timesyncs_are_taken_above_their_fastest() -> None:
    station = driving(boot_ahead=77_777 * SECOND, seconds=4.0)
    assert age_of(station) == (pytest.approx(0.0, abs=0.003), False)
    station.late = 700 * MILLISECOND
    station.goes()
    assert age_of(station) == (pytest.approx(0.7, abs=0.003), False)


@pytest.mark.parametrize("behind_ms", [100, 400, 499, 501, 3_000])
@pytest.mark.parametrize("less_ms", [0, 50, 400])
def test_a_timesync_that_runs_behind_the_set_points_makes_no_word_younger(
    behind_ms: int, less_ms: int
) -> None:
    """Check TIMESYNC: by it alone the command would be fresh; the fastest one so far has come at once."""
    station = driving(boot_ahead=1_000 * SECOND + behind_ms * MILLISECOND, seconds=4.0)
    assert age_of(station) == (pytest.approx(0.0, abs=0.003), False)
    station.late = (behind_ms + less_ms) * MILLISECOND
    station.goes()
    age, timestamped = age_of(station)
    assert age == pytest.approx((behind_ms + less_ms) / 1000, abs=0.003)
    assert timestamped is (behind_ms < 500), "what differs by more than a word may be old dates nothing"


def test_clocks_that_disagree_are_reported_once() -> None:
    station = driving(boot_ahead=1_003 * SECOND, seconds=4.0)
    station.late = 3_100 * MILLISECOND
    stated = []
    for _ in range(60):
        station.bench.now += CYCLE
        station.goes()
        assert age_of(station) == (pytest.approx(3.1, abs=0.003), False)
        for packet in station.bench.operator.report(station.bench.snapshot(), (), station.bench.now):
            stated += texts(Codec(9, 9).decode(packet.payload)) if packet.address == HERE else []
    (reported,) = [text for text in stated if "clocks disagree" in text]
    assert reported.startswith("link: this station's clocks disagree by 3.00 s")


@pytest.mark.parametrize("in_time", [0.05, 0.25, 0.45, 0.7, 1.0])
@pytest.mark.parametrize("set_back", [0, 1, 2, 3, 4, 5])
def test_clocks_that_were_set_before_messages_came_late_make_none_of_them_young(
    set_back: int, in_time: float
) -> None:
    """TIMESYNC's clock by 5 s, the set-points' by less; messages in time for a while, then 3 s late."""
    station = driving(boot_ahead=1_000 * SECOND, seconds=4.0, answers_at_once=True)
    station.ahead -= 5 * SECOND
    station.boot_ahead = (1_000 - set_back) * SECOND
    station.drives(in_time)
    station.late = 3 * SECOND
    for _ in range(60):
        station.drives(0.05)
        age, _ = age_of(station)
        assert age >= 3.0 - 0.05


def test_clocks_that_were_set_together_date_messages_again() -> None:
    station = driving(boot_ahead=1_000 * SECOND, seconds=4.0)
    station.ahead -= 5 * SECOND
    station.boot_ahead = 995 * SECOND
    station.drives(1.5)
    assert age_of(station) == (pytest.approx(0.0, abs=0.05), True)


def test_without_any_answer_words_are_undated_and_nothing_is_reported() -> None:
    station = driving(answers=set())
    message = dialect.MAVLink_manual_control_message(1, 200, 0, 0, 0, 0)
    station.sends(message)
    assert age_of(station) == (None, False)


def test_a_signature_reports_the_age_of_a_stick_by_the_stamps_of_answers() -> None:
    station = driving(key=KEY, answers={"PING"})
    station.late = 350 * MILLISECOND
    station.bench.now += SECOND
    station.sends(dialect.MAVLink_manual_control_message(1, 200, 0, 0, 0, 0))
    assert age_of(station) == (pytest.approx(0.35, abs=0.001), True)


def test_a_station_whose_stamps_count_frames_does_not_date_its_words() -> None:
    """So pymavlink and the C library sign: the stamp of the start, and one more for each frame."""
    station = driving(key=KEY, seconds=0.05)
    station.frame = lambda message, sent_at: station.codec.encode(message)  # type: ignore[method-assign] # noqa: ARG005
    for _ in range(200):
        station.bench.now += CYCLE
        station.sends(dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0))
        assert not age_of(station)[1]
        for packet in station.bench.operator.report(station.bench.snapshot(), (), station.bench.now):
            for one in Codec(9, 9).decode(packet.payload):
                if one.get_type() == "PING" and packet.address == HERE:
                    station.comes(station.answer(one))
    assert age_of(station) == (0.0, False)


def test_only_an_answer_of_who_drives_to_an_open_question_counts() -> None:
    station = driving(answers=set())
    other = Station(station.bench, THERE)
    ages = in_control(station.bench).clocks
    question = next(one for one in reversed(station.requested) if one.get_type() == "TIMESYNC")
    station.comes(other.answer(question), THERE)
    assert ages.trips.newest(station.bench.now) is None, "of another place"
    forged = dialect.MAVLink_timesync_message(5, question.ts1 + 1)
    station.sends(forged)
    assert ages.trips.newest(station.bench.now) is None, "to no request"
    station.comes(station.answer(question))
    trip = ages.trips.newest(station.bench.now)
    assert trip is not None
    station.bench.now += 100 * MILLISECOND
    station.comes(station.answer(question))
    assert ages.trips.newest(station.bench.now) == trip, "twice"


def test_a_timesync_with_the_newer_fields_counts() -> None:
    """Two bytes more, of target system and component: an extension of MAVLink 2 (common.xml, 2024)."""
    station = driving(answers=set())
    question = next(one for one in reversed(station.requested) if one.get_type() == "TIMESYNC")
    short = station.answer(question)
    payload = short[10:-2].ljust(16, b"\0") + bytes((1, 1))
    header = bytes((0xFD, len(payload), *short[2:10]))
    crc = dialect.x25crc(header[1:] + payload)
    crc.accumulate(bytes((34,)))
    station.comes(header + payload + crc.crc.to_bytes(2, "little"))
    assert in_control(station.bench).clocks.trips.newest(station.bench.now) is not None


def test_a_new_driver_is_requested_again() -> None:
    station = driving()
    assert age_of(station)[1]
    station.orders(32100, 0.0)
    station.orders(32100, 1.0)
    station.goes()
    assert not age_of(station)[1]


def test_a_go_with_an_older_time_and_an_older_number_is_overtaken_however_late() -> None:
    station = driving()
    bench = station.bench
    old = station.frame(station.set_point(0.3), bench.now)
    for _ in range(100):
        bench.now += CYCLE
        station.goes(0.0)
    station.comes(old)
    assert bench.command.speed_mps == 0.0
    assert bench.operator.dropped.overtaken == 1


@pytest.mark.parametrize(
    ("stop", "go", "request_"),
    [
        ((400, 0.0), (400, 1.0), Arm()),
        ((5300, 0.0), (5300, 1.0), ClearEmergencyStop()),
        ((193, 0.0), (193, 1.0), Resume()),
        ((185, 1.0), (400, 1.0), Arm()),
    ],
)
def test_what_was_stated_before_a_stop_does_not_undo_it(
    stop: tuple[int, float], go: tuple[int, float], request_: Any
) -> None:
    station = driving()
    bench = station.bench
    seven = (go[1], *(0.0,) * 6)
    late = station.frame(dialect.MAVLink_command_long_message(1, 1, go[0], 0, *seven), bench.now)
    station.orders(*stop)
    bench.requested.clear()
    for _ in range(5):
        bench.now += CYCLE
        station.goes(0.0)
    [*_, ack] = station.comes(late)
    assert (ack.command, ack.result) == (go[0], 1), "temporarily rejected"
    assert bench.requested == []
    station.orders(*go)
    assert bench.requested == [request_], "sent after it"


@pytest.mark.parametrize(
    ("order", "request_"),
    [
        ((400, 0.0), Disarm()),
        ((400, 0.0, 21196.0), Disarm(force=True)),
        ((185, 1.0), EmergencyStop(final=True)),
        ((5300, 0.0), EmergencyStop()),
        ((193, 0.0), Pause()),
        ((176, 1.0, 4.0), Pause()),
    ],
)
def test_a_command_to_stop_is_obeyed_however_old(order: tuple[int, ...], request_: Any) -> None:
    station = driving(key=KEY)
    station.bench.requested.clear()
    station.bench.now += 40 * SECOND
    station.late = 39 * SECOND
    station.orders(order[0], *map(float, order[1:]))
    assert station.bench.requested[-1] == request_


def test_an_old_order_to_go_is_refused_where_its_age_is_known() -> None:
    station = driving(key=KEY)
    station.orders(400, 0.0)
    station.bench.requested.clear()
    station.bench.now += SECOND
    station.late = 500 * MILLISECOND
    reported = station.orders(400, 1.0)
    assert station.bench.requested == []
    assert "it was sent 0.50 s ago, limit 0.50 s" in "".join(texts(reported))
    station.late = 490 * MILLISECOND
    station.bench.now += SECOND
    station.orders(400, 1.0)
    assert station.bench.requested == [Arm()]


def test_an_old_press_of_a_button_switches_nothing() -> None:
    station = driving(key=KEY)
    station.sends(dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0))
    station.bench.now += SECOND
    station.late = 600 * MILLISECOND
    before = station.bench.command
    station.sends(dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 2))
    assert station.bench.command.headlamp == before.headlamp
    station.sends(dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0))
    station.late = 0
    station.bench.now += SECOND
    station.sends(dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 2))
    assert station.bench.command.headlamp != before.headlamp


@pytest.mark.parametrize("key", [None, KEY])
@pytest.mark.parametrize("decided", [None, *UnknownAge])
def test_unknown_is_refused_where_a_key_is_set_unless_the_file_states_otherwise(
    key: bytes | None, decided: UnknownAge | None
) -> None:
    bench = rars()
    bench.trust = Trust(key=key, started_at=NOW)
    operator = bench.robot.operator.model_copy(update={"unknown_age": decided, "max_age_ms": 700})
    bench.robot = bench.robot.model_copy(update={"operator": operator})
    bench.restart()
    refuses = key is not None if decided is None else decided is UnknownAge.REFUSE
    assert bench.operator.age_limit.needed is refuses
    assert bench.operator.age_limit.most == 700 * MILLISECOND


def test_who_drives_is_reported_once_that_no_one_knows_how_old_his_words_are() -> None:
    bench = rars()
    station = Station(bench)
    station.orders(400, 1.0)
    received = []
    for _ in range(200):
        bench.now += CYCLE
        station.sends(dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0))
        sent = bench.operator.report(bench.snapshot(), (), bench.now)
        received += [one for p in sent if p.address == HERE for one in Codec(9, 9).decode(p.payload)]
    assert "".join(texts(received)).count("the age of this station's commands is unknown") == 1


def test_round_trips_forget_what_is_long_ago_and_what_was_never_answered() -> None:
    trips = RoundTrips()
    for n in range(3 * MOST_OPEN):
        trips.ask((1, n), now=n * EVERY)
    assert trips.answered((1, 0), 60 * SECOND) is None
    assert trips.answered((1, 3 * MOST_OPEN - 1), 60 * SECOND) == (3 * MOST_OPEN - 1) * EVERY
    assert trips.newest(60 * SECOND) == 60 * SECOND - (3 * MOST_OPEN - 1) * EVERY
    assert trips.newest(63 * SECOND + 1) is None


@pytest.mark.parametrize(
    ("numbers", "share"),
    [
        (range(300), 0.0),
        (range(0, 600, 2), 0.5),
        ([*range(50), 51, 50, *range(52, 300)], 0.0),
        ([n for one in range(100) for n in (one, one)], 0.0),
    ],
    ids=["all", "every other", "one overtaken", "all twice"],
)
def test_the_share_that_is_lost(numbers: Iterable[int], share: float) -> None:
    losses = Losses()
    for number in numbers:
        losses.received(number & 0xFF, 0)
    assert losses.share is None
    losses.received(0, LOSS_OVER)
    assert losses.share == pytest.approx(share, abs=0.01)
