"""A robot file that names a serial link: what it may say, and what is refused with file and key."""

import pytest

from firmware_bridge.robot import Link, Robot, RobotFileError, find, parse, shipped
from firmware_bridge.wire.maxon.frame import Generation

TEXT = next(path for path in shipped() if path.stem == "rars").read_text(encoding="utf-8")
ON_LINE = 'link = "serial"\ngateway = 1\n'


def rars(added: str) -> Robot:
    """RARS with more lines under [bus]."""
    return parse(TEXT.replace("[bus]\n", f"[bus]\n{added}", 1), "my.toml")


def test_a_serial_link_is_named_with_its_gateway() -> None:
    bus = rars(ON_LINE).bus
    assert (bus.link, bus.gateway, bus.protocol, bus.line_rate) == (Link.SERIAL, 1, Generation.V2, 1_000_000)


def test_everything_of_the_line_can_be_said() -> None:
    bus = rars(f'{ON_LINE}protocol = "v1"\nbaud = 57_600\nport_latency_us = 0\n').bus
    assert (bus.protocol, bus.line_rate, bus.port_latency_us) == (Generation.V1, 57_600, 0)


def test_without_a_word_of_it_the_link_is_can() -> None:
    assert find("rars").bus.link is Link.CAN


@pytest.mark.parametrize(
    ("added", "key", "problem"),
    [
        ('link = "serial"\n', "bus", "link = 'serial' needs gateway"),
        ('link = "lpt"\n', "bus.link", "'lpt'"),
        ('link = "serial"\ngateway = 9\n', "", "bus.gateway 9 is not the node of an axis"),
        ('link = "serial"\ngateway = 0\n', "bus.gateway", "but it is 0"),
        (f'{ON_LINE}protocol = "v3"\n', "bus.protocol", "'v3'"),
        (f"{ON_LINE}baud = 300\n", "bus.baud", "but it is 300"),
        (f"{ON_LINE}port_latency_us = -1\n", "bus.port_latency_us", "but it is -1"),
        (f"{ON_LINE}gate_way = 1\n", "bus.gate_way", "but it is 1"),
    ],
)
def test_what_is_wrong_is_refused_by_file_and_key(added: str, key: str, problem: str) -> None:
    with pytest.raises(RobotFileError) as refusal:
        rars(added)
    assert (refusal.value.file, refusal.value.key) == ("my.toml", key)
    assert problem in str(refusal.value)


def test_the_command_line_puts_any_robot_on_a_line() -> None:
    """The first drive is the gateway where the file names none; what is not said stays the file's."""
    bus = find("rars").over_serial(Generation.V1, 38_400).bus
    assert (bus.link, bus.gateway, bus.protocol, bus.line_rate) == (Link.SERIAL, 1, Generation.V1, 38_400)
    named = rars('link = "serial"\ngateway = 3\nprotocol = "v1"\nbaud = 57_600\n')
    assert named.over_serial().bus == named.bus
    assert named.over_serial(Generation.V2).bus.line_rate == 1_000_000


@pytest.mark.parametrize(("gateway", "guardian"), [(1, 2), (2, 1), (4, 1)])
def test_the_gateway_watches_the_first_other_drive(gateway: int, guardian: int) -> None:
    robot = rars(f'link = "serial"\ngateway = {gateway}\n')
    watched = {axis.node: robot.watched_by(axis) for axis in robot.axes}
    assert watched == {node: guardian if node == gateway else 100 for node in (1, 2, 3, 4)}
