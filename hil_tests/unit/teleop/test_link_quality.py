"""Link quality for the station in control: both edges of each figure, each direction, and the texts."""

from __future__ import annotations

from firmware_bridge.intent import AgeLimit
from firmware_bridge.mavlink.age import Ages
from firmware_bridge.safety.interlock_base import Severity
from firmware_bridge.teleop.texts import LinkState, Quality
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.rows import every

QUESTION = (111, 1)
REQUESTED_AT = 7 * SECOND
WHOLE = 2 * SECOND
"""Age limit of a command here: not the usual one, so that a reader of another one is seen."""
UNDATED = "link: the age of this station's commands is unknown, only their loss is noticed"


def link(
    trip: Nanoseconds | None = None,
    *,
    lost: float | None = None,
    differs: Nanoseconds = 0,
    timestamped: bool = True,
    requested_for: Nanoseconds | None = None,
) -> LinkState:
    """Return a link on which one request was answered after `trip`, or one was sent so long ago."""
    ages = Ages(signed=False)
    now = REQUESTED_AT + (trip or requested_for or 0)
    if trip is not None or requested_for is not None:
        ages.trips.ask(QUESTION, now=REQUESTED_AT)
    if trip is not None:
        ages.trips.answered(QUESTION, now)
    ages.losses.share = lost
    ages.differs = differs
    return LinkState(ages, AgeLimit(most=WHOLE), timestamped, now)


def reported(*links: LinkState) -> list[list[tuple[Severity, str]]]:
    """Return what the station in control is informed of on a link that changes so."""
    quality = Quality()
    return [quality.changes(one) for one in links]


def warned(text: str) -> list[tuple[Severity, str]]:
    return [(Severity.WARNING, text)]


def eased(text: str) -> list[tuple[Severity, str]]:
    return [(Severity.INFO, text)]


DIFFER = "link: this station's clocks disagree by 2.00 s: its messages count as old as the oldest"
EDGES = {
    "clocks that disagree by as much as a word may be old": (
        [link(differs=WHOLE - 1), link(differs=WHOLE), link(differs=WHOLE), link(differs=WHOLE // 2)],
        [[], warned(DIFFER), [], []],
    ),
    "... and agree again": (
        [link(differs=WHOLE), link(differs=WHOLE // 2 - 1)],
        [warned(DIFFER), eased("link: this station's clocks agree again")],
    ),
    "a round trip as long as a word may be old": (
        [link(WHOLE - 1), link(WHOLE)],
        [[], warned("link: round trip 2.00 s")],
    ),
    "... which gets better, but not by a quarter": (
        [link(WHOLE), link(1500 * MILLISECOND)],
        [warned("link: round trip 2.00 s"), []],
    ),
    "... and by more": (
        [link(WHOLE), link(1500 * MILLISECOND - 1)],
        [warned("link: round trip 2.00 s"), eased("link: round trip 1.50 s, good again")],
    ),
    "a round trip between the bounds, from the good side": ([link(1800 * MILLISECOND)], [[]]),
    "one frame in ten is lost": (
        [link(lost=0.0999), link(lost=0.1)],
        [[], warned("link: 10% of this station's frames are lost")],
    ),
    "all frames are lost": ([link(lost=1.0)], [warned("link: 100% of this station's frames are lost")]),
    "... one in twenty": (
        [link(lost=0.25), link(lost=0.05)],
        [warned("link: 25% of this station's frames are lost"), []],
    ),
    "... and fewer": (
        [link(lost=0.25), link(lost=0.0499)],
        [warned("link: 25% of this station's frames are lost"), eased("link: frames come again")],
    ),
    "a share between the bounds, from the good side": ([link(lost=0.07)], [[]]),
    "messages without a time, requested for 3 s": (
        [
            link(timestamped=False, requested_for=3 * SECOND - 1),
            link(timestamped=False, requested_for=3 * SECOND),
        ],
        [[], warned(UNDATED)],
    ),
    "... and still without": (
        [
            link(timestamped=False, requested_for=3 * SECOND),
            link(timestamped=False, requested_for=4 * SECOND),
        ],
        [warned(UNDATED), []],
    ),
    "... and then with one": (
        [link(timestamped=False, requested_for=3 * SECOND), link(timestamped=True, requested_for=3 * SECOND)],
        [warned(UNDATED), eased("link: the age of this station's commands is known")],
    ),
    "words with a time": ([link(timestamped=True, requested_for=3 * SECOND)], [[]]),
    "a station that was never queried": ([link(timestamped=False)], [[]]),
}


@every("edge", EDGES)
def test_what_is_reported_at_both_edges(edge: str) -> None:
    links, expected = EDGES[edge]
    assert reported(*links) == expected


def test_what_is_bad_is_reported_once_and_again_after_it_was_good() -> None:
    bad, good = link(WHOLE), link(MILLISECOND)
    assert [len(texts) for texts in reported(bad, bad, bad, good, good, bad)] == [1, 0, 0, 1, 0, 1]


def test_a_figure_that_is_not_known_any_more_ends_nothing() -> None:
    assert [len(texts) for texts in reported(link(WHOLE), link(), link(WHOLE))] == [1, 0, 0]


def test_each_figure_is_reported_by_itself() -> None:
    both = link(WHOLE, lost=0.5)
    assert reported(both, link(WHOLE, lost=0.01), link(MILLISECOND, lost=0.5)) == [
        [
            *warned("link: round trip 2.00 s"),
            *warned("link: 50% of this station's frames are lost"),
        ],
        eased("link: frames come again"),
        [
            *eased("link: round trip 0.00 s, good again"),
            *warned("link: 50% of this station's frames are lost"),
        ],
    ]
