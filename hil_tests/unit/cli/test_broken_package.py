"""A package of someone's own that cannot be loaded takes nothing else with it."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest

PROGRAM: Final = Path(sys.executable).with_name("firmware-bridge")
ENTRIES: Final = """[firmware_bridge.robots]
scout = scout_that_is_not_there:ROBOT_TYPE
[firmware_bridge.bench_setups]
scout = scout_that_is_not_there.bench:BENCH_SETUP
[firmware_bridge.emulated_families]
scout = scout_that_is_not_there.family:FAMILY
"""
WHY: Final = "scout: cannot be loaded: ModuleNotFoundError: No module named 'scout_that_is_not_there'"


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A folder in which a package is installed whose module is gone."""
    about = tmp_path / "site" / "scout-1.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: scout\nVersion: 1\n", encoding="utf-8")
    (about / "entry_points.txt").write_text(ENTRIES, encoding="utf-8")
    return about.parent


def stated(site: Path, *words: str) -> tuple[int, str, str]:
    path = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, "PYTHONPATH": path, "COLUMNS": "200", "NO_COLOR": "1"}
    reported = subprocess.run([PROGRAM, *words], env=environment, capture_output=True, text=True, check=False)
    return reported.returncode, reported.stdout, reported.stderr


def test_it_is_one_row_among_the_robots(site: Path) -> None:
    status, out, complained = stated(site, "robots")
    assert status == 2
    rows = [line for line in out.splitlines() if "scout" in line]
    assert len(rows) == 1
    assert "cannot be loaded" in rows[0]
    assert all(f"\n{name} " in out for name in ("rars", "rome", "climber", "diff_drive"))
    assert complained.startswith(f"firmware-bridge: {WHY}")


@pytest.mark.parametrize("words", [("drive", "scout"), ("bench", "scout"), ("emulate", "scout")])
def test_who_names_it_is_reported_why(site: Path, words: tuple[str, ...]) -> None:
    status, _, complained = stated(site, *words)
    (line,) = complained.splitlines()
    assert (status, line.startswith(f"firmware-bridge: {WHY}")) == (2, True), line


def test_the_others_are_driven_as_ever(site: Path, tmp_path: Path) -> None:
    status, out, complained = stated(
        site, "bench", "diff_drive", "--mission", "line", "--out", str(tmp_path / "out")
    )
    assert (status, complained) == (0, "")
    assert "results:" in out
    assert stated(site, "fmu", "list")[0] == 0
