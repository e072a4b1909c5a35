"""Set-points of one drive as frames: Controlword and target, the handshake of positions included.

The safety of a set-point and the time of its frames are not known here. Controlwords: EPOS Firmware
Specification, profile velocity and profile position mode; halt as maxon's command library writes it, quick
stop as the EPOS2 Application Notes do.
"""

import math
from typing import Final, Protocol

from firmware_bridge.canopen import cia402
from firmware_bridge.canopen.cia402 import ControlwordBit, PowerState, word_of
from firmware_bridge.canopen_drive.driver.feedback import DriveFeedback
from firmware_bridge.canopen_drive.driver.process_data import SET_POINT, SET_POINT_COB_ID
from firmware_bridge.canopen_drive.driver.scale import (
    WHOLE_COUNTER,
    Scale,
    highest_speed,
    travel_of,
    wrapped,
)
from firmware_bridge.canopen_drive.settings import DriveAxis
from firmware_bridge.drivers.driver import Position, SetPoint, Speed, Stop
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, CommandForm

DISABLE_VOLTAGE: Final = word_of(cia402.ControlwordCommand.DISABLE_VOLTAGE)
SHUTDOWN: Final = word_of(cia402.ControlwordCommand.SHUTDOWN)
ENABLE: Final = word_of(cia402.ControlwordCommand.ENABLE_OPERATION)
HALT: Final = int(ENABLE | ControlwordBit.HALT)
NEW_POSITION: Final = int(ENABLE | ControlwordBit.NEW_SETPOINT | ControlwordBit.CHANGE_IMMEDIATELY)
QUICK_STOP: Final = int(ENABLE & ~ControlwordBit.NO_QUICK_STOP)
"""0x000B, quick stop. Without power it commands no motion: it is the Controlword for a disabled drive."""
FAULT_RESET: Final = int(ControlwordBit.FAULT_RESET)

_SPEED: Final = SET_POINT[CommandForm.SPEED]
_POSITION: Final = SET_POINT[CommandForm.POSITION]

SMALLEST_MOVE: Final = 2
"""A target that changed by less is not sent again: it is the rounding of the kinematics."""


class DriveSetPoint(Protocol):
    """The set-point frame of one drive."""

    def word(self, controlword: int) -> Packet:
        """Return a frame with this controlword and a target that moves nothing."""

    def frame_for(self, set_point: SetPoint) -> Packet:
        """Return the frame for a set-point; to a drive that is not enabled never one to move."""

    def release(self) -> Packet | None:
        """Return the frame that ends a handshake; None where none is open."""


def set_point(axis: Axis, feedback: DriveFeedback) -> DriveSetPoint:
    """Return the kind of set-point that the axis's command needs."""
    if axis.command is CommandForm.SPEED:
        return VelocitySetPoint(axis, feedback)
    return PositionSetPoint(axis, feedback)


class VelocitySetPoint:
    """Controlword and target velocity."""

    def __init__(self, axis: Axis, feedback: DriveFeedback) -> None:
        self._link = axis.link
        self._cob_id = SET_POINT_COB_ID[CommandForm.SPEED] + DriveAxis.of(axis).node
        self._feedback = feedback
        self._scale = Scale.of(axis)
        self._highest = highest_speed(axis)

    def word(self, controlword: int) -> Packet:
        """Return a frame with this controlword and speed 0."""
        return self._frame(controlword, 0)

    def frame_for(self, set_point: SetPoint) -> Packet:
        """Return the frame for a set-point; a position, or what is no finite speed, counts as rest."""
        if set_point is Stop.POWER_OFF:
            return self._frame(DISABLE_VOLTAGE, 0)
        # Not enabled: 0x000B gives no power, while 0x000F would enable a drive in Switched on (transition 4).
        if set_point is Stop.QUICK_STOP or self._feedback.state is not PowerState.OPERATION_ENABLED:
            return self._frame(QUICK_STOP, 0)
        if isinstance(set_point, Speed) and math.isfinite(set_point.value):
            speed = self._scale.speed(set_point.value)
            return self._frame(ENABLE, round(min(max(speed, -self._highest), self._highest)))
        return self._frame(ENABLE, 0)

    def release(self) -> None:
        """Do nothing: a velocity has no handshake."""

    def _frame(self, controlword: int, speed: int) -> Packet:
        return Packet(self._link, self._cob_id, _SPEED.pack(controlword, speed))


class PositionSetPoint:
    """Controlword and target position.

    A drive takes a target at the rising edge of the new set-point bit, so the bit is released between two.
    """

    def __init__(self, axis: Axis, feedback: DriveFeedback) -> None:
        self._link = axis.link
        self._cob_id = SET_POINT_COB_ID[CommandForm.POSITION] + DriveAxis.of(axis).node
        self._feedback = feedback
        self._scale = Scale.of(axis)
        self._travel = travel_of(axis) or WHOLE_COUNTER
        self._target = 0
        self._bit_is_set = False
        self._under_way = False
        """True while the drive moves to, or holds, `_target`."""

    def word(self, controlword: int) -> Packet:
        """Return a frame with this controlword and the actual position."""
        # The actual position as target: should the drive take it, it stays where it is.
        self._under_way = False
        self._target = self._travel.clip(wrapped(self._feedback.position_counts))
        return self._frame(controlword)

    def frame_for(self, set_point: SetPoint) -> Packet:
        """Return the frame for a set-point; a speed, or what is no finite position, counts as rest."""
        if set_point is Stop.POWER_OFF:
            return self.word(DISABLE_VOLTAGE)
        if set_point is Stop.QUICK_STOP or self._stopped():
            return self.word(QUICK_STOP)
        if isinstance(set_point, Position) and math.isfinite(set_point.value):
            return self._go(self._scale.within(set_point.value, self._travel))
        self._under_way = False
        return self._frame(HALT)

    def release(self) -> Packet | None:
        """Return the frame that ends the handshake of a new position; None where none is open."""
        if not self._bit_is_set:
            return None
        # In a drive that stopped by itself since, 0x000F would put the power on again.
        return self.frame_for(Stop.QUICK_STOP) if self._stopped() else self._frame(ENABLE)

    def _go(self, target: int) -> Packet:
        if self._bit_is_set:
            # Not released yet: an edge is not possible now, the next cycle will bring it.
            return self._frame(NEW_POSITION)
        # Too small to be sent again; ENABLE keeps the drive on its way to the target that it has.
        if self._under_way and abs(target - self._target) < SMALLEST_MOVE:
            return self._frame(ENABLE)
        self._target = target
        self._under_way = True
        return self._frame(NEW_POSITION)

    def _stopped(self) -> bool:
        return self._feedback.state is not PowerState.OPERATION_ENABLED

    def _frame(self, controlword: int) -> Packet:
        # The drive acts on the rising edge of bit 4, so its last level must be known.
        self._bit_is_set = controlword == NEW_POSITION
        return Packet(self._link, self._cob_id, _POSITION.pack(controlword, self._target))
