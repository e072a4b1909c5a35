"""A robot file that names a serial link: what it may say, and what is refused with file and key."""

from typing import Any

import pytest

from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.settings import Epos2Driver, Epos2Link, nodes_on
from firmware_bridge.robot import AnyRobot, RobotFileError
from hil_tests.unit.drivers.robots import LINK, RARS, changed

ON_LINE: dict[str, object] = {"driver": "epos2-serial", "gateway": 1}
KEY = f"links.{LINK}"


def rars(stated: dict[str, object]) -> AnyRobot:
    """RARS with other settings of its link."""

    def change(table: dict[str, Any]) -> None:
        table["links"][LINK] |= stated

    return changed(change)


def test_a_serial_link_is_named_with_its_gateway() -> None:
    link = Epos2Link.of_link(rars(ON_LINE), LINK)
    stated = (link.driver, link.gateway, link.protocol, link.line_rate)
    assert stated == (Epos2Driver.SERIAL, 1, Generation.V2, 1_000_000)


def test_everything_of_the_line_can_be_stated() -> None:
    link = Epos2Link.of_link(rars({**ON_LINE, "protocol": "v1", "baud": 57_600, "port_latency_us": 0}), LINK)
    assert (link.protocol, link.line_rate, link.port_latency_us) == (Generation.V1, 57_600, 0)


def test_rars_itself_is_on_can() -> None:
    assert Epos2Link.of_link(RARS, LINK).driver is Epos2Driver.CAN


@pytest.mark.parametrize(
    ("stated", "key", "problem"),
    [
        ({"driver": "epos2-serial"}, KEY, "driver = 'epos2-serial' needs gateway"),
        ({"driver": "lpt"}, f"{KEY}.driver", "'lpt'"),
        ({**ON_LINE, "gateway": 9}, f"{KEY}.gateway", "9 is not the node of an axis"),
        ({**ON_LINE, "gateway": 0}, f"{KEY}.gateway", "but it is 0"),
        ({**ON_LINE, "protocol": "v3"}, f"{KEY}.protocol", "'v3'"),
        ({**ON_LINE, "baud": 300}, f"{KEY}.baud", "but it is 300"),
        ({**ON_LINE, "port_latency_us": -1}, f"{KEY}.port_latency_us", "but it is -1"),
        ({**ON_LINE, "gate_way": 1}, f"{KEY}.gate_way", "perhaps 'gateway'?"),
    ],
)
def test_what_is_wrong_is_refused_by_file_and_key(stated: dict[str, object], key: str, problem: str) -> None:
    with pytest.raises(RobotFileError) as refusal:
        rars(stated)
    assert refusal.value.file == "test.toml"
    assert [one.key for one in refusal.value.problems] == [key]
    assert problem in str(refusal.value)


def test_the_command_line_puts_any_robot_on_a_line() -> None:
    """The first drive is the gateway where the file names none; other settings stay the file's."""
    link = Epos2Link.of_link(over_serial(RARS, Generation.V1, 38_400), LINK)
    stated = (link.driver, link.gateway, link.protocol, link.line_rate)
    assert stated == (Epos2Driver.SERIAL, 1, Generation.V1, 38_400)
    named = rars({**ON_LINE, "gateway": 3, "protocol": "v1", "baud": 57_600})
    assert over_serial(named).links == named.links
    assert Epos2Link.of_link(over_serial(named, Generation.V2), LINK).line_rate == 1_000_000
    assert Epos2Link.of_link(over_serial(named, gateway=2), LINK).gateway == 2


def test_a_gateway_that_is_not_there_is_refused() -> None:
    with pytest.raises(RobotFileError, match=r"links\.drives\.gateway: 9 is not the node of an axis"):
        over_serial(RARS, gateway=9)


def test_a_drive_alone_on_its_link_has_no_one_to_watch() -> None:
    def one(table: dict[str, Any]) -> None:
        table["links"]["far"] = dict(table["links"][LINK])
        table["axes"][3]["link"] = "far"

    with pytest.raises(RobotFileError, match=r"links\.far\.gateway: a drive without another one behind it"):
        over_serial(changed(one))


@pytest.mark.parametrize(("gateway", "guardian"), [(1, 2), (2, 1), (4, 1)])
def test_the_gateway_watches_the_first_other_drive(gateway: int, guardian: int) -> None:
    robot = rars({**ON_LINE, "gateway": gateway})
    nodes = nodes_on(robot, LINK)
    watched = {node: Epos2Link.of_link(robot, LINK).watched_by(node, nodes) for node in nodes}
    assert watched == {node: guardian if node == gateway else 100 for node in (1, 2, 3, 4)}
