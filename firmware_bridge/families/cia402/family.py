"""CiA 402 drives of any maker as a family of devices."""

from typing import Final

from firmware_bridge.canopen_drive.driver.stops import CONFIRMED_BY, alone, stop_stages
from firmware_bridge.canopen_drive.shown import shown
from firmware_bridge.families.cia402.check import check
from firmware_bridge.families.cia402.driver.link_drivers import link_drivers
from firmware_bridge.families.cia402.driver.product import REPORTS
from firmware_bridge.families.cia402.guard.product import can_rules
from firmware_bridge.families.cia402.reading import DICTIONARY, expected
from firmware_bridge.families.cia402.settings import Cia402Axis, Cia402Link, Cia402Supply
from firmware_bridge.family import Family

FAMILY: Final = Family(
    name="cia402",
    title="a link to CiA 402 drives of any maker",
    link=Cia402Link,
    axis=Cia402Axis,
    sensor=Cia402Supply,
    check=check,
    link_drivers=link_drivers,
    reports=lambda _robot, _axis: REPORTS,
    stop_stages=stop_stages,
    confirmed_by=CONFIRMED_BY,
    alone=alone,
    wire_rules=can_rules,
    dictionary=DICTIONARY,
    expected=expected,
    shown=shown,
)
