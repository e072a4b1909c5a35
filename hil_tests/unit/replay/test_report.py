"""The page of a recorded drive: what was measured, as it was known then, without a plant."""

import json
import re
import shutil
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from emulators.bench.animated import animated
from emulators.bench.columns import ARMED, PLANAR, Samples
from emulators.bench.summary import InterlockEntry
from firmware_bridge.cli import program
from firmware_bridge.intent import ConfirmPosition
from firmware_bridge.mavlink.frames import Codec
from firmware_bridge.mavlink.texts import Speaker
from firmware_bridge.mcap_file.writer import RecordingWriter
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.robot import RobotFileError
from firmware_bridge.robot_types import find
from firmware_bridge.runtime.run_file import RUN_FILE, AsRun, read_run, run_file
from firmware_bridge.safety.interlock_base import Severity

REAL: Final = Path(__file__).with_name("places_known")
"""3 s of `drive rars` at emulated drives in real time, no one driving."""
DRIVEN: Final = """
title = "a meter, and a stop"
duration_s = 7.0
[[step]]
at_s = 0.0
title = "where it stands"
zero = { steering = 0.0, lift = 0.0 }
[[step]]
at_s = 3.0
title = "arm"
arm = true
[[step]]
at_s = 4.0
title = "drive"
speed_mps = 0.3
[[step]]
at_s = 6.0
title = "stop"
emergency_stop = true
"""
IDLE: Final = """
[[step]]
at_s = 3.0
title = "arm, and drive nowhere"
arm = true
"""


def reported(*words: str) -> Result:
    return CliRunner().invoke(program, list(words))


def table(path: Path) -> "np.ndarray[tuple[int], np.dtype[np.void]]":
    return np.genfromtxt(path, delimiter=",", names=True)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of the bench, with its recording."""
    folder = tmp_path_factory.mktemp("driven")
    (folder / "m.toml").write_text(DRIVEN, encoding="utf-8")
    words = ("--mission", str(folder / "m.toml"), "--out", str(folder / "run"))
    done = reported("bench", "rars", *words, "--record", str(folder / "run.mcap"))
    assert done.exit_code == 0, done.output
    return folder / "run"


def test_it_knows_what_the_bridge_knew_in_the_run(bench: Path, tmp_path: Path) -> None:
    done = reported("report", str(bench), "--out", str(tmp_path))
    assert done.exit_code == 0, done.output
    then, now = table(bench / "samples.csv"), table(tmp_path / "samples.csv")
    assert len(now) == pytest.approx(len(then), abs=2)
    rows = min(len(then), len(now))
    for name in ("odometry_x_m", "odometry_y_m", "odometry_heading_rad", "demanded_speed_mps", "armed"):
        assert np.array_equal(then[name][:rows], now[name][:rows], equal_nan=True), name
    assert now["odometry_x_m"][-1] > 0.5
    assert {"x_m", "heading_rad", "steer_rad"} & set(now.dtype.names or ()) == set(), "no plant has it"
    driving = slice(520, 590)
    assert np.abs(now["speed_mps"] - then["speed_mps"])[driving].max() < 0.02
    for name in ("motor_speed_left_rad_s", "current_left_a"):
        assert np.mean(now[name][driving]) == pytest.approx(np.mean(then[name][driving]), rel=0.05, abs=0.05)


def test_its_page_has_numbers_holds_and_pictures(bench: Path, tmp_path: Path) -> None:
    assert reported("report", str(bench), "--out", str(tmp_path)).exit_code == 0
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for stated in (
        "largest speed",
        "limit 0.5",
        "largest current, left rear wheel",
        "emergency stop",
        "by odometry",
    ):
        assert stated in page, stated
    pictures = {path.stem for path in tmp_path.glob("*.png")}
    assert pictures == {"path", "speeds", "currents", "interlocks"}
    assert page.count("data:image/png") == len(pictures)
    assert "does otherwise than was recorded" not in page


def test_a_recording_in_mcap_gives_the_page_of_its_folder(bench: Path, tmp_path: Path) -> None:
    file = shutil.copy(bench.with_suffix(".mcap"), tmp_path / "run.mcap")
    done = reported("report", str(file))
    assert done.exit_code == 0, done.output
    assert done.output.startswith(f"{tmp_path / 'run' / 'report.html'}: ")
    assert reported("report", str(bench), "--out", str(tmp_path / "of_folder")).exit_code == 0
    assert (tmp_path / "run/samples.csv").read_bytes() == (tmp_path / "of_folder/samples.csv").read_bytes()
    page = (tmp_path / "run/report.html").read_text(encoding="utf-8")
    assert "run.mcap" in page
    assert "emergency stop" in page
    assert "does otherwise than was recorded" not in page


def test_a_recording_in_mcap_has_a_drives_serial_lines_and_cameras_too(tmp_path: Path) -> None:
    mission = tmp_path / "short.toml"
    mission.write_text(DRIVEN.partition("[[step]]")[0].replace("7.0", "4.0") + IDLE, encoding="utf-8")
    for robot in ("rome", "climber+cameras"):
        file, folder = tmp_path / f"{robot}.mcap", tmp_path / f"{robot}-run"
        words = (robot, "--mission", str(mission), "--out", str(folder), "--record", str(file))
        assert reported("bench", *words).exit_code == 0
        for one, out in ((file, "of_file"), (folder, "of_folder")):
            done = reported("report", str(one), "--out", str(tmp_path / out))
            assert done.exit_code == 0, done.output
        pages = [(tmp_path / out / "samples.csv").read_bytes() for out in ("of_file", "of_folder")]
        assert pages[0] == pages[1]


def mcap_of(path: Path, *, frames: bool = True, words: bool = True, run: bool = True) -> Path:
    """Write a recording in MCAP with the first frame of a run, a message of its operator, and its robot."""
    with path.open("wb") as file:
        writer = RecordingWriter(file, {})
        if frames:
            writer.frame(0, "drives", Packet(CAN, 0x701, b"\0"), sent=False)
        if words:
            for message in Speaker().say(Severity.INFO, "armed"):
                writer.datagram(0, OPERATOR, Packet(OPERATOR, 0, Codec(1, 1).encode(message)), sent=True)
        if run:
            writer.attach(RUN_FILE, "application/json", run_file(AsRun(find("rars")))[RUN_FILE].encode())
        writer.finish()
    return path


@pytest.mark.parametrize(
    ("parts", "states"),
    [
        ({"frames": False}, "has no frames and no bytes of serial lines; record it with `bench` or `drive`"),
        ({"words": False}, "has no messages of an operator's link; record it with `bench` or `drive`"),
        ({"run": False}, "has no run.json, which names the robot; name the robot behind it"),
    ],
)
def test_a_recording_in_mcap_that_has_too_little_is_one_message(
    tmp_path: Path, parts: dict[str, Any], states: str
) -> None:
    file = mcap_of(tmp_path / "run.mcap", **parts)
    done = reported("report", str(file))
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr == f"firmware-bridge: {file}: {states}\n"
    assert sorted(tmp_path.iterdir()) == [file]


def test_a_file_that_is_cut_off_or_of_another_robot_is_named_as_the_user_named_it(
    bench: Path, tmp_path: Path
) -> None:
    whole, cut = bench.with_suffix(".mcap").read_bytes(), tmp_path / "cut.mcap"
    cut.write_bytes(whole[:-200])
    done = reported("report", str(cut), "rars")
    assert done.exit_code == 0, done.output
    assert f"{cut}: its end is cut off" in done.output
    cut.write_bytes(whole)
    done = reported("report", str(cut), "rome", "--out", str(tmp_path / "out"))
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.startswith("firmware-bridge: cut.mcap: holds nothing of rome's link 'board'")
    (tmp_path / "none.mcap").write_bytes(b"garbage")
    done = reported("report", str(tmp_path / "none.mcap"))
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1)
    assert "does not begin like an MCAP file" in done.stderr


def test_a_real_drive_is_reported_in_its_own_folder(tmp_path: Path) -> None:
    folder = shutil.copytree(REAL, tmp_path / "run")
    nameless = reported("report", str(folder))
    assert nameless.exit_code == 2
    assert "has no run.json" in nameless.stderr
    done = reported("report", str(folder), "rars", "--animate")
    assert done.exit_code == 0, done.output
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "Messages" in page
    assert "reference lost: lift" in page
    assert (folder / "animated.html").exists()


def test_from_where_this_bridge_does_otherwise_is_stated(bench: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(bench, tmp_path / "run")
    lines = (folder / "can.log").read_text(encoding="ascii").splitlines(keepends=True)
    at = next(number for number, line in enumerate(lines) if " 501#" in line and number > len(lines) // 2)
    # A set-point that the bridge has not sent.
    lines[at] = re.sub(r"501#\w+", "501#0F0011000000", lines[at])
    (folder / "can.log").write_text("".join(lines), encoding="ascii")
    done = reported("report", str(folder), "--out", str(tmp_path / "page"))
    assert done.exit_code == 0, done.output
    assert "does otherwise than was recorded from" in done.output
    assert "does otherwise than was recorded" in (tmp_path / "page" / "report.html").read_text(
        encoding="utf-8"
    )
    assert len(table(tmp_path / "page" / "samples.csv")) > 600, "it goes on behind that"


@pytest.mark.parametrize(
    ("words", "states"),
    [
        (("nowhere",), "is no folder"),
        (("bench",), "`bench` has made its page already; use --out DIR"),
        (("bench", "rome", "--out", "page"), "holds no"),
        (("bench", "no one", "--out", "page"), "no such robot"),
    ],
)
def test_a_folder_that_cannot_be_used_is_refused(
    bench: Path, tmp_path: Path, words: tuple[str, ...], states: str
) -> None:
    places = {"bench": str(bench), "nowhere": str(tmp_path / "nowhere"), "page": str(tmp_path / "page")}
    done = reported("report", *(places.get(word, word) for word in words))
    assert done.exit_code == 2, done.output
    assert states in done.stderr


def test_a_path_is_played_from_where_the_robot_knew_its_place() -> None:
    samples = Samples((*PLANAR, ARMED), truth=False)
    for row in range(101):
        place = float("nan") if row < 10 else row / 100.0
        values = {"odometry_x_m": place, "odometry_y_m": 0.0, "odometry_heading_rad": 0.0}
        samples.add(row * 10_000_000, tuple(values.get(it.name, 0.0) for it in samples.columns))
    page = animated("a <run>", samples, [InterlockEntry("lift extended", "50 mm </script>", 0.2, None)])
    data = json.loads(re.search(r"const run = (\{.*?\});\n", page, re.DOTALL)[1].replace("<\\/", "</"))  # type: ignore[index]
    assert data["at"][0] == 0.1
    assert data["x"][-1] == 1.0
    assert data["events"] == [{"from": 0.2, "to": None, "text": "50 mm </script>"}]
    assert page.count("</script>") == 1
    assert "a &lt;run&gt;" in page
    assert re.findall(r'(?:src|href)="(?!data:|#)', page) == []


def test_what_was_driven_is_read_back_whole(tmp_path: Path) -> None:
    robot = find("rars").agreed_on(0.8)
    run = AsRun(robot, (ConfirmPosition("lift", 0.02), ConfirmPosition("steer")), "lift_failed")
    (tmp_path / RUN_FILE).write_text(run_file(run)[RUN_FILE], encoding="utf-8")
    found = read_run(tmp_path)
    assert found is not None
    assert (found.robot, found.mode, str(found.confirmed)) == (robot, "lift_failed", str(run.confirmed))
    assert read_run(tmp_path / "empty") is None
    for text in ("{", "[]", '{"robot": {"kind": "no one"}, "agreed_ms": null, "stands": {}, "mode": ""}'):
        (tmp_path / RUN_FILE).write_text(text, encoding="utf-8")
        with pytest.raises(RobotFileError, match="cannot be read"):
            read_run(tmp_path)
