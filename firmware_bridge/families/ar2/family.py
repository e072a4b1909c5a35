"""Boards of AR2 arms as a family of devices."""

from typing import Final

from firmware_bridge.dissector.protocols import Protocols
from firmware_bridge.families.ar2.dissector import Ar2Line
from firmware_bridge.families.ar2.driver.joint import REPORTS
from firmware_bridge.families.ar2.driver.link_drivers import ar2_link_drivers
from firmware_bridge.families.ar2.driver.stops import CONFIRMED_BY, alone, stop_stages
from firmware_bridge.families.ar2.guard import Ar2Rules
from firmware_bridge.families.ar2.settings import Ar2Axis, Ar2Firmware, Ar2Link
from firmware_bridge.family import Family
from firmware_bridge.robot import AnyRobot


def _shown(robot: AnyRobot, name: str) -> str:
    link = Ar2Link.of_link(robot, name)
    every = f"every {link.every * robot.cycle_ms} ms"
    return f"{name}: {link.driver.value}, {link.rate} Bd, moves of {link.move_ms} ms\n{every}"


FAMILY: Final = Family(
    name="ar2",
    title="a board of an AR2 arm",
    link=Ar2Link,
    axis=Ar2Axis,
    link_drivers=ar2_link_drivers,
    reports=lambda _robot, _axis: REPORTS,
    stop_stages=stop_stages,
    confirmed_by=CONFIRMED_BY,
    alone=alone,
    wire_rules=Ar2Rules,
    protocols={Ar2Firmware.AR2_2_0: Protocols(Ar2Line)},
    shown=_shown,
)
