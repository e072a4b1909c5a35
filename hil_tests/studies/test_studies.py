"""Every study that comes with the program: its numbers within their bounds, and its axes with their units."""

import re
from typing import Final

import pytest

from validation.studies.shelf import studies
from validation.studies.study import Study

STUDIES: Final = {study.name: study for study in studies()}
SHORT: Final = ("tipping", "torques", "sizing", "turning_circle", "pivot", "polar_law")
"""Studies that `make test` has time for; `make long` makes all of them, quick and whole."""


@pytest.mark.parametrize("study", [STUDIES[name] for name in SHORT], ids=SHORT)
def test_a_study_holds_its_bounds_in_short(study: Study) -> None:
    holds(study, quick=True)


@pytest.mark.long(beside="test_a_study_holds_its_bounds_in_short")
@pytest.mark.parametrize("quick", [True, False], ids=["quick", "whole"])
@pytest.mark.parametrize("study", STUDIES.values(), ids=STUDIES)
def test_every_study_holds_its_bounds(study: Study, *, quick: bool) -> None:
    holds(study, quick=quick)


def holds(study: Study, *, quick: bool) -> None:
    findings = study.made(quick=quick)
    assert findings.compared
    assert findings.out_of_bounds == ()
    assert all(row.within > 0.0 for row in findings.compared)
    for row in findings.compared:
        # Where the print differs from the independent way, the reader finds the reason.
        assert row.printed is None or abs(row.printed - row.independent) <= row.within or row.why
    for plot in findings.plots:
        assert plot.caption
        for axis in (plot.x, plot.y):
            assert re.search(r"\[.+\]$", axis), f"'{axis}' of '{plot.title}' has no unit"
        assert plot.equal or any(curve.label for curve in plot.curves)
        assert all(len(curve.x) == len(curve.y) for curve in plot.curves)
