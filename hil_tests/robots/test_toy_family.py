"""The example of a device family, installed beside the product: listed, read, driven, guarded, stopped."""

import os
import re
import shutil
from pathlib import Path
from typing import Final

import pytest

from hil_tests.robots.beside import ROOT, Beside, files

EXAMPLE: Final = ROOT / "examples" / "toy_drive"
PYTEST: Final = ("-m", "pytest", "-q", "-p", "no:xdist", "-p", "no:cacheprovider", "--import-mode=importlib")


@pytest.fixture(scope="module")
def toy(tmp_path_factory: pytest.TempPathFactory) -> Beside:
    """Install a copy, so that no build is left in the tree."""
    beside = Beside(tmp_path_factory.mktemp("toy"))
    shutil.copytree(
        EXAMPLE, beside.folder / "toy_drive", ignore=shutil.ignore_patterns("build", "*.egg-info")
    )
    beside.installs("./toy_drive")
    return beside


def test_it_is_listed_and_its_own_tests_pass_and_no_file_of_the_product_changes(
    request: pytest.FixtureRequest,
) -> None:
    """Those tests drive it to a speed and stop it, try the guard, and kill the bridge."""
    before = files()
    toy: Beside = request.getfixturevalue("toy")
    listed = toy.bridge("families", "toy_drive")
    for stated in ("toy-drive", "toy-1", "position, power, stop, velocity", "250 ms", "toy_trolley"):
        assert stated in listed
    assert "motor_shield" in toy.bridge("families")
    assert "failed" not in toy.run(*PYTEST, "toy_drive/tests", "-k", "not pulled")
    assert files() == before


def test_nothing_of_the_product_names_it() -> None:
    sources = [path for path in files() if path.suffix == ".py" and EXAMPLE not in path.parents]
    assert len(sources) > 500
    named = [path for path in sources if re.search(r"toy[-_]|Toy[A-Z]", path.read_text(encoding="utf-8"))]
    assert named == []


def test_a_mistake_in_its_robot_file_is_reported_by_file_and_key(toy: Beside) -> None:
    text = (EXAMPLE / "src/toy_drive/toy_trolley.toml").read_text(encoding="utf-8")
    wrong = text.replace("watchdog_ms = 250", "watchdog_ms = 20").replace("counts_per_turn", "count_per_turn")
    (toy.folder / "wrong.toml").write_text(wrong, encoding="utf-8")
    stated = toy.fails("robots", "wrong.toml")
    assert "wrong.toml: links.line.watchdog_ms: " in stated
    assert "wrong.toml: axes[0].settings.count_per_turn: no such key; perhaps 'counts_per_turn'?" in stated


def test_without_its_package_a_robot_file_of_it_is_refused_by_its_driver(tmp_path: Path) -> None:
    text = (EXAMPLE / "src/toy_drive/toy_trolley.toml").read_text(encoding="utf-8")
    (tmp_path / "own.toml").write_text('kind = "diff_drive"\n' + text, encoding="utf-8")
    stated = Beside(tmp_path).fails("robots", "own.toml")
    assert "own.toml: links.line.driver: 'toy-drive' is not known; there are: " in stated


def test_the_page_shows_the_example_s_own_lines() -> None:
    page = (ROOT / "docs" / "device-family.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", page, flags=re.DOTALL | re.MULTILINE)
    sources = [path.read_text(encoding="utf-8") for path in (EXAMPLE / "src/toy_drive").glob("*.py")]
    own = {line.strip() for text in sources for line in text.splitlines()}
    assert len(blocks) >= 4
    assert [line for block in blocks for line in block.splitlines() if line.strip() not in own] == []


@pytest.mark.long(beside="test_it_is_listed_and_its_own_tests_pass_and_no_file_of_the_product_changes")
def test_its_robot_gets_the_safety_tests_of_every_robot_and_drives_its_mission(toy: Beside) -> None:
    inherited = ("--robot", "toy_trolley", "--pyargs", "emulators.testing.inherited")
    assert " passed" in toy.run(*PYTEST, *inherited)
    assert " passed" in toy.run(*PYTEST, "toy_drive/tests", "-k", "pulled")
    toy.bridge("bench", "toy_trolley", "--mission", "there", "--out", "driven")
    assert (toy.folder / "driven" / "summary.json").is_file()
    assert "V13000" in toy.bridge("monitor", "--log", "driven/serial.log", "--robot", "toy_trolley")


@pytest.mark.long(beside="test_it_is_listed_and_its_own_tests_pass_and_no_file_of_the_product_changes")
def test_it_is_code_to_hold_up(toy: Beside) -> None:
    toy.run("-m", "ruff", "check", "--no-cache", "toy_drive")
    toy.run("-m", "ruff", "format", "--no-cache", "--check", "toy_drive")
    words = ("--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(ROOT / ".mypy_cache"))
    toy.run(
        *("-m", "mypy", *words, "-p", "toy_drive"),
        MYPYPATH=f"{toy.folder / 'toy_drive' / 'src'}{os.pathsep}{ROOT}",
    )
