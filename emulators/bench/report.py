"""A run's summary as tables on the terminal: its numbers, its faults, and its active interlocks."""

from collections.abc import Iterator, Mapping

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from emulators.bench.summary import Faulted, InterlockEntry, Summary

TRACE_DIGITS = 16
"""Number of digits of the hash to compare two runs by eye; the whole one is in `summary.json`."""


def show(console: Console, summary: Summary, remarks: Mapping[str, str]) -> None:
    """Print the tables; `remarks` stand beside the numbers, by their keys in the summary."""
    measured = Table(box=SIMPLE_HEAD, title=f"{summary.robot}, {summary.mission}, seed {summary.seed}")
    measured.title_justify = "left"
    measured.add_column("measured")
    measured.add_column("value", justify="right")
    measured.add_column("unit")
    measured.add_column("remark", style="dim")
    for row in numbers(summary, remarks):
        measured.add_row(*row)
    console.print(measured)
    if summary.faults:
        console.print(_faulted(summary.faults))
    console.print(
        _active(summary.interlock_events) if summary.interlock_events else "no interlock was active\n"
    )


def numbers(summary: Summary, remarks: Mapping[str, str]) -> Iterator[tuple[str, str, str, str]]:
    """Yield what was measured, its value, unit and remark."""
    yield "simulated time", f"{summary.simulated_s:.1f}", "s", f"in {summary.wall_s:.1f} s on the wall clock"
    yield "real-time factor", f"{summary.realtime_factor:.1f}", "", ""
    yield "largest speed", f"{summary.max_speed_mps:.3f}", "m/s", remarks.get("max_speed_mps", "")
    yield (
        "largest acceleration",
        f"{summary.max_acceleration_mps2:.3f}",
        "m/s²",
        "; ".join(filter(None, (summary.acceleration_is, remarks.get("max_acceleration_mps2")))),
    )
    yield "largest motor current", f"{summary.max_current_a:.2f}", "A", ""
    yield "path length", f"{summary.path_length_m:.3f}", "m", ""
    yield (
        "odometry error at the end",
        f"{summary.odometry_error_m * 1000.0:.1f}",
        "mm",
        f"against the plant; at most {summary.max_odometry_error_m * 1000.0:.1f} on the way",
    )
    if summary.max_path_error_m is not None and summary.max_cross_track_m is not None:
        across = f"at the same instant; across the path at most {summary.max_cross_track_m * 1000.0:.1f}"
        yield "distance from the path", f"{summary.max_path_error_m * 1000.0:.1f}", "mm", across
    if summary.radial_error_m is not None:
        swing = f"{summary.radial_error_m * 1000.0:.1f}"
        yield "swing about the path", swing, "mm", "half of peak to peak, once it had settled"
    for name, figure in summary.figures.items():
        if figure is not None:
            yield name, f"{figure:.4g}", "", ""
    yield "CAN frames", f"{summary.frames}", "", f"bus load {summary.bus_load_percent:.2f} %"
    for line in summary.lines:
        yield (
            "serial bytes",
            f"{line.bytes}",
            "",
            f"{line.protocol} at {line.baud} Bd, {line.commands} commands",
        )
        yield "line busy", f"{line.busy_percent:.1f}", "%", ""
        late = f"cycle {line.cycle_ms:g} ms; {line.late_cycles} late"
        yield "longest cycle on the line", f"{line.longest_cycle_ms:.1f}", "ms", late
        if line.i2c_percent is not None:
            yield "I2C busy", f"{line.i2c_percent:.1f}", "%", "between the board and its shield"
    if summary.guard_refusals:
        yield "refusals of the guard", f"{summary.guard_refusals}", "", "a safe word left in each one's place"
    yield "trace", summary.trace_sha256[:TRACE_DIGITS], "", "the same run gives the same trace"


def _over_time(title: str, *headings: str) -> Table:
    table = Table(box=SIMPLE_HEAD, title=title, title_justify="left")
    table.add_column("from", justify="right")
    table.add_column("to", justify="right")
    for heading in headings:
        table.add_column(heading)
    return table


def span(row: Faulted | InterlockEntry) -> tuple[str, str]:
    """Return the text of a span of time."""
    return f"{row.began_s:.2f} s", "end" if row.ended_s is None else f"{row.ended_s:.2f} s"


def _faulted(faults: tuple[Faulted, ...]) -> Table:
    table = _over_time("faults that were put on", "fault", "where", "title")
    for fault in faults:
        table.add_row(*span(fault), fault.kind, ", ".join(fault.nodes), fault.title)
    return table


def _active(events: tuple[InterlockEntry, ...]) -> Table:
    table = _over_time("active interlocks", "interlock", "reason")
    for event in events:
        table.add_row(*span(event), event.name, event.reason)
    return table
