"""The examples' masters: their own tests are green, and red where a master has the mistake they look for."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Final, NamedTuple

import pytest

from hil_tests.testing.conftest import Imported

pytest_plugins = ["pytester"]

EXAMPLES: Final = Path(__file__).parents[2] / "examples" / "masters"


Changes = dict[str, str]
"""Passages of the good master, and their replacements in another."""


Judge = Callable[..., None]


class Planted(NamedTuple):
    """A mistake in a master, and the test of its own that looks for it."""

    master: str
    mistake: Changes
    red: str


HURRIED: Final = {"ANSWERS_S = 10.0": "ANSWERS_S = 0.5", "ENABLES_S = 10.0": "ENABLES_S = 0.5"}
"""Shorter time-outs: a master with the mistake waits for an event that never comes."""
C: Final = Planted(
    "cia402.c", {"if (status & FAULT) {": "if (0) {"}, "test_it_gives_up_where_the_load_is_too_heavy"
)
PYTHON: Final = Planted(
    "two_drives.py",
    {"            if silent:\n                return silent\n": ""},
    "test_one_that_loses_its_power_stops_the_other",
)
CHECK_SUM: Final = Planted(
    "usb_v2.py",
    {
        'if check_sum(head + rest[:-2] + bytes(2)) != int.from_bytes(rest[-2:], "little"):': "if False:",
        **HURRIED,
    },
    "test_a_damaged_answer_is_not_believed",
)
ERROR_CODE: Final = Planted(
    "usb_v2.py",
    {"        if error:\n": "        if False:\n", **HURRIED},
    "test_a_node_that_is_not_there_is_an_error",
)


@pytest.fixture
def judge(pytester: pytest.Pytester, imported: Imported) -> Judge:
    """Return what sees that a good master's tests are green, and the one for its mistake red.

    It is given the mistake, words for pytest, and `of`, which of the tests are run of a good one.
    """

    def see(planted: Planted, *more: str, of: str = "") -> None:
        good = outcomes(pytester, imported, planted.master, {}, "-k", of, *more)
        assert planted.red in good
        assert set(good.values()) == {"passed"}, good
        bad = outcomes(pytester, imported, planted.master, planted.mistake, "-k", planted.red, *more)
        assert bad == {planted.red: "failed"}

    return see


def outcomes(
    pytester: pytest.Pytester, imported: Imported, master: str, changes: Changes, *more: str
) -> dict[str, str]:
    """Run a master's own tests with these changes; return what became of each."""
    source = (EXAMPLES / master).read_text(encoding="utf-8")
    for good, bad in changes.items():
        assert source.count(good) == 1, good
        source = source.replace(good, bad)
    (pytester.path / master).write_text(source, encoding="utf-8")
    shutil.copy(EXAMPLES / f"test_{Path(master).stem}.py", pytester.path)
    words = ("-p", "emulators.testing.plugin", "-p", "no:cacheprovider", "--late-after=0", *more)
    reports = pytester.inline_run(*words, plugins=[imported]).getreports("pytest_runtest_logreport")
    done = [it for it in reports if it.when == "call" or not it.passed]
    return {
        it.nodeid.rpartition("::")[2]: it.outcome
        if it.when == "call" or it.skipped
        else f"{it.when} {it.outcome}"
        for it in done
    }


@pytest.mark.vcan
def test_a_master_in_c_that_does_not_look_at_the_fault_bit(judge: Judge) -> None:
    judge(C)


@pytest.mark.alone
def test_a_master_in_python_that_does_not_miss_a_heartbeat(judge: Judge) -> None:
    judge(PYTHON, "--bus", "loopback_multicast")


def test_a_master_on_a_line_that_believes_a_damaged_answer(judge: Judge) -> None:
    judge(CHECK_SUM, of=CHECK_SUM.red)


@pytest.mark.long(beside="test_a_master_on_a_line_that_believes_a_damaged_answer")
def test_a_master_on_a_line_that_does_not_look_at_the_error_code(judge: Judge) -> None:
    judge(ERROR_CODE)
