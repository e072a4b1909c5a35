"""docs/coverage.md: each place that it names is there, and no equation that is known is left out."""

import re
from itertools import pairwise
from pathlib import Path
from typing import Final

import pytest

from hil_tests.rows import every
from validation.studies.shelf import studies

ROOT: Final = Path(__file__).parents[2]
PAGE: Final = (ROOT / "docs/coverage.md").read_text(encoding="utf-8")
SECTIONS: Final = dict(re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", PAGE, flags=re.DOTALL | re.MULTILINE))

KNOWN: Final = {
    "RARS": [
        *(
            (f"{chapter}.", first, last)
            for chapter, first, last in (
                (2, 1, 18),
                (3, 13, 102),
                (4, 1, 11),
                (4, 13, 15),
                (5, 1, 1),
                (5, 3, 6),
            )
        ),
        ("6.", 1, 1),
        ("B.", 4, 4),
        ("C.", 1, 1),
    ],
    "ROME": [
        ("2.", 7, 11),
        ("2.", 13, 15),
        ("2.", 17, 22),
        ("3.", 1, 1),
        ("3.", 6, 6),
        ("3.", 15, 16),
        ("3.", 21, 25),
        ("4.", 7, 8),
        ("4.", 10, 10),
    ],
    "The climber": [
        ("", 4, 7),
        ("", 10, 11),
        ("", 13, 13),
        ("", 15, 17),
        ("", 19, 20),
        ("", 27, 29),
        ("", 33, 33),
    ],
}
"""Numbers of the equations of which something is known, by source."""


def rows(section: str) -> list[tuple[str, str, str]]:
    """Return item, places and remark of each row of a section's table."""
    found = [
        tuple(each.strip() for each in line.strip("|").split("|"))
        for line in section.splitlines()
        if line[:2] == "| "
    ]
    return [(row[0], row[1], row[2]) for row in found[1:]]


ROWS: Final = [row for section in SECTIONS.values() for row in rows(section)]
PLACES: Final = sorted({place for _, places, _ in ROWS for place in re.findall(r"`([^`]+)`", places)})


def numbers(item: str) -> set[str]:
    """Return the equations that an item names, ranges written out."""
    found = set()
    for first, last in re.findall(r"\(([\w.]+)\)(?:-\(([\w.]+)\))?", item):
        chapter, _, begin = first.rpartition(".")
        end = (last or first).rpartition(".")[2]
        found |= {f"{chapter}.{one}".strip(".") for one in range(int(begin), int(end) + 1)}
    return found


@every("place", PLACES)
def test_what_the_page_names_is_there(place: str) -> None:
    if place.startswith("study "):
        assert place.removeprefix("study ") in {study.name for study in studies()}
        return
    path, _, name = place.partition(":")
    assert (ROOT / path).exists()
    assert not name or re.search(
        rf"^\s*(?:def|class) {name}\b|^\s*(?:self\.)?{name}\b.*=",
        (ROOT / path).read_text(encoding="utf-8"),
        flags=re.MULTILINE,
    )


@pytest.mark.parametrize("source", KNOWN)
def test_every_known_equation_is_in_the_table_once(source: str) -> None:
    known = {f"{chapter}{one}" for chapter, first, last in KNOWN[source] for one in range(first, last + 1)}
    listed = [each for item, _, _ in rows(SECTIONS[source]) for each in sorted(numbers(item))]
    assert known - set(listed) == set()
    assert [one for one, other in pairwise(sorted(listed)) if one == other] == []


def test_what_has_no_place_states_why_and_every_study_is_named() -> None:
    assert [item for item, places, remark in ROWS if "`" not in places and "Not " not in remark] == []
    assert {study.name for study in studies()} <= {place.removeprefix("study ") for place in PLACES}
