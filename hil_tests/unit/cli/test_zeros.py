"""Options `--zero` and `--home`: axis positions at the start."""

import math

import pytest
import typer

from firmware_bridge.cli.zeros import zeros_of
from firmware_bridge.intent import ConfirmPosition


def test_what_was_seen_comes_before_what_shall_find_out() -> None:
    stated = zeros_of(["lift=0.2"], ["steer", "neck"])
    assert stated[0] == ConfirmPosition("lift", 0.2)
    assert [(one.axis, math.isnan(one.value)) for one in stated[1:]] == [("steer", True), ("neck", True)]


@pytest.mark.parametrize(
    ("zero", "home"), [(["lift=0.2"], ["lift"]), (None, ["lift", "lift"]), (["lift=nan"], None)]
)
def test_an_axis_stated_twice_or_without_a_number_ends_the_program(
    zero: list[str] | None, home: list[str] | None
) -> None:
    with pytest.raises(typer.Exit):
        zeros_of(zero, home)
