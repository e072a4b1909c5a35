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


def asked(monkeypatch: pytest.MonkeyPatch, facts: Facts, *words: str) -> Any:
    monkeypatch.setattr("emulators.doctor.gather.gather", lambda: facts)
    return CliRunner().invoke(program, ["doctor", *words], env={"COLUMNS": "300"})


def test_a_machine_that_has_everything(monkeypatch: pytest.MonkeyPatch) -> None:
    told = asked(monkeypatch, WELL)
    assert told.exit_code == 0, told.output
    assert told.stdout.endswith("nothing that is needed is missing\n")
    for row in ROWS:
        assert row.title in told.stdout
        assert row.judge(WELL).found in told.stdout


@pytest.mark.parametrize("words", [(), ("--json",)])
def test_what_is_needed_and_missing_is_exit_status_1(
    monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    poor = replace(WELL, compiler=None, plants={"rars": None}, socketcan=False)
    told = asked(monkeypatch, poor, *words)
    assert told.exit_code == 1
    if not words:
        assert told.stdout.endswith("needed, and missing: C compiler\n")
        assert "apt-get install gcc" in told.stdout
        return
    said = json.loads(told.stdout)
    assert said["missing"] == ["C compiler"]
    assert [one["looked_at"] for one in said["rows"]] == [row.title for row in ROWS]
    for one, row in zip(said["rows"], ROWS, strict=True):
        judged = row.judge(poor)
        assert (one["found"], one["verdict"]) == (judged.found, judged.verdict.value)
        assert (one["remedy"], one["needed"]) == (judged.remedy, row.needed)


def test_what_is_missing_and_not_needed_is_no_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    told = asked(monkeypatch, replace(WELL, interfaces=(), ports=(), vcan=False, socketcan=False))
    assert (told.exit_code, "missing" in told.stdout) == (0, True)
