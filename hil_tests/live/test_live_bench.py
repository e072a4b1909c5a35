"""A bench on the live page: what is shown, pace and rewind, faults, driving, stops; wrong requests."""

from collections.abc import Iterator
from typing import Any

import pytest

from emulators.bench.faults.failures import failures_of
from emulators.bench.foreign_datagrams import command
from emulators.live.moments import MOST
from emulators.live.page_station import SILENT_AFTER
from emulators.paced import OutsideOperator
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, from_seconds, to_seconds
from firmware_bridge.wire.internet import number_of
from hil_tests.live.shown_bench import OTHER_PAGE, PAGE, ShownBench, shown


@pytest.fixture
def rome() -> Iterator[ShownBench]:
    with shown("rome", "line") as bench:
        yield bench


def stick(bench: ShownBench, milliseconds: int, x: float = 0.0) -> None:
    """Hold the page's stick so long."""
    for _ in range(0, milliseconds, 50):
        assert bench.receives(b'{"do":"drive","x":%g,"y":0,"z":0.5,"r":0}' % x) == []
        bench.runs(50)


def fastest(bench: ShownBench) -> float:
    """Return the largest part of the newest command."""
    command = bench.state()["command"]
    return max(abs(float(value or 0.0)) for value in command.values())


def taken(bench: ShownBench) -> None:
    """Take control and arm from the page."""
    bench.opens()
    bench.runs(3000)
    stick(bench, 500)
    bench.does("take_control", on=True)
    stick(bench, 500)
    bench.does("arm", on=True)
    stick(bench, 1500)


@pytest.mark.parametrize(
    ("robot", "mission"), [("rars", "line"), ("rome", "circle"), ("climber", "square"), ("ar2", "sine")]
)
def test_a_page_is_introduced_and_then_shown_the_bench_twenty_times_a_second(
    robot: str, mission: str
) -> None:
    with shown(robot, mission) as bench:
        first, events, _, state = bench.opens()
        assert (first["kind"], events["kind"], state["kind"]) == ("hello", "events", "state")
        assert [axis["name"] for axis in first["axes"]] == [axis.name for axis in find(robot).axes]
        assert {one["kind"] for one in first["faults"]} == {one.kind for one in failures_of(find(robot))}
        states = [one for one in bench.runs(4000) if one["kind"] == "state"]
        assert 78 <= len(states) <= 81
        assert [one["at_s"] for one in states] == sorted(one["at_s"] for one in states)
        newest = states[-1]
        assert [axis["name"] for axis in newest["axes"]] == [axis.name for axis in find(robot).axes]
        assert len(newest["measured"]) > 10
        assert newest["pose"] is not None


@pytest.mark.parametrize("robot", ["rars", "rome", "climber", "ar2"])
def test_each_fault_of_the_list_begins_with_the_values_of_its_form(robot: str) -> None:
    with shown(robot, {"climber": "square", "ar2": "sine"}.get(robot, "line")) as bench:
        (first, *_) = bench.opens()
        bench.runs(500)
        for kind in first["faults"]:
            filled = {
                key["name"]: key["default"]
                if key["default"] is not None
                else next(iter(key["choices"]), None)
                for key in kind["keys"]
                if key["required"] or key["default"] is not None
            }
            bench.does("inject", fault=kind["kind"], keys=filled)
            assert bench.rig.faults.records[-1].kind == kind["kind"]
            bench.does("clear")


def test_what_a_fault_does_is_among_the_events_and_on_the_list(rome: ShownBench) -> None:
    rome.opens()
    rome.runs(1000)
    number = rome.does("inject", fault="shaft_blocked", keys={"node": "one"})["number"]
    rome.runs(100)
    (fault,) = rome.state()["faults"]
    assert (fault["number"], fault["kind"], fault["nodes"]) == (number, "shaft_blocked", ["one"])
    (_, events, *_) = rome.opens(OTHER_PAGE)
    assert any("fault shaft_blocked begins" in one["text"] for one in events["events"])
    rome.does("clear", number=number)
    rome.runs(100)
    assert rome.state()["faults"] == []


def test_what_explain_finds_on_the_bus_is_among_the_incidents_until_time_is_put_back() -> None:
    with shown("rars", "line") as bench:
        bench.opens()
        bench.runs(5000)
        assert [one for one in bench.messages(PAGE, 0) if one.get("incidents")] == []
        bench.does("inject", fault="drive_restart", keys={"node": "left", "for_s": 0.5})
        bench.runs(2000)
        newest = [one["incidents"] for one in bench.messages(PAGE, 0) if one.get("kind") == "incidents"][-1]
        assert any("node 1" in one["title"] and one["causes"] for one in newest), newest
        bench.does("rewind", to_s=4.0)
        bench.runs(100)
        newest = [one["incidents"] for one in bench.messages(PAGE, 0) if one.get("kind") == "incidents"][-1]
        assert newest == []
        bench.does("pause", on=False)
        bench.runs(3000)
        newest = [one["incidents"] for one in bench.messages(PAGE, 0) if one.get("kind") == "incidents"][-1]
        assert newest == []


def test_long_texts_are_whole_on_a_link_that_changes_their_order() -> None:
    with shown("rars", "circles") as bench:
        bench.opens()
        messages = bench.runs(1500)
        texts = [one["text"] for message in messages for one in message.get("events", ())]
        for axis in ("node 3 (steering)", "node 4 (scissor lift)"):
            text = f"{axis}: its reference is lost, position unknown; look where it stands, and confirm it"
            assert sum(one.startswith(text) and one.endswith("MAV_CMD_USER_1)") for one in texts) == 1, texts
        assert not [text for text in texts if "..." in text]


def test_an_answer_goes_to_its_page_alone_and_without_pages_nothing_is_sent(rome: ShownBench) -> None:
    rome.runs(500)
    assert rome.sent == []
    rome.opens()
    rome.opens(OTHER_PAGE)
    rome.does("pause", on=True)
    assert [one for one in rome.messages(OTHER_PAGE, 0) if "id" in one] == []
    rome.receives(b"\0", PAGE)
    rome.receives(b"\0", OTHER_PAGE)
    begun = len(rome.sent)
    rome.runs(500)
    assert rome.sent[begun:] == []


def test_pause_step_and_speed(rome: ShownBench) -> None:
    rome.opens()
    rome.runs(1000)
    rome.does("pause", on=True)
    at = rome.rig.world.now
    rome.runs(2000)
    assert rome.rig.world.now == at
    assert rome.state()["paused"]
    rome.does("step", seconds=0.25)
    rome.runs(1000)
    assert rome.rig.world.now == at + from_seconds(0.25)
    rome.does("pause", on=False)
    rome.does("speed", factor=4)
    rome.runs(1000)
    assert rome.rig.world.now == pytest.approx(at + from_seconds(4.25), abs=11 * 4 * MILLISECOND)
    assert not rome.state()["paused"]


def test_time_goes_back_and_the_run_goes_on_as_it_went() -> None:
    with shown("rars", "line") as bench, shown("rars", "line") as straight:
        bench.opens()
        bench.runs(6000)
        first, last = bench.state()["kept_s"]
        assert (first, last) == (pytest.approx(0.0, abs=0.02), pytest.approx(6.0, abs=0.06))
        bench.does("inject", fault="frame_loss", keys={"node": "left"})
        bench.runs(1500)
        assert bench.does("rewind", to_s=4.5)["at_s"] == 4.5
        assert bench.rig.faults.records == []
        bench.runs(1000)
        assert bench.state()["paused"]
        bench.does("pause", on=False)
        bench.runs(3500)
        straight.runs(to_seconds(bench.rig.world.now) * 1000)
        assert bench.rig.world.now == straight.rig.world.now == from_seconds(8.0)
        assert bench.rig.world.trace_sha256 == straight.rig.world.trace_sha256


def test_moments_are_kept_of_the_newest_two_minutes_alone(rome: ShownBench) -> None:
    rome.opens()
    rome.does("speed", factor=10)
    rome.runs(5990)
    first, last = rome.state()["kept_s"]
    assert last - first <= MOST + 2
    answer = rome.request("rewind", to_s=first - 1.0) if first >= 1 else rome.request("rewind", to_s=-1.0)
    assert not answer["ok"]


def test_the_page_drives_and_a_page_that_is_silent_lets_go(rome: ShownBench) -> None:
    taken(rome)
    assert rome.state()["armed"]
    assert rome.state()["operator"]["station"] == "254/190 at 127.0.0.1:14551"
    stick(rome, 1500, x=1.0)
    assert fastest(rome) > 0.05
    rome.runs(to_seconds(SILENT_AFTER) * 1000 + 100)
    assert fastest(rome) == 0.0


def test_a_page_in_control_whose_stick_is_let_go_stays_there_and_one_that_is_closed_is_missed(
    rome: ShownBench,
) -> None:
    taken(rome)
    rome.runs(3000)
    assert "operator link timeout" not in [one["name"] for one in rome.state()["interlocks"]]
    stick(rome, 500, x=1.0)
    assert fastest(rome) > 0.05, "no neutral stick is needed first"
    rome.receives(b"\0")
    rome.runs(2500)
    rome.opens(OTHER_PAGE)
    (*_, state) = rome.messages(OTHER_PAGE, 0)
    assert "operator link timeout" in [one["name"] for one in state["interlocks"]]
    assert abs(max(state["command"].values())) == 0.0


@pytest.mark.parametrize(("robot", "mission"), [("rars", "line"), ("rars", "circles"), ("rome", "line")])
def test_a_stop_of_the_page_brings_a_mission_to_standstill_over_a_link_that_reorders_too(
    robot: str, mission: str
) -> None:
    with shown(robot, mission) as bench:
        bench.opens()
        bench.runs(9000)
        assert fastest(bench) > 0.05
        bench.does("stop")
        bench.runs(3000)
        state = bench.state()
        assert not state["stopped"], "no emergency stop is needed"
        assert "operation paused" in [one["name"] for one in state["interlocks"]]
        assert state["operator"]["station"].startswith("254/190")
        assert all(abs(axis["velocity"]) < 0.05 for axis in state["axes"])


def test_control_is_taken_from_the_mission_and_given_back(rome: ShownBench) -> None:
    rome.opens()
    rome.runs(4000)
    rome.does("take_control", on=True)
    rome.runs(500)
    assert rome.state()["operator"]["station"].startswith("254/190")
    rome.does("take_control", on=False)
    rome.runs(1500)
    assert not rome.state()["operator"]["station"].startswith("254/190")


def test_a_station_outside_keeps_its_control_and_a_stop_is_an_emergency_stop_then() -> None:
    outside = OutsideOperator()
    codec = Codec(255, 190)
    with shown("rome", "line", outside) as bench:

        def hold(milliseconds: int, *messages: Any) -> None:
            for _ in range(0, milliseconds, 50):
                for one in (*messages, dialect.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0)):
                    outside.put(Packet(OPERATOR, number_of("127.0.0.1", 14_550), codec.encode(one)))
                bench.rig.world.rouse("operator")
                bench.runs(50)

        bench.opens()
        hold(3000, dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
        hold(300, command(1, 1, 32100, 1.0))
        bench.does("take_control", on=True)
        hold(1000)
        assert bench.state()["operator"]["station"].startswith("255/190")
        bench.does("stop")
        hold(1500)
        assert bench.state()["stopped"]


@pytest.mark.parametrize("paused", [False, True])
def test_an_emergency_stop_takes_the_power_also_of_a_bench_that_was_paused(
    rome: ShownBench,
    paused: bool,  # noqa: FBT001
) -> None:
    taken(rome)
    stick(rome, 500, x=1.0)
    rome.does("pause", on=paused)
    rome.does("emergency_stop")
    stick(rome, 500)
    state = rome.state()
    assert state["stopped"]
    assert not state["armed"]
    assert any(one["name"] == "emergency stop" for one in state["interlocks"])
    stick(rome, 2000)
    rome.does("reset_emergency_stop")
    stick(rome, 500)
    assert not rome.state()["stopped"]


def test_frames_are_shown_in_words_where_they_are_wanted() -> None:
    with shown("rars", "line") as bench:
        bench.opens()
        assert [one for one in bench.runs(1000) if one["kind"] == "frames"] == []
        bench.does("watch_frames", on=True, filter="TPDO")
        found = [frame for one in bench.runs(1000) if one["kind"] == "frames" for frame in one["frames"]]
        assert len(found) > 50
        assert all("TPDO" in text and "Statusword" in text for _, _, number, text in found if number == "181")
        assert all("TPDO" in text for *_, text in found)
        bench.does("watch_frames", on=False)
        assert [one for one in bench.runs(500) if one["kind"] == "frames"] == []


@pytest.mark.parametrize(
    "line",
    [
        b"{}",
        b"{",
        b"[1]",
        b'{"do":"no such"}',
        b'{"do":"pause"}',
        b'{"do":"pause","on":1}',
        b'{"do":"speed","factor":0}',
        b'{"do":"speed","factor":1e9}',
        b'{"do":"speed","factor":NaN}',
        b'{"do":"step","seconds":-1}',
        b'{"do":"rewind","to_s":1e9}',
        b'{"do":"rewind","to_s":"x"}',
        b'{"do":"arm","on":"yes"}',
        b'{"do":"arm","on":[]}',
        b'{"do":"arm","on":{}}',
        b'{"id":1e999,"do":"pause","on":true}',
        b'{"id":NaN,"do":"pause","on":true}',
        b'{"id":{"a":-1e999},"do":"inject"}',
        b'{"id":Infinity,"do":"state"}',
        b'{"do":"inject","fault":"none","keys":{}}',
        b'{"do":"inject","fault":[],"keys":{}}',
        b"{" * 10_000,
        b"\xff\xfe",
    ],
)
def test_a_request_that_is_none_is_refused_in_one_answer_and_the_bench_goes_on(
    rome: ShownBench, line: bytes
) -> None:
    rome.opens()
    rome.runs(200)
    answers = [one for one in rome.receives(line) if "ok" in one]
    assert [one["ok"] for one in answers] == [False]
    assert answers[0]["error"]
    at = rome.rig.world.now
    rome.runs(200)
    assert rome.rig.world.now > at


@pytest.mark.parametrize(
    "line", [b'{"do":"drive","x":2}', b'{"do":"drive","x":NaN}', b'{"do":"drive","buttons":1.5}']
)
def test_a_stick_that_is_none_moves_nothing(rome: ShownBench, line: bytes) -> None:
    taken(rome)
    rome.receives(line)
    rome.runs(100)
    assert fastest(rome) == 0.0
