"""Real drives in a test's hands: requests to them, and actions that never happen to them.

The drives of the long test are emulated ones that the plugin takes for real.
"""

import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from unittest import SkipTest

import pytest

from emulators.testing.buses import Bus
from emulators.testing.errors import RigError
from emulators.testing.plugin import PROGRAM
from emulators.testing.process import Process
from emulators.testing.real import LOOKS, RealDrives
from hil_tests.testing.conftest import Imported

pytest_plugins = ["pytester"]

BUS = Bus("socketcan", "can0")
PLACE = ("-i", "socketcan", "-c", "can0")
LINE = "v2:/dev/ttyUSB0"

STORIES = f"""
    import pytest

    STATE = [*{PROGRAM!r}, "epos2", "state"]

    def test_reads(drives, under_test):
        state = under_test([*STATE, "--serial", drives("1-2")])
        assert state.ends(within=60) == 0
        assert "switch on disabled" in state.printed

    @pytest.mark.destructive
    def test_moves(drives, under_test):
        state = under_test([*STATE, "enable", "--yes", "--serial", drives("1-2"), "--node", "2"])
        assert state.ends(within=60) == 0

    @pytest.mark.destructive
    def test_of_power(drives):
        drives("1")
        drives.lose_power("1")

    def test_of_load(drives):
        drives("1", "--load", "2e-5,0.001")

    def test_on_a_bus(drives, bus):
        drives("1", on=bus())

    def test_plant(plant):
        pass
"""


class Program:
    """Stand-in for `firmware-bridge`: it notes its words, and answers as drives do."""

    def __init__(self, folder: Path) -> None:
        self.commands: list[tuple[str, ...]] = []
        self.rpm = 0
        self.not_receiving: tuple[str, ...] = ()
        self._folder = folder

    def __call__(self, words: Sequence[str]) -> Process:
        self.commands.append(tuple(words))
        status = int(words[1:3] == self.not_receiving or words[1:5] == self.not_receiving)
        answer = json.dumps({"objects": [{"value": self.rpm}]})
        states = f"print({answer!r}); raise SystemExit({status})"
        return Process([sys.executable, "-S", "-c", states], self._folder / f"{len(self.commands)}.txt")


@pytest.fixture
def program(tmp_path: Path) -> Program:
    return Program(tmp_path)


def test_who_only_reads_leaves_nothing_written(program: Program) -> None:
    real = RealDrives(program, LINE, moved=False)
    assert real("1-2", on=BUS) == "can0"
    assert real("3") == "/dev/ttyUSB0"
    real.finish()
    line = ("--serial", "/dev/ttyUSB0", "--protocol", "v2")
    assert program.commands == [
        ("epos2", "state", "--node", "1", *PLACE),
        ("epos2", "state", "--node", "2", *PLACE),
        ("epos2", "state", "--node", "3", *line),
    ]


def test_who_moves_them_leaves_them_at_rest_and_all_are_stopped_before_one_loses_its_power(
    program: Program,
) -> None:
    real = RealDrives(program, None, moved=True)
    real("1-2", on=BUS)
    program.commands.clear()
    real.finish()
    assert [words[1:5] for words in program.commands] == [
        ("state", "quick-stop", "--node", "1"),
        ("state", "quick-stop", "--node", "2"),
        ("read", "0x2028", "--json", "--node"),
        ("state", "disable", "--node", "1"),
        ("read", "0x2028", "--json", "--node"),
        ("state", "disable", "--node", "2"),
    ]


def test_one_that_goes_on_turning_keeps_its_power_and_one_that_is_silent_holds_up_no_one(
    program: Program,
) -> None:
    real = RealDrives(program, None, moved=True)
    real("1-2", on=BUS)
    program.commands.clear()
    program.rpm, program.not_receiving = -6, ("state", "quick-stop", "--node", "1")
    with pytest.raises(AssertionError, match="ended with 1"):
        real.finish()
    assert ("state", "quick-stop", "--node", "2") in [words[1:5] for words in program.commands]
    assert sum(words[1] == "read" for words in program.commands) == 2 * LOOKS
    assert not any("disable" in words for words in program.commands)


def test_what_no_one_can_do_to_them_is_left_out(program: Program) -> None:
    real = RealDrives(program, None, moved=True)
    for wrong, commands in (
        (lambda: real("1", "--load", "2e-5,0.001"), "take no --load"),
        (lambda: real("1"), "needs a line to real drives"),
        (lambda: real.lose_power("1"), "no one here can disable the power"),
    ):
        with pytest.raises(SkipTest, match=commands):
            wrong()
    with pytest.raises(RigError, match="--serial-line /dev/ttyUSB0: give PROTOCOL:DEVICE"):
        RealDrives(program, "/dev/ttyUSB0", moved=True)
    assert program.commands == []


@pytest.fixture
def line(tmp_path: Path) -> Iterator[str]:
    port = tmp_path / "real.tty"
    words = ("emulate", "epos2", "--node", "1-2", "--serial", "pty", "--serial-link", str(port))
    process = Process((*PROGRAM, *words), tmp_path / "emulated.txt")
    process.prints("Ctrl-C ends it", within=60)
    yield f"v1:{port}"
    process.stop()


@pytest.mark.long(beside="test_who_only_reads_leaves_nothing_written")
def test_the_same_tests_on_real_drives(pytester: pytest.Pytester, imported: Imported, line: str) -> None:
    pytester.makepyfile(STORIES)
    words = (
        "-p",
        "emulators.testing.plugin",
        "-p",
        "no:cacheprovider",
        "--late-after=0",
        "-rs",
        "--robot",
        "rome",
        "--rig=hardware",
        "--serial-line",
        line,
    )
    careful = pytester.runpytest_inprocess(*words, plugins=[imported])
    careful.assert_outcomes(passed=1, skipped=5)
    careful.stdout.fnmatch_lines(
        [
            "firmware-bridge: real drives on v1:*; what is marked destructive is left out",
            "*it moves what is real: use --yes-move-it",
            "*take no --load",
            "*needs the bus of real drives*",
        ]
    )
    bold = pytester.runpytest_inprocess(*words, "--yes-move-it", plugins=[imported])
    bold.assert_outcomes(passed=2, skipped=4)
    bold.stdout.fnmatch_lines("*no one here can disable the power*")
    again = pytester.runpytest_inprocess(*words, "-k", "reads", plugins=[imported])
    again.assert_outcomes(passed=1)
