"""The tests have two lanes, and none is lost between them."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def collected(*words: str) -> list[str]:
    """Return the names of the tests that pytest finds with these words."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider", *words]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return [line for line in found.stdout.splitlines() if "::" in line]


def test_one_lane_is_what_the_other_is_not_and_both_are_checked() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    lanes = dict(re.findall(r"^([a-z-]+): LANE :=(.*)$", makefile, flags=re.MULTILINE))
    assert lanes == {"test": " -m 'not long'", "long": " -m long", "test-all": ""}
    steps = re.findall(
        r"^step make ([a-z-]+)$", (ROOT / ".ci/run").read_text(encoding="utf-8"), flags=re.MULTILINE
    )
    assert [step for step in steps if step in lanes] == ["test", "long"]


@pytest.mark.long
@pytest.mark.timeout(0)
def test_both_lanes_together_are_all_tests_each_once() -> None:
    first, second = collected("-m", "not long"), collected("-m", "long")
    assert second
    assert sorted([*first, *second]) == sorted(collected())


@pytest.mark.long
@pytest.mark.timeout(0)
def test_a_test_that_is_long_has_a_shorter_one_beside_it() -> None:
    first, second = (
        {name.partition("[")[0] for name in collected("-m", lane)} for lane in ("not long", "long")
    )
    own = {name for name in second if "test_lanes.py" in name}
    assert second - first - own == set(), "give it a parameter by which the first lane runs less of the same"
