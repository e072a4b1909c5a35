"""On any terminal: one that knows only ASCII, a pipe that no one reads, a shell that completes words."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest
from typer.testing import CliRunner

from emulators.cli import beginning
from firmware_bridge.cli import program
from fmu.errors import PlantError

PROGRAM: Final = [sys.executable, "-c", "from firmware_bridge.cli import main; main()"]
WITHOUT_PICTURES: Final = [
    sys.executable,
    "-c",
    """
import sys, types
from firmware_bridge.cli import main
sys.modules["emulators.bench.plots"] = types.SimpleNamespace(draw=lambda *_, **__: [])
main()
""",
]
"""They are not for the terminal, and Matplotlib takes more time than the run."""
MISSION: Final = 'title = "look"\nduration_s = 0.3\n\n[[step]]\nat_s = 0.1\ntitle = "arm"\narm = true\n'
ASCII: Final = {
    "by Python's own variable": {"PYTHONIOENCODING": "ascii"},
    "by the locale": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
}


def environment(**more: str) -> dict[str, str]:
    return {**os.environ, "COLUMNS": "150", **more}


@pytest.mark.long(keeps=["by the locale"])
@pytest.mark.parametrize("how", ASCII)
def test_a_terminal_that_knows_only_ascii_is_reported_a_run_in_ascii(how: str, tmp_path: Path) -> None:
    mission = tmp_path / "look.toml"
    mission.write_text(MISSION, encoding="utf-8")
    words = ["bench", "rars", "--mission", str(mission), "--out", str(tmp_path / "out")]
    ended = subprocess.run(
        [*WITHOUT_PICTURES, *words], capture_output=True, check=False, env=environment(**ASCII[how])
    )
    assert ended.returncode == 0, ended.stderr
    assert b" m/s2 " in ended.stdout
    assert ended.stdout.isascii()


@pytest.mark.long(keeps=["by the locale"])
@pytest.mark.parametrize("how", ASCII)
def test_a_terminal_that_knows_only_ascii_is_reported_a_mistake_in_ascii(how: str) -> None:
    ended = subprocess.run(
        [*PROGRAM, "robots", "größe²Ω.toml"], capture_output=True, check=False, env=environment(**ASCII[how])
    )
    assert ended.returncode == 2
    assert ended.stderr.isascii()
    assert re.search(rb"gr.+\.toml: cannot be read", ended.stderr), ended.stderr


@pytest.mark.long(keeps=["drive rars -i virtual -c no one --mavlink udpin:127.0.0.1:0"])
@pytest.mark.parametrize(
    "words",
    [
        ("--help",),
        ("--version",),
        ("robots",),
        ("epos2", "eds"),
        ("epos2", "objects"),
        ("drive", "rars", "-i", "virtual", "-c", "no one", "--mavlink", "udpin:127.0.0.1:0"),
        ("emulate", "epos2", "-i", "virtual", "-c", "no one"),
    ],
    ids=" ".join,
)
def test_a_pipe_that_no_one_reads_ends_a_command_quietly(words: tuple[str, ...]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        ended = subprocess.run(
            [*PROGRAM, *words], stdout=writer, stderr=subprocess.PIPE, text=True, check=False, timeout=600
        )
    finally:
        os.close(writer)
    assert ended.stderr == ""
    assert ended.returncode in {0, 1}


def test_a_bridge_that_no_one_reads_any_more_stops_in_good_order() -> None:
    words = ["drive", "rars", "-i", "virtual", "-c", "no one", "--mavlink", "udpin:127.0.0.1:0"]
    code = (
        "from firmware_bridge.bridge import Bridge\n"
        "from firmware_bridge.cli import main\n"
        "import sys\n"
        "stop = Bridge.stop\n"
        "def ordered(self, now):\n"
        "    sys.stderr.write('ordered to stop\\n')\n"
        "    return stop(self, now)\n"
        "Bridge.stop = ordered\n"
        "main()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert "bridge on no one" in process.stdout.readline()
        process.stdout.close()
        assert process.stderr is not None
        reported = process.stderr.read()
    assert reported.startswith("ordered to stop\n")
    # A busy machine gets round to it only after the bridge has begun with its drives, which confirm nothing.
    begun = "not confirmed to be without power" in reported
    assert begun or reported == "ordered to stop\n"
    assert process.returncode == (3 if begun else 1)


def complete(words: str) -> list[str]:
    """Return what bash is offered for the last of these words."""
    typed = words.split(" ")
    requested = environment(
        _FIRMWARE_BRIDGE_COMPLETE="complete_bash", COMP_WORDS=words, COMP_CWORD=str(len(typed) - 1)
    )
    code = "import sys; sys.argv[0] = 'firmware-bridge'; from firmware_bridge.cli import main; main()"
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=requested
    )
    assert ended.stderr == ""
    return ended.stdout.split()


@pytest.mark.long(keeps=["firmware-bridge bench rars --mission l-offered6"])
@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("firmware-bridge dr", {"drive"}),
        ("firmware-bridge e", {"emulate", "epos2"}),
        ("firmware-bridge epos2 ", {"read", "write", "state", "version", "nmt", "eds", "dcf"}),
        ("firmware-bridge drive r", {"rars"}),
        ("firmware-bridge bench ", {"rars"}),
        ("firmware-bridge bench rars --mission ", {"circles", "interlocks", "line"}),
        ("firmware-bridge bench rars --mission l", {"line"}),
        ("firmware-bridge fmu build c", {"climber"}),
        ("firmware-bridge epos2 state qu", {"quick-stop"}),
        ("firmware-bridge drive rars --mav", {"--mavlink"}),
    ],
)
def test_a_shell_completes_commands_robots_missions_and_options(words: str, offered: set[str]) -> None:
    found = set(complete(words))
    assert offered <= found
    typed = words.rpartition(" ")[2]
    assert all(word.startswith(typed) for word in found)


def test_completion_is_installed_for_bash(tmp_path: Path) -> None:
    home = environment(HOME=str(tmp_path), _TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION="1")
    code = "import sys; sys.argv[0] = 'firmware-bridge'; from firmware_bridge.cli import main; main()"
    command = [sys.executable, "-c", code, "--install-completion", "bash"]
    ended = subprocess.run(command, capture_output=True, text=True, check=True, env=home)
    assert "bash completion installed" in ended.stdout
    (script,) = [path for path in tmp_path.rglob("*") if path.is_file() and path.name != ".bashrc"]
    assert str(script) in (tmp_path / ".bashrc").read_text(encoding="utf-8")
    known = subprocess.run(
        ["bash", "--norc", "-c", f"source {script} && complete -p firmware-bridge"],  # noqa: S607 - the user's own
        capture_output=True,
        text=True,
        check=True,
    )
    assert known.stdout.endswith("firmware-bridge\n")


def test_to_build_a_plant_is_stated_before_it_takes_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    reported: list[str] = []

    def building(model: str) -> None:
        reported.append(f"builds {model}")
        raise PlantError("no compiler")

    monkeypatch.setattr(beginning, "is_built", lambda _model: False)
    monkeypatch.setattr(beginning, "ensure", building)
    result = CliRunner().invoke(program, ["bench", "rars", "--mission", "line"])
    assert reported == ["builds rars"]
    assert result.stderr.splitlines() == [
        "building the plant 'rars' (once, about 10 s)",
        "firmware-bridge: no compiler",
    ]


def test_a_plant_that_is_built_is_not_spoken_of(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(beginning, "is_built", lambda _model: True)
    taken = tmp_path / "taken"
    taken.write_text("a file, no folder", encoding="utf-8")
    result = CliRunner().invoke(program, ["bench", "rars", "--mission", "line", "--out", str(taken)])
    assert "building" not in result.stderr
