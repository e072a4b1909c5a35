"""Campaigns driven: the same results by any number of processes, resumed when killed, failures kept."""

import csv
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from distributed import Client, LocalCluster
from pyarrow import parquet  # type: ignore[import-untyped]

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import load as load_mission
from emulators.campaign.campaign_file import load
from emulators.campaign.cluster import ClusterError
from emulators.campaign.engine import Settings, campaign, drive_alone
from emulators.campaign.journal import NAME, JournalError
from emulators.campaign.plan import Plan, plan
from emulators.campaign.results import ERROR
from emulators.run import RunOrder, measure
from firmware_bridge.campaign import run as run_campaign
from firmware_bridge.robot_types import find
from hil_tests.campaign.campaigns import written

PROGRAM = str(Path(sys.executable).with_name("firmware-bridge"))


def made(folder: Path, **changed: object) -> Plan:
    return plan(load(written(folder, **changed)), str(folder / "floors.toml"), folder)


def driven(made_plan: Plan, out: Path, jobs: int = 1, **more: object) -> bytes:
    campaign(made_plan, Settings(out=out, jobs=jobs, **more))  # type: ignore[arg-type] # settings by name
    return (out / "results.csv").read_bytes()


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, bytes]:
    """Return the campaign's folder, and the results of one process."""
    folder = tmp_path_factory.mktemp("campaign")
    return folder, driven(made(folder), folder / "one")


def test_a_row_has_the_key_the_numbers_and_no_clock(reference: tuple[Path, bytes]) -> None:
    rows = list(csv.DictReader(reference[1].decode().splitlines()))
    assert [int(row["run"]) for row in rows] == list(range(12))
    assert {"plant.floor_friction", "link.delay", "path_length_m", "trace_sha256", "interlocks"} <= set(
        rows[0]
    )
    assert not {"wall_s", "realtime_factor"} & set(rows[0])
    assert {row["failed"] for row in rows} == {""}
    # Runs that differ in what they are of differ in what was on the bus.
    assert len({row["trace_sha256"] for row in rows}) == 12
    assert "floors and loads" in (reference[0] / "one" / "report.html").read_text(encoding="utf-8")


@pytest.mark.long(keeps=["2"])
@pytest.mark.parametrize("jobs", [2, 4])
def test_the_results_are_the_same_for_any_number_of_processes(
    jobs: int, reference: tuple[Path, bytes], tmp_path: Path
) -> None:
    assert driven(made(reference[0]), tmp_path, jobs) == reference[1]


def test_a_campaign_that_is_killed_goes_on_where_it_was(
    reference: tuple[Path, bytes], tmp_path: Path
) -> None:
    folder = reference[0]
    line = [PROGRAM, "campaign", str(folder / "floors.toml"), "--out", str(tmp_path), "--jobs", "2"]
    journal = tmp_path / NAME
    kept = b""
    # On a busy machine it may be over before it is killed: then once more from the beginning.
    while not 4 <= kept.count(b"\n") < 13:
        journal.unlink(missing_ok=True)
        begun = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        while begun.poll() is None and (not journal.exists() or journal.read_bytes().count(b"\n") < 4):
            os.sched_yield()
        begun.kill()
        begun.communicate()
        kept = journal.read_bytes()
    # A line that was being written as it was killed.
    journal.write_bytes(kept[: kept.rfind(b"\n") + 1] + b'[{"run": 3, "rob')
    again = subprocess.run(line, check=True, capture_output=True, text=True)
    assert (tmp_path / "results.csv").read_bytes() == reference[1]
    assert "12 runs, 0 failed" in again.stdout
    before = kept[: kept.rfind(b"\n") + 1].splitlines()
    assert journal.read_bytes().splitlines()[: len(before)] == before, "what was driven is driven again"


def test_ctrl_c_ends_it_with_one_line(tmp_path: Path) -> None:
    # Minutes of runs: however busy the machine is, they are not over before the signal.
    file, out = written(tmp_path, seeds=500), tmp_path / "out"
    line = [PROGRAM, "campaign", str(file), "--out", str(out), "--jobs", "2"]
    journal = out / NAME
    begun = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not journal.exists() or journal.read_bytes().count(b"\n") < 2:
        assert begun.poll() is None, begun.communicate()[1]
        os.sched_yield()
    begun.send_signal(signal.SIGINT)
    _, errors = begun.communicate()
    assert begun.returncode == 130
    assert errors == f"interrupted; what was driven is in {out}/, and the same line goes on there\n"


def test_another_campaign_in_the_folder_is_refused(reference: tuple[Path, bytes]) -> None:
    folder = reference[0]
    other = made(folder, seeds=1)
    with pytest.raises(JournalError, match="has another campaign's runs: choose another --out"):
        campaign(other, Settings(out=folder / "one"))
    written(folder)


def test_a_journal_that_is_none_is_refused_by_its_line(reference: tuple[Path, bytes], tmp_path: Path) -> None:
    lines = (reference[0] / "one" / NAME).read_bytes().splitlines()
    (tmp_path / NAME).write_bytes(b"\n".join([lines[0], b"nonsense", b""]))
    with pytest.raises(JournalError, match="line 2: is no run"):
        campaign(made(reference[0]), Settings(out=tmp_path))


FAULT = {"kind": "node_silent", "node": "left", "at_s": 3.0}


@pytest.fixture(scope="module")
def failing(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Plan]:
    """Return a folder with the results of two runs, one of which fails, and the campaign."""
    folder = tmp_path_factory.mktemp("failing")
    require = [{"never": "axis timeout: left"}]
    of = made(folder, parameter=[], seeds=1, faults=[{}, FAULT], require=require)
    campaign(of, Settings(out=folder / "out"))
    return folder / "out", of


def test_a_failing_run_keeps_its_recording_and_a_smaller_mission(failing: tuple[Path, Plan]) -> None:
    out, _ = failing
    rows = list(csv.DictReader((out / "results.csv").read_text(encoding="utf-8").splitlines()))
    assert [bool(row["failed"]) for row in rows] == [False, True], rows
    (folder,) = (out / "failures").iterdir()
    assert folder.name == "000001"
    assert {"can.log", "summary.json", "report.html", "mission.toml", "robot.toml"} <= {
        it.name for it in folder.iterdir()
    }
    robot = find(str(folder / "robot.toml"))
    smaller = load_mission(folder / "smaller.toml", robot, bench_setup_of(robot))
    whole = load_mission(folder / "mission.toml", robot, bench_setup_of(robot))
    assert len(smaller.step) < len(whole.step) or smaller.duration_s < whole.duration_s
    again = measure(RunOrder(robot, bench_setup_of(robot), "smaller", smaller, 0, folder))
    assert rows[1]["failed"].split("; ")[0].split("'")[1] in [event.name for event in again.interlock_events]


def test_the_page_has_the_line_that_drives_it_again(failing: tuple[Path, Plan]) -> None:
    out, of = failing
    text = (out / "report.html").read_text(encoding="utf-8")
    assert f"firmware-bridge campaign {of.file} --only 1 --out {out}" in text
    assert "failures/000001/" in text
    row = drive_alone(of, 1, out)
    assert row.broken
    assert (out / "run-000001" / "summary.json").exists()
    with pytest.raises(LookupError, match="the campaign has the runs 0 to 1"):
        drive_alone(of, 2, out)


def test_a_run_that_ends_in_an_error_is_a_row_and_ends_nothing_else(tmp_path: Path) -> None:
    # Below the least value that the plant takes: known only when it starts.
    of = made(tmp_path, parameter=[{"path": "plant.gear_left", "values": [-1.0, 26.0]}], seeds=1)
    rows = campaign(of, Settings(out=tmp_path / "out"))
    assert [bool(row.broken) for row in rows] == [True, False]
    assert "gear_left" in rows[0].broken[ERROR]
    # Driven again alone it is a row, too, and no traceback.
    assert drive_alone(of, 0, tmp_path / "out").broken == rows[0].broken
    # Steps and time are left out as long as the plant refuses, and not until the mission is none.
    folder = tmp_path / "out" / "failures" / "000000"
    robot = find(str(folder / "robot.toml"))
    smaller = load_mission(folder / "smaller.toml", robot, bench_setup_of(robot))
    assert smaller.plant == {"gear_left": -1.0}
    assert len(smaller.step) == 1


def test_driven_afresh_nothing_of_before_is_left(failing: tuple[Path, Plan]) -> None:
    out, of = failing
    mark = out / "failures" / "000001" / "mark"
    mark.touch()
    campaign(of, Settings(out=out))
    assert mark.exists()
    campaign(of, Settings(out=out, fresh=True))
    assert not mark.exists()
    assert (mark.parent / "smaller.toml").exists()


def test_from_a_program_a_table_gives_its_rows(
    monkeypatch: pytest.MonkeyPatch, reference: tuple[Path, bytes]
) -> None:
    monkeypatch.chdir(reference[0])
    table = {"robots": ["rars"], "missions": ["short.toml"], "require": [{"key": "frames", "most": 1}]}
    (row,) = run_campaign(table, jobs=1)
    assert row["robot"] == "rars"
    assert row["failed"] == f"frames = {row['frames']} is above 1"
    with pytest.raises(ValueError, match="campaign: robots: is missing"):
        run_campaign({"missions": ["short.toml"]})


def test_parquet_has_the_same_rows(reference: tuple[Path, bytes], tmp_path: Path) -> None:
    driven(made(reference[0], parameter=[]), tmp_path, parquet=True)
    written(reference[0])
    table = parquet.read_table(tmp_path / "results.parquet")
    rows = list(csv.DictReader((tmp_path / "results.csv").read_text(encoding="utf-8").splitlines()))
    assert table.column_names == list(rows[0])
    assert [str(number) for number in table["path_length_m"].to_pylist()] == [
        row["path_length_m"] for row in rows
    ]


def test_the_command_searches_and_names_the_worst(tmp_path: Path) -> None:
    file = written(
        tmp_path, parameter=[{"path": "mission.step[2].speed_mps", "least": 0.05, "most": 0.3}], seeds=1
    )
    line = [
        PROGRAM,
        "campaign",
        str(file),
        "--out",
        str(tmp_path / "out"),
        "--search",
        "max_speed_mps",
        "--runs",
        "5",
    ]
    ended = subprocess.run([*line, "--jobs", "1"], check=True, capture_output=True, text=True)
    assert "largest max_speed_mps: 0." in ended.stdout
    assert "mission.step[2].speed_mps = 0." in ended.stdout
    again = ended.stdout.partition("again: ")[2].splitlines()[0].split()
    assert again[:2] == ["firmware-bridge", "bench"]
    subprocess.run([PROGRAM, *again[1:], "--check"], check=True, capture_output=True)
    assert len((tmp_path / "out" / "results.csv").read_text(encoding="utf-8").splitlines()) == 6
    line[line.index("max_speed_mps")] = "max_sped"
    wrong = subprocess.run([*line, "--jobs", "1"], check=False, capture_output=True, text=True)
    assert wrong.returncode == 1
    assert "--search max_sped: no run has such a number" in wrong.stderr


def test_the_command_names_the_runs_that_failed(failing: tuple[Path, Plan]) -> None:
    out, of = failing
    line = [PROGRAM, "campaign", of.file, "--out", str(out)]
    ended = subprocess.run(line, check=False, capture_output=True, text=True)
    assert ended.returncode == 1
    assert "2 runs, 1 failed" in ended.stdout
    assert "run 1: " in ended.stderr


@contextmanager
def dask(*words: str) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen([sys.executable, "-m", "distributed.cli." + words[0], *words[1:]],
                               stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)  # fmt: skip
    try:
        yield process
    finally:
        process.terminate()
        process.wait()


@pytest.mark.long(beside="test_the_results_are_the_same_for_any_number_of_processes")
def test_a_local_cluster_gives_the_same_results(reference: tuple[Path, bytes], tmp_path: Path) -> None:
    with LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0", host="127.0.0.1"
    ) as local:  # type: ignore[no-untyped-call] # Dask's
        assert driven(made(reference[0]), tmp_path, scheduler=local.scheduler_address) == reference[1]


@pytest.mark.long(beside="test_the_results_are_the_same_for_any_number_of_processes")
def test_two_workers_over_tcp_give_the_same_results_though_one_is_killed(
    reference: tuple[Path, bytes], tmp_path: Path
) -> None:
    place = tmp_path / "scheduler.json"
    loopback = ("--host", "127.0.0.1")
    worker = (
        "dask_worker",
        "--scheduler-file",
        str(place),
        "--nthreads",
        "1",
        "--dashboard-address",
        "127.0.0.1:0",
        *loopback,
    )
    with (
        dask(
            "dask_scheduler",
            "--scheduler-file",
            str(place),
            "--port",
            "0",
            "--dashboard-address",
            "127.0.0.1:0",
            *loopback,
        ),
        dask(*worker, "--no-nanny") as first,
        dask(*worker, "--no-nanny"),
    ):
        deadline = time.monotonic() + 60.0
        while not place.exists() or not place.read_text(encoding="utf-8"):
            assert time.monotonic() < deadline, "no scheduler"
            os.sched_yield()
        with Client(scheduler_file=str(place)) as client:  # type: ignore[no-untyped-call] # Dask's
            client.wait_for_workers(2, timeout=60.0)
            address = client.scheduler_info()["address"]
        killed: list[bool] = []

        def kill_one(_: object) -> None:
            if not killed:
                first.send_signal(signal.SIGKILL)
                killed.append(True)

        campaign(made(reference[0]), Settings(out=tmp_path, scheduler=address), kill_one)
        assert first.wait() == -signal.SIGKILL
    assert (tmp_path / "results.csv").read_bytes() == reference[1]


@pytest.mark.parametrize(
    ("scheduler", "message"),
    [
        ("tcp://127.0.0.1:1", r"--scheduler tcp://127.0.0.1:1: nothing answers there .*; start one: dask"),
        ("127.0.0.1:8786", r"--scheduler '127.0.0.1:8786': it is written as tcp://HOST:PORT"),
        ("tcp://127.0.0.1:99999", "nothing answers there"),
    ],
)
def test_a_scheduler_that_is_not_there_is_one_line(
    scheduler: str, message: str, reference: tuple[Path, bytes], tmp_path: Path
) -> None:
    with pytest.raises(ClusterError, match=message):
        driven(made(reference[0]), tmp_path, scheduler=scheduler)
