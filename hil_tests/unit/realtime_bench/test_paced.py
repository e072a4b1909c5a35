"""A bench at a clock's pace: the same run as in virtual time, faults from outside, stations from outside."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from emulators.bench.faults import kinds
from emulators.bench.faults.failures import failures_of
from firmware_bridge.cli import program
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds, to_seconds
from hil_tests.unit.realtime_bench.paced_bench import STATION, PacedBench, paced

ARM, INJECT, CLEAR_STOP = 400, dialect.MAV_CMD_INJECT_FAILURE, 5300
MOTOR, CAMERAS, SIGNAL = 101, 6, 105
OK, OFF, STUCK, GARBAGE, WRONG, INTERMITTENT = 0, 1, 2, 3, 4, 7
ACCEPTED, DENIED = 0, 2


def test_at_a_clock_s_pace_the_run_is_the_same_as_in_virtual_time(tmp_path: Path) -> None:
    with paced("rars", "line", tmp_path) as bench, paced("rars", "line", tmp_path) as other:
        for part in (3.0, 17.0, 1300.0, 2000.5, 1679.5):
            bench.runs(part)
        other.rig.run(from_seconds(5.0))
        assert bench.rig.world.now == other.rig.world.now
        assert bench.rig.world.trace_sha256 == other.rig.world.trace_sha256
        assert bench.rig.samples.csv() == other.rig.samples.csv()


@pytest.mark.parametrize("name", ["rars", "rome", "climber"])
def test_every_kind_of_fault_begins_when_its_request_comes(name: str, tmp_path: Path) -> None:
    robot = find(name)
    mission = {"rars": "line", "rome": "line", "climber": "square"}[name]
    with paced(name, mission, tmp_path) as bench:
        bench.runs(1000)
        begun = 0
        for failure in failures_of(robot):
            bench.runs(7.3)
            answer = bench.does("inject", fault=failure.kind, keys=dict(failure.keys))
            assert answer["ok"], (failure.kind, answer)
            record = bench.rig.faults.records[-1]
            assert (record.kind, to_seconds(record.began)) == (failure.kind, answer["at_s"])
            assert record.began == bench.now
            begun += 1
            assert bench.does("clear")["ok"]
        assert begun == len(failures_of(robot)) > 20
        assert bench.rig.faults.standing == ()
        assert {one.kind for one in bench.rig.faults.records} <= kinds().keys()


@pytest.mark.parametrize(("milliseconds", "ends"), [(59_990, False), (60_010, True)])
def test_it_ends_with_its_mission(tmp_path: Path, milliseconds: float, ends: bool) -> None:  # noqa: FBT001
    with paced("rome", "line", tmp_path) as bench:
        bench.runs(milliseconds)
        assert bench.desk.finished is ends
        assert to_seconds(bench.rig.world.now) == min(milliseconds / 1000, 60.0)


def test_it_ends_on_request(tmp_path: Path) -> None:
    with paced("rome", "line", tmp_path) as bench:
        assert bench.does("shutdown")["ok"]
        assert bench.desk.finished


@pytest.fixture
def driven(tmp_path: Path) -> Iterator[PacedBench]:
    with paced("rars", "line", tmp_path, outside=True) as bench:
        bench.stays(3000)
        yield bench


def test_a_station_outside_arms_it_and_is_answered_where_it_speaks_from(tmp_path: Path) -> None:
    with paced("rome", "line", tmp_path, outside=True) as bench:
        bench.stays(3000)
        assert bench.orders(ARM, 1.0)[0] == ACCEPTED
        states = [one.base_mode & 128 for one in bench.stays(1200) if one.get_type() == "HEARTBEAT"]
        assert states[-1] == 128
        # Before there is one, telemetry has no address.
        assert {packet.address for packet in bench.sent} - {0} == {STATION}


def test_a_station_injects_failures_of_the_devices(driven: PacedBench) -> None:
    result, texts = driven.orders(INJECT, MOTOR, STUCK, 2)
    assert result == ACCEPTED
    assert "injected failures: set_points_ignored right" in texts
    (fault,) = driven.rig.faults.records
    assert (fault.kind, fault.nodes, fault.ended) == ("set_points_ignored", ("right",), None)
    assert driven.orders(INJECT, MOTOR, OFF, 0)[0] == ACCEPTED
    assert [one.kind for one in driven.rig.faults.records[1:]] == ["drive_restart"] * 4
    assert driven.orders(INJECT, MOTOR, OK, 1)[0] == ACCEPTED
    assert [one.nodes[0] for one in driven.rig.faults.records if one.ended] == ["left"]
    assert driven.orders(INJECT, MOTOR, OK, 0)[0] == ACCEPTED
    assert all(one.ended is not None for one in driven.rig.faults.records)


def test_an_emergency_stop_ends_them_all(driven: PacedBench) -> None:
    assert driven.orders(INJECT, MOTOR, INTERMITTENT, 1)[0] == ACCEPTED
    assert driven.rig.faults.standing != ()
    assert driven.orders(CLEAR_STOP, 0.0)[0] == ACCEPTED
    assert driven.rig.faults.standing == ()


@pytest.mark.parametrize(
    ("params", "reason"),
    [
        ((MOTOR, GARBAGE, 1), "types of motor are 0: none, 1: off, 2: stuck, 4: wrong, 7: intermittent"),
        ((MOTOR, OFF, 5), "motor has instances 1 to 4, and 0 for all"),
        ((MOTOR, OFF, 0.5), "the instance is a whole number, 0 for all"),
        ((CAMERAS, OFF, 1), "rars has no link to a capture system"),
        ((9, OFF, 1), "units of this robot are the link's signals (104, 105), battery (100), motor (101)"),
    ],
)
def test_what_no_device_can_have_is_denied_with_the_reason(
    driven: PacedBench, params: tuple[float, ...], reason: str
) -> None:
    result, texts = driven.orders(INJECT, *params)
    assert result == DENIED
    assert reason in texts
    assert driven.rig.faults.records == []


def test_a_motor_that_cannot_have_it_leaves_the_others_without_it(driven: PacedBench) -> None:
    """All or none: two failures of one encoder's wires cannot be on at once."""
    assert driven.orders(INJECT, MOTOR, WRONG, 4)[0] == ACCEPTED
    assert driven.orders(INJECT, MOTOR, WRONG, 0)[0] == DENIED
    assert [one.nodes for one in driven.rig.faults.records if one.ended is None] == [("lift",)]


def test_without_a_station_outside_it_is_denied(tmp_path: Path) -> None:
    with paced("rars", "line", tmp_path) as bench:
        answer = bench.rig.bridge.operator.injection.request(MOTOR, STUCK, 1)
        assert answer.result == DENIED


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (["--control", "none"], "--control needs --realtime"),
        (["--mavlink", "udpin:127.0.0.1:14550"], "--mavlink needs --realtime"),
        (["--realtime", "--duration", "5"], "--duration needs --mavlink"),
        (["--realtime", "--mavlink", "udpin:0.0.0.0:14550"], "others than this machine can reach it"),
    ],
)
def test_an_option_that_needs_another_one_is_refused(words: list[str], problem: str) -> None:
    given = CliRunner().invoke(program, ["bench", "rars", *words])
    assert given.exit_code == 2
    assert problem in " ".join(given.output.split())
