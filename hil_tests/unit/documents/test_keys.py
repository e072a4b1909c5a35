"""Reference of the keys of robot files and missions: complete, and as the tables check them."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import Mission
from firmware_bridge.robot import Robot
from firmware_bridge.robot_types import find, robot_type_named
from hil_tests.failures.causes import LINES
from validation.pages.keys import rows, sections

DOCS: Final = Path(__file__).parents[3] / "docs"


def keys_of(raw: Any) -> Iterator[str]:
    """Yield every key of a table below which further keys are fixed; a name that is free has no row."""
    if isinstance(raw, list):
        for one in raw:
            yield from keys_of(one)
    elif isinstance(raw, dict):
        for key, value in raw.items():
            yield key
            yield from keys_of(value)


@pytest.mark.parametrize("robot", sorted(LINES))
def test_every_key_of_a_shipped_robot_file_has_its_row(robot: str) -> None:
    text = (DOCS / "robot-file.md").read_text(encoding="utf-8")
    raw = tomllib.loads(robot_type_named(robot).file.read_text(encoding="utf-8"))
    free = {*raw["links"], *raw.get("plant", {}).get("parameters", {})}
    free |= {"geometry"} | {axis for row in raw.get("guard", {}).get("sums", []) for axis in row["of"]}
    assert [key for key in keys_of(raw) if key not in free and f"| `{key}` |" not in text] == []


@pytest.mark.parametrize("robot", sorted(LINES))
def test_every_key_of_a_robots_step_has_its_row(robot: str) -> None:
    text = (DOCS / "mission-file.md").read_text(encoding="utf-8")
    step = bench_setup_of(find(robot)).step
    assert [key for key in step.model_fields if f"| `{key}` |" not in text] == []


def test_a_row_has_kind_bounds_default_and_meaning() -> None:
    (axes,) = (one for one in sections(Robot) if one.path == "axes")
    found = {cells[0]: cells[1:] for cells in rows(axes.table, axes.path)}
    assert found["`top_speed`"] == ("number, above 0", "required", "In `unit` a second, to both sides.")
    assert found["`command`"][:2] == ("`speed` or `position`", "required")
    assert found["`travel`"][:2] == ("list of 2 number", "none")
    assert found["`zero`"][:2] == ("table `axes.zero`", "its defaults")
    mission = {cells[0]: cells[1:] for cells in rows(Mission, "")}
    assert mission["`send_hz`"][:2] == ("whole number, at least 1, at most 100", "`20`")
    assert mission["`plant`"][0] == "table of number by name"
