"""`new --kind omni`: one command writes the file, the next one drives it; what makes no base is refused."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from typer.testing import CliRunner

from emulators.testing.rig import VirtualRig
from firmware_bridge.cli import program
from firmware_bridge.robot_types import find

SIZES = ("--wheel-radius", "0.05", "--wheel-distance", "0.16")
SMALL = ("--wheel-radius", "0.024", "--wheel-distance", "0.09", "--speed", "0.2", "--turn-rate", "2")
SWING = 0.13
"""Of the loop about a constant speed, as a share of the limit; MWProtocol's cycle is the slowest."""


def new(folder: Path, *words: str) -> tuple[int, str, Path]:
    """Run the command in a folder; return its status, what it has printed, and the file."""
    done = CliRunner().invoke(program, ["new", "tray", "--kind", "omni", "--dir", str(folder), *words])
    return done.exit_code, done.output, folder / "tray.toml"


@pytest.mark.parametrize(
    "words",
    [
        SIZES,
        (*SIZES, "--protocol", "mw"),
        (*SIZES, "--protocol", "arduinoio"),
        (*SIZES, "--motor", "RE40", "--gear", "14", "--encoder-lines", "100", "--mass", "12"),
        (*SIZES, "--gear", "30", "--encoder-lines", "3", "--mass", "3", "--speed", "0.6"),
        (*SMALL, "--mass", "1.5"),
    ],
    ids=["kit", "mw", "arduinoio", "heavy motor", "coarse encoder", "small"],
)
def test_what_is_written_drives_at_once_and_stops(tmp_path: Path, words: Sequence[str]) -> None:
    status, printed, file = new(tmp_path, *words)
    assert status == 0, printed
    assert f"next: firmware-bridge bench {file}" in printed
    robot = find(str(file), plant_too=True)
    limit = robot.geometry.limits.speed_mps
    rig = VirtualRig(robot)
    rig.bench.runs(4.0)
    assert rig.operator.armed
    rig.operator.does("drives", speed_mps=0.7 * limit, turn_deg_s=10.0)
    rig.bench.runs(3.0)
    rolling = rig.bench.samples.column("speed_mps")
    assert abs(rolling[-1] / limit - 0.7) < SWING
    rig.operator.stops()
    rig.bench.runs(2.0)
    assert abs(rig.bench.samples[-1]["speed_mps"]) < 0.02 * limit
    assert max(map(abs, rig.bench.samples.column("speed_mps"))) < (0.7 + SWING) * limit
    assert rig.bench.guard.refused == 0
    rig.bench.finish()


@pytest.mark.parametrize(
    ("words", "stated"),
    [
        ((), "--wheel-radius: a robot of the kind omni needs it"),
        (("--wheel-radius", "0.05"), "--wheel-distance: a robot of the kind omni needs it"),
        ((*SIZES, "--track", "0.3"), "--track: a robot of the kind omni takes no such option"),
        ((*SIZES, "--nodes", "1"), "--nodes: a robot of the kind omni takes no such option"),
        ((*SIZES, "--voltage", "24"), "--voltage 24: the shield's motor supply is 4.5 to 13.5 V"),
        ((*SIZES, "--speed", "0.7"), "go at 14; 12 V gear motor of 17 W behind 64 gives 11.8"),
        ((*SIZES, "--turn-rate", "3"), "--turn-rate 3: on the spot 0.48 m/s at a rim, --speed allows 0.4"),
        ((*SIZES, "--encoder-lines", "500"), "--encoder-lines 500: at full speed 9389 counts in a frame"),
        ((*SIZES, "--encoder-lines", "0"), "--encoder-lines must be 1 to 2500000, not 0"),
        (
            (*SIZES, "--protocol", "firmata"),
            "--protocol: no 'firmata'; there are: mw, ros-arduino-bridge, ard",
        ),
        ((*SIZES, "--motor", "118889"), "(118889) has three phases; a shield drives brushed"),
        ((*SIZES, "--mass", "0"), "--mass must be positive, not 0"),
    ],
)
def test_what_is_no_base_is_refused_and_writes_nothing(
    tmp_path: Path, words: Sequence[str], stated: str
) -> None:
    status, printed, file = new(tmp_path, *words)
    assert status == 2
    assert stated in printed
    assert not file.exists()
