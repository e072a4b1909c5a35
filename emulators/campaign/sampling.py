"""Values of the parameters in each run: every one with every other, or drawn from their ranges."""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

import numpy as np

from emulators.campaign.campaign_file import Campaign, Varied
from firmware_bridge.extras import from_extras

Drawn = tuple[Any, ...]
"""A value for each parameter."""


def samples_of(campaign: Campaign) -> Iterator[Drawn]:
    """Yield the parameters' values, sample by sample; ExtraMissingError where SciPy is needed and missing."""
    if campaign.sample == "grid":
        yield from product(*(row.grid for row in campaign.parameter))
        return
    for shares in _shares(campaign, len(campaign.parameter)):
        yield valued(campaign.parameter, shares)


def valued(rows: Sequence[Varied], shares: Sequence[float]) -> Drawn:
    """Return the values at these shares of the ranges."""
    return tuple(row.at(float(share)) for row, share in zip(rows, shares, strict=True))


def _shares(campaign: Campaign, width: int) -> Sequence[Sequence[float]]:
    count = campaign.samples or 0
    if width == 0:
        return [()] * count
    if campaign.sample == "random":
        return list(np.random.default_rng(campaign.draw_seed).random((count, width)))
    with from_extras():
        from scipy.stats import qmc  # type: ignore[import-untyped] # noqa: PLC0415 - an extra

    if campaign.sample == "sobol":
        # Of a power of two points it is balanced: the first `count` of them are taken.
        power = max(count - 1, 0).bit_length()
        return list(qmc.Sobol(width, rng=campaign.draw_seed).random_base2(power)[:count])
    return list(qmc.LatinHypercube(width, rng=campaign.draw_seed).random(count))
