"""The tests have two lanes, and what is long leaves something shorter of its kind in the first."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from hil_tests.conftest import LONG
from hil_tests.lanes import FIRST_LANE

ROOT = Path(__file__).parents[2]
LISTING = """
import json, sys, pytest

class Listing:
    def pytest_collection_finish(self, session):
        rows = []
        for item in session.items:
            mark = item.get_closest_marker("long")
            name, _, case = item.nodeid.removeprefix("hil_tests/").partition("[")
            beside = None if mark is None else mark.kwargs.get("beside", "")
            rows.append((name, case.removesuffix("]"), beside))
        print("\\n" + json.dumps(rows))

sys.exit(pytest.main(["--collect-only", "-qq", "-p", "no:cacheprovider"], plugins=[Listing()]))
"""


def test_one_lane_is_what_the_other_is_not_and_both_are_checked() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    lanes = dict(re.findall(r"^([a-z-]+): LANE :=(.*)$", makefile, flags=re.MULTILINE))
    # What judges the sources is `make check`'s.
    others = " --ignore=hil_tests/architecture"
    assert lanes == {
        "test": f" -m 'not long' --hypothesis-profile={FIRST_LANE}{others}",
        "long": f" -m '(long or hypothesis) and not interpreted'{others}",
    }
    assert "worksteal -q -m '(long or hypothesis) and interpreted'" in makefile
    assert "pytest -q -p no:xdist hil_tests/architecture" in makefile
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
    quick = {(name, case) for name, case, beside in rows if beside is None}
    names = {name for name, _ in quick}
    short = {name.rpartition("::")[2] for name in names}
    alone = {
        name for name, _, beside in rows if beside is not None and name not in names and beside not in short
    }
    assert alone == set(), "give it a parameter by which the first lane runs less of the same, or name one"
    assert LONG.keys() <= {name for name, _, _ in rows}, "lanes.toml names a test that is not there"
    kept = {(name, case) for name, row in LONG.items() for case in row.get("keeps", ())}
    assert kept <= quick, "lanes.toml keeps a case that is not there"
