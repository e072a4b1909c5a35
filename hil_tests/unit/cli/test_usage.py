"""Mistakes on the command line: one line each, in the form of all other messages, with where help is."""

import pytest
from typer.testing import CliRunner

from firmware_bridge.cli import program
from firmware_bridge.cli.usage import text_of


@pytest.mark.parametrize(
    ("message", "shown"),
    [
        (
            "No such option: --bit-rat (Possible options: --bitrate, --state)",
            "no such option: --bit-rat; perhaps --bitrate, --state",
        ),
        ("Missing argument 'ROBOT'.", "missing argument 'ROBOT'"),
        (
            "Invalid value for '--seed' / '-s': Input should be\n a valid integer",
            "--seed / -s: input should be a valid integer",
        ),
        ("Invalid value: Too much.", "too much"),
    ],
)
def test_a_mistake_is_one_line_with_its_command(message: str, shown: str) -> None:
    assert text_of(message, "epos2 scan") == (
        f"firmware-bridge: epos2 scan: {shown}; see 'firmware-bridge epos2 scan -h'"
    )
    assert text_of(message, "") == f"firmware-bridge: {shown}; see 'firmware-bridge -h'"


@pytest.mark.parametrize(
    "words",
    [
        ("drive", "rars", "--operator", "x"),
        ("drive",),
        ("bench", "rars", "--seed", "x"),
        ("bench", "rars", "--mission"),
        ("drive", "rars", "--duration", "-3"),
        ("epos2", "scan", "--frob"),
        ("nonsense",),
    ],
)
def test_the_program_ends_with_2_and_one_line(words: tuple[str, ...]) -> None:
    found = CliRunner().invoke(program, words, prog_name="firmware-bridge", env={"COLUMNS": "60"})
    assert found.exit_code == 2
    (line,) = found.stderr.splitlines()
    assert line.startswith("firmware-bridge: ")
    assert line.endswith(" -h'")
    assert found.stdout == ""


def test_an_option_without_its_value_is_named_with_its_command() -> None:
    found = CliRunner().invoke(program, ["bench", "rars", "--mission"])
    (line,) = found.stderr.splitlines()
    assert line == (
        "firmware-bridge: bench: option '--mission' requires an argument; see 'firmware-bridge bench -h'"
    )


def test_a_group_alone_shows_its_help() -> None:
    found = CliRunner().invoke(program, ["epos2"], prog_name="firmware-bridge")
    assert found.exit_code == 2
    assert "Usage: firmware-bridge epos2" in found.output
