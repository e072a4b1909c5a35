"""The control port of drives on a bus of this machine: faults, and their instants in the recording."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

import pytest

from emulators.bench.faults import kinds
from emulators.bench.faults.failures import failures_of
from emulators.testing.buses import buses
from emulators.testing.plugin import PROGRAM
from emulators.testing.process import Process
from firmware_bridge.recording import parse_candump
from firmware_bridge.robot_types import find
from firmware_bridge.testing.control import ControlError, of_process
from firmware_bridge.units import SECOND
from hil_tests.lanes import HUNG_S

pytest_plugins = ["emulators.testing.plugin"]

STRAY: Final = 0x123
EVENT: Final = re.compile(r"fault (\w+) begins at (\d+\.\d+) s")


def events(folder: Path) -> list[tuple[str, float]]:
    """Return each fault of the recording and the instant of the devices' clock at which it began, in s."""
    (run,) = folder.iterdir()
    text = (run / "events.log").read_text(encoding="utf-8")
    return [(kind, float(at)) for kind, at in EVENT.findall(text)]


def frames(folder: Path) -> list[tuple[float, int, bytes]]:
    """Return instant in s, identifier and data of each frame of the recording."""
    (run,) = folder.iterdir()
    read = [parse_candump(line) for line in (run / "can.log").read_text(encoding="ascii").splitlines()]
    return [(at / SECOND, packet.address, packet.payload) for at, _, packet in read]


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param("loopback_multicast", marks=pytest.mark.alone),
        pytest.param("vcan", marks=pytest.mark.vcan),
    ],
)
def test_every_fault_on_the_bus_stands_in_the_recording_with_its_instant(
    under_test: Callable[[Sequence[str]], Process], tmp_path: Path, kind: str
) -> None:
    bus = buses(kind)[0]
    folder = tmp_path / "recorded"
    program = under_test((*PROGRAM, "emulate", "rars", *bus.words, "--record", str(folder)))
    program.prints("Ctrl-C ends it", HUNG_S)
    begun = []
    with of_process(program.pid) as control:
        for failure in failures_of(find("rars")):
            fault = kinds()[failure.kind].fault.model_validate({"at_s": 0.0, **failure.keys})
            if fault.real_bus_problem(find("rars")):
                with pytest.raises(ControlError, match="not on a real bus"):
                    control.inject(failure.kind, **failure.keys)
                continue
            control.inject(failure.kind, **failure.keys)
            begun.append(failure.kind)
            control.clear()
        for number in range(2):
            control.inject("stray_frames", identifier=STRAY + number, data="01", every_ms=10_000)
            control.clear()
        control.shutdown()
    assert program.ends(HUNG_S) == 0, program.printed
    noted = events(folder)
    assert [kind for kind, _ in noted] == [*begun, "stray_frames", "stray_frames"]
    (one,), (two,) = ([at for at, address, _ in frames(folder) if address == STRAY + it] for it in range(2))
    assert two - one == pytest.approx(noted[-1][1] - noted[-2][1], abs=0.001)
    assert len(begun) > 20
