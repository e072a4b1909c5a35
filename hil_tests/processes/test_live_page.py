"""The live page of programs: a bench is broken, put back and ended; a robot is shown and stopped."""

import json
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

from emulators.testing.plugin import PROGRAM
from emulators.testing.process import Process
from hil_tests.lanes import HUNG_S

pytest_plugins = ["emulators.testing.plugin"]


def answer(page: ClientConnection, do: str, **keys: Any) -> dict[str, Any]:
    """Send a request; return its answer, whatever else comes meanwhile."""
    page.send(json.dumps({"id": 1, "do": do, **keys}))
    while True:
        message: dict[str, Any] = json.loads(page.recv(timeout=HUNG_S))
        if message.get("id") == 1:
            return message


def test_a_page_shows_the_bench_breaks_it_goes_back_and_ends_it(
    under_test: Callable[[Sequence[str]], Process], tmp_path: Path
) -> None:
    words = ("bench", "rome", "--mission", "line", "--realtime", "--live", "--out", str(tmp_path))
    program = under_test((*PROGRAM, *words))
    with connect(opened(program), open_timeout=HUNG_S) as page:
        assert json.loads(page.recv(timeout=HUNG_S))["title"] == "rome, line"
        assert answer(page, "step", seconds=2.0)["at_s"] >= 2.0
        assert answer(page, "inject", fault="shaft_blocked", keys={"node": "one"})["ok"]
        assert answer(page, "rewind", to_s=1.0)["at_s"] == 1.0
        assert answer(page, "shutdown")["ok"]
    program.prints("results:", HUNG_S)
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert (summary["simulated_s"], summary["faults"]) == (1.0, [])
    # A recording in which time steps back would mislead.
    lines = (tmp_path / "serial.log").read_text(encoding="ascii").splitlines()
    instants = [float(line[1 : line.index(")")]) for line in lines]
    assert instants == sorted(instants)
    assert len(instants) > 10


def test_a_robot_is_shown_and_its_page_ends_the_bridge_in_good_order(
    under_test: Callable[[Sequence[str]], Process], tmp_path: Path
) -> None:
    line = str(tmp_path / "line")
    board = under_test((*PROGRAM, "emulate", "rome", "--serial", "pty", "--serial-link", line))
    board.prints("Ctrl-C ends it", HUNG_S)
    words = ("drive", "rome", "--serial", line, "--live", "--state", str(tmp_path / "state.json"))
    bridge = under_test((*PROGRAM, *words, "--mavlink", "udpin:127.0.0.1:0"))
    with connect(opened(bridge), open_timeout=HUNG_S) as page:
        first = json.loads(page.recv(timeout=HUNG_S))
        assert (first["mode"], first["can"]) == ("robot", ["stop", "emergency_stop"])
        assert not answer(page, "arm", on=True)["ok"]
        assert answer(page, "emergency_stop")["ok"]
        bridge.prints("emergency stop", HUNG_S)
        assert answer(page, "stop")["ok"]
    bridge.prints("ended: SIGINT", HUNG_S)
    assert bridge.ends(HUNG_S) == 0


def opened(program: Process) -> str:
    """Return the address of a program's page."""
    program.prints("Ctrl-C ends it", HUNG_S)
    address = re.search(r"live page: http://(\S+)", program.printed)
    assert address is not None
    return f"ws://{address[1]}ws"


def test_an_emulated_board_is_shown_broken_and_ended(
    under_test: Callable[[Sequence[str]], Process],
) -> None:
    words = ("emulate", "board", "--firmware", "mw", "--serial", "pty", "--control", "none", "--live")
    program = under_test((*PROGRAM, *words, "--fault", "current_limit"))
    with connect(opened(program), open_timeout=HUNG_S) as page:
        first = json.loads(page.recv(timeout=HUNG_S))
        assert (first["mode"], len(first["axes"])) == ("devices", 4)
        assert answer(page, "inject", fault="shaft_blocked", keys={"node": "M1"})["ok"]
        assert not answer(page, "inject", fault="bus_off", keys={})["ok"]
        assert answer(page, "shutdown")["ok"]
    assert program.ends(HUNG_S) == 0
    assert "fault current_limit begins at 0.000000 s" in program.printed
    assert "fault shaft_blocked begins at" in program.printed


def test_a_pilot_is_shown_and_ended_by_its_page(
    under_test: Callable[[Sequence[str]], Process], tmp_path: Path
) -> None:
    path = tmp_path / "path.csv"
    path.write_text("0,0\n1,0\n2,0\n", encoding="ascii")
    words = ("pilot", "rars", "--path", str(path), "--mavlink", "udpin:127.0.0.1:0", "--live")
    program = under_test((*PROGRAM, *words))
    with connect(opened(program), open_timeout=HUNG_S) as page:
        first = json.loads(page.recv(timeout=HUNG_S))
        assert (first["mode"], first["can"]) == ("station", ["stop", "emergency_stop"])
        assert not answer(page, "drive", x=1.0)["ok"]
        assert answer(page, "stop")["ok"]
    assert program.ends(HUNG_S) == 0
