"""The clients in `examples/arduino`, as they are, at the pty of an emulated board."""

import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest

from hil_tests.lanes import HUNG_S
from hil_tests.scenarios.test_board_on_a_pty import emulated

CLIENTS: Final = Path(__file__).parents[2] / "examples" / "arduino"


@pytest.mark.timeout(120)
@pytest.mark.long(beside="test_a_client_drives_a_wheel_and_reads_its_encoder")
@pytest.mark.parametrize(
    ("client", "board", "words"),
    [
        ("in_ros_manner.py", ("ros-arduino-bridge", "--encoders", "3"), ("15", "3")),
        ("turn_by_firmata.py", ("firmata", "--encoders", "2"), ("300",)),
    ],
)
def test_it_turns_what_it_states(
    client: str, board: tuple[str, ...], words: tuple[str, ...], tmp_path: Path
) -> None:
    link = tmp_path / "board.tty"
    with emulated(link, "--firmware", *board):
        script = [sys.executable, str(CLIENTS / client), str(link), *words]
        done = subprocess.run(script, capture_output=True, text=True, timeout=HUNG_S, check=False)
    assert done.returncode == 0, done.stderr
    counts = [int(word) for word in done.stdout.splitlines()[-1].split()]
    assert min(counts) >= 200, done.stdout


def test_without_a_port_it_states_how_it_is_used() -> None:
    for client in CLIENTS.glob("*.py"):
        done = subprocess.run([sys.executable, client], capture_output=True, text=True, check=False)
        assert done.returncode == 1
        assert f"Usage: python {client.name} PORT" in done.stderr
