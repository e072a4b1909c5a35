"""`bench --realtime` as a program: a fault and its end over the control port, and results after Ctrl-C."""

import json
import os
import signal
from collections.abc import Callable, Sequence
from pathlib import Path

from emulators.testing.plugin import PROGRAM
from emulators.testing.process import Process
from firmware_bridge.testing.control import of_process
from hil_tests.lanes import HUNG_S

pytest_plugins = ["emulators.testing.plugin"]


def test_it_takes_faults_and_leaves_its_results_when_it_is_interrupted(
    under_test: Callable[[Sequence[str]], Process], tmp_path: Path
) -> None:
    words = ("bench", "rome", "--mission", "line", "--realtime", "--out", str(tmp_path / "results"))
    program = under_test((*PROGRAM, *words))
    program.prints("rome, line in real time", HUNG_S)
    with of_process(program.pid) as control:
        number = control.inject("shaft_blocked", node="one")
        program.prints("fault shaft_blocked begins at", HUNG_S)
        # Only here bits of a frame, and the bridge's own program, are in reach.
        control.inject("bridge_suspended", for_s=0.2)
        assert control.state()["emulates"] == "rome"
        control.clear(number)
        program.prints("fault shaft_blocked cleared at", HUNG_S)
    os.kill(program.pid, signal.SIGINT)
    program.prints("results:", HUNG_S)
    summary = json.loads((tmp_path / "results" / "summary.json").read_text(encoding="utf-8"))
    assert [one["kind"] for one in summary["faults"]] == ["shaft_blocked", "bridge_suspended"]
    assert 0 < summary["simulated_s"] < 60
    assert (tmp_path / "results" / "report.html").exists()
