"""A mission recorded in MCAP: the frames of can.log, one file for one seed, and what reads it."""

import hashlib
import json
import sys
from pathlib import Path

import pytest
import typer

from emulators.cli.options import run_file
from firmware_bridge.cli.program import main
from firmware_bridge.extras import LIBRARIES
from firmware_bridge.mcap_file.channels import drive_topics
from firmware_bridge.mcap_file.reader import attachments, frames
from firmware_bridge.recording import parse_candump, parse_chunk, parse_tlog
from firmware_bridge.robot_types import find
from firmware_bridge.units import MICROSECOND
from hil_tests.unit.mcap_file.recorded_run import BOARD, CRAWL, recorded, rows

SILENT_AT = 2_400_000_000
"""Begin of the fault, in ns."""
OURS = ("firmware_bridge.mcap_file.", "firmware_bridge.runtime.mcap_box")
"""Modules that need the extra."""


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of runs: two with one seed, one with another, and one of a board on a line."""
    folder = tmp_path_factory.mktemp("mcap")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("emulators.run.installed", lambda _extra: False)
        for name, seed in (("first", 3), ("second", 3), ("other", 4)):
            recorded(folder, name, seed)
        recorded(folder, "board", robot="rome", text=BOARD)
    return folder


def command(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, str, str]:
    """Run the program; return its status and both outputs."""
    monkeypatch.setattr("sys.argv", ["firmware-bridge", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    captured = capsys.readouterr()
    return int(ended.value.code or 0), captured.out, captured.err


def test_its_frames_are_those_of_can_log_one_by_one(runs: Path) -> None:
    logged = [parse_candump(line) for line in (runs / "first/can.log").read_text("ascii").splitlines()]
    found = list(rows(runs / "first.mcap", "/can/frames"))
    assert len(logged) > 500
    assert [(row.at // MICROSECOND * MICROSECOND, row.message.bus) for row in found] == [
        (at, bus) for at, bus, _ in logged
    ]
    assert [(row.message.id, row.message.data) for row in found] == [
        (packet.address, packet.payload) for _, _, packet in logged
    ]
    assert [packet for _, _, packet in frames(runs / "first.mcap", lambda _note: None)] == [
        packet for _, _, packet in logged
    ]
    by_bridge = {row.message.id for row in found if row.message.sent}
    assert 0x80 in by_bridge
    assert 0x181 not in by_bridge, "a drive's own"


def test_its_datagrams_and_bytes_are_those_of_the_logs(runs: Path) -> None:
    telemetry = [message for _, message in parse_tlog((runs / "first/operator.tlog").read_bytes())]
    datagrams = [row.message for row in rows(runs / "first.mcap", "/datagrams")]
    assert b"".join(one.data for one in datagrams) == b"".join(telemetry)
    lines = [parse_chunk(line) for line in (runs / "board/serial.log").read_text("ascii").splitlines()]
    assert lines
    found = [(row.at, row.message.link, row.message.data) for row in rows(runs / "board.mcap", "/serial")]
    assert found == [(at, packet.link, packet.payload) for at, _, packet in lines]


def test_one_seed_gives_one_file_and_another_seed_another(runs: Path) -> None:
    first, second, other = (
        hashlib.sha256((runs / f"{name}.mcap").read_bytes()).hexdigest()
        for name in ("first", "second", "other")
    )
    assert first == second
    assert other != first
    sent = [
        [row.at for row in rows(runs / f"{name}.mcap", "/datagrams")] for name in ("first", "second", "other")
    ]
    assert sent[0] == sent[1] != sent[2], "not the metadata alone"


def test_every_time_is_the_runs_own(runs: Path) -> None:
    found = list(rows(runs / "first.mcap"))
    at = [row.at for row in found]
    assert at == sorted(at), "a reader needs no sorting"
    assert 0 <= at[0] < at[-1] <= 3_000_000_000
    for row in found:
        if row.schema.startswith("foxglove."):
            assert row.message.timestamp.seconds * 1_000_000_000 + row.message.timestamp.nanos == row.at
    assert b"wall_s" not in (runs / "first.mcap").read_bytes()


def test_each_drive_has_its_state_in_every_cycle(runs: Path) -> None:
    topics = drive_topics(find("rars"))
    joints = [row.message.joints for row in rows(runs / "first.mcap", "/robot/joints")]
    for axis, topic in topics.items():
        found = list(rows(runs / "first.mcap", topic))
        states = [row.message for row in found]
        assert 50 <= len(states) <= 62, "3 s of cycles of 50 ms"
        assert {one.axis for one in states} == {axis}
        enabled = [row.message for row in found if row.at < SILENT_AT][-10:]
        assert {one.state for one in enabled} == {"operation enabled"}
        # The same by the drive's own word.
        assert {one.statusword & 0x6F for one in enabled} == {0x27}
        measured = [one.position for one in states if one.HasField("position")]
        assert measured == [joint.position for row in joints for joint in row if joint.name == axis]
    drives = [row.message for row in rows(runs / "first.mcap", topics["left"]) if row.at < SILENT_AT][-1]
    assert (drives.mode_name, drives.unit, drives.power) == ("profile velocity", "rad", "on")
    assert drives.velocity > 0.1
    assert drives.HasField("current_a")


def test_the_true_pose_and_the_bridges_are_those_of_samples_csv(runs: Path) -> None:
    head, *lines = (runs / "first/samples.csv").read_text("ascii").splitlines()
    table = [dict(zip(head.split(","), map(float, line.split(",")), strict=True)) for line in lines]
    for topic, column in (("/robot/pose", "x_m"), ("/robot/odometry", "odometry_x_m")):
        found = [row.message.pose.position.x for row in rows(runs / "first.mcap", topic)]
        assert found == pytest.approx([row[column] for row in table], abs=1e-8)
        assert found[-1] > 0.01


def test_interlocks_arming_faults_and_texts_are_there(runs: Path) -> None:
    events = [row.message for row in rows(runs / "first.mcap", "/events")]
    kinds = {one.Kind.Name(one.kind): one for one in events}
    assert set(kinds) >= {"INTERLOCK_ACTIVE", "INTERLOCK_CLEARED", "ARMED", "FAULT_BEGAN", "FAULT_ENDED"}
    assert (kinds["FAULT_BEGAN"].name, list(kinds["FAULT_BEGAN"].devices)) == ("node_silent", ["lift"])
    assert kinds["FAULT_BEGAN"].since_ns == SILENT_AT
    summary = json.loads((runs / "first/summary.json").read_text("utf-8"))
    active = [one.name for one in events if one.kind == one.INTERLOCK_ACTIVE]
    assert {one["name"] for one in summary["interlock_events"]} <= set(active)
    texts = [row.message.message for row in rows(runs / "first.mcap", "/log")]
    assert any(text.startswith("the robot is not armed") for text in texts)


def test_mission_summary_and_robot_are_attached(runs: Path) -> None:
    found = attachments(runs / "first.mcap")
    assert set(found) == {"mission.toml", "summary.json", "run.json"}
    assert found["mission.toml"].decode() == CRAWL
    assert found["run.json"] == (runs / "first/run.json").read_bytes()
    whole = json.loads((runs / "first/summary.json").read_text("utf-8"))
    attached = json.loads(found["summary.json"])
    assert attached == {key: value for key, value in whole.items() if key in attached}
    assert set(whole) - set(attached) == {"wall_s", "realtime_factor"}


def test_explain_reads_of_it_what_it_reads_of_the_folder(
    runs: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, robot in (("first", "rars"), ("board", "rome")):
        explained = []
        for path in (runs / name, runs / f"{name}.mcap"):
            status, out, err = command(["explain", str(path), "--robot", robot], monkeypatch, capsys)
            explained.append((status, out.replace(str(path), "it"), err.replace(str(path), "it")))
        assert explained[0] == explained[1]
        assert explained[0][1]


def test_explain_reports_a_file_without_its_end_in_one_line(
    runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole, cut = (runs / "first.mcap").read_bytes(), tmp_path / "cut.mcap"
    cut.write_bytes(whole[:-100])
    status, out, err = command(["explain", str(cut)], monkeypatch, capsys)
    assert status in {0, 1}
    assert err == f"firmware-bridge: {cut}: its end is cut off\n"
    assert out
    cut.write_bytes(whole[:500])
    status, out, err = command(["explain", str(cut)], monkeypatch, capsys)
    what = "its end is cut off before its first message; record it again"
    assert (status, out, err) == (3, "", f"firmware-bridge: {cut}: cannot be read: {what}\n")


def test_a_monitor_and_a_replay_take_it(
    runs: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    drawn = [
        command(["monitor", "--log", str(path), "--robot", "rars"], monkeypatch, capsys)
        for path in (runs / "first/can.log", runs / "first.mcap")
    ]
    assert drawn[0] == drawn[1]
    status, out, _ = command(
        ["replay", str(runs / "first.mcap"), "rars", "--until", "1"], monkeypatch, capsys
    )
    assert (status, out.partition(":")[0]) == (0, "no difference")


@pytest.mark.parametrize("library", LIBRARIES["mcap"])
def test_without_the_extra_one_line_names_it(
    runs: Path, library: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # As in a program that has imported none of it yet.
    for module in [name for name in sys.modules if name.startswith((*LIBRARIES["mcap"], *OURS))]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.delattr("firmware_bridge.mcap_file.reader", raising=False)
    monkeypatch.setitem(sys.modules, library, None)
    file, log = str(runs / "new.mcap"), str(runs / "first.mcap")
    for words, status in (
        (["bench", "rars", "--record", file], 2),
        (["emulate", "rars", "--serial", "pty", "--duration", "0.1", "--record", file], 2),
        (["explain", log], 3),
    ):
        ended, out, err = command(words, monkeypatch, capsys)
        assert (ended, out) == (status, "")
        assert err.count("\n") == 1
        assert "pip install 'firmware-bridge[mcap]'" in err
    assert not (runs / "new.mcap").exists()
    # Before a plant is built, which may take a minute.
    with pytest.raises(typer.Exit):
        run_file(runs / "new.mcap")


def test_bench_records_in_a_file_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_file(tmp_path / "A.MCAP") == tmp_path / "A.MCAP"
    ended, _, err = command(["bench", "rars", "--record", str(tmp_path / "folder")], monkeypatch, capsys)
    assert ended == 2
    assert err == (
        f"firmware-bridge: --record {tmp_path / 'folder'}: name a file that ends in .asc, .blf, .trc or "
        ".mcap; --out names the results' folder\n"
    )
