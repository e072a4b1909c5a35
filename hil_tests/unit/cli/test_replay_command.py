"""The command `replay` at the command line: its output, and its exit statuses."""

import lzma
from pathlib import Path

import pytest
from typer.testing import CliRunner

from firmware_bridge.cli import program

RECORDING = Path(__file__).parents[2] / "recordings" / "rars" / "canopen-master.log.xz"


def replayed(*words: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(program, ["replay", *words])
    return result.exit_code, result.stdout, result.stderr


@pytest.fixture
def changed(tmp_path: Path) -> Path:
    """The recording with another last byte: the statusword of the first drive."""
    content = lzma.decompress(RECORDING.read_bytes()).rstrip(b"\n")
    file = tmp_path / "changed.log"
    file.write_bytes(content[:-1] + (b"1" if content[-1:] == b"0" else b"0") + b"\n")
    return file


def test_no_difference_is_status_0() -> None:
    status, stated, error = replayed(str(RECORDING), "rars")
    assert (status, error) == (0, "")
    assert stated.startswith(
        "no difference: 119 packets of the drives are as recorded, 123 others were played"
    )


def test_a_difference_is_status_1_and_both_frames(changed: Path) -> None:
    status, stated, error = replayed(str(changed), "rars")
    assert (status, error) == (1, "")
    lines = stated.splitlines()
    assert lines[0] == "changed.log, line 242 is the first that differs"
    assert "  TPDO 1, node 1: 0x6041 Statusword = 0x" in lines[-2]
    assert lines[-2].startswith("expected")
    assert lines[-1].startswith("but came")


@pytest.mark.parametrize("words", [("--without", "pdo"), ("--until", "0.5")])
def test_what_is_left_out_is_no_difference(changed: Path, words: tuple[str, str]) -> None:
    status, stated, _ = replayed(str(changed), "rars", *words)
    assert (status, stated[:13]) == (0, "no difference")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("--without", "emcy"),
            "--without emcy: no such service; there are: nmt, sync, emergency, time, sdo",
        ),
        (("--until", "0"), "canopen-master.log.xz: holds no frame of a drive of rars"),
        (("--until", "inf"), "cannot convert float infinity to integer"),
        (("--plant", "nothing.fmu"), "nothing.fmu"),
        (("--channel", "can7"), "canopen-master.log.xz: holds no frame of 'can7', but of can0"),
    ],
)
def test_a_mistake_is_one_line_and_status_2(words: tuple[str, str], message: str) -> None:
    status, stated, error = replayed(str(RECORDING), "rars", *words)
    assert (status, stated) == (2, "")
    assert message in error
    assert error.count("\n") == 1
