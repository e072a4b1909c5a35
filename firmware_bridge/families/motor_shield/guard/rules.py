"""The output guard of a board with a motor shield: listed commands, motor by motor within their bounds.

A motor is commanded no further than its bound, no faster than its slope, and never to reverse without
standing at 0 for half a cycle in between: at full speed a reversal draws twice the current of a stall. Where
the speed loop is on the board its commands are speeds; elsewhere they are PWM, and count as the speed without
load, which is the most that they can come to.

Sources: TB6612FNG data sheet, 1.2 A for ever and 3.2 A for an instant; robot file for bounds.
"""

import math
from collections.abc import Mapping
from typing import Final

from firmware_bridge.families.motor_shield.guard.commands import (
    READERS,
    Board,
    Inputs,
    ListedCommand,
    libraries_in,
    no_motion,
)
from firmware_bridge.families.motor_shield.settings import FULL_PWM, ShieldAxis, ShieldLink, ShieldProtocol
from firmware_bridge.families.motor_shield.wire import mw
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as ros
from firmware_bridge.node import DTR_DOWN, DTR_UP, LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.safety.guard.in_force import InForce, RequestedMotion
from firmware_bridge.safety.guard.wire_rules import ROUNDING, WireRules
from firmware_bridge.units import MILLISECOND, NEVER, RPM_PER_RAD_S, SECOND, Nanoseconds

SLOWEST: Final = 2
"""Cycles without a command after which the permitted change of a motor grows no further."""


class GuardedMotor:
    """One motor: what is in force at its half bridge."""

    def __init__(self, axis: Axis, robot: AnyRobot) -> None:
        self.axis: Final = axis
        link, motor = ShieldLink.of_link(robot, axis.link), ShieldAxis.of(axis)
        self.cycle: Final = robot.cycle * link.every
        self.all: tuple[InForce, ...] = ()
        self.commanded_at: Nanoseconds = -NEVER
        self.homes: Final = False
        self.homes_within_s: Final = 0.0
        self.number: Final = motor.port
        per_turn = motor.counts_per_turn * axis.ratio / math.tau
        on_board = link.protocol is ShieldProtocol.ROS_ARDUINO_BRIDGE
        ticks = per_turn * ros.FRAME_MS * MILLISECOND / SECOND
        free = motor.full_speed_rpm / RPM_PER_RAD_S / axis.ratio
        self.unit: Final = "ticks" if on_board else "PWM"
        self._per_step: Final = axis.direction * (1.0 / ticks if on_board else free / FULL_PWM)
        """The axis's speed in its unit a second, for each tick or count."""
        self.most: Final = (
            math.floor(axis.top_speed * ticks * (1.0 + ROUNDING)) if on_board else motor.max_pwm
        )
        self._slope: Final = None if on_board else motor.slope_pwm_s
        self._inputs = Inputs(0, in1=False, in2=False)
        self._sized_at: Nanoseconds = -NEVER
        """Time of its last PWM command."""
        self._sign = 0
        """Direction in which it was driven last."""
        self._stood_at: Nanoseconds = -NEVER
        """Since when it has not been driven."""

    @property
    def permitted(self) -> str:
        """The values that it may be sent."""
        return f"-{self.most} to {self.most} {self.unit}"

    @property
    def powered(self) -> bool:
        """True while its half bridge is not released, as far as commanded."""
        return bool(self._inputs.in1 or self._inputs.in2)

    @property
    def moving(self) -> bool:
        """True while it is driven."""
        return self.duty(self._inputs) != 0

    @property
    def speed(self) -> float:
        """The speed in force, in the axis's unit a second."""
        return self.duty(self._inputs) * self._per_step

    def duty(self, inputs: Inputs) -> int:
        """Return ticks or PWM with a sign; 0 where both inputs are alike."""
        # TB6612FNG: unlike inputs give the direction; alike they brake or release, whatever the PWM.
        return (inputs.size or 0) * (bool(inputs.in1) - bool(inputs.in2))

    def with_(self, inputs: Inputs) -> Inputs:
        """Return the inputs in force after a command."""
        old = self._inputs
        return Inputs(
            old.size if inputs.size is None else inputs.size,
            old.in1 if inputs.in1 is None else inputs.in1,
            old.in2 if inputs.in2 is None else inputs.in2,
        )

    def requested_by(self, inputs: Inputs) -> RequestedMotion:
        """Return the motor's motion by a command."""
        duty = self.duty(self.with_(inputs))
        return RequestedMotion(duty != 0, duty * self._per_step)

    def refuses(self, inputs: Inputs, now: Nanoseconds) -> str | None:
        """Return why a command may not come into force, or None."""
        duty, before = self.duty(self.with_(inputs)), self.duty(self._inputs)
        if (inputs.size or 0) > self.most:
            return f"{self.axis.called}: {inputs.size} {self.unit} is beyond {self.most}"
        # Right after a reversal the back-EMF adds to the supply instead of opposing it.
        if duty * self._sign < 0 and (before or now < self._stood_at + self.cycle // 2):
            return f"{self.axis.called}: reversed to {duty} {self.unit} without standing at 0"
        if self._slope is None or abs(duty) <= abs(before):
            return None
        # Half a cycle is for a late loop; the cap keeps a long silence from permitting a large step.
        waited = min(now - self._sized_at, SLOWEST * self.cycle) + self.cycle // 2
        rise = math.ceil(self._slope * waited / SECOND)
        if abs(duty) - abs(before) > rise:
            return f"{self.axis.called}: from {before} to {duty} PWM at once, {rise} is allowed"
        return None

    def sent(self, inputs: Inputs, now: Nanoseconds) -> None:
        """Note what is in force from now on."""
        before = self.duty(self._inputs)
        self._inputs = self.with_(inputs)
        duty = self.duty(self._inputs)
        if inputs.size is not None:
            self._sized_at = now
        if duty:
            self._sign = 1 if duty > 0 else -1
        elif before:
            self._stood_at = now


class ShieldRules(WireRules):
    """Commands of one board; what it answers is the bridge's."""

    def __init__(self, robot: AnyRobot, link: str) -> None:
        self.link = link
        motors = tuple(GuardedMotor(axis, robot) for axis in robot.axes_on(link))
        self._motors: Final = {motor.number: motor for motor in motors}
        self.axes: tuple[InForce, ...] = motors
        table = ShieldLink.of_link(robot, link)
        self._read: Final = READERS[table.protocol]
        numbers = tuple(sorted(self._motors))
        self._board = Board(table, numbers, mw.LIBRARIES)
        self._answers: Final = mw.AnswerReader() if table.protocol is ShieldProtocol.MW else None

    def axes_of(self, packet: Packet) -> tuple[InForce, ...]:
        """Return the motors that a command drives."""
        command = self._command(packet)
        return () if command is None else tuple(self._motors[number] for number in command.drives)

    def requested_by(self, packet: Packet) -> Mapping[InForce, RequestedMotion]:
        """Return what a command has its motors do."""
        command = self._command(packet) or ListedCommand()
        motors = ((self._motors[number], inputs) for number, inputs in command.drives.items())
        return {motor: motor.requested_by(inputs) for motor, inputs in motors}

    def permitted(self, axis: Axis) -> str:
        """Describe the targets that an axis of the link may be sent."""
        return next(one.permitted for one in self._motors.values() if one.axis.name == axis.name)

    def refuses(self, packet: Packet, now: Nanoseconds) -> str | None:
        """Look into the list, and at what is in force."""
        moving = next((motor.axis.called for motor in self._motors.values() if motor.moving), None)
        # The shield has no wire to the reset: its motors run on as commanded while the board boots.
        if packet.address in {DTR_UP, DTR_DOWN} and not packet.payload:
            return None if moving is None else f"a reset of the board while {moving} may move"
        command = self._command(packet)
        if command is None:
            return f"the command '{packet.payload.hex(' ')}' is not listed"
        if command.at_standstill and moving is not None:
            return f"the command '{packet.payload.hex(' ')}' while {moving} may move"
        reasons = (self._motors[number].refuses(inputs, now) for number, inputs in command.drives.items())
        return next((reason for reason in reasons if reason is not None), None)

    def safe(self, axis: GuardedMotor) -> tuple[Packet, ...]:
        """Return what takes the speed of a motor."""
        return tuple(Packet(self.link, 0, data) for data in no_motion(axis.number, self._board))

    def sends(self, packet: Packet, now: Nanoseconds, *, requested: bool) -> tuple[InForce, ...]:
        """Note what a command does to the motors."""
        del requested
        command = self._command(packet) or ListedCommand()
        for number, inputs in command.drives.items():
            self._motors[number].sent(inputs, now)
        return tuple(self._motors[number] for number in command.drives)

    def receives(self, packet: Packet, now: Nanoseconds) -> bool:
        """Accept everything; note the libraries that MWProtocol reports."""
        del now
        if self._answers is not None and packet.address not in {LINE_LOST, LINE_BACK}:
            libraries = libraries_in(self._answers.receive(packet.payload))
            if libraries is not None:
                # Which number a library has depends on how the sketch was built, so the board's own report
                # counts.
                self._board = self._board._replace(libraries=libraries)
        return True

    def _command(self, packet: Packet) -> ListedCommand | None:
        return self._read(packet.payload, self._board) if packet.address == 0 else None
