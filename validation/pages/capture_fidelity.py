"""Provenance of the emulated motion capture system, aspect by aspect."""

from collections.abc import Callable, Iterable, Sequence
from typing import Final, TypeAlias

from validation.pages import board_fidelity

Table: TypeAlias = Callable[[Sequence[str], Iterable[Sequence[str]]], str]

TITLE: Final = "Fidelity of the emulated capture system"
FOLDER: Final = "motion_capture"
TEXT: Final = "Data that [`emulate capture`](motion-capture.md) streams, and their sources."
KNOWN: Final = (
    ("frames, models, server info of NatNet 3.0", "by the layout of recordings of a Motive 2.1"),
    ("3.1", "as 3.0, as in all examined clients"),
    ("2.9, 2.10, 4.0 to 4.4; skeletons, assets, force plates, devices", "from clients; not recorded"),
    ("ports, connect, keep-alive, echo, commands", "from clients, and from answers of a Motive 2.1"),
    ("5.4 ms from exposure to sending", "of a Motive 2.1 at 120 Hz: least 5.09, median 5.40, most 5.89 ms"),
    ("PyPI's client natnet", "reads 2.10, 3.1 and 4.1 on loopback, in the tests"),
    ("Motive itself, OptiTrack's own library, VRPN, multicast", "not tried"),
)


def parts(table: Table) -> tuple[str, ...]:
    """Return the page's title and its parts; `table` makes a table of headings and rows."""
    return (
        TITLE,
        TEXT,
        table(("item", "source"), KNOWN),
        "## Stated assumptions",
        table(("assumption", "file"), board_fidelity.assumptions(FOLDER)),
    )
