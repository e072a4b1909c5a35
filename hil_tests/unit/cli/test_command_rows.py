"""Commands are rows: each leads to a command, has that command's help, and takes no other's place."""

import re
from collections.abc import Iterable
from importlib.metadata import EntryPoint
from typing import Any, Final

import pytest
import typer
from typer.testing import CliRunner

from emulators.arduino_omni.commands import COMMANDS as OF_BOARDS
from emulators.cia402.commands import COMMANDS as OF_EMULATED_SERVOS
from emulators.cli.commands import COMMANDS as OF_THE_SIMULATION
from emulators.epos2.commands import COMMANDS as OF_EMULATED_DRIVES
from emulators.imu.commands import COMMANDS as OF_IMUS
from emulators.motion_capture.commands import COMMANDS as OF_CAMERAS
from emulators.robots.commands import COMMANDS as OF_NEW_ROBOTS
from firmware_bridge.cli import commands, program
from firmware_bridge.cli.commands import CliCommand, Group, Row
from firmware_bridge.cli.program import COMMANDS as OWN
from firmware_bridge.families.epos2.commands import COMMANDS as OF_DRIVES

OF_FAMILIES: Final = (
    *OF_DRIVES,
    *OF_EMULATED_DRIVES,
    *OF_EMULATED_SERVOS,
    *OF_NEW_ROBOTS,
    *OF_BOARDS,
    *OF_CAMERAS,
    *OF_IMUS,
)
ROWS: Final = (*OWN, *OF_FAMILIES, *OF_THE_SIMULATION)
EVERY: Final = {row.words: row for row in ROWS if isinstance(row, CliCommand)}
PLAIN: Final = {"COLUMNS": "200", "TERM": "dumb", "NO_COLOR": "1"}


class ForeignNode:
    """An entry point of a package that is not there."""

    dist = None

    def __init__(self, name: str, rows: Iterable[Row] | Exception) -> None:
        self.name = name
        self._rows = rows

    def load(self) -> Iterable[Row]:
        if isinstance(self._rows, Exception):
            raise self._rows
        return self._rows


def with_foreign(monkeypatch: pytest.MonkeyPatch, *new_stations: ForeignNode) -> None:
    def entry_points(group: str) -> list[EntryPoint | ForeignNode]:
        assert group == commands.COMMAND_GROUP
        return list(new_stations)

    monkeypatch.setattr("importlib.metadata.entry_points", entry_points)


def run(*words: str) -> Any:
    return CliRunner().invoke(program, list(words), env=PLAIN)


@pytest.mark.parametrize("words", EVERY)
def test_a_row_states_how_the_help_of_its_command_begins(words: str) -> None:
    help_text = " ".join((EVERY[words].load().help or "").split())
    assert help_text.startswith(EVERY[words].line.removesuffix("."))


def test_every_command_is_reached_by_its_words() -> None:
    for words in EVERY:
        result = run(*words.split(), "--help")
        assert result.exit_code == 0, result.output
        assert f"firmware-bridge {words.partition(' ')[0]}" in result.output
        assert "<bool>" not in result.output, f"{words}: a flag takes no value"
        head, _, options = result.output.partition("Options")
        assert "Example" in head, f"{words}: examples come first"
        assert "Example" not in options
        assert re.search(r"\bstatus\s+[012]\b", result.output), f"{words} does not say how it ends"


def test_a_package_that_cannot_be_imported_is_named_and_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    with_foreign(monkeypatch, ForeignNode("broken", ImportError("no module named 'gone'")))
    result = run("--help")
    assert result.exit_code == 0
    assert "the commands of 'broken' are left out: no module named 'gone'" in result.stderr
    assert " drive " in result.stdout


def test_no_one_takes_the_place_of_a_command_that_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    row = CliCommand("epos2 state", "somewhere:state", "Something else.")
    with_foreign(monkeypatch, ForeignNode("greedy", [row]))
    result = run("epos2", "--help")
    assert "'epos2 state' is left out: there is one of this name" in result.stderr
    assert "Show a drive's power state" in result.stdout


def test_a_command_of_a_group_that_is_not_there_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    with_foreign(monkeypatch, ForeignNode("lost", [CliCommand("nowhere at-all", "somewhere:it", "It.")]))
    assert "there is no group 'nowhere'" in run("--help").stderr


def test_a_package_adds_a_group_with_commands(monkeypatch: pytest.MonkeyPatch) -> None:
    group, thing = (
        Group("own", "A group.", "No example"),
        CliCommand("own thing", "somewhere:it", "It does it."),
    )
    with_foreign(monkeypatch, ForeignNode("own", (group, thing)))
    assert "It does it." in run("own", "--help").stdout


def test_a_command_that_cannot_be_imported_states_so_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    with_foreign(monkeypatch, ForeignNode("half", [CliCommand("half", "no_such_package.half:it", "It.")]))
    result = run("half")
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert line.startswith(
        "firmware-bridge: this command cannot be loaded: No module named 'no_such_package'"
    )


def test_a_wrong_word_is_answered_with_one_like_it() -> None:
    result = run("benhc")
    assert result.exit_code == 2
    assert "bench" in result.stderr


def test_what_a_row_names_must_be_a_command() -> None:
    with pytest.raises(TypeError, match="no command"):
        CliCommand("run", "firmware_bridge.cli.console:refusal", "It.").load()


def test_typer_is_requested_a_group() -> None:
    group = typer.main.get_group(program)
    assert {words.partition(" ")[0] for words in EVERY} == set(group.list_commands(typer.Context(group)))
