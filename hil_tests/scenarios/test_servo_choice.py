"""One mission with the kernel in C and with its twin in Python: the same frames, to bit and nanosecond."""

import pytest

from emulators.servo import kernel
from hil_tests.scenarios.ride import ARMED, ride, step


def trace(servo: str, monkeypatch: pytest.MonkeyPatch) -> tuple[str, bool]:
    monkeypatch.setenv(kernel.VARIABLE, servo)
    short = ride(ARMED, step(3.4, speed_mps=0.3), step(4.2, steer_deg=20.0), seconds=6.0)
    short.runs_until(6.0)
    assert short.fastest() > 0.1
    short.rig.finish()
    return short.rig.world.trace_sha256, short.rig.devices.servo_bank.native


@pytest.mark.long(beside="test_whatever_is_ordered_both_obey_alike")
@pytest.mark.skipif(kernel.find().library is None, reason="the kernel is not built here")
def test_kernel_and_twin_drive_the_robot_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    native, twin = trace("native", monkeypatch), trace("twin", monkeypatch)
    assert (native[1], twin[1]) == (True, False)
    assert native[0] == twin[0]
