"""The documents say what the code does: commands, missions, folders, layers and decisions are all there."""

import re
import tomllib
from pathlib import Path

import pytest
import typer

from firmware_bridge.cli import program

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
ARCHITECTURE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
COMMANDS = (ROOT / "docs/commands.md").read_text(encoding="utf-8")
RUNS = (ROOT / "docs/runs.md").read_text(encoding="utf-8")
PAGES = [*sorted((ROOT / "docs").rglob("*.md")), *sorted(ROOT.glob("*.md"))]


def shown(page: str, word: str) -> list[str]:
    """Return the lines of a page's code blocks that begin with this word."""
    blocks = re.findall(r"^```[a-z]*\n(.*?)^```", page, flags=re.DOTALL | re.MULTILINE)
    return [line for block in blocks for line in block.splitlines() if line.split()[:1] == [word]]


def test_the_front_page_is_one_screen_or_two() -> None:
    assert len(README.splitlines()) < 100


def test_every_command_has_its_example() -> None:
    group = typer.main.get_group(program)
    commands = set(group.list_commands(typer.Context(group)))
    named = {line.split()[1] for line in shown(COMMANDS, "firmware-bridge")}
    assert named
    assert named == commands


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md"])
def test_every_make_target_in_a_page_is_one(page: str) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z-]+):", makefile, flags=re.MULTILINE))
    named = {line.split()[1] for line in shown((ROOT / page).read_text(encoding="utf-8"), "make")}
    assert named
    assert named <= targets


def test_every_mission_is_named_in_its_page_and_driven_by_the_demo() -> None:
    missions = {path.stem for path in (ROOT / "emulators/robots/rars/missions").glob("*.toml")}
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (driven,) = re.findall(r"^MISSIONS := (.*)$", makefile, flags=re.MULTILINE)
    assert missions
    assert missions == set(driven.split())
    assert {mission for mission in missions if f"`{mission}`" in RUNS} == missions


@pytest.mark.parametrize("package", ["firmware_bridge", "emulators", "fmu", "hil_tests", "docs"])
def test_every_folder_has_its_line_in_the_architecture(package: str) -> None:
    folders = {
        path.name
        for path in (ROOT / package).iterdir()
        if path.is_dir() and not path.name.startswith(("_", "."))
    }
    assert {folder for folder in folders if f"{folder}/" in ARCHITECTURE} == folders


def test_the_layers_in_the_architecture_are_those_that_are_checked() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = {contract["id"]: contract for contract in project["tool"]["importlinter"]["contracts"]}
    for contract in ("packages", "bridge", "emulators", "epos2", "arduino"):
        assert " > ".join(contracts[contract]["layers"]) in ARCHITECTURE


def test_every_decision_is_in_the_list_of_decisions() -> None:
    pages = {path.name for path in (ROOT / "docs/decisions").glob("*.md")} - {"README.md"}
    listed = (ROOT / "docs/decisions/README.md").read_text(encoding="utf-8")
    assert set(re.findall(r"\]\(([^)]+\.md)\)", listed)) == pages


def test_the_changelog_knows_the_version() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert f"## {version}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_link_between_the_documents_leads_somewhere(page: Path) -> None:
    links = re.findall(r"\]\((?!https?://|#)([^)#]+)", page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []
