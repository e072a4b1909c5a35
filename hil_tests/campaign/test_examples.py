"""The shipped campaign and the notebook run as they stand."""

import json
from pathlib import Path
from typing import Any, Final

import pytest

from emulators.campaign.campaign_file import load
from emulators.campaign.plan import plan

EXAMPLES: Final = Path(__file__).parents[2] / "examples" / "campaigns"


def test_the_shipped_campaign_fits() -> None:
    file = EXAMPLES / "floors.toml"
    assert len(plan(load(file), str(file), file.parent).runs) == 18


@pytest.mark.long(beside="test_the_shipped_campaign_fits")
def test_the_notebook_runs_from_its_first_cell_to_its_last() -> None:
    cells = json.loads((EXAMPLES / "floors.ipynb").read_text(encoding="utf-8"))["cells"]
    names: dict[str, Any] = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)  # noqa: S102 - the notebook's own lines
    assert [row["failed"] for row in names["rows"]] == [""] * 4
    assert names["figure"].axes
