"""ROME's base over its emulated board: four firmwares drive it."""

import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.path_error import Followed, path_error
from emulators.rig import BRIDGE
from firmware_bridge.packet import Packet
from hil_tests.scenarios.rome_ride import FULL, STANDSTILL_MPS, driven, speed


@pytest.mark.long(keeps=["ros-arduino-bridge"])
@pytest.mark.parametrize("protocol", FULL)
def test_each_firmware_drives_the_circle_and_the_guard_has_nothing_to_refuse(protocol: str) -> None:
    with driven(protocol, 'path_follower = "circle"', 12.0, encoders=FULL[protocol]) as rig:
        rig.runs(9.5)
        assert rig.guard.refused == 0, rig.guard.refusals
        path = bench_setup_of(rig.robot).paths["circle"](rig.robot)
        error = path_error(rig.samples, [Followed(4.5, path)], 2.5)
        assert error.same_instant is not None
        assert error.same_instant < (0.02 if FULL[protocol] == 3 else 0.08)
        assert speed(rig) == pytest.approx(0.25, abs=0.04)
        rig.world.stop(BRIDGE)
        rig.runs(4.0)
        assert rig.bridge.finished
        assert rig.bridge.not_acknowledged == ()
        assert not any(axis.powered for axis in rig.devices.axes)
        assert speed(rig) < STANDSTILL_MPS


def test_who_takes_control_is_reported_what_the_start_has_shown_of_the_boards_reset() -> None:
    stated: list[bytes] = []

    def note(_now: int, sender: str, packet: Packet) -> None:
        if sender == BRIDGE:
            stated.append(packet.payload)

    with driven("mw", "speed_mps = 0.1", 5.0, encoders=3) as rig:
        rig.operator_wire.observe(note)
        rig.runs(3.9)
        at_start = b"".join(stated).count(b"the line's reset works")
        rig.runs(0.5)
    assert at_start == 1
    assert b"the line's reset works" in b"".join(stated).partition(b" drives")[2]
