"""`bench` from the command line to the last file, on a mission of two seconds."""

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from firmware_bridge.cli import program
from firmware_bridge.recording import parse_candump, parse_tlog
from firmware_bridge.robot_types import robots

MISSION = """
title = "start, arm, and ask for a crawl"
duration_s = 2.0

[noise]
jitter_ms = 5.0

[[step]]
at_s = 0.0
title = "where it stands"
zero = { steering = 0.0, lift = 0.0 }

[[step]]
at_s = 0.2
title = "arm"
arm = true

[[step]]
at_s = 1.0
title = "crawl"
speed_mps = 0.05
"""


def bench(folder: Path, seed: int = 0) -> str:
    mission = folder.parent / "crawl.toml"
    mission.write_text(MISSION, encoding="utf-8")
    words = ["bench", "rars", "--mission", str(mission), "--seed", str(seed), "--out", str(folder)]
    result = CliRunner().invoke(program, words, env={"COLUMNS": "150"})
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bench")
    (folder / "printed").write_text(bench(folder / "first"), encoding="utf-8")
    bench(folder / "second")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("emulators.bench.plots.draw", lambda *_, **__: [])
        bench(folder / "other", seed=1)  # of which no one looks at the pictures
    return folder


def test_what_it_leaves_behind_is_what_its_page_states(results: Path) -> None:
    page = (Path(__file__).parents[3] / "docs/runs.md").read_text(encoding="utf-8")
    rows = page.partition("| file | content |")[2].partition("\n\n")[0].splitlines()
    named = [word.strip("`") for row in rows[2:] for word in row.split("|")[1].split()]
    assert sorted(path.name for path in (results / "first").iterdir()) == sorted(named)


def test_the_table_states_where_the_results_are(results: Path) -> None:
    stated = (results / "printed").read_text(encoding="utf-8")
    assert str(results / "first") in stated.replace("\n", "")
    for word in ("real-time factor", "largest speed", "odometry error", "bus load"):
        assert word in stated


def test_the_summary_is_of_this_run(results: Path) -> None:
    summary = json.loads((results / "first/summary.json").read_text(encoding="utf-8"))
    assert (summary["robot"], summary["mission"], summary["seed"]) == ("rars", "crawl", 0)
    assert summary["simulated_s"] == 2.0
    assert summary["frames"] > 0
    assert len(summary["trace_sha256"]) == 64


def test_the_bus_is_recorded_frame_by_frame(results: Path) -> None:
    lines = (results / "first/can.log").read_text(encoding="ascii").splitlines()
    summary = json.loads((results / "first/summary.json").read_text(encoding="utf-8"))
    instants = [parse_candump(line)[0] for line in lines]
    assert len(lines) == summary["frames"]
    assert instants == sorted(instants)
    assert 0 <= instants[0] <= instants[-1] <= 2_000_000_000


def test_the_line_to_a_board_is_recorded_as_the_bridge_speaks_and_receives(tmp_path: Path) -> None:
    mission = tmp_path / "arm.toml"
    mission.write_text('title = "t"\nduration_s = 2.0\n[[step]]\nat_s = 1.0\ntitle = "arm"\narm = true\n')
    words = ["bench", "rome", "--mission", str(mission), "--out", str(tmp_path / "rome")]
    assert CliRunner().invoke(program, words).exit_code == 0
    lines = (tmp_path / "rome/serial.log").read_text(encoding="ascii").splitlines()
    reported = [line.split(" board ")[1] for line in lines]
    at = reported.index("T 6D 20 30 20 30 20 30 0D")
    assert reported[at - 2 : at] == ["T 62 0D", "R 35 37 36 30 30 0D 0A"]
    assert bytes.fromhex(reported[at + 1][2:]) == b"OK\r\n"
    assert (tmp_path / "rome/can.log").read_bytes() == b""
    (line,) = json.loads((tmp_path / "rome/summary.json").read_text())["lines"]
    again = CliRunner().invoke(program, ["replay", str(tmp_path / "rome"), "rome"])
    assert again.exit_code == 0, again.output
    assert "packets of the bridge are as recorded" in again.output
    carried = sum(len(words) - 1 for words in map(str.split, reported))
    assert 0 <= line["bytes"] - carried < 32  # a chunk is on its way at the end
    assert 0.0 < line["busy_percent"] < 80.0
    # At least the shield's set-up, of 21 writes of 0.5 ms, and motion in half a second of cycles.
    assert 0.5 < line["i2c_percent"] < 50.0


def test_the_operators_link_is_recorded_message_by_message(results: Path) -> None:
    messages = list(parse_tlog((results / "first/operator.tlog").read_bytes()))
    assert len(messages) > 40


def test_one_seed_gives_the_same_bytes_and_another_seed_others(results: Path) -> None:
    first, second, other = (results / name for name in ("first", "second", "other"))
    for name in ("can.log", "operator.tlog", "currents.png", "interlocks.png"):
        assert (first / name).read_bytes() == (second / name).read_bytes(), name
    traces = [json.loads((it / "summary.json").read_text())["trace_sha256"] for it in (first, second, other)]
    assert traces[0] == traces[1] != traces[2]


def test_what_it_recorded_plays_again(results: Path) -> None:
    folder = results / "first"
    frames, words = str(folder / "can.log"), str(folder / "operator.tlog")
    for files in ((frames,), (frames, "--operator", words), (words,)):
        result = CliRunner().invoke(program, ["replay", files[0], "rars", *files[1:]])
        assert result.exit_code == 0, result.output


def test_a_run_that_did_not_start_has_a_status_and_states_why(tmp_path: Path) -> None:
    text = robots()["rars"].read_text(encoding="utf-8")
    other = re.sub(r"product_code = 0x\w+", "product_code = 0x61100000", text, count=1)
    assert other != text
    (tmp_path / "other.toml").write_text(other, encoding="utf-8")
    (tmp_path / "crawl.toml").write_text(MISSION, encoding="utf-8")
    words = ["bench", str(tmp_path / "other.toml"), "--mission", str(tmp_path / "crawl.toml")]
    result = CliRunner().invoke(program, [*words, "--out", str(tmp_path / "out")], env={"COLUMNS": "150"})
    assert result.exit_code == 1
    (line,) = result.stderr.splitlines()
    assert line.startswith("firmware-bridge: the run did not start: node 1 (left rear wheel):")
    assert "0x61100000" in line
