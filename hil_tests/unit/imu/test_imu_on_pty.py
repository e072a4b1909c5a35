"""An emulated IMU on a pseudo-terminal, read by the bridge's end of its line; which robots have it there."""

from collections.abc import Iterator

import pytest

from emulators.cli.emulate_robot import RobotOptions, start
from emulators.devices import devices
from emulators.family import Devices
from emulators.imu.commands.imu import ImuOptions
from emulators.imu.commands.imu import start as alone
from emulators.imu.family import FAMILY
from firmware_bridge.robot_types import find, parse, robot_type_named
from firmware_bridge.runtime.ports import SerialLine
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.imu.imu_bench import LINK, Line


@pytest.fixture
def below() -> Iterator[Devices]:
    found = devices(find("rars+imu"))
    yield found
    found.plant.close()


def test_beside_drives_it_is_on_a_pseudo_terminal_that_the_bridge_reads(below: Devices) -> None:
    assert FAMILY.beside is not None
    beside = FAMILY.beside(find("rars+imu"), below)
    assert set(beside.members) == set(beside.openers) == {LINK}
    (place,) = beside.where
    path = place.removeprefix("serial line ").removesuffix(" (imu)")
    port, host, line = beside.openers[LINK](), SerialLine(path, 115_200), Line()
    try:
        for now in range(0, 1_000 * MILLISECOND, 10 * MILLISECOND):
            below.physics.advance(now)
            for packet in beside.members[LINK].wake(now).sent:
                port.write(0, packet.payload, now)
            for _, data in host.read(now):
                line.link.receive(type(packet)(LINK, 0, data), now)
        assert (line.link.refused, line.link.missing) == (0, 0)
        assert abs(line.degrees("pitch")) < 2.0
    finally:
        host.close()
        port.close()


def test_beside_boards_it_is_on_a_line_as_they_are() -> None:
    imu = robot_type_named("rars").more["imu"].read_text(encoding="utf-8")
    rome = parse(robot_type_named("rome").file.read_text(encoding="utf-8") + imu, "rome_imu.toml")
    below = devices(rome)
    try:
        assert set(below.stations) == {"board", LINK}
        assert FAMILY.beside is not None
        assert FAMILY.beside(rome, below).members == {}
    finally:
        below.plant.close()


def test_a_sensor_alone_stands_as_its_options_have_it() -> None:
    emulation, line = alone(ImuOptions(pitch=10.0, roll=-20.0, seed=1)), Line()
    for step in range(120):
        now = step * 10 * MILLISECOND
        for packet in emulation.node.wake(now).sent:
            line.link.receive(type(packet)(LINK, 0, packet.payload), now)
    assert line.degrees("pitch") == pytest.approx(10.0, abs=0.6)
    assert line.degrees("roll") == pytest.approx(-20.0, abs=0.6)
    openers, where = emulation.opened()
    assert emulation.text(where).endswith("pitch 10, roll -20 deg")
    openers["serial"]().close()


def test_emulate_opens_it() -> None:
    emulation = start(RobotOptions(robot="rars+imu"))
    assert "serial line /dev/pts/" in emulation.opened()[1]
