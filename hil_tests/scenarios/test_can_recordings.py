"""A mission recorded for the tools of Vector and PEAK: the frames of can.log, and what reads them here."""

import hashlib
import re
from pathlib import Path

import pytest

from emulators.bench import mission
from emulators.bench.bench_setup import bench_setup_of
from emulators.rig import Rig
from emulators.run import RunOrder, drive
from firmware_bridge.cli.program import main
from firmware_bridge.recording import parse_candump
from firmware_bridge.robot_types import find
from firmware_bridge.runtime.can_files import FROM_ITS_BEGIN, OF_FRAMES, frames
from firmware_bridge.units import Nanoseconds
from hil_tests.unit.mcap_file.recorded_run import CRAWL


def recorded(folder: Path, name: str, suffix: str, seed: int) -> Path:
    """Drive a mission, without pictures; return the file, beside which is the folder of the results."""
    robot = find("rars")
    setup = bench_setup_of(robot)
    path = folder / f"{name}{suffix}"
    script = mission.parse(CRAWL, "crawl", robot, setup)
    drive(RunOrder(robot, setup, "crawl", script, seed, folder / name, record=path), lambda _now: None)
    return path


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Path, Path]]:
    """Return two files of one seed and one of another, by their suffix."""
    folder = tmp_path_factory.mktemp("frames")
    found = {}
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("emulators.run.installed", lambda _extra: False)
        for suffix in OF_FRAMES:
            first, second, other = (
                recorded(folder / suffix[1:], name, suffix, seed)
                for name, seed in (("first", 3), ("second", 3), ("other", 4))
            )
            found[suffix] = (first, second, other)
    return found


def command(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, str, str]:
    """Run the program; return its status and both outputs."""
    monkeypatch.setattr("sys.argv", ["firmware-bridge", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    captured = capsys.readouterr()
    return int(ended.value.code or 0), captured.out, captured.err


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_its_frames_are_those_of_can_log_one_by_one(
    runs: dict[str, tuple[Path, Path, Path]], suffix: str
) -> None:
    path = runs[suffix][0]
    lines = (path.with_suffix("") / "can.log").read_text("ascii").splitlines()
    logged = [(at, packet) for at, _bus, packet in map(parse_candump, lines)]
    began = FROM_ITS_BEGIN if suffix == ".asc" else 0
    assert len(logged) > 500
    assert [(at - began, packet) for at, _bus, packet in frames(path)] == logged


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_one_seed_gives_one_file_and_another_seed_another(
    runs: dict[str, tuple[Path, Path, Path]], suffix: str
) -> None:
    first, second, other = (hashlib.sha256(path.read_bytes()).hexdigest() for path in runs[suffix])
    assert first == second
    assert other != first


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_a_monitor_and_explain_read_of_it_what_they_read_of_can_log(
    runs: dict[str, tuple[Path, Path, Path]],
    suffix: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = runs[suffix][0]
    log = path.with_suffix("") / "can.log"
    drawn = [
        command(["monitor", "--log", str(one), "--robot", "rars"], monkeypatch, capsys) for one in (log, path)
    ]
    assert drawn[0] == drawn[1]
    explained = []
    for one in (log, path):
        status, out, err = command(["explain", str(one), "--robot", "rars"], monkeypatch, capsys)
        # A channel has a number there, and no name; the origin of .asc is another one.
        text = re.sub(r"\bcan\d*\b", "can", out.replace(str(one), "it"))
        explained.append((status, text, err))
    assert explained[0] == explained[1]
    assert explained[0][1]


# .asc has a date without a time zone: it is taken for a recording of a real bus, whose begin is not known.
@pytest.mark.parametrize("suffix", [".blf", ".trc"])
def test_a_replay_into_the_drives_takes_it(
    runs: dict[str, tuple[Path, Path, Path]],
    suffix: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["replay", str(runs[suffix][0]), "rars", "--until", "1"]
    status, out, _err = command(words, monkeypatch, capsys)
    assert (status, out.partition(":")[0]) == (0, "no difference")


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_a_robot_on_lines_is_refused_before_it_drives(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / f"run{suffix}"
    for words in (
        ["bench", "rome", "--out", str(tmp_path / "out"), "--record", str(file)],
        ["bench", "rars", "--serial", "v2", "--out", str(tmp_path / "out"), "--record", str(file)],
    ):
        status, out, err = command(words, monkeypatch, capsys)
        assert (status, out) == (2, "")
        assert err == (
            f"firmware-bridge: --record {file}: has CAN frames only, and this run has no bus; "
            "a name that ends in .mcap has lines\n"
        )
    words = ["emulate", "rome", "--duration", "0.1", "--record", str(file)]
    status, _out, err = command(words, monkeypatch, capsys)
    assert status == 2
    assert "a name that ends in .mcap, or a folder, has lines" in err
    assert sorted(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", OF_FRAMES)
def test_a_run_that_fails_leaves_the_frames_before(tmp_path: Path, suffix: str) -> None:
    robot = find("rars")
    setup = bench_setup_of(robot)
    script = mission.parse(CRAWL, "crawl", robot, setup)
    path = tmp_path / f"crawl{suffix}"
    order = RunOrder(robot, setup, "crawl", script, 3, tmp_path / "crawl", record=path)

    def fails(rig: Rig, _end: Nanoseconds, _progress: object) -> None:
        rig.runs(1.0)
        raise RuntimeError("the plant has failed")

    with pytest.raises(RuntimeError, match="the plant has failed"):
        drive(order, lambda _now: None, fails)
    logged = (tmp_path / "crawl" / "can.log").read_text(encoding="ascii").splitlines()
    assert len(list(frames(path))) == len(logged) > 10
