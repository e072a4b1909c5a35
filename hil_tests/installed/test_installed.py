"""The result of `make installed`, for a user without checkout, compiler and extras."""

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from zipfile import ZipFile

import pytest

from hil_tests.installed.files import difference

pytestmark = pytest.mark.installed

ROOT = Path(__file__).parents[2]
INSTALLED = ROOT / ".venv" / "installed"
MEGABYTE = 1 << 20
PIPS_OWN = ("pip", "setuptools", "pkg_resources")
PAGE = (ROOT / "docs" / "installing.md").read_text(encoding="utf-8")
STORY = """
def test_silence(rig):
    rig.operator.drives(forward=0.3)
    rig.runs(seconds=2)
    rig.operator.falls_silent()
    rig.runs(seconds=1)
    assert abs(rig.body.speed) < 0.01
    assert "operator link timeout" in rig.interlock_events

def test_read_a_drive(drives, under_test):
    port = drives("1-2")
    master = under_test(f"firmware-bridge epos2 read statusword --node 2 --serial {port}")
    assert master.ends(within=60) == 0
    assert "switch on disabled" in master.printed
"""
Ran = subprocess.CompletedProcess[str]
Run = Callable[..., Ran]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Run a program of the installation where there is no other: no compiler, no cache, no checkout."""
    bare = {"PATH": str(INSTALLED / "bin"), "HOME": str(tmp_path / "home"), "COLUMNS": "120"}

    def runs(program: str, *words: str) -> Ran:
        return subprocess.run(
            [INSTALLED / "bin" / program, *words],
            cwd=tmp_path,
            env=bare,
            capture_output=True,
            text=True,
            check=False,
        )

    return runs


def wheel() -> Path:
    """Return the wheel for this machine."""
    (found,) = (ROOT / "dist" / "wheel").glob("*.whl")
    return found


def test_each_file_of_the_packages_is_in_the_wheel() -> None:
    assert difference(wheel()) == (set(), set())


def test_a_mission_gives_the_bytes_that_it_gives_in_a_checkout(run: Run, tmp_path: Path) -> None:
    order = ("bench", "rars", "--mission", "line", "--out")
    ended = run("firmware-bridge", *order, str(tmp_path / "there"))
    assert ended.returncode == 0, ended.stderr
    assert "pip install 'firmware-bridge[plots]'" in ended.stderr
    program = Path(sys.executable).with_name("firmware-bridge")
    subprocess.run([program, *order, tmp_path / "here"], check=True, capture_output=True)
    for name in ("can.log", "operator.tlog", "samples.csv"):
        assert (tmp_path / "there" / name).read_bytes() == (tmp_path / "here" / name).read_bytes(), name
    left = {path.name for path in (tmp_path / "there").iterdir()}
    assert left == {path.name for path in (tmp_path / "here").iterdir() if path.suffix != ".png"}
    assert not (tmp_path / "home" / ".cache").exists()


def test_the_core_is_compiled_and_kept_small() -> None:
    with ZipFile(wheel()) as archive:
        libraries = {it.filename: it.file_size for it in archive.infolist() if it.filename.endswith(".so")}
    assert any(name.startswith("firmware_bridge/packet.") for name in libraries)
    assert "emulators/servo/libservo.so" in libraries
    assert sum(libraries.values()) < 30 * MEGABYTE, "with debugging symbols it is twice as large"


@pytest.mark.parametrize("robot", ["rars", "rome", "climber", "ar2", "rome_arm"])
def test_every_robot_has_its_plant_with_it(run: Run, robot: str) -> None:
    script = (
        "import sys; from firmware_bridge.robot_types import find; from fmu.build import ensure;"
        "print(ensure(find(sys.argv[1]).plant.fmu, int(sys.argv[2])))"
    )
    for fmi in ("2", "3"):
        reported = run("python", "-c", script, robot, fmi)
        assert str(INSTALLED) in reported.stdout, reported.stderr


def test_a_plant_is_had_without_a_compiler(run: Run, tmp_path: Path) -> None:
    ended = run("firmware-bridge", "fmu", "build", "rars", "--fmi", "2")
    assert ended.returncode == 0, ended.stderr
    assert run("firmware-bridge", "fmu", "check", "rars.fmu").returncode == 0
    assert (tmp_path / "rars.fmu").stat().st_size > MEGABYTE // 10


def test_stories_of_a_user_run(run: Run, tmp_path: Path) -> None:
    (tmp_path / "test_story.py").write_text(STORY)
    ended = run("pytest", "-q", "--robot", "rars", "test_story.py")
    assert "2 passed" in ended.stdout, ended.stdout


@pytest.mark.parametrize(
    ("words", "stated"),
    [
        ("study tipping --quick", "studies come with a checkout"),
    ],
)
def test_what_is_missing_is_stated_with_its_fix(run: Run, words: str, stated: str) -> None:
    ended = run("firmware-bridge", *words.split())
    assert ended.returncode != 0
    assert stated in " ".join(ended.stderr.split())
    assert "Traceback" not in ended.stderr


def test_the_doctor_misses_nothing_that_is_needed(run: Run) -> None:
    reported = json.loads(run("firmware-bridge", "doctor", "--json").stdout)
    assert reported["missing"] == []


def test_the_base_is_as_small_as_the_page_states(run: Run) -> None:
    listed = json.loads(run("python", "-m", "pip", "list", "--format", "json").stdout)
    names = {it["name"].lower() for it in listed}
    assert not names & {"matplotlib", "sympy", "mypy"}
    (limit,) = re.findall(r"less than (\d+) MB", PAGE)
    site = next((INSTALLED / "lib").glob("python3.*")) / "site-packages"
    files = [path for path in site.rglob("*") if path.is_file() and path.suffix != ".pyc"]
    size = sum(path.stat().st_size for path in files if path.relative_to(site).parts[0] not in PIPS_OWN)
    assert size < int(limit) * 1_000_000


DUMMY = {
    "fmu/x/__init__.py": "HERE = True\n",
    "fmu_x-1.dist-info/METADATA": "Metadata-Version: 2.1\nName: fmu-x\nVersion: 1\n",
    "fmu_x-1.dist-info/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    "fmu_x-1.dist-info/RECORD": "".join(
        f"{it},,\n" for it in ("fmu/x/__init__.py", "fmu_x-1.dist-info/RECORD")
    ),
}
EXTENDS = "__path__ = __import__('pkgutil').extend_path(__path__, __name__)\n"


@pytest.mark.parametrize("init", [None, EXTENDS], ids=["namespace", "pkgutil"])
def test_another_makers_package_of_the_same_name_is_found_beside_ours(
    tmp_path: Path, init: str | None
) -> None:
    """A dozen packages share the name, each in a folder of its own; here in another place of the path."""
    wheel, there = tmp_path / "fmu_x-1-py3-none-any.whl", tmp_path / "there"
    with ZipFile(wheel, "w") as archive:
        for name, text in (DUMMY if init is None else {"fmu/__init__.py": init, **DUMMY}).items():
            archive.writestr(name, text)
    python = INSTALLED / "bin" / "python"
    install = ("-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--disable-pip-version-check")
    subprocess.run([python, *install, "--target", there, wheel], check=True)
    (site,) = (INSTALLED / "lib").glob("python3.*/site-packages")
    for path in ((there, site), (site, there)):
        script = (
            f"import sys; sys.path[:0] = {[str(it) for it in path]!r}; import fmu.x, fmu.plants, fmu.export"
        )
        subprocess.run([python, "-c", script], check=True, cwd=tmp_path)


def test_it_may_be_published() -> None:
    with ZipFile(wheel()) as archive:
        (name,) = (it for it in archive.namelist() if it.endswith(".dist-info/METADATA"))
        reported = archive.read(name).decode()
    assert "Do Not Upload" not in reported
    assert "License-Expression: MIT" in reported
    for extra in ("mcap", "plants", "plots", "testing"):
        assert f"Provides-Extra: {extra}" in reported
