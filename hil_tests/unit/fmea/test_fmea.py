"""Every failure in every state: the list of them, the assessment of a cell, and its completeness."""

import csv
import io
from dataclasses import replace
from functools import partial
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from emulators.bench.columns import Floats
from emulators.bench.faults import kinds
from emulators.bench.faults.failures import failures_of
from emulators.bench.faults.severe import SEVERE
from emulators.bench.log import LogEntry, Subject
from emulators.bench.records import InterlockEvent
from emulators.fmea import matrix as matrices
from emulators.fmea.effect import ASIDE, LATE_MS, WATCHED_S, Assessment, Course, effect
from emulators.fmea.matrix import all_failures, matrix, of_state, state_names
from emulators.fmea.reasons import REASONS
from emulators.fmea.report import COLUMNS, as_csv, as_page, wrongs
from emulators.fmea.states import states_of
from emulators.testing.rig import VirtualRig
from firmware_bridge.cli import main
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.robot_types import find, names
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.cia402_drives.on_servos import rars

ROWS = int(WATCHED_S * 100)
MACHINES = (*names(), "rome+cameras", "rars+imu")


def test_every_kind_of_fault_is_tried_on_some_robot() -> None:
    machines = (*map(find, MACHINES), rars())
    tried = {failure.kind for robot in machines for failure in failures_of(robot)}
    assert set(kinds()) == tried
    assert set(SEVERE) <= set(kinds())
    assert {row.kind for row in REASONS} <= set(kinds())


def test_a_failure_is_tried_wherever_it_can_be() -> None:
    places = {(failure.kind, failure.place) for failure in failures_of(find("rars"))}
    assert {place for kind, place in places if kind == "node_silent"} == {"bridge", *AXES}
    assert {place for kind, place in places if kind == "encoder_cut"} == set(AXES)
    assert ("can_cut", "bridge / left") in places
    assert {place for kind, place in places if kind == "datagram_loss"} == {""}
    two = {failure.place for failure in failures_of(find("rome_arm"))}
    assert set(find("rome_arm").links) <= two


AXES = ("left", "right", "steer", "lift")


@pytest.mark.parametrize("name", names())
def test_a_robot_is_tried_in_each_thing_that_it_can_do(name: str) -> None:
    rig = VirtualRig(find(name))
    reported = state_names(find(name))
    assert reported[:2] == ("disarmed", "at rest")
    assert reported[-2:] == ("stopping", "emergency stop")
    for channel in rig.bench_setup.channels:
        assert f"{channel.name} 50%" in reported
    rig.finish()


def test_in_a_state_the_robot_does_what_it_states() -> None:
    rig = VirtualRig(find("rars"))
    rig.arms()
    states = {state.name: state for state in states_of(rig)}
    with rig.branch():
        states["speed, steer 50%"].enter(rig)
        assert rig.body.speed == pytest.approx(0.25, abs=0.02)
        assert rig.body.steer_rad > np.radians(15.0)
    with rig.branch():
        states["stopping"].enter(rig)
        assert 0.02 < rig.body.speed < 0.24
    with rig.branch():
        states["emergency stop"].enter(rig)
        assert "emergency stop" in rig.interlock_events
        assert abs(rig.body.speed) < 5e-3
    with rig.branch():
        states["disarmed"].enter(rig)
        assert "not armed" in rig.interlock_events
    rig.finish()


def course(x: Floats, held_ms: float | None = None, reported_ms: float | None = None) -> Course:
    """Return a course along one place, and what was noticed."""
    events = () if held_ms is None else (InterlockEvent("a row", "", int(held_ms * MILLISECOND)),)
    texts = (
        () if reported_ms is None else (LogEntry(int(reported_ms * MILLISECOND), Subject.REPORTED, "words"),)
    )
    return Course({"x_m": x}, {"x_m": "m"}, events, texts, 0)


TIMES: Floats = np.arange(ROWS, dtype=np.float64) / 100.0
GOES: Floats = 0.3 * TIMES
RUNS_ON: Floats = 0.6 * TIMES
STANDS: Floats = np.minimum(GOES, 0.1)
ASIDE_AT_MS = 1e3 * ASIDE["m"] / (0.3 - 0.05 * 0.3)
"""Time at which a robot of twice the speed reaches the limit of a deviation."""


@pytest.mark.parametrize(
    ("ill", "verdict"),
    [
        (course(GOES), Assessment.TOLERATED),
        (course(GOES, held_ms=100.0), Assessment.NOTICED),
        (course(GOES, held_ms=200.0, reported_ms=100.0), Assessment.NOTICED),
        (course(GOES, reported_ms=100.0), Assessment.REPORTED),
        (course(RUNS_ON), Assessment.NOT_NOTICED),
        (course(RUNS_ON, held_ms=ASIDE_AT_MS + LATE_MS - 20.0), Assessment.NOTICED),
        (course(RUNS_ON, held_ms=ASIDE_AT_MS + LATE_MS + 20.0), Assessment.LATE),
        (course(RUNS_ON, reported_ms=ASIDE_AT_MS + LATE_MS + 20.0), Assessment.LATE),
        (course(STANDS), Assessment.STOPPED),
        (course(STANDS, held_ms=2000.0), Assessment.NOTICED),
        (course(GOES + 0.5 * ASIDE["m"]), Assessment.TOLERATED),
    ],
)
def test_what_is_stated_of_a_cell(ill: Course, verdict: Assessment) -> None:
    found = effect(course(GOES), ill)
    assert found.verdict is verdict
    assert (found.standstill_after_ms is not None) == (ill.places["x_m"] is STANDS)
    assert found.goes_m == pytest.approx(float(ill.places["x_m"][-1] - ill.places["x_m"][0]))


def test_who_never_stands_is_not_noticed_whatever_was_reported() -> None:
    """The same robot stands without the failure: the operator lets go."""
    stands = course(STANDS)
    assert effect(stands, course(RUNS_ON, held_ms=100.0, reported_ms=50.0)).verdict is Assessment.NOT_NOTICED
    assert effect(stands, course(RUNS_ON, held_ms=100.0)).standstill_after_ms is None
    assert effect(course(GOES), course(GOES, held_ms=100.0)).verdict is Assessment.NOTICED


@pytest.mark.parametrize(
    ("ends_ms", "verdict"), [(2_000.0, Assessment.NOTICED), (1_900.0, Assessment.TOLERATED)]
)
def test_a_notice_that_comes_of_the_failures_own_end_is_none(ends_ms: float, verdict: Assessment) -> None:
    ill = replace(course(GOES, held_ms=1_950.0, reported_ms=1_960.0), ends=int(ends_ms * MILLISECOND))
    assert effect(course(GOES), ill).verdict is verdict


def test_the_first_of_words_and_holds_states_whether_it_was_late() -> None:
    reported = course(RUNS_ON, held_ms=ASIDE_AT_MS + LATE_MS + 500.0, reported_ms=100.0)
    found = effect(course(GOES), reported)
    assert (found.verdict, found.noticed_by) == (Assessment.NOTICED, "a row")


@pytest.mark.parametrize(
    ("protocol", "runs_on"), [("ros-arduino-bridge", False), ("mw", True), ("arduinoio", True)]
)
def test_a_bridge_that_is_killed_is_excused_only_where_the_devices_stop_by_themselves(
    protocol: str, *, runs_on: bool
) -> None:
    made = partial(over_protocol, find("rome"), protocol, 3)
    cells = of_state(made, all_failures(made(), ["bridge_ends"]), "speed 50%")
    killed = next(cell for cell in cells if "killed" in cell.failure.title)
    assert killed.effect.verdict is Assessment.NOT_NOTICED
    assert killed.wrong is runs_on
    assert (killed.effect.standstill_after_ms is None) is runs_on
    assert bool(killed.why) is not runs_on
    requested = next(cell for cell in cells if "interrupted" in cell.failure.title)
    assert not requested.late


def test_what_holds_without_the_failure_has_not_noticed_it() -> None:
    held = course(GOES, held_ms=100.0, reported_ms=50.0)
    assert effect(held, held).verdict is Assessment.TOLERATED


def test_an_encoder_that_freezes_while_the_robot_is_stopped_does_not_run_away_unseen() -> None:
    made = partial(find, "rars")
    cells = of_state(made, all_failures(made(), ["encoder_frozen"]), "stopping")
    left = next(cell for cell in cells if cell.failure.place == "left")
    assert left.effect.verdict is Assessment.NOTICED
    assert left.effect.noticed_by == "position not changing: left"
    assert left.effect.after_ms is not None
    assert left.effect.after_ms < LATE_MS
    assert left.effect.standstill_after_ms is not None
    assert left.effect.goes_m < 0.2


@pytest.mark.long(beside="test_an_encoder_that_freezes_while_the_robot_is_stopped_does_not_run_away_unseen")
def test_the_matrix_does_not_depend_on_how_many_share_the_work() -> None:
    made = partial(find, "ar2")
    failures = all_failures(made(), ["board_reset", "datagram_loss"])
    reported: list[int] = []
    one = matrix(made, ["at rest", "up 50%"], failures, 1, lambda cells: reported.append(len(cells)))
    two = matrix(made, ["at rest", "up 50%"], failures, 2, lambda cells: reported.append(len(cells)))
    assert one == two
    assert reported == [len(failures)] * 4
    assert [cell.state for cell in one] == ["at rest"] * len(failures) + ["up 50%"] * len(failures)


def ended() -> int | str | None:
    """Run the program; return its status."""
    with pytest.raises(SystemExit) as end:
        main()
    return end.value.code


class Table(HTMLParser):
    """Counter of the elements of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.kinds: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take a cell's class."""
        if tag == "td":
            self.kinds.append(str(dict(attrs)["class"]))


def test_what_no_one_has_thought_about_is_wrong_and_ends_the_program(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ["fmea", "rome", "--fault", "load_lifted", "--state", "left 50%", "--jobs", "1", "--out"]
    monkeypatch.setattr("sys.argv", ["firmware-bridge", *words, str(tmp_path)])
    assert ended() == 0
    assert "only cameras detect it" in capsys.readouterr().out
    monkeypatch.setattr(matrices, "reason", lambda *_: "")
    assert ended() == 1
    assert "left 50%: load_lifted one: NOT NOTICED; it goes" in " ".join(capsys.readouterr().err.split())
    rows = list(csv.DictReader(io.StringIO((tmp_path / "fmea.csv").read_text(encoding="utf-8"))))
    assert [row["verdict"] for row in rows] == ["NOT NOTICED"] * 3
    page = Table()
    page.feed((tmp_path / "fmea.html").read_text(encoding="utf-8"))
    assert page.kinds == ["wrong"] * 3


@pytest.mark.parametrize(
    ("words", "stated"),
    [
        (["--fault", "encoder_frosen"], "no such fault as 'encoder_frosen'; perhaps 'encoder_frozen'"),
        (["--state", "flying"], "no such state as 'flying'"),
        (["--fault", "grip_lost"], "rars cannot have these faults"),
    ],
)
def test_a_wrong_word_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: list[str], stated: str
) -> None:
    monkeypatch.setattr("sys.argv", ["firmware-bridge", "fmea", "rars", *words])
    assert ended() == 2
    assert stated in " ".join(capsys.readouterr().err.split())


@pytest.mark.long(beside="test_an_encoder_that_freezes_while_the_robot_is_stopped_does_not_run_away_unseen")
@pytest.mark.parametrize("name", MACHINES)
def test_no_one_overlooks_a_failure_of_this_robot(name: str) -> None:
    made = partial(find, name)
    cells = [cell for state in state_names(made()) for cell in of_state(made, all_failures(made()), state)]
    assert list(wrongs(cells)) == []
    assert as_csv(cells).count("\n") == len(cells) + 1
    assert as_csv(cells).startswith(",".join(COLUMNS))
    assert as_page(name, cells).count("<td ") == len(cells)
