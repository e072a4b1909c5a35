"""The search for worst cases: over planted weaknesses it needs at most a third of the runs of chance."""

import math
import statistics
from collections.abc import Callable, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np
import pytest

from emulators.campaign.campaign_file import load
from emulators.campaign.plan import Plan, Run, plan
from emulators.campaign.results import ERROR, Row
from emulators.campaign.sampling import valued
from emulators.campaign.search import Search, SearchError, best, search
from hil_tests.campaign.campaigns import written

RANGES: Final = {
    "plant.floor_friction": (0.1, 1.0),
    "plant.slope": (-0.4, 0.4),
    "link.delay": (0.0, 1.0),
    "mission.noise.stick": (0.0, 0.1),
}
ROWS: Final = [{"path": path, "least": least, "most": most} for path, (least, most) in RANGES.items()]
RARE: Final = 0.004
"""Share of the runs that chance finds as bad as a search must."""
MOST: Final = 400
SEEDS: Final = range(5)

Weakness = Callable[[float, float, float, float], float]
"""By friction, slope, delay and tremor, each as a share of its range, 0 to 1."""


def near(value: float, place: float, width: float) -> float:
    return math.exp(-(((value - place) / width) ** 2))


WEAKNESSES: Final[Mapping[str, Weakness]] = {
    "slides on ice downhill": lambda mu, slope, _d, _n: (1 - mu) * slope,
    "swings at long delays, more with tremor": lambda _m, _s, delay, noise: delay * (0.5 + noise),
    "odometry drifts on a soft floor uphill": lambda mu, slope, _d, _n: near(mu, 0.3, 0.2) * (1 - slope),
    "stops late on ice with a slow link": lambda mu, _s, delay, _n: (1 - mu) ** 2 * delay,
    "a resonance of delay and slope": lambda _m, slope, delay, _n: (
        near(delay, 0.55, 0.1) * near(slope, 0.7, 0.2)
    ),
    "a window of friction": lambda mu, _s, delay, _n: near(mu, 0.62, 0.06) + 0.3 * delay,
    "tremor reverses the steering on a slope": lambda _m, slope, _d, noise: noise * abs(2 * slope - 1),
    "everything at once": lambda mu, slope, delay, noise: (1 - mu) * slope * delay * noise,
    "overshoots on grip, level, without delay": lambda mu, slope, delay, _n: (
        mu * near(slope, 0.5, 0.3) * (1 - delay)
    ),
    "two valleys, one deeper": lambda mu, _s, delay, _n: max(
        0.8 * near(mu, 0.2, 0.2) * near(delay, 0.2, 0.2), near(mu, 0.8, 0.15) * near(delay, 0.8, 0.15)
    ),
}


def shares(values: Mapping[str, float]) -> list[float]:
    return [(values[path] - least) / (most - least) for path, (least, most) in RANGES.items()]


def driven(weakness: Weakness) -> Callable[[Sequence[Run]], list[Row]]:
    """Return what stands for driving: a run's number follows from its values alone."""
    return lambda runs: [Row(run.key, {"swing": weakness(*shares(run.values))}, {}) for run in runs]


def needed(numbers: Sequence[float], bad: float) -> int:
    return next((place for place, number in enumerate(numbers, 1) if number >= bad), MOST)


@pytest.fixture(scope="module")
def varied(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    folder = tmp_path_factory.mktemp("search")
    file = written(folder, parameter=ROWS, sample="random", samples=4000, seeds=1)
    return plan(load(file), "floors.toml", folder)


def bad_of(weakness: Weakness, varied: Plan) -> float:
    """Return how bad the worst few of many runs are."""
    return float(np.quantile([weakness(*shares(run.values)) for run in varied.runs], 1.0 - RARE))


def by_search(weakness: Weakness, varied: Plan, seed: int, bad: float) -> int:
    found = search(varied, Search(key="swing", runs=MOST, seed=seed), driven(weakness))
    numbers: list[float] = []
    for row in found:
        numbers.append(row.number("swing") or 0.0)
        if numbers[-1] >= bad:
            break
    return needed(numbers, bad)


def by_chance(weakness: Weakness, varied: Plan, seed: int, bad: float) -> int:
    chance = np.random.default_rng([seed, 1])
    drawn = (valued(varied.campaign.parameter, list(chance.random(len(RANGES)))) for _ in range(MOST))
    return needed([weakness(*shares(dict(zip(RANGES, values, strict=True)))) for values in drawn], bad)


@pytest.mark.long(beside="test_the_same_seed_proposes_the_same_runs")
def test_over_ten_weaknesses_it_needs_a_third_of_the_runs_of_chance(varied: Plan) -> None:
    assert len(WEAKNESSES) == 10
    by_both = [
        (by_search(weakness, varied, seed, bad), by_chance(weakness, varied, seed, bad))
        for weakness in WEAKNESSES.values()
        for bad in [bad_of(weakness, varied)]
        for seed in SEEDS
    ]
    searched, drawn = (statistics.median(numbers) for numbers in zip(*by_both, strict=True))
    assert searched <= drawn / 3.0, by_both


def test_the_same_seed_proposes_the_same_runs(varied: Plan) -> None:
    weakness = WEAKNESSES["slides on ice downhill"]
    first, again, other = (
        list(search(varied, Search(key="swing", runs=20, seed=seed), driven(weakness))) for seed in (1, 1, 2)
    )
    assert first == again
    assert first != other
    worst = best(first, Search(key="swing"))
    assert worst is not None
    assert worst.number("swing") == max(row.number("swing") or 0.0 for row in first)


def test_a_run_without_the_number_is_left_out(varied: Plan) -> None:
    def breaks_down(runs: Sequence[Run]) -> list[Row]:
        return [Row(run.key, {}, {ERROR: "no plant"}) for run in runs]

    rows = list(islice(search(varied, Search(key="swing", runs=8), breaks_down), 8))
    assert len(rows) == 8
    assert best(rows, Search(key="swing")) is None


def test_a_campaign_that_varies_nothing_is_refused(tmp_path: Path) -> None:
    made = plan(load(written(tmp_path, parameter=[], seeds=1)), "floors.toml", tmp_path)
    with pytest.raises(SearchError, match="the campaign varies nothing: add"):
        list(search(made, Search(key="swing"), driven(WEAKNESSES["everything at once"])))
