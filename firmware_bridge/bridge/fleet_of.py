"""The drivers of one robot: which axis is moved by which kind of drive, and how far it may go."""

import math
from collections.abc import Callable, Mapping
from typing import Final

from firmware_bridge.drivers.can_link import CanLink
from firmware_bridge.drivers.epos2 import Epos2
from firmware_bridge.drivers.epos2_setup import Travel
from firmware_bridge.drivers.fleet import Fleet
from firmware_bridge.drivers.serial.epos import EposSerial
from firmware_bridge.drivers.serial.errands import Exchange
from firmware_bridge.drivers.serial.link import SerialLink
from firmware_bridge.drivers.serial.plan import fitting_plan
from firmware_bridge.motion import davis, lift
from firmware_bridge.robot import Link, Robot, Role


def fleet_of(robot: Robot) -> Fleet:
    """Return the drives that the robot file names, in its order, on the link that it names.

    PlanError where the cycle does not fit on a serial link.
    """
    return _FLEETS[robot.bus.link](robot)


def _can_fleet(robot: Robot) -> Fleet:
    travels = _travels(robot)
    drives = tuple(Epos2(axis, robot.bus, travels.get(axis.role)) for axis in robot.axes)
    return Fleet(drives, CanLink(drives, robot.bus))


def _serial_fleet(robot: Robot) -> Fleet:
    plan = fitting_plan(robot)
    travels = _travels(robot)
    exchange = Exchange()
    drives = tuple(EposSerial(axis, robot, travels.get(axis.role), exchange) for axis in robot.axes)
    return Fleet(drives, SerialLink(drives, exchange, robot, plan.answers_within))


def _travels(robot: Robot) -> Mapping[Role, Travel]:
    """Return the mechanical range of each position axis.

    ASSUME: a drive counts from where it was switched on; the steering was straight ahead then, the lift
    collapsed. The thesis names no absolute encoder and no switch.
    """
    steering, lifting = robot.axis(Role.STEERING), robot.axis(Role.LIFT)
    full = math.radians(robot.limits.steer_angle_deg)
    ends: Final = {
        Role.STEERING: [davis.steer_quadcounts(robot.base, steering, angle) for angle in (-full, full)],
        Role.LIFT: [
            lift.lift_quadcounts(robot.lift, lifting, height) for height in (0.0, lift.highest(robot.lift))
        ],
    }
    return {role: Travel(min(two), max(two)) for role, two in ends.items()}


_FLEETS: Final[Mapping[Link, Callable[[Robot], Fleet]]] = {
    Link.CAN: _can_fleet,
    Link.SERIAL: _serial_fleet,
}
