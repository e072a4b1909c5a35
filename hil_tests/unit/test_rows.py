"""A table that is one test: it fails where a row does, and names each."""

import inspect

import pytest

from hil_tests import rows
from hil_tests.rows import every


@every(("low", "high"), [(1, 2), (3, 3), (9, 2), (4, 0), (5, 6)])
def ordered(tmp: str, low: int, high: int) -> None:
    assert tmp
    assert low <= high


@every("value", ["good", "bad"])
def refuses_bad(value: str) -> None:
    if value != "good":
        with pytest.raises(ValueError, match="never"):
            pass


def test_all_rows_that_fail_are_named_in_the_first_line_and_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rows._Run, "stops_at_once", False)  # noqa: SLF001 - as without -x
    with pytest.raises(ExceptionGroup, match=r"^2 of 5 rows: 9-2, 4-0") as caught:
        ordered(tmp="a fixture")
    assert ["assert 9 <= 2" in str(one) for one in caught.value.exceptions] == [True, False]
    with pytest.raises(pytest.fail.Exception, match="DID NOT RAISE") as alone:
        refuses_bad()
    assert alone.value.__notes__ == ["in the row bad"]


def test_with_x_the_first_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rows._Run, "stops_at_once", True)  # noqa: SLF001 - as with -x
    with pytest.raises(AssertionError, match="assert 9 <= 2"):
        ordered(tmp="a fixture")


def test_pytest_sees_the_fixtures_alone() -> None:
    assert list(inspect.signature(ordered).parameters) == ["tmp"]
    stacked = every("tmp", ["x"])(ordered)
    assert list(inspect.signature(stacked).parameters) == []
    with pytest.raises(ValueError, match="tests nothing"):
        every("value", [])
