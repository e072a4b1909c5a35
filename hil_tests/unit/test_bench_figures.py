"""The table of `make bench`: ratios and goals, a machine that is not quiet, the history of releases."""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from benchmarks import __main__ as program
from benchmarks import figure
from benchmarks.figure import Figure, OthersLoad, keep, ratios
from hil_tests.rows import every

FASTER = Figure(name="a", value=3.0, unit="ms", against="loop", reference=6.0, goal=0.5)
SLOWER = Figure(name="b", value=9.0, unit="h", against="an hour", reference=3.0, goal=4.0, at_least=True)
WATCHED = Figure(name="c", value=9.0, unit="ms", against="loop", reference=3.0)


@every(
    ("one", "ratio", "met", "limit"),
    [(FASTER, 0.5, True, "<= 0.5"), (SLOWER, 3.0, False, ">= 4"), (WATCHED, 3.0, True, "")],
    ids=lambda value: getattr(value, "name", value),
)
def test_a_goal_is_one_of_the_ratio(one: Figure, ratio: float, *, met: bool, limit: str) -> None:
    assert (one.ratio, one.met, one.limit) == (ratio, met, limit)


@pytest.fixture
def history(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a history of its own."""
    file = tmp_path / "history.csv"
    monkeypatch.setattr(figure, "HISTORY", file)
    return file


def test_the_history_has_each_release_once_and_the_newest_is_compared(history: Path) -> None:
    assert ratios() == {}
    keep([FASTER, WATCHED], "0.1.0")
    keep([SLOWER], "0.2.0")
    keep([FASTER], "0.1.0")
    assert ratios("0.2.0") == {"b": 3.0}
    assert ratios() == ratios("0.1.0") == {"a": 0.5}
    assert len(history.read_text(encoding="utf-8").splitlines()) == 3


def busy(monkeypatch: pytest.MonkeyPatch, whole: list[float], own: list[float]) -> None:
    """Let the machine and this process work so long, look by look, within two seconds."""
    times = iter([10.0, 12.0])
    monkeypatch.setattr(figure, "time", SimpleNamespace(perf_counter=lambda: next(times)))
    for name, values in (("_busy_s", iter(whole)), ("_own_s", iter(own))):
        monkeypatch.setattr(figure, name, lambda values=values: next(values))


@pytest.mark.skipif(not Path("/proc/stat").exists(), reason="needs /proc/stat")
@every(("whole", "others"), [(101.9, 0.0), (102.5, 0.25), (104.0, 1.0), (101.0, 0.0)])
def test_what_others_work_is_all_but_ones_own(whole: float, others: float) -> None:
    with pytest.MonkeyPatch.context() as patch:
        busy(patch, [100.0, whole], [5.0, 7.0])
        assert OthersLoad().seen() == pytest.approx(others)


@every(
    ("others", "found", "status"),
    [(0.3, [FASTER], 0), (0.3, [FASTER, SLOWER], 1), (0.31, [FASTER], 2)],
)
def test_a_busy_machine_measures_nothing(others: float, found: list[Figure], status: int) -> None:
    with pytest.MonkeyPatch.context() as patch:
        kept: list[str] = []
        patch.setattr(program, "OthersLoad", lambda: SimpleNamespace(seen=lambda: others))
        patch.setattr(program, "keep", lambda _, release: kept.append(release))
        patch.setattr(importlib.import_module("benchmarks.start"), "figures", lambda: iter(found))
        patch.setattr(sys, "argv", ["benchmarks", "start", "--keep", "9.9.9"])
        assert program.main() == status
        assert bool(kept) == (status < 2)


def test_the_table_marks_a_missed_goal_and_a_busy_machine(
    history: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    keep([FASTER], "0.1.0")
    monkeypatch.setattr(program, "OthersLoad", lambda: SimpleNamespace(seen=lambda: 0.7))
    part = importlib.import_module("benchmarks.start")
    monkeypatch.setattr(part, "figures", lambda: iter([FASTER, SLOWER]))
    monkeypatch.setattr(sys, "argv", ["benchmarks", "start"])
    program.main()
    printed = capsys.readouterr().out
    rows = {line.split()[0]: line.split() for line in printed.splitlines() if line.strip()}
    assert rows["a"] == ["a", "3", "ms", "loop,", "6", "0.5", "<=", "0.5", "0.5"]
    assert "missed" in rows["b"]
    assert "INVALID: above 0.3 no figure counts; other processes kept 0.70 processors busy" in printed
    assert history.exists()


def test_each_part_of_the_table_measures_something() -> None:
    for name in program.PARTS:
        assert isinstance(importlib.import_module(f"benchmarks.{name}").figures(), Iterator)


def test_a_part_that_there_is_not_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks", "rum"])
    with pytest.raises(SystemExit) as ended:
        program.main()
    assert ended.value.code == 2
    assert "no such part: rum; there are parts, scale," in capsys.readouterr().err
