"""The examples' masters: their own tests are green, and red where a master has the mistake they look for."""

import shutil
from pathlib import Path
from typing import Final, NamedTuple

import pytest

pytest_plugins = ["pytester"]

EXAMPLES: Final = Path(__file__).parents[2] / "examples" / "masters"


Changes = dict[str, str]
"""What stands in the good master, and what in its place in another."""


class Planted(NamedTuple):
    """A mistake in a master, and the test of its own that looks for it."""

    master: str
    mistake: Changes
    red: str


HURRIED: Final = {"ANSWERS_S = 10.0": "ANSWERS_S = 0.5", "ENABLES_S = 10.0": "ENABLES_S = 0.5"}
"""What has the mistake waits for what never comes, and need not do so for long."""
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


def outcomes(pytester: pytest.Pytester, master: str, changes: Changes, *more: str) -> dict[str, str]:
    """Run a master's own tests with these changes; return what became of each."""
    source = (EXAMPLES / master).read_text(encoding="utf-8")
    for good, bad in changes.items():
        assert source.count(good) == 1, good
        source = source.replace(good, bad)
    (pytester.path / master).write_text(source, encoding="utf-8")
    shutil.copy(EXAMPLES / f"test_{Path(master).stem}.py", pytester.path)
    words = ("-p", "emulators.testing.plugin", "-p", "no:cacheprovider", *more)
    reports = pytester.inline_run(*words).getreports("pytest_runtest_logreport")
    done = [it for it in reports if it.when == "call" or not it.passed]
    return {
        it.nodeid.rpartition("::")[2]: it.outcome
        if it.when == "call" or it.skipped
        else f"{it.when} {it.outcome}"
        for it in done
    }


def judge(pytester: pytest.Pytester, planted: Planted, *more: str, of: str = "") -> None:
    """See that a good master's tests, or those `of` a kind, are green, and the one for its mistake red."""
    good = outcomes(pytester, planted.master, {}, "-k", of, *more)
    assert planted.red in good
    assert set(good.values()) == {"passed"}, good
    bad = outcomes(pytester, planted.master, planted.mistake, "-k", planted.red, *more)
    assert bad == {planted.red: "failed"}


@pytest.mark.vcan
def test_a_master_in_c_that_does_not_look_at_the_fault_bit(pytester: pytest.Pytester) -> None:
    judge(pytester, C)


@pytest.mark.alone
def test_a_master_in_python_that_does_not_miss_a_heartbeat(pytester: pytest.Pytester) -> None:
    judge(pytester, PYTHON, "--bus", "udp_multicast")


def test_a_master_on_a_line_that_believes_a_damaged_answer(pytester: pytest.Pytester) -> None:
    judge(pytester, CHECK_SUM, of=CHECK_SUM.red)


@pytest.mark.long(beside="test_a_master_on_a_line_that_believes_a_damaged_answer")
def test_a_master_on_a_line_that_does_not_look_at_the_error_code(pytester: pytest.Pytester) -> None:
    judge(pytester, ERROR_CODE)
