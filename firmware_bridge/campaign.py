"""Campaigns from a program or a notebook: `from firmware_bridge.campaign import run`.

    rows = run("floors.toml")
    rows = run({"robots": ["rars"], "missions": ["line"], "seeds": 10}, out="out/seeds", jobs=4)

A script calls it below `if __name__ == "__main__":`, as each of its processes reads the script once more; a
notebook need not. Each row is a dict: what the run is of, the numbers of its summary, and `failed`, empty
where it held to every requirement. `pandas.DataFrame(rows)` is a table of them.
"""

from collections.abc import Mapping
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

GROUP = "firmware_bridge.campaign"


def run(
    campaign: str | Path | Mapping[str, Any],
    *,
    out: str | Path | None = None,
    jobs: int | None = None,
    scheduler: str = "",
) -> list[dict[str, Any]]:
    """Drive a campaign, a file or its table, and return its rows in the order of the runs.

    `out` is the folder of the results (a file's name below out/ unless given, none for a table), `jobs` the
    number of processes (all processors), `scheduler` that of a Dask cluster, tcp://HOST:PORT. What was driven
    into `out` before is not driven again. Paths in a table are relative to the working directory.
    ValueError with every mistake of the campaign; LookupError where the simulation or an extra is missing.
    """
    for entry in entry_points(group=GROUP, name="run"):
        rows: list[dict[str, Any]] = entry.load()(campaign, out=out, jobs=jobs, scheduler=scheduler)
        return rows
    raise LookupError(
        "campaigns are driven by the simulation, which is not installed: pip install firmware-bridge"
    )
