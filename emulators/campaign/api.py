"""What `firmware_bridge.campaign` calls."""

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from emulators.bench.toml_text import as_toml
from emulators.campaign.campaign_file import CampaignError, load, parse
from emulators.campaign.engine import Settings, campaign
from emulators.campaign.plan import plan

TABLE = "campaign"
"""What a table is called in messages."""


def run(
    given: str | Path | Mapping[str, Any],
    *,
    out: str | Path | None = None,
    jobs: int | None = None,
    scheduler: str = "",
) -> list[dict[str, Any]]:
    """Drive a campaign; see `firmware_bridge.campaign.run`."""
    try:
        if isinstance(given, Mapping):
            made = plan(parse(as_toml(given), TABLE), TABLE)
        else:
            made = plan(load(Path(given)), str(given), Path(given).parent)
    except CampaignError as error:
        raise ValueError(str(error)) from error
    processes = jobs or os.cpu_count() or 1
    if out is None and isinstance(given, Mapping):
        with tempfile.TemporaryDirectory() as folder:
            settings = Settings(out=Path(folder), jobs=processes, scheduler=scheduler, keep=0)
            return [row.flat for row in campaign(made, settings)]
    folder_of = Path(out) if out is not None else Path("out") / Path(str(given)).stem
    settings = Settings(out=folder_of, jobs=processes, scheduler=scheduler)
    return [row.flat for row in campaign(made, settings)]
