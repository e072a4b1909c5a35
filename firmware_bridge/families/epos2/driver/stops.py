"""The stop stages of an EPOS2 as its link carries them, and what stops it without the bridge."""

from typing import Final

from firmware_bridge.canopen_drive.driver import stops
from firmware_bridge.canopen_drive.driver.stops import ON_CAN, Carrier
from firmware_bridge.drivers.stop_stages import StopStage
from firmware_bridge.families.epos2.settings import Epos2Driver, Epos2Link
from firmware_bridge.robot import AnyRobot, Axis

CARRIERS: Final = {
    Epos2Driver.CAN: ON_CAN,
    Epos2Driver.SERIAL: Carrier(
        "by WriteObject",
        "the bridge's heartbeat (command 0x20) and the guarding (0x21) withheld",
        "NMT service 129, reset node",
        process_data=False,
    ),
}


def stop_stages(robot: AnyRobot, axis: Axis) -> tuple[StopStage, ...]:
    """Return the stop stages of one drive of a robot. TypeError where no EPOS2 is on its link."""
    return stops.stop_stages(robot, axis, CARRIERS[Epos2Link.of_link(robot, axis.link).driver])
