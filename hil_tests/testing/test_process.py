"""A program of the user's against emulated drives on a serial line, in real time, as a test starts it."""

import os
import select
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from emulators.testing.plugin import PROGRAM
from emulators.testing.process import Process
from hil_tests.lanes import HUNG_S
from hil_tests.testing.conftest import Imported

pytest_plugins = ["pytester"]

WORDS = ("-p", "emulators.testing.plugin", "-p", "no:cacheprovider", "--late-after=0")
HANGS = "print('here', flush=True); __import__('threading').Event().wait()"

MASTER = f"""
    def test_a_master(drives, under_test):
        port = drives("1-2")
        words = ("epos2", "read", "statusword", "--node", "2", "--serial", port)
        master = under_test([*{PROGRAM!r}, *words])
        assert master.ends(within=60) == 0, master.printed
        assert "switch on disabled" in master.printed

    def test_one_that_hangs(under_test):
        master = under_test([{sys.executable!r}, "-c", {HANGS!r}])
        master.prints("here", within=60)
        master.ends(within=0.1)
"""


Starts = Callable[[str], Process]


@pytest.fixture
def python(tmp_path: Path) -> Iterator[Starts]:
    started: list[Process] = []

    def start(program: str) -> Process:
        started.append(Process([sys.executable, "-c", program], tmp_path / "out.txt"))
        return started[-1]

    yield start
    for one in started:
        one.stop()


def test_one_that_ends_too_soon_states_what_it_printed(python: Starts) -> None:
    one = python("print('no bus'); raise SystemExit(3)")
    with pytest.raises(AssertionError, match=r"ended with 3, not 'ready' printed; it printed:\nno bus"):
        one.prints("ready", within=60)
    assert one.ends() == 3


def test_one_that_hangs_is_ended(python: Starts) -> None:
    one = python(HANGS)
    one.prints("here", within=60)
    with pytest.raises(AssertionError, match=r"still runs after 0.1 s; it printed:\nhere"):
        one.ends(within=0.1)
    one.stop()
    assert one.status is not None


@pytest.mark.long(beside="test_one_that_ends_too_soon_states_what_it_printed")
def test_drives_on_a_line_and_a_master_of_ones_own(pytester: pytest.Pytester, imported: Imported) -> None:
    pytester.makepyfile(MASTER)
    result = pytester.runpytest_inprocess(*WORDS, plugins=[imported])
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["*still runs after 0.1 s; it printed:*", "exit status: None", "here"])


@pytest.mark.long(
    beside="test_a_board_is_left_alone_in_its_boot_loader_and_then_requested_until_it_has_stated_all"
)
@pytest.mark.parametrize(
    "board",
    ['"mw"', '"arduinoio"', '"firmata", "--encoders", "2"', '"ar2"', '"rome", protocol="firmata"'],
)
@pytest.mark.usefixtures("home")
def test_every_board_comes_and_answers(pytester: pytest.Pytester, imported: Imported, board: str) -> None:
    pytester.makepyfile(
        f"""
        import os

        def test_it(board):
            assert os.path.islink(board({board}))
        """
    )
    result = pytester.runpytest_inprocess(*WORDS, plugins=[imported])
    result.assert_outcomes(passed=1)


ORPHAN = """
import os, sys, time
from pathlib import Path
from emulators.testing.process import Process
child = Process([sys.executable, "-c", "import threading; threading.Event().wait()"], Path(sys.argv[1]))
print(child._process.pid, flush=True)
os.kill(os.getpid(), 9)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux informs a process that its parent is gone")
def test_a_test_session_that_is_killed_leaves_no_program_behind(tmp_path: Path) -> None:
    killed = subprocess.run(
        [sys.executable, "-c", ORPHAN, str(tmp_path / "child.txt")],
        capture_output=True,
        text=True,
        check=False,
        timeout=HUNG_S,
    )
    assert killed.returncode == -signal.SIGKILL, killed.stderr
    try:
        ended = os.pidfd_open(int(killed.stdout))
    except ProcessLookupError:
        return  # it is gone already
    assert select.select([ended], [], [], HUNG_S)[0], "it lives on"
    os.close(ended)
