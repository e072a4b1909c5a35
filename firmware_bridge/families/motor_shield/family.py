"""Boards with a motor shield as a family of devices."""

from typing import Final

from firmware_bridge.dissector.protocols import Protocols
from firmware_bridge.families.motor_shield.dissector import ArduinoIoLine, FirmataLine, MwLine, RosLine
from firmware_bridge.families.motor_shield.driver.link_drivers import (
    measured,
    over_protocol,
    shield_link_drivers,
)
from firmware_bridge.families.motor_shield.driver.motor import reports
from firmware_bridge.families.motor_shield.driver.plan import shield_plan
from firmware_bridge.families.motor_shield.driver.stops import CONFIRMED_BY, alone, stop_stages
from firmware_bridge.families.motor_shield.guard.rules import ShieldRules
from firmware_bridge.families.motor_shield.settings import RUNS_ON, ShieldAxis, ShieldLink, ShieldProtocol
from firmware_bridge.family import Family
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND


def _shown(robot: AnyRobot, name: str) -> str:
    link = ShieldLink.of_link(robot, name)
    rows = [
        f"{name}: {link.driver.value}, {link.protocol.value}, {link.rate} Bd",
        f"every {link.every * robot.cycle_ms} ms",
    ]
    for protocol in ShieldProtocol:
        other = robot.with_links({name: link.over(protocol, robot.cycle_ms, None)})
        plan, table = shield_plan(other, name), ShieldLink.of_link(other, name)
        rows.append(
            f"{protocol.value}: {table.counted} encoders, a reversal takes {plan.time / MILLISECOND:.0f} of "
            f"{plan.cycle // MILLISECOND} ms" + ("; NO WATCHDOG" if table.unwatched else "")
        )
    if link.unwatched:
        rows.insert(1, f"NO WATCHDOG: {RUNS_ON}")
    return "\n".join(rows)


FAMILY: Final = Family(
    name="motor_shield",
    title="a board with a motor shield",
    link=ShieldLink,
    axis=ShieldAxis,
    link_drivers=shield_link_drivers,
    reports=reports,
    stop_stages=stop_stages,
    confirmed_by=CONFIRMED_BY,
    alone=alone,
    wire_rules=ShieldRules,
    protocols={
        ShieldProtocol.MW: Protocols(MwLine),
        ShieldProtocol.ROS_ARDUINO_BRIDGE: Protocols(RosLine),
        ShieldProtocol.ARDUINOIO: Protocols(ArduinoIoLine),
        ShieldProtocol.FIRMATA: Protocols(FirmataLine),
    },
    takes=frozenset({"protocol", "encoders"}),
    over=lambda robot, options: over_protocol(robot, options.protocol, options.encoders),
    drivable=measured,
    shown=_shown,
)
