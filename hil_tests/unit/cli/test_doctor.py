"""`doctor` on the command line: the same rows for people and for programs, and its exit status."""

import json
from dataclasses import replace
from typing import Any

import pytest
from typer.testing import CliRunner

from emulators.doctor.facts import Facts
from emulators.doctor.rows import ROWS
from firmware_bridge.cli import program
from hil_tests.unit.doctor.test_rows import WELL


def requested(monkeypatch: pytest.MonkeyPatch, facts: Facts, *words: str) -> Any:
    monkeypatch.setattr("emulators.doctor.gather.gather", lambda: facts)
    return CliRunner().invoke(program, ["doctor", *words], env={"COLUMNS": "300"})


def test_a_machine_that_has_everything(monkeypatch: pytest.MonkeyPatch) -> None:
    reported = requested(monkeypatch, WELL)
    assert reported.exit_code == 0, reported.output
    assert reported.stdout.endswith("nothing that is needed is missing\n")
    for row in ROWS:
        assert row.title in reported.stdout
        assert row.judge(WELL).found in reported.stdout


@pytest.mark.parametrize("words", [(), ("--json",)])
def test_what_is_needed_and_missing_is_exit_status_1(
    monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    poor = replace(WELL, compiler=None, plants={"rars": None}, socketcan=False)
    reported = requested(monkeypatch, poor, *words)
    assert reported.exit_code == 1
    if not words:
        assert reported.stdout.endswith("needed, and missing: C compiler\n")
        assert "apt-get install gcc" in reported.stdout
        return
    stated = json.loads(reported.stdout)
    assert stated["missing"] == ["C compiler"]
    assert [one["looked_at"] for one in stated["rows"]] == [row.title for row in ROWS]
    for one, row in zip(stated["rows"], ROWS, strict=True):
        judged = row.judge(poor)
        assert (one["found"], one["verdict"]) == (judged.found, judged.verdict.value)
        assert (one["remedy"], one["needed"]) == (judged.remedy, row.needed)


def test_what_is_missing_and_not_needed_is_no_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    reported = requested(monkeypatch, replace(WELL, interfaces=(), ports=(), vcan=False, socketcan=False))
    assert (reported.exit_code, "missing" in reported.stdout) == (0, True)
