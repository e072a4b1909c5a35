"""EPOS2 drives as a family of devices."""

from typing import Final

from firmware_bridge.canopen_drive.driver.stops import CONFIRMED_BY, alone
from firmware_bridge.canopen_drive.shown import shown
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.epos2.check import check
from firmware_bridge.families.epos2.driver.can_link_drivers import can_link_drivers
from firmware_bridge.families.epos2.driver.product import REPORTS
from firmware_bridge.families.epos2.driver.serial.line import MaxonLine
from firmware_bridge.families.epos2.driver.serial.link_drivers import (
    OPTIONS,
    serial_link_drivers,
    with_options,
)
from firmware_bridge.families.epos2.driver.stops import stop_stages
from firmware_bridge.families.epos2.guard.product import can_rules
from firmware_bridge.families.epos2.guard.serial import Epos2SerialRules
from firmware_bridge.families.epos2.reading import DICTIONARY, PROTOCOLS, expected
from firmware_bridge.families.epos2.settings import (
    Epos2AnalogueInput,
    Epos2Axis,
    Epos2DigitalOutput,
    Epos2Driver,
    Epos2Link,
)
from firmware_bridge.family import Family
from firmware_bridge.node import Node
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.table import LinkTable
from firmware_bridge.safety.guard.wire_rules import WireRules


def _link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    serial = Epos2Link.of_link(robot, name).driver is Epos2Driver.SERIAL
    return (serial_link_drivers if serial else can_link_drivers)(robot, name)


def _wire_rules(robot: AnyRobot, name: str) -> WireRules:
    serial = Epos2Link.of_link(robot, name).driver is Epos2Driver.SERIAL
    return (Epos2SerialRules if serial else can_rules)(robot, name)


def _line_end(node: Node, link: LinkTable, name: str) -> Node:
    if not isinstance(link, Epos2Link) or link.driver is Epos2Driver.CAN:
        return node
    return MaxonLine(node, link.protocol, name)


FAMILY: Final = Family(
    name="epos2",
    title="a link to EPOS2 drives",
    link=Epos2Link,
    axis=Epos2Axis,
    sensor=Epos2AnalogueInput,
    output=Epos2DigitalOutput,
    check=check,
    link_drivers=_link_drivers,
    reports=lambda _robot, _axis: REPORTS,
    stop_stages=stop_stages,
    confirmed_by=CONFIRMED_BY,
    alone=alone,
    wire_rules=_wire_rules,
    line_end=_line_end,
    protocols=PROTOCOLS,
    dictionary=DICTIONARY,
    expected=expected,
    takes=OPTIONS,
    over=with_options,
    shown=shown,
)
