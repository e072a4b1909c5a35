"""Provenance of the emulated motion capture system, aspect by aspect."""

from collections.abc import Callable, Iterable, Sequence
from typing import Final, TypeAlias

from validation.pages import board_fidelity

Table: TypeAlias = Callable[[Sequence[str], Iterable[Sequence[str]]], str]

TITLE: Final = "How far the emulated capture system is known"
FOLDER: Final = "motion_capture"
TEXT: Final = "What [`emulate capture`](motion-capture.md) streams, and what stands behind it."
KNOWN: Final = (
    ("frames, models, server info of NatNet 3.0", "by the layout in which those of a Motive 2.1 were read"),
    ("3.1", "as 3.0: so do all clients that were read"),
    ("2.9, 2.10, 4.0 to 4.4; skeletons, assets, force plates, devices", "from clients; nothing recorded"),
    ("ports, connect, keep-alive, echo, commands", "from clients, and from what a Motive 2.1 has answered"),
    ("5.4 ms from exposure to sending", "of a Motive 2.1 at 120 Hz: least 5.09, median 5.40, most 5.89 ms"),
    ("PyPI's client natnet", "reads 2.10, 3.1 and 4.1 on loopback, in the tests"),
    ("Motive itself, OptiTrack's own library, VRPN, multicast", "not tried"),
)


def parts(table: Table) -> tuple[str, ...]:
    """Return the page's title and its parts; `table` makes a table of headings and rows."""
    return (
        TITLE,
        TEXT,
        table(("what", "known"), KNOWN),
        "## Stated assumptions",
        table(("what", "where"), board_fidelity.assumptions(FOLDER)),
    )
