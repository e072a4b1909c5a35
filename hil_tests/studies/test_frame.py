"""Output of a study, and its reaction to a number that is not within its bound."""

import csv
import sys
from importlib import metadata
from pathlib import Path

import pytest
from typer.testing import CliRunner

from firmware_bridge.cli import program
from validation.studies.report import page, write
from validation.studies.solve import integrate, root
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet, Study, chosen

HERE = "hil_tests.studies.test_frame"
GOOD = Compared("length", "m", 1.1, 1.0, 1.05, 0.1, "rounded")
BAD = Compared("mass & more", "kg", None, 1.0, 1.2, 0.1)
PLOT = Plot("A <line>", "time [s]", "way [m]", (Curve("", [0.0, 1.0], [0.0, 2.0]),), "as in (1)")
STUDY = Study("one", "One & only", "Someone, 2000", "os:getcwd")


def made(*compared: Compared) -> Findings:
    return Findings(compared, (PLOT,), (Sheet("Sheet", ("a", "b [m]"), (("x", 1.0),)),), ("A remark.",))


def test_a_number_holds_up_to_its_bound_and_what_is_no_number_never_does() -> None:
    for ours, holds in (
        (1.1, True),
        (0.9, True),
        (1.1001, False),
        (float("nan"), False),
        (float("inf"), False),
    ):
        assert Compared("q", "", None, 1.0, ours, 0.1 + 1e-9).holds is holds
    assert made(GOOD, BAD).out_of_bounds == (BAD,)


def test_a_folder_has_every_table_and_picture_and_the_same_bytes_each_time(tmp_path: Path) -> None:
    for name in ("first", "second"):
        write(tmp_path / name, made(GOOD, BAD))
    files = {path.name: path.read_bytes() for path in (tmp_path / "first").iterdir()}
    assert files.keys() == {"comparison.csv", "table1.csv", "figure1.csv", "figure1.svg", "figure1.png"}
    assert files == {path.name: path.read_bytes() for path in (tmp_path / "second").iterdir()}
    rows = list(csv.DictReader(files["comparison.csv"].decode().splitlines()))
    assert [(row["quantity"], row["printed"], row["holds"]) for row in rows] == [
        ("length", "1.1", "yes"),
        ("mass & more", "", "NO"),
    ]


def test_the_report_is_one_page_that_needs_no_other_and_states_everything() -> None:
    text = page([(STUDY, made(GOOD, BAD))])
    for word in ("One &amp; only", "Someone, 2000", "mass &amp; more", "A remark.", "as in (1)", "b [m]"):
        assert word in text
    assert text.count("data:image/svg+xml;base64,") == 1
    assert '<td class="wrong">NO</td>' in text
    assert "http" not in text.replace("http-equiv", "")


def test_a_study_is_chosen_by_its_name_and_a_wrong_one_is_answered_with_those_that_there_are() -> None:
    other = Study("other", "", "", "")
    assert chosen((STUDY, other), "other") == (other,)
    assert chosen((STUDY, other), "all") == (STUDY, other)
    with pytest.raises(LookupError, match="there is no study 'three'; there are one, other, and 'all'"):
        chosen((STUDY, other), "three")


def test_a_number_out_of_its_bound_ends_the_command_with_status_1(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("validation.studies.shelf.studies", lambda: (STUDY,))
    monkeypatch.setattr(Study, "made", lambda _, **__: made(GOOD, BAD))
    ended = CliRunner().invoke(program, ["study", "one", "--quick", "--out", str(tmp_path)])
    assert ended.exit_code == 1
    assert "out of bounds: one: mass & more" in ended.stderr
    assert (tmp_path / "studies.html").exists()
    assert (tmp_path / "one" / "comparison.csv").exists()


def test_the_independent_ways_find_what_is_known() -> None:
    import numpy as np  # noqa: PLC0415 - beside what it tests

    assert root(lambda x: x * x - 2.0, 0.0, 2.0) == pytest.approx(2.0**0.5, abs=1e-12)
    assert root(lambda x: 2.0 - x * x, 0.0, 2.0) == pytest.approx(2.0**0.5, abs=1e-12)
    with pytest.raises(ValueError, match="no change of sign"):
        root(lambda x: x * x + 1.0, 0.0, 2.0)
    swing = integrate(lambda _, y: np.array([y[1], -y[0]]), np.array([1.0, 0.0]), np.linspace(0.0, 1.0, 101))
    assert swing[-1] == pytest.approx([np.cos(1.0), -np.sin(1.0)], abs=1e-9)


def test_without_a_checkout_one_line_states_where_studies_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "emulators.cli.study", raising=False)
    installed = metadata.entry_points
    absent = "firmware_bridge.study"
    monkeypatch.setattr(
        metadata, "entry_points", lambda *, group: () if group == absent else installed(group=group)
    )
    ended = CliRunner().invoke(program, ["study", "tipping", "--quick"])
    assert ended.exit_code == 2
    assert "studies come with a checkout" in ended.output
    assert "Traceback" not in ended.output
