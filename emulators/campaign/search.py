"""A search for the worst case: Optuna proposes the parameters of the next runs by those before them.

Runs are proposed in batches of one size, whatever drives them: the same seed proposes the same runs with any
number of processes.
"""

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from emulators.campaign.campaign_file import Varied
from emulators.campaign.plan import Plan, Run
from emulators.campaign.results import Row
from firmware_bridge.extras import from_extras

BATCH: Final = 4
BEGINS: Final = 12
"""Runs that are drawn at random before any is proposed."""
Drive = Callable[[Sequence[Run]], Sequence[Row]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Search:
    """What is looked for: the largest or the smallest value of a number."""

    key: str
    largest: bool = True
    runs: int = 60
    seed: int = 0


class SearchError(Exception):
    """Nothing to search for, or in; one line."""


def search(plan: Plan, wanted: Search, drive: Drive) -> Iterator[Row]:
    """Yield the rows of the runs that the search drives, batch by batch, in their order.

    Each case and seed of the campaign is a choice beside its parameters. A run in which the number has no
    value is left out. SearchError where nothing is varied; ExtraMissingError without the extra `search`.
    """
    with from_extras():
        import optuna  # noqa: PLC0415 - an extra

    pairs = tuple(dict.fromkeys((run.case, run.seed) for run in _bare(plan)))
    if not plan.campaign.parameter and len(pairs) < 2:  # noqa: PLR2004 - a choice needs two
        raise SearchError("the campaign varies nothing: add a [[parameter]], a robot, a mission or a fault")
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        sampler = optuna.samplers.TPESampler(
            seed=wanted.seed, n_startup_trials=BEGINS, multivariate=True, constant_liar=True
        )
    study = optuna.create_study(direction="maximize" if wanted.largest else "minimize", sampler=sampler)
    driven = 0
    while driven < wanted.runs:
        trials = [study.ask() for _ in range(min(BATCH, wanted.runs - driven))]
        batch = []
        for place, trial in enumerate(trials, driven):
            case, seed = pairs[trial.suggest_int("case", 0, len(pairs) - 1) if len(pairs) > 1 else 0]
            values = {row.path: _suggested(trial, row) for row in plan.campaign.parameter}
            batch.append(Run(place, case, seed, values))
        for trial, row in zip(trials, drive(batch), strict=True):
            value = row.number(wanted.key)
            # A run that broke down gives no number: Optuna leaves it out.
            study.tell(trial, value, state=optuna.trial.TrialState.FAIL if value is None else None)
            yield row
        driven += len(batch)


def best(rows: Sequence[Row], wanted: Search) -> Row | None:
    """Return the row with the largest or smallest value; None where none has one."""
    sign = -1.0 if wanted.largest else 1.0
    known = [(sign * value, row.run, row) for row in rows if (value := row.number(wanted.key)) is not None]
    return min(known, default=(0.0, 0, None))[2]


def _bare(plan: Plan) -> Iterator[Run]:
    return (replace(run, number=0, values={}) for run in plan.runs)


def _suggested(trial: Any, row: Varied) -> Any:
    if row.values is not None:
        return row.values[trial.suggest_int(row.path, 0, len(row.values) - 1)]
    return trial.suggest_float(row.path, row.least, row.most, log=row.log)
