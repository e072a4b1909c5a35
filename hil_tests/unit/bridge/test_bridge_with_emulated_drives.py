"""The bridge with the emulated drives and the plant below: two halves written apart agree."""

from typing import TYPE_CHECKING

import pytest

from firmware_bridge.drivers.driver import Power
from hil_tests.unit.bridge.bench import ACCEPTED, TEMPORARILY_REJECTED

if TYPE_CHECKING:
    from emulators.family import Devices
    from hil_tests.unit.bridge.bench import Bench


def powers(bench: "Bench") -> set[Power]:
    return {axis.power for axis in bench.bridge.seen.facts.axes.values()}


def test_start_up_takes_less_than_a_second(emulated: "tuple[Bench, Devices]") -> None:
    bench, _ = emulated
    bench.runs(1)
    assert powers(bench) == {Power.ON}
    assert bench.bridge.failure is None


def test_the_plant_drives_as_the_operator_commands_and_odometry_knows(
    emulated: "tuple[Bench, Devices]",
) -> None:
    bench, below = emulated
    bench.starts()
    bench.stands()
    assert bench.arms() == ACCEPTED
    bench.speed, bench.steer = 0.3, 30.0
    bench.runs(3)
    assert below.plant.read("speed") == pytest.approx(0.3, abs=0.003)
    # The turn of 30 degrees has a radius of 0.997 m (2.13).
    assert below.plant.read("yaw_rate") == pytest.approx(0.3 / 0.997, rel=0.02)
    bench.speed = 0.0
    bench.runs(1)
    pose = bench.bridge.seen.pose
    assert pose.x_m == pytest.approx(below.plant.read("x"), abs=0.005)
    assert pose.y_m == pytest.approx(below.plant.read("y"), abs=0.005)


def test_without_the_bridge_the_drives_stop_by_themselves_and_are_enabled_again(
    emulated: "tuple[Bench, Devices]",
) -> None:
    bench, below = emulated
    bench.starts()
    bench.stands()
    bench.arms()
    bench.speed = 0.4
    bench.runs(1.5)
    bench.world.silence("bridge", bench.now)
    bench.runs(0.6)
    assert below.plant.read("speed") == pytest.approx(0.0, abs=0.01)
    bench.world.silence("bridge", 2**62 - 1)
    bench.speed = 0.0
    bench.runs(0.5)
    assert bench.arms() == TEMPORARILY_REJECTED
    bench.runs(1)
    assert bench.arms() == ACCEPTED


def test_an_orderly_end_leaves_drives_without_power_and_without_fault(
    emulated: "tuple[Bench, Devices]",
) -> None:
    bench, below = emulated
    bench.starts()
    bench.stands()
    bench.arms()
    bench.speed = 0.4
    bench.runs(1.5)
    begin = bench.now
    bench.stops()
    bench.runs(3.5)
    assert bench.bridge.finished
    assert below.plant.read("speed") == pytest.approx(0.0, abs=0.01)
    emergencies = [p for now, _, p in bench.frames if now > begin and 0x081 <= p.address <= 0x0FF]
    assert emergencies == []
    last = {p.address: p.payload[:1].hex() for _, _, p in bench.frames if p.address in range(0x701, 0x705)}
    assert last == dict.fromkeys(range(0x701, 0x705), "7f")
