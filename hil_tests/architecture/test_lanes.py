"""The tests have two lanes, and what is long leaves something shorter of its kind in the first."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from nights import SHARES, STEPS

from hil_tests.conftest import AT_HAND, ON_DEMAND
from hil_tests.lanes import FIRST_LANE

ROOT = Path(__file__).parents[2]
SHARE = "$(SHARE:%=-p hil_tests.lanes --share %)"
LISTING = """
import json, sys, pytest

class Listing:
    def pytest_collection_finish(self, session):
        rows = []
        for item in session.items:
            mark = item.get_closest_marker("long")
            name, _, case = item.nodeid.removeprefix("hil_tests/").partition("[")
            beside = None if mark is None else mark.kwargs.get("beside", "")
            keeps = [] if mark is None else mark.kwargs.get("keeps", [])
            rows.append((name, case.removesuffix("]"), beside, keeps))
        print("\\n" + json.dumps(rows))

sys.exit(pytest.main(["--collect-only", "-qq", "-p", "no:cacheprovider"], plugins=[Listing()]))
"""


def test_one_lane_is_what_the_other_is_not_and_both_are_checked() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    lanes = dict(re.findall(r"^([a-z-]+): LANE :?=(.*)$", makefile, flags=re.MULTILINE))
    # What judges the sources is `make check`'s.
    others = " --ignore=hil_tests/architecture"
    assert lanes == {
        "test": f" -m 'not long' --hypothesis-profile={FIRST_LANE}{others}",
        "long": f" -m '(long or hypothesis) and not interpreted'{others} {SHARE}",
    }
    assert "worksteal -q -m '(long or hypothesis) and interpreted'" in makefile
    assert "pytest -q -n $(JOBS) hil_tests/architecture" in makefile
    assert re.search(r"^test-all: test long ", makefile, flags=re.MULTILINE)


def test_a_change_or_a_night_runs_each_lane_and_each_mark() -> None:
    by_day = set(
        re.findall(r"^step (.*)$", (ROOT / ".ci/run").read_text(encoding="utf-8"), flags=re.MULTILINE)
    )
    by_night = {command for step in STEPS for command in step.commands}
    assert {"make check", "make test", ".venv/bin/python tools/rotating.py"} <= by_day
    assert {f"make long SHARE={number}/{SHARES}" for number in range(1, SHARES + 1)} <= by_night
    words = [command.split() for command in by_day | by_night]
    requested = {line[place + 1] for line in words for place, word in enumerate(line) if word == "-m"}
    # Where tshark is missing `.ci/packages` installs it.
    assert {*AT_HAND, *ON_DEMAND} - {"tshark"} <= requested


@pytest.mark.timeout(0)
def test_a_test_that_is_long_has_a_shorter_one_beside_it() -> None:
    """One of the same name with another parameter, or the one that its mark names; it keeps what is there."""
    listed = subprocess.run(
        [sys.executable, "-c", LISTING], cwd=ROOT, capture_output=True, text=True, check=True
    )
    rows: list[list[Any]] = json.loads(next(it for it in listed.stdout.splitlines() if it.startswith("[[")))
    quick = {(name, case) for name, case, beside, _ in rows if beside is None}
    names = {name for name, _ in quick}
    short = {name.rpartition("::")[2] for name in names}
    long = {(name, beside) for name, _, beside, _ in rows if beside is not None}
    alone = {name for name, beside in long if name not in names and beside not in short}
    assert alone == set(), "let its mark keep a case, or name a shorter test"
    kept = {(name, case) for name, _, _, keeps in rows for case in keeps}
    assert kept <= quick, "a mark keeps a case that is not there"
