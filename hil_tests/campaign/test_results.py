"""Rows, requirements and sensitivities of a campaign, without a run."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from emulators.campaign.campaign_file import Require, parse
from emulators.campaign.journal import Journal
from emulators.campaign.plan import Plan
from emulators.campaign.results import Row, as_csv, as_json, broken, columns, of_json
from emulators.campaign.sensitivity import sensitivities, varied_figures, varied_keys

FIGURES = {"swing": 0.1, "far": None, "count": 3, "interlocks": "starting; not armed; axis timeout: left"}

REQUIRED: list[tuple[Mapping[str, Any], str]] = [
    ({"key": "swing", "most": 0.1}, ""),
    ({"key": "swing", "most": 0.0999}, "swing = 0.1 is above 0.0999"),
    ({"key": "swing", "least": 0.1}, ""),
    ({"key": "swing", "least": 0.1001}, "swing = 0.1 is below 0.1001"),
    ({"key": "swing", "least": 0.0, "most": 0.2}, ""),
    ({"key": "count", "least": 4.0, "most": 5.0}, "count = 3 is below 4"),
    ({"key": "far", "most": 1.0}, "far has no value"),
    ({"key": "absent", "most": 1.0}, "absent has no value"),
    ({"never": "axis timeout: left"}, "'axis timeout: left' became active"),
    ({"never": "axis timeout: right"}, ""),
    ({"always": "axis timeout: left"}, ""),
    ({"always": "emergency stop"}, "'emergency stop' did not become active"),
]


@pytest.mark.parametrize(("required", "message"), REQUIRED)
def test_a_requirement_at_both_edges(required: Mapping[str, Any], message: str) -> None:
    assert broken(FIGURES, [Require(**required)]) == ({0: message} if message else {})


@pytest.mark.parametrize("value", [math.nan, math.inf, True, "0.1"])
def test_what_is_no_number_holds_to_nothing(value: Any) -> None:
    assert broken({"swing": value}, [Require(key="swing", least=0.0, most=1.0)]) == {0: "swing has no value"}


def row(run: int, mu: float, seed: int, swing: float | None) -> Row:
    return Row({"run": run, "robot": "rars", "mu": mu, "seed": seed}, {"swing": swing, "same": 1.0}, {})


ROWS = [
    row(place, mu, seed, mu**3)
    for place, (mu, seed) in enumerate((m / 10, s) for m in range(5) for s in (0, 1))
]


def test_a_number_that_follows_a_parameter_has_rank_correlation_one() -> None:
    assert varied_keys(ROWS) == ["mu", "seed"]
    assert varied_figures(ROWS) == ["swing"]
    by = {one.parameter: one for one in sensitivities(ROWS)}
    assert by["mu"].ranked
    assert by["mu"].strength == pytest.approx(1.0)
    # A seed has no order: by groups, which are the same.
    assert not by["seed"].ranked
    assert by["seed"].strength == pytest.approx(0.0, abs=1e-12)


def test_a_number_that_rises_and_falls_again_is_found_by_groups() -> None:
    valley = [
        row(place, mu, seed, mu**2)
        for place, (mu, seed) in enumerate((m / 10, s) for m in (-2, 0, 2) for s in range(3))
    ]
    (by,) = [one for one in sensitivities(valley) if one.parameter == "mu"]
    assert not by.ranked
    assert by.strength == pytest.approx(1.0)


def test_draws_that_are_all_different_are_no_groups() -> None:
    draws = [row(place, place / 10, 0, math.sin(7.0 * place)) for place in range(12)]
    (by,) = [one for one in sensitivities(draws) if one.parameter == "mu"]
    assert by.ranked


def test_few_runs_state_no_dependence() -> None:
    assert sensitivities(ROWS[:3]) == []


def test_a_row_is_the_same_from_its_line() -> None:
    full = Row({"run": 3, "path": "ä"}, {"swing": 0.1 + 0.2, "far": None}, {0: "swing", -1: "error"})
    assert of_json(as_json(full)) == full


def test_a_journal_keeps_an_error_s_text_whatever_is_in_it(tmp_path: Path) -> None:
    of = Plan(parse('robots = ["rars"]\nmissions = ["line"]', "floors.toml"), (), "floors.toml", "0" * 64)
    torn = Row({"run": 0}, {}, {-1: "PlantError: a\u2028b\x85c\nd"})
    with Journal(tmp_path, of) as journal:
        journal.add(torn)
    assert Journal(tmp_path, of).rows == {0: torn}


def test_columns_of_all_rows_are_there_and_failed_is_the_last() -> None:
    rows = [row(0, 0.1, 0, None), Row({"run": 1}, {"more": 2}, {-1: "no plant"})]
    assert columns(rows) == ["run", "robot", "mu", "seed", "swing", "same", "more", "failed"]
    assert as_csv(rows).splitlines()[1:] == ["0,rars,0.1,0,,1.0,,", "1,,,,,,2,no plant"]
