"""One run of a campaign, in any process: driven, measured, judged."""

from collections.abc import Callable, Sequence

from emulators.bench.summary import Summary
from emulators.campaign.campaign_file import Require
from emulators.campaign.plan import Run, order_of
from emulators.campaign.results import Row, broken, error_row, figures_of
from emulators.run import RunOrder, measure
from firmware_bridge.bridge.bridge import FAILED as NOT_STARTED


def drive(
    run: Run,
    require: Sequence[Require],
    order: Callable[[Run], RunOrder] = order_of,
    by: Callable[[RunOrder], Summary] = measure,
) -> Row:
    """Drive a run, and return its row; what ends it is in the row, and ends nothing else."""
    try:
        summary = by(order(run))
    except Exception as error:  # noqa: BLE001 - on a robot the bridge would be dead: that is the result
        return error_row(run, f"{type(error).__name__}: {error}")
    for event in summary.interlock_events:
        if event.name == NOT_STARTED.name:
            return error_row(run, f"the run did not start: {event.reason}")
    figures = figures_of(summary)
    return Row(run.key, figures, broken(figures, require))
