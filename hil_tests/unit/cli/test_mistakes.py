"""Each mistake at the command line is answered with one message: the fault, its place, and a remedy."""

import socket
from collections.abc import Iterator
from pathlib import Path
from zipfile import ZipFile

import pytest
from typer.testing import CliRunner

from firmware_bridge.cli import program
from firmware_bridge.robot_types import robot_type_named
from fmu.build import ensure


def refused(*words: str) -> str:
    """Run the program, which must refuse with exit status 2 and one line; return that line."""
    result = CliRunner().invoke(program, list(words))
    assert isinstance(result.exception, SystemExit), result.exception
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert line.startswith("firmware-bridge: ")
    assert "Traceback" not in result.output
    return line


@pytest.fixture
def port_in_use() -> Iterator[str]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        yield f"udpin:127.0.0.1:{taken.getsockname()[1]}"


def test_an_unknown_mission_is_answered_with_those_that_there_are() -> None:
    line = refused("bench", "rars", "--mission", "moonwalk")
    for mission in ("circles", "interlocks", "line"):
        assert mission in line


def test_a_serial_line_that_is_too_slow_for_the_cycle_is_refused_with_what_would_do(tmp_path: Path) -> None:
    line = refused("bench", "rars", "--serial", "v1", "--out", str(tmp_path))
    assert "a cycle of 50 ms does not hold statusword of node 4 (scissor lift)" in line
    assert "cycle_ms = 136 or more" in line


def test_a_mission_file_that_is_not_there_is_named() -> None:
    assert "nowhere.toml" in refused("bench", "rars", "--mission", "nowhere.toml")


def test_a_results_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.write_text("a file, no folder")
    line = refused("bench", "rars", "--mission", "line", "--out", str(taken))
    assert f"{taken}: cannot be written" in line
    assert "--out" in line


def test_a_page_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    line = refused("epos2", "eds", "--out", str(tmp_path / "nowhere" / "epos2.eds"))
    assert f"{tmp_path}/nowhere/epos2.eds: cannot be written: No such file" in line
    assert "--out" in line


@pytest.mark.parametrize("command", ["bench", "emulate"])
def test_a_plant_that_is_not_there_is_named(command: str, tmp_path: Path) -> None:
    assert "nowhere.fmu" in refused(command, "rars", "--plant", "nowhere.fmu", *out_of(command, tmp_path))


@pytest.mark.parametrize("command", ["bench", "emulate"])
def test_a_plant_that_is_no_fmu_is_named(command: str, tmp_path: Path) -> None:
    strange = tmp_path / "strange.fmu"
    strange.write_text("not an archive")
    assert str(strange) in refused(command, "rars", "--plant", str(strange), *out_of(command, tmp_path))


@pytest.mark.parametrize("command", ["bench", "emulate"])
def test_a_plant_that_lacks_a_variable_is_refused_by_its_name(command: str, tmp_path: Path) -> None:
    lacking = tmp_path / "lacking.fmu"
    with ZipFile(ensure("rars")) as whole, ZipFile(lacking, "w") as partial:
        for name in whole.namelist():
            content = whole.read(name)
            if name == "modelDescription.xml":
                assert b'"voltage_steer"' in content
                content = content.replace(b'"voltage_steer"', b'"voltage_strange"')
            partial.writestr(name, content)
    line = refused(command, "rars", "--plant", str(lacking), *out_of(command, tmp_path))
    assert str(lacking) in line
    assert "voltage_steer" in line


@pytest.mark.parametrize("command", ["drive", "emulate"])
def test_a_bus_that_is_not_there_is_named(command: str) -> None:
    assert "nosuchcan0" in refused(command, "rars", "-i", "socketcan", "-c", "nosuchcan0")


@pytest.mark.parametrize("command", ["drive", "emulate"])
def test_an_unknown_interface_is_answered_with_those_that_there_are(command: str) -> None:
    line = refused(command, "rars", "-i", "smoke", "-c", "0")
    assert "smoke" in line
    assert "socketcan" in line


def test_a_port_in_use_is_named(port_in_use: str) -> None:
    line = refused("drive", "rars", "-i", "virtual", "-c", "mistakes", "--mavlink", port_in_use)
    assert port_in_use in line
    assert "in use" in line


def test_a_robot_is_not_driven_from_beyond_the_machine_without_a_key() -> None:
    where = "udpin:0.0.0.0:14550"
    line = refused("drive", "rars", "-i", "virtual", "-c", "mistakes", "--mavlink", where)
    assert where in line
    assert "--key FILE" in line


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        ("pilot rars", "--joystick, --keyboard, or --path NAME"),
        ("pilot rars --joystick --path line", "--joystick, --keyboard, or --path NAME"),
        ("pilot rars --path lime", "there is no path 'lime'; perhaps 'line'?"),
        ("pilot rars --joystick --controls gampad", "perhaps 'gamepad'?"),
        ("pilot rars --joystick --mavlink udpin:127.0.0.1:0 --device /dev/input/none", "`ls /dev/input/js*`"),
        ("pilot rars --path line --max-delay 3", "50 to 2000 ms may be"),
        ("pilot rars --path line --view predikted", "no such view; perhaps 'predicted'?"),
        ("pilot rars --path line --view-to x.png", "with --view video and --view predicted only"),
        ("pilot rars --path line --view video --view-to x.jpg", "a name that ends in .png"),
    ],
)
def test_a_pilot_without_what_it_needs_is_reported_what(words: str, reported: str) -> None:
    assert reported in refused(*words.split())


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        ("bench rars --link dealy=0.5", "'dealy=0.5': there is no key 'dealy'; perhaps 'delay'?"),
        ("bench rars --link delay=0.5 --max-delay 3", "a delay of 3 s was requested; 50 to 2000 ms may be"),
        ("bench rars --mission line --predictor", "no one follows a path, who could predict?"),
        ("drive rars -i virtual -c mistakes --link up.lose=0.1", "there is no key 'lose'; perhaps 'loss'?"),
        ("drive rars --link drive=can:can0", "rars has no link 'drive'; perhaps 'drives'?"),
        ("drive rars --link drives=can0 --link delay=1", "give NAME=INTERFACE:CHANNEL"),
        ("drive rars -i virtual -c mistakes --max-delay 2.5", "operator.max_age_ceiling_ms"),
    ],
)
def test_a_slow_link_that_makes_no_sense_is_refused_with_what_was_meant(words: str, reported: str) -> None:
    assert reported in refused(*words.split())


@pytest.mark.parametrize(
    ("pilot", "step", "reported"),
    [
        ('path = "cirkle"', "arm = true", "pilot.path: there is no path 'cirkle'; perhaps 'circle'?"),
        ('path = "nowhere.csv"', "arm = true", "nowhere.csv: cannot be read"),
        ('path = "line"', "speed_mps = 0.1", "step[0].speed_mps: a pilot drives"),
        ('path = "line"\nspeed = 1', "arm = true", "pilot.speed: no such key; perhaps 'speed_mps'?"),
    ],
)
def test_a_pilot_that_makes_no_sense_is_refused(pilot: str, step: str, reported: str, tmp_path: Path) -> None:
    file = tmp_path / "my.toml"
    head = f'title = "t"\nduration_s = 1.0\n[pilot]\n{pilot}\n'
    file.write_text(f'{head}[[step]]\nat_s = 0.0\ntitle = "s"\n{step}\n', encoding="utf-8")
    assert reported in refused("bench", "rars", "--mission", str(file), "--out", str(tmp_path / "out"))


def test_an_operator_link_that_makes_no_sense_shows_one_that_does() -> None:
    line = refused("drive", "rars", "-i", "virtual", "-c", "mistakes", "--mavlink", "tcp:14550")
    assert "udpin:127.0.0.1:14550" in line


@pytest.mark.parametrize("cut", ["9@1", "3", "3@", "3@soon", "3@-1", "@1", "3@nan"])
def test_a_cut_that_makes_no_sense_shows_one_that_does(cut: str) -> None:
    line = refused("emulate", "rars", "-i", "virtual", "-c", "mistakes", "--silence", cut)
    assert f"--silence {cut}" in line
    assert "NODE@SECONDS" in line or "3 (steer)" in line


def out_of(command: str, folder: Path) -> list[str]:
    return ["--out", str(folder / "out")] if command == "bench" else ["-i", "virtual", "-c", "mistakes"]


def test_an_arms_firmware_that_there_is_not_is_answered_with_those_that_there_are() -> None:
    assert "--firmware 1.0: there is none; there are: 2.0, 1.5" in refused(
        "emulate", "ar2", "--firmware", "1.0"
    )
    line = refused("emulate", "ar2", "--serial", "/dev/nowhere", "--reset-on-open")
    assert "only --serial pty needs it" in line


def test_a_robot_of_two_boards_wants_a_line_for_each() -> None:
    line = refused("emulate", "rome_arm", "--serial", "/dev/null")
    assert line.endswith("--serial /dev/null: rome_arm has several lines; use --serial pty")
    line = refused("drive", "rome_arm", "--serial", "/dev/null")
    assert "rome_arm has several links (board, arm); use --link NAME=PLACE for each" in line


@pytest.mark.parametrize("protocol", ["mw", "arduinoio"])
@pytest.mark.parametrize("place", ["/dev/null", "pty"])
def test_a_board_without_a_watchdog_is_not_driven_unless_that_is_accepted(protocol: str, place: str) -> None:
    """A pseudo-terminal is no exception: what is tried there is what is done on the robot."""
    words = ("drive", "rome", "--protocol", protocol, "--encoders", "3", "--serial", place)
    line = refused(*words)
    assert f"link 'board': a board with {protocol} has no watchdog" in line
    assert "emulators/arduino_omni/sketch" in line
    assert "--accept-no-watchdog (accept_no_watchdog = true in [links.board])" in line


def test_a_robot_file_may_accept_a_board_without_a_watchdog(tmp_path: Path) -> None:
    text = Path(robot_type_named("rome").file).read_text(encoding="utf-8")
    text = text.replace('protocol = "ros-arduino-bridge"', 'protocol = "arduinoio"\nencoders = 3')
    file = tmp_path / "mine.toml"
    file.write_text(text, encoding="utf-8")
    words = ("drive", str(file), "--serial", "/dev/nowhere", "--mavlink", "udpin:127.0.0.1:0")
    assert "has no watchdog" in refused(*words)
    file.write_text(text.replace("encoders = 3", "encoders = 3\naccept_no_watchdog = true"), encoding="utf-8")
    assert "/dev/nowhere" in refused(*words)
