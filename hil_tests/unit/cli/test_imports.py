"""Third-party libraries that a command imports, and the reason; and the time until a stop is sent."""

import json
import os
import re
import select
import subprocess
import sys
import tty
from importlib.metadata import entry_points, packages_distributions, requires
from pathlib import Path
from typing import Final

import pytest

from hil_tests.lanes import HUNG_S

OWN: Final = {"firmware_bridge", "emulators", "fmu"}
TYPER: Final = {"typer", "annotated_doc", "shellingham"}
"""Packages that read the command line."""
OPTIONS: Final = {
    *TYPER,
    "pydantic",
    "pydantic_core",
    "annotated_types",
    "typing_extensions",
    "typing_inspection",
}
"""Typer checks values with pydantic, and the robot file is read with it."""
HELP: Final = {*OPTIONS, "rich", "attr", "markdown_it", "mdurl", "pygments"}
"""Typer prints help with rich, which highlights with pygments and reads markdown with markdown-it."""
LINE: Final = {*OPTIONS, "serial"}
"""A drive may be on a serial line: pyserial."""
BRIDGE: Final = {*LINE, "pymavlink", "fastcrc"}
"""The operator speaks MAVLink."""
KINDS: Final = {row.module.partition(".")[0] for row in entry_points(group="firmware_bridge.robots")}
"""Packages of all installed robots."""
MATRICES: Final = {"numpy"}
"""The arm's kind reckons with matrices; who drives another robot does not load it."""

IMPORTED: Final[dict[str, set[str]]] = {
    "--version": TYPER,
    "--help": HELP,
    "robots": {*OPTIONS, "rich", *KINDS, *MATRICES},
    "drive --help": HELP,
    "pilot --help": HELP,
    "monitor --help": HELP,
    "monitor -i socketcan -c nosuchcan0": {*BRIDGE, "rich"},  # the dissector reads MAVLink, too
    "pilot rars --joystick --mavlink udpin:127.0.0.1:0 --device /dev/input/none": BRIDGE,
    "bench --help": HELP,
    "study --help": {*HELP, "validation"},
    "doctor --help": HELP,
    "emulate --help": HELP,
    "emulate rars --help": HELP,
    "emulate epos2 --help": HELP,
    "emulate cia402 --help": HELP,
    "emulate ar2 --help": HELP,
    "emulate board --help": HELP,
    "emulate board --firmware mw --serial /dev/nowhere": {*LINE, "numpy"},  # faults of the control port draw
    "fmu --help": HELP,
    "fmu build --help": HELP,
    "epos2 --help": HELP,
    "epos2 nmt --help": {*HELP, *LINE},
    "epos2 eds": {*LINE, "rich"},
    "epos2 nmt start -i socketcan -c nosuchcan0": LINE,
    "epos2 state quick-stop -i socketcan -c nosuchcan0": LINE,
    "epos2 state quick-stop --serial /dev/null": LINE,
    "epos2 read statusword --serial /dev/null": {*LINE, "rich"},
    "epos2 scan -i socketcan -c nosuchcan0": LINE,
    "drive rars -i socketcan -c nosuchcan0": BRIDGE,
}
"""Everything else, above all Matplotlib, NumPy, SymPy, FMPy and python-can, is loaded on request only."""

INSTALLED: Final = packages_distributions().keys()
LISTING: Final = """
import json, sys
from firmware_bridge.cli import program
try:
    program(sys.argv[1:])
finally:
    print(json.dumps(sorted(sys.modules)), file=sys.stderr)
"""
TYPER_IN_S: Final = 0.08
"""Processor time that `import typer` takes on the machine on which the next figure was measured."""
STOP_WITHIN_S: Final = 0.4


def imported(words: str) -> set[str]:
    """Return the top-level names of other people's modules that a command has imported at its end."""
    ended = subprocess.run(
        [sys.executable, "-c", LISTING, *words.split()], capture_output=True, text=True, check=False
    )
    modules = json.loads(ended.stderr.splitlines()[-1])
    names = {module.partition(".")[0] for module in modules} - OWN - set(sys.stdlib_module_names)
    return {name for name in names & INSTALLED if not name.startswith("_")}


@pytest.mark.long(keeps=["--help", "drive rars -i socketcan -c nosuchcan0"])
@pytest.mark.parametrize("words", IMPORTED)
def test_a_command_imports_no_more_than_it_needs(words: str) -> None:
    found = imported(words)
    assert found <= IMPORTED[words], f"{words} imports, too: {found - IMPORTED[words]}"
    assert "typer" in found


def test_each_library_that_the_program_needs_is_known_to_the_table_or_left_for_who_requests_it() -> None:
    rows = requires("firmware-bridge") or ()
    needed = {re.split(r"[^\w-]", row)[0] for row in rows if "extra ==" not in row}
    owners = packages_distributions()
    light = {owner for names in IMPORTED.values() for name in names for owner in owners.get(name, ())}
    assert needed - light == {"fmpy", "python-can"}


def test_what_is_installed_is_not_looked_through_before_a_stop() -> None:
    code = LISTING.replace("import json", "import importlib.metadata as all, json").replace(
        "try:", "all.entry_points = None\ntry:", 1
    )
    words = ["epos2", "state", "quick-stop", "--serial", "/dev/null"]
    ended = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=False)
    assert "cannot open serial port /dev/null" in ended.stderr


def test_a_quick_stop_is_on_the_wire_soon_after_enter() -> None:
    """In processor time, by that of a known import, so that a busy or slow machine does not count."""
    known = min(processor_time_of_typer() for _ in range(3))
    needed = min(processor_time_before_the_first_byte() for _ in range(3))
    assert needed / known < STOP_WITHIN_S / TYPER_IN_S, f"{needed:.3f} s, and typer alone {known:.3f} s"


def processor_time_of_typer() -> float:
    code = "import time, typer; print(time.process_time())"
    return float(subprocess.check_output([sys.executable, "-c", code]))


def processor_time_before_the_first_byte() -> float:
    """Return the seconds that a quick stop has taken when its first byte is on a serial line."""
    near, far = os.openpty()
    tty.setraw(far)
    words = ["epos2", "state", "quick-stop", "--serial", os.ttyname(far)]
    code = "from firmware_bridge.cli import main; main()"
    process = subprocess.Popen([sys.executable, "-c", code, *words], stderr=subprocess.PIPE, text=True)
    try:
        ready, _, _ = select.select([near], [], [], 600)
        fields = Path(f"/proc/{process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        assert ready, process.communicate(timeout=HUNG_S)
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    finally:
        process.kill()
        process.communicate()
        os.close(near)
        os.close(far)
