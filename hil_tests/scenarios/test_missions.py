"""The shipped missions, driven whole: what stays within its bounds, and what a run leaves behind."""

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import pytest

from emulators.bench import mission as missions
from emulators.robots.rars import BENCH_SETUP
from emulators.run import RunOrder, drive
from firmware_bridge.canopen_drive.driver.scale import Scale
from firmware_bridge.recording import parse_candump
from firmware_bridge.robot_types import find
from firmware_bridge.units import from_seconds

TSHARK: Final = shutil.which("tshark") or "tshark: not installed"
LARGEST_SPEED_MPS: Final = 0.505
LARGEST_ACCELERATION_MPS2: Final = 1.45
Driven = Callable[[str], Path]


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Driven:
    """Drive a shipped mission once, and return the folder of its results."""
    folders: dict[str, Path] = {}

    def results(name: str) -> Path:
        if name not in folders:
            folders[name] = tmp_path_factory.mktemp(name)
            run(name, folders[name])
        return folders[name]

    return results


def run(name: str, folder: Path, seed: int = 0) -> str:
    rars = find("rars")
    order = RunOrder(rars, BENCH_SETUP, name, missions.find(name, rars, BENCH_SETUP), seed, folder)
    return drive(order, lambda _: None).trace_sha256


def summary(folder: Path) -> dict[str, Any]:
    read: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return read


@pytest.mark.long(beside="test_its_missions_drive_without_a_refusal_and_it_ends_without_power")
def test_an_operator_who_tries_everything_forbidden_gets_no_further(driven: Driven) -> None:
    reported = summary(driven("interlocks"))
    assert reported["max_speed_mps"] <= LARGEST_SPEED_MPS
    assert reported["max_acceleration_mps2"] <= LARGEST_ACCELERATION_MPS2


@pytest.mark.long(beside="test_at_its_threshold_it_stops_the_robot_and_states_why")
def test_every_interlock_that_an_operator_can_trip_is_tripped_and_states_why(driven: Driven) -> None:
    events = summary(driven("interlocks"))["interlock_events"]
    assert all(event["reason"] for event in events)
    assert {
        "not armed",
        "speed limit",
        "acceleration limit",
        "steer angle limit",
        "turn radius limit",
        "lift refused",
        "lift moving",
        "lift extended",
        "operator link timeout",
        "emergency stop",
        "axis not enabled: left",
    } <= {event["name"] for event in events}


@pytest.mark.long(beside="test_the_lift_rises_at_rest_only_and_holds_the_wheels")
def test_nothing_rolls_while_the_lift_is_extended(driven: Driven) -> None:
    """From the positions on the bus: between two frames with the lift out, no wheel turns by 2 mm."""
    retracted = 0.005
    rars = find("rars")
    frames = [parse_candump(line) for line in (driven("interlocks") / "can.log").read_text().splitlines()]
    lifted = [
        (event["began_s"], event["ended_s"])
        for event in summary(driven("interlocks"))["interlock_events"]
        if event["name"] == "lift extended"
    ]
    assert len(lifted) >= 2
    assert rars.geometry.limits.lift_retracted_m == retracted
    for began, ended in lifted:
        for address in (0x281, 0x282):
            counts = [
                int.from_bytes(packet.payload[2:6], "little", signed=True)
                for at, _, packet in frames
                if packet.address == address and from_seconds(began) <= at <= from_seconds(ended)
            ]
            assert len(counts) > 10
            turned = Scale.of(rars.axes[0]).position(max(counts) - min(counts))
            metres = turned * rars.geometry.base.wheel_radius_m
            assert metres < 0.002


@pytest.mark.long(beside="test_a_mission_begins_as_it_always_did")
def test_the_line_reaches_its_speed_at_its_acceleration(driven: Driven) -> None:
    reported = summary(driven("line"))
    assert reported["max_speed_mps"] == pytest.approx(0.240, rel=0.02)
    assert reported["max_acceleration_mps2"] == pytest.approx(0.024, rel=0.7)
    assert reported["odometry_error_m"] < 0.005


INDEX_FAULTS: Final = 3
"""The first one at a wrong count, channels exchanged, counts lost."""


@pytest.mark.long(beside="test_a_cause_has_the_outcome_that_was_measured")
def test_what_goes_wrong_in_the_mission_of_faults_is_held_and_named(driven: Driven) -> None:
    reported = summary(driven("faults"))
    assert reported["max_speed_mps"] <= LARGEST_SPEED_MPS
    assert reported["max_acceleration_mps2"] <= LARGEST_ACCELERATION_MPS2
    assert len(reported["faults"]) == len(missions.find("faults", find("rars"), BENCH_SETUP).fault)
    assert all(fault["title"] for fault in reported["faults"])
    reasons = " ".join(event["reason"] for event in reported["interlock_events"])
    for code in ("0x8110", "0x3220", "0x4210", "0xFF0A", "0x81FD", "0x8130"):
        assert code in reasons
    # Where the index comes first, before or after its turn, hangs on where the wheels stand.
    assert reasons.count("0xFF02") + reasons.count("0xFF03") >= INDEX_FAULTS
    names = {event["name"].split(":")[0] for event in reported["interlock_events"]}
    assert {"operator link timeout", "axis timeout", "axis fault", "axis not enabled", "not armed"} <= names


@pytest.mark.long(beside="test_a_cause_has_the_outcome_that_was_measured")
def test_nothing_but_rolling_out_follows_a_fault_that_stops_the_robot(driven: Driven) -> None:
    """From the titles: until the seventeenth second no one stops; after each later fault all do."""
    reported = summary(driven("faults"))
    stopped = [
        event["began_s"]
        for event in reported["interlock_events"]
        if event["name"] in {"not armed", "operator link timeout"}
    ]
    for fault in reported["faults"]:
        soon = [at for at in stopped if fault["began_s"] <= at <= fault["began_s"] + 1.0]
        armed = fault["began_s"] < 110.0
        assert bool(soon) is (fault["began_s"] >= 17.0 and armed), fault["title"]


@pytest.mark.long(beside="test_what_it_leaves_behind_is_what_its_page_states")
def test_a_run_leaves_everything_that_it_promises(driven: Driven) -> None:
    folder = driven("line")
    names = {path.name for path in folder.iterdir()}
    assert {
        "summary.json",
        "can.log",
        "operator.tlog",
        "path.png",
        "speeds.png",
        "currents.png",
        "interlocks.png",
    } <= names
    assert {
        "simulated_s",
        "wall_s",
        "realtime_factor",
        "max_speed_mps",
        "max_acceleration_mps2",
        "path_length_m",
        "odometry_error_m",
        "holds",
        "frames",
        "bus_load_percent",
        "trace_sha256",
    } <= set(summary(folder))
    assert summary(folder)["guard_refusals"] == 0


@pytest.mark.long(beside="test_two_runs_with_one_seed_are_the_same_bytes")
def test_one_seed_is_one_run(driven: Driven, tmp_path: Path) -> None:
    again = run("line", tmp_path)
    assert again == summary(driven("line"))["trace_sha256"]
    for name in ("can.log", "operator.tlog"):
        assert (tmp_path / name).read_bytes() == (driven("line") / name).read_bytes()


@pytest.mark.long(beside="test_tshark_finds_nothing_malformed")
@pytest.mark.tshark
@pytest.mark.parametrize("name", ["line", "interlocks"])
def test_a_third_party_dissector_finds_no_malformed_frame(driven: Driven, name: str) -> None:
    log = driven(name) / "can.log"
    canopen = ["-r", str(log), "-d", "can.subdissector,canopen"]
    read = subprocess.run([TSHARK, *canopen], capture_output=True, check=True, text=True)
    assert read.stdout.count("\n") == summary(driven(name))["frames"]
    assert "SYNC" in read.stdout
    wrong = subprocess.run(
        [TSHARK, *canopen, "-Y", "_ws.malformed"], capture_output=True, check=True, text=True
    )
    assert wrong.stdout == ""
