"""`emulate WORD`: a family, a robot, or a message that lists both."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from firmware_bridge.cli import program


def refused(*words: str) -> str:
    """Return the message of a command that is refused."""
    ran = CliRunner().invoke(program, ["emulate", *words])
    assert ran.exit_code == 2
    return " ".join(ran.stderr.split())


def test_a_word_that_is_neither_lists_families_and_robots() -> None:
    message = refused("nosuch", "-i", "socketcan")
    assert "emulate nosuch: no such family or robot" in message
    assert "the families ar2, board, canopen, capture, cia402, epos2" in message
    assert "rars, rome" in message


@pytest.mark.parametrize("word", ["nosuch.toml", "rars+nosuch"])
def test_a_file_and_a_robot_with_more_have_the_messages_of_robots(word: str) -> None:
    message = refused(word)
    assert "no such family" not in message
    assert word.partition("+")[0] in message


def test_a_folder_of_that_name_may_be_a_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine").mkdir()
    monkeypatch.chdir(tmp_path)
    assert "pip install -e mine" in refused("mine")


@pytest.mark.parametrize("word", ["cia402", "epos2", "rars", "robot"])
def test_families_and_robots_are_found(word: str) -> None:
    assert CliRunner().invoke(program, ["emulate", word, "--help"]).exit_code == 0
