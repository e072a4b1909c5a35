"""The tests have two lanes, and what is long leaves something shorter of its kind in the first."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
LISTING = """
import json, sys, pytest

class Listing:
    def pytest_collection_finish(self, session):
        rows = []
        for item in session.items:
            mark = item.get_closest_marker("long")
            long = None if mark is None else mark.kwargs.get("beside", "")
            rows.append((item.nodeid.partition("[")[0], long))
        print("\\n" + json.dumps(rows))

sys.exit(pytest.main(["--collect-only", "-qq", "-p", "no:cacheprovider"], plugins=[Listing()]))
"""


def test_one_lane_is_what_the_other_is_not_and_both_are_checked() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    lanes = dict(re.findall(r"^([a-z-]+): LANE :=(.*)$", makefile, flags=re.MULTILINE))
    assert lanes == {"test": " -m 'not long'", "long": " -m long"}
    assert re.search(r"^test-all: test long ", makefile, flags=re.MULTILINE)
    steps = re.findall(
        r"^step make ([a-z-]+)$", (ROOT / ".ci/run").read_text(encoding="utf-8"), flags=re.MULTILINE
    )
    assert [step for step in steps if step in lanes] == ["test", "long"]


@pytest.mark.timeout(0)
def test_a_test_that_is_long_has_a_shorter_one_beside_it() -> None:
    """One of the same name with another parameter, or the one that its mark names."""
    listed = subprocess.run(
        [sys.executable, "-c", LISTING], cwd=ROOT, capture_output=True, text=True, check=True
    )
    rows: list[list[Any]] = json.loads(next(it for it in listed.stdout.splitlines() if it.startswith("[[")))
    quick = {name for name, beside in rows if beside is None}
    short = {name.rpartition("::")[2] for name in quick}
    alone = {name for name, beside in rows if beside is not None and name not in quick and beside not in short}
    assert alone == set(), "give it a parameter by which the first lane runs less of the same, or name one"
