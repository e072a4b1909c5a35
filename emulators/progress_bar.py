"""A progress bar that shows on a terminal only."""

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from firmware_bridge.cli.tables import terminal


def progress_bar() -> Progress:
    """Return the bar; it is to be entered as a context."""
    return _bar(TextColumn("{task.percentage:>3.0f} %"))


def counting_bar() -> Progress:
    """Return a bar that counts runs and shows their rate; it is to be entered as a context."""
    return _bar(MofNCompleteColumn(), _Rate())


class _Rate(ProgressColumn):
    """Runs a minute, of the last ones."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{60.0 * speed:.0f} a minute")


def _bar(*columns: ProgressColumn) -> Progress:
    console = terminal(stderr=True)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        *columns,
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
        transient=True,
    )
