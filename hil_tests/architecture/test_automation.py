"""The repository's action, container file and hooks: their lines are run as far as that is possible here."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Final

import pytest

ROOT: Final = Path(__file__).parents[2]
ACTION: Final = (ROOT / "action.yml").read_text(encoding="utf-8")
WORKFLOW: Final = (ROOT / "examples/ci/github-actions.yml").read_text(encoding="utf-8")
CONTAINER: Final = (ROOT / "examples/ci/Containerfile").read_text(encoding="utf-8")
HOOKS: Final = (ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8")
MISSIONS: Final = ROOT / "emulators/robots/rars/missions"
RARS: Final = ROOT / "firmware_bridge/robots/rars/rars.toml"
INPUT: Final = re.compile(r"\$\{\{ *inputs\.(\w+) *\}\}|inputs\.(\w+)")


def hook(name: str, *words: str | Path) -> subprocess.CompletedProcess[str]:
    """Run a hook on files, as pre-commit does: its entry, its arguments, then the files."""
    (entry,) = re.findall(rf"^- id: {name}\n(?:  .*\n)*?  entry: (.*)\n", HOOKS, flags=re.MULTILINE)
    line = f"{entry} {' '.join(map(str, words))}"
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    shell = ["/bin/sh", "-c", line]
    return subprocess.run(
        shell, env={**os.environ, "PATH": path}, capture_output=True, text=True, check=False
    )


def test_the_hook_for_robot_files_finds_what_is_wrong(tmp_path: Path) -> None:
    assert hook("firmware-bridge-robots", RARS).returncode == 0
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(
        RARS.read_text(encoding="utf-8").replace("cycle_ms = 50", "cycle_ms = 0"), encoding="utf-8"
    )
    found = hook("firmware-bridge-robots", RARS, wrong)
    assert found.returncode != 0
    assert "cycle_ms: " in found.stderr


def test_the_hook_for_missions_finds_what_is_wrong_and_drives_nothing(tmp_path: Path) -> None:
    good = sorted(MISSIONS.glob("*.toml"))[:2]
    found = hook("firmware-bridge-missions", "rars", *good)
    assert (found.returncode, found.stderr) == (0, "")
    assert found.stdout.count("good, for rars") == len(good)
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(good[0].read_text(encoding="utf-8").replace("duration_s", "duration"), encoding="utf-8")
    found = hook("firmware-bridge-missions", "rars", good[0], wrong)
    assert found.returncode != 0
    assert "duration_s: is missing" in found.stderr


def test_the_actions_lines_are_a_shells_and_its_inputs_are_declared() -> None:
    declared = set(re.findall(r"^  (\w+):\n    description", ACTION, flags=re.MULTILINE))
    assert {one or other for one, other in INPUT.findall(ACTION)} == declared
    blocks = re.findall(r"^      run: (?:\|\n((?:        .*\n|\n)+)|(.*)$)", ACTION, flags=re.MULTILINE)
    assert len(blocks) == 4
    for block, line in blocks:
        text = re.sub(r"\$\{\{.*?\}\}", "x", block or line)
        subprocess.run(["/bin/bash", "-n"], input=text, text=True, check=True)


@pytest.mark.parametrize("text", [ACTION, CONTAINER], ids=["action", "container"])
def test_what_they_install_has_these_extras(text: str) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (named,) = re.findall(r"pip install .*?\[([\w,]+)\]", text)
    assert set(named.split(",")) <= set(project["optional-dependencies"])


def test_the_workflow_gives_inputs_that_there_are() -> None:
    declared = set(re.findall(r"^  (\w+):\n    description", ACTION, flags=re.MULTILINE))
    given = re.findall(r"firmware-bridge@REFERENCE\n        with:\n((?:          \w+: .*\n)+)", WORKFLOW)
    assert len(given) == 2
    assert {
        name for block in given for name in re.findall(r"^ +(\w+):", block, flags=re.MULTILINE)
    } <= declared
