"""Extras: a missing one is reported with the line that installs it."""

import importlib
import sys

import pytest

from firmware_bridge.extras import LIBRARIES, Extra, ExtraMissingError, from_extras, installed
from validation.studies.study import Study


@pytest.mark.parametrize(
    ("extra", "library"), [(extra, library) for extra, needed in LIBRARIES.items() for library in needed]
)
def test_an_extra_that_is_missing_is_named(
    monkeypatch: pytest.MonkeyPatch, extra: Extra, library: str
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    assert not installed(extra)
    with (
        pytest.raises(ExtraMissingError, match=rf"pip install 'firmware-bridge\[{extra}\]'"),
        from_extras(),
    ):
        importlib.import_module(f"{library}.anything")


def test_what_no_extra_brings_is_missing_as_it_is() -> None:
    with pytest.raises(ModuleNotFoundError, match="no_such_thing"), from_extras():
        importlib.import_module("no_such_thing")


def test_a_study_that_cannot_be_made_states_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sympy", None)
    with pytest.raises(LookupError, match=r"firmware-bridge\[plants\]"):
        Study("mine", "", "", "sympy:made").made()


def test_all_of_them_are_here() -> None:
    assert all(installed(extra) for extra in LIBRARIES)
