"""Missions that are begun from the page, and the station of a robot that it shows."""

from collections.abc import Iterator

import pytest

from emulators.paced import OutsideOperator
from hil_tests.live.shown_bench import ShownBench, shown


@pytest.fixture
def rome() -> Iterator[ShownBench]:
    with shown("rome", "line") as bench:
        yield bench


@pytest.mark.parametrize(("robot", "helm"), [("rars", True), ("rome", False)])
def test_the_page_has_the_station_of_its_robot(robot: str, *, helm: bool) -> None:
    with shown(robot, "line") as bench:
        hello = bench.opens()[0]
    assert (hello["wheel"], hello["up"]) == (helm, helm)
    lamps = [{"title": "detector", "bit": 0}, {"title": "headlamp", "bit": 1}]
    assert hello["buttons"] == (lamps if helm else [])


def test_a_mission_is_begun_from_the_page_at_the_next_whole_second(rome: ShownBench) -> None:
    hello, *_ = rome.opens()
    assert {"line", "circle"} <= set(hello["missions"])
    assert "floor" not in hello["missions"], "it has another floor"
    rome.runs(2300)
    answer = rome.request("mission", name="circle")
    assert (answer["ok"], answer["until_s"]) == (True, 39.0)
    rome.runs(9000)
    assert rome.rig.bridge.seen.facts.armed
    ramped = [one for one in rome.runs(1000) if one.get("kind") == "state"]
    assert max(abs(value) for one in ramped for value in one["command"].values()) > 0.0
    assert rome.request("mission", name="floor")["ok"] is False
    assert rome.request("mission", name=5)["ok"] is False
    # Time goes back to before it: the first mission's operator sits there again.
    assert rome.request("rewind", to_s=1.5)["ok"]
    assert rome.request("pause", on=False)["ok"]
    rome.runs(1000)
    assert not rome.node.finished


def test_a_mission_whose_faults_meet_those_that_are_planned_is_refused_and_the_bench_goes_on() -> None:
    with shown("rome", "faults") as bench:
        bench.opens()
        bench.runs(500)
        answers = [bench.request("mission", name="faults") for _ in range(3)]
        assert any(not one["ok"] and "its faults meet" in one["error"] for one in answers)
        assert [one for one in bench.runs(1000) if one.get("kind") == "state"]


def test_the_same_mission_from_the_page_drives_as_from_the_command_line(rome: ShownBench) -> None:
    rome.opens()
    rome.runs(500)
    assert rome.request("mission", name="line")["until_s"] == 22.0 + 1.0
    rome.runs(23_500)
    assert rome.node.finished
    with shown("rome", "line") as alone:
        alone.runs(22_500)
        ends = [one.rig.bridge.seen.pose for one in (rome, alone)]
    assert ends[0].x_m == pytest.approx(ends[1].x_m, abs=5e-3)
    assert ends[0].y_m == pytest.approx(ends[1].y_m, abs=5e-3)


def test_stations_outside_keep_the_bench_to_themselves() -> None:
    with shown("rome", "line", OutsideOperator()) as outside:
        outside.opens()
        assert "stations outside" in outside.request("mission", name="line")["error"]
