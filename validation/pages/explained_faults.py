"""The page of the faults that `explain` names in a recording, from a table of measured rides.

The table is written by `python -m hil_tests.unit.explain.fault_stories`; a test measures rows of it again.
"""

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

from emulators.bench.faults import kinds
from validation.pages.capture_fidelity import Table

TABLE: Final = Path(__file__).parents[2] / "hil_tests/unit/explain/fault_stories.csv"
TITLE: Final = "Faults that explain names"
COLUMNS: Final = ("CAN", "EPOS2 over serial", "board")
NAMED, CANDIDATE, NOT_ON_THE_WIRES = "named", "candidate", "not on the wires"
VERDICTS: Final = (NAMED, CANDIDATE, "seen", "no incident", "same")
"""From the best on."""
OFF_THE_WIRES: Final = "the frames do not differ"
REASONS: Final[Mapping[str, str]] = {
    "datagram_loss": "the operator's radio link is not in the recording; at most the bridge's stop is",
    "datagram_late": "the operator's radio link is not in the recording; at most the bridge's stop is",
    "datagram_doubled": "the operator's radio link is not in the recording",
    "second_station": "the operator's radio link is not in the recording; at most the bridge's stop is",
    "body_hidden": "the cameras' network is not in the recording; at most the bridge's stop is",
    "body_shakes": "the cameras' network is not in the recording; at most the bridge's stop is",
    "markers_swapped": "the cameras' network is not in the recording; at most the bridge's stop is",
    "capture_late": "the cameras' network is not in the recording; at most the bridge's stop is",
    "capture_loss": "the cameras' network is not in the recording; at most the bridge's stop is",
}
"""Faults of what no wire of a recording carries."""
LIMITS: Final[Mapping[str, str]] = {
    "set_points_ignored": "the drive answers as before, and a constant set-point hides it",
    "encoder_frozen": "the drive reports nothing and counts what the shaft does; the bridge's stop is seen",
    "drive_variation": "what it does is lawful",
    "imu_frozen": "an IMU's values are shown, and not judged",
    "imu_axes_swapped": "an IMU's values are shown, and not judged",
    "imu_silent": "a line on which a device sends by itself is shown, and not judged",
    "grip_lost": "the wheels turn as commanded; only the pose differs",
    "load_lifted": "without its load a motor in a closed loop counts nearly as before",
    "current_limit": "this ride does not reach the limit",
    "over_temperature": "this ride does not heat the half bridges",
    "second_bridge": "the second bridge finds the first one and sends nothing",
}
"""Faults that frames show, and do not explain."""
TEXT: Final = (
    "[`explain`](explain.md) on one short ride for each kind of [fault](faults.md), with the severe keys "
    "of the failure analysis, at the first axis that can have it. The recording is compared with that of "
    "the same ride without the fault."
)
LEGEND: Final = (
    "* **named**: one of the first three incidents, or its first cause, is the fault.\n"
    "* **candidate**: the fault is among at most three causes of one of them.\n"
    "* **not on the wires**: the frames are the same, or differ by the bridge's own reaction only.\n"
    "* **not named**: the frames differ, and no incident has the cause.\n"
    "* **-**: the fault needs another link.\n\n"
    "n of m: so many of a kind's severities have this result, the others less. A board speaks mw or "
    "ros-arduino-bridge, of which the better one counts; the drives behind a serial port speak V2."
)
_COUNTS: Final = (
    "{named} of {all} kinds are named, {candidate} are among at most three causes, {off} are not on the "
    "wires, {rest} are on them and not named."
)


def _measured() -> Mapping[tuple[str, str], Mapping[str, tuple[str, str]]]:
    """Return the best verdict, and what shows it, of each fault by kind and column, and by its keys."""
    found: dict[tuple[str, str], dict[str, tuple[str, str]]] = {}
    with TABLE.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            of_keys = found.setdefault((row["kind"], row["column"]), {})
            new = (row["verdict"], row["shown"])
            known = of_keys.get(row["title"], new)
            of_keys[row["title"]] = min(known, new, key=lambda one: VERDICTS.index(one[0]))
    return found


MEASURED: Final = _measured()


def verdict(kind: str, column: str) -> str:
    """Return the result of a kind in a column."""
    by_keys = MEASURED.get((kind, column))
    if by_keys is None:
        return "-"
    results = [_result(kind, one) for one, _ in by_keys.values()]
    best = min(results, key=_RANK.index)
    return best if len(set(results)) == 1 else f"{best} ({results.count(best)} of {len(results)})"


def _result(kind: str, measured: str) -> str:
    if measured in {NAMED, CANDIDATE}:
        return measured
    return NOT_ON_THE_WIRES if measured == "same" or kind in REASONS else "not named"


_RANK: Final = (NAMED, CANDIDATE, "not named", NOT_ON_THE_WIRES)


def overall(kind: str) -> str:
    """Return the best result of a kind."""
    results = [verdict(kind, column).partition(" (")[0] for column in COLUMNS]
    return min((one for one in results if one != "-"), key=_RANK.index)


def _why(kind: str) -> str:
    """Return what names a kind, or why nothing does."""
    if kind in REASONS:
        return REASONS[kind]
    shown = [
        one
        for column in COLUMNS
        for one in MEASURED.get((kind, column), {}).values()
        if one[0] in {NAMED, CANDIDATE}
    ]
    if shown:
        return min(shown, key=lambda one: VERDICTS.index(one[0]))[1]
    return LIMITS.get(kind, OFF_THE_WIRES)


def rows() -> Iterator[tuple[str, ...]]:
    """Yield a row for each kind of fault."""
    for kind in kinds():
        yield (f"[`{kind}`](faults.md#{kind})", *(verdict(kind, column) for column in COLUMNS), _why(kind))


def parts(table: Table) -> tuple[str, ...]:
    """Return the page's title and its parts; `table` makes a table of headings and rows."""
    results = [overall(kind) for kind in kinds()]
    counts = _COUNTS.format(
        named=results.count(NAMED),
        candidate=results.count(CANDIDATE),
        off=results.count(NOT_ON_THE_WIRES),
        rest=results.count("not named"),
        all=len(results),
    )
    return (
        TITLE,
        TEXT,
        LEGEND,
        counts,
        table(("fault", *COLUMNS, "what names it, or why nothing does"), rows()),
    )
