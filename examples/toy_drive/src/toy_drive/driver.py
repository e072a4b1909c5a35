"""The toy drive as the bridge commands it: its requests, its answers in the axis's units, its stop stages."""

import math
from collections.abc import Mapping
from typing import ClassVar

from firmware_bridge.drivers.driver import Power, Reports, SetPoint, Speed, Stop
from firmware_bridge.drivers.life_cycle import Task, Transition
from firmware_bridge.drivers.line_device import LineDevice, Report
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.drivers.request_line import line_drivers
from firmware_bridge.drivers.stop_stages import StopStage
from firmware_bridge.robot import AnyRobot, Axis, Problem, RobotFileError

from toy_drive import wire
from toy_drive.settings import ToyAxis, ToyLink

POWERS = (Power.OFF, Power.ON, Power.STOPPED)


class ToyDevice(LineDevice):
    """The device on one line."""

    reports: ClassVar[frozenset[Reports]] = frozenset(
        {Reports.POWER, Reports.POSITION, Reports.VELOCITY, Reports.STOP}
    )
    question: ClassVar[bytes] = wire.QUESTION
    tasks: ClassVar[Mapping[Task, tuple[bytes, ...]]] = {
        Task.CONFIGURE: (wire.POWER_OFF,),
        Task.ENABLE: (wire.speed(0), wire.POWER_ON),
        Task.LEAVE: (wire.POWER_OFF,),
        Task.DISABLE: (wire.POWER_OFF,),
    }

    def __init__(self, axis: Axis) -> None:
        super().__init__(axis)
        # Units of the axis for each mrad/s, and for each count, of the motor's shaft.
        self._per_mrad = axis.direction / 1000.0 / axis.ratio
        self._per_count = axis.direction * math.tau / ToyAxis.of(axis).counts_per_turn / axis.ratio

    def request(self, set_point: SetPoint) -> bytes:
        """Return the request for a set-point; what is no speed stops."""
        if set_point is Stop.POWER_OFF:
            return wire.POWER_OFF
        if set_point is Stop.QUICK_STOP:
            return wire.STOP
        # Towards 0: a rounded set-point must not pass the guard's bound.
        return wire.speed(int(set_point.value / self._per_mrad) if isinstance(set_point, Speed) else 0)

    def read(self, request: bytes, line: bytes) -> Report | bool:
        """Return the state in a line that repeats the request: no late answer to another one counts."""
        answer = wire.answer_of(line)
        if answer is None or answer.request != request:
            return False
        position, velocity = answer.counts * self._per_count, answer.speed * self._per_mrad
        return Report(POWERS[answer.state], position, velocity, text=wire.STATES[answer.state])


def link_drivers(robot: AnyRobot, name: str) -> LinkDrivers:
    """Return the device on a link; RobotFileError where not one axis is on it."""
    axes = robot.axes_on(name)
    if len(axes) != 1:
        raise RobotFileError(robot.name, Problem(f"links.{name}", f"one axis is on it, not {len(axes)}"))
    return line_drivers(name, ToyLink.of_link(robot, name), ToyDevice(axes[0]))


def stop_stages(robot: AnyRobot, axis: Axis) -> tuple[StopStage, ...]:
    """Return the stop stages, the gentlest first."""
    within = ToyLink.of_link(robot, axis.link).confirmed(robot.cycle)
    ramp = ToyAxis.of(axis).acceleration
    return (
        StopStage("speed 0", "V0", Stop.STANDSTILL, within, ramp, received=True),
        StopStage("quick stop", "S", Stop.QUICK_STOP, within, ramp, received=True),
        StopStage(
            "power off", "P0", Stop.POWER_OFF, within, transition=Transition.POWER_OFF, ends_power=True
        ),
    )


def alone(robot: AnyRobot, link: str) -> str:
    """Return what stops the device when the bridge falls silent."""
    return f"its watchdog, {ToyLink.of_link(robot, link).watchdog_ms} ms after the last request: quick stop"
