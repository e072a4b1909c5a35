"""Demands to one EPOS2's set-point frames: controlword and target, the handshake of positions included.

It refuses to know whether a demand is wise, and when frames are sent. Controlwords: EPOS Firmware
Specification, profile velocity and profile position mode; halt as maxon's command library writes it, quick
stop as the EPOS2 Application Notes do.
"""

import math
from typing import Final, Protocol

from firmware_bridge.drivers.drive import Demand, Heard, Position, Speed, Stop
from firmware_bridge.drivers.epos2_pdo import SET_POINT, SET_POINT_COB_ID
from firmware_bridge.drivers.epos2_setup import Travel
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, Mode
from firmware_bridge.units import RPM_PER_RAD_S
from firmware_bridge.wire.cia402 import Control, State

DISABLE_VOLTAGE: Final = 0x0000
SHUTDOWN: Final = int(Control.NO_QUICK_STOP | Control.ENABLE_VOLTAGE)
SWITCH_ON: Final = int(SHUTDOWN | Control.SWITCH_ON)
ENABLE: Final = int(SWITCH_ON | Control.ENABLE_OPERATION)
HALT: Final = int(ENABLE | Control.HALT)
NEW_POSITION: Final = int(ENABLE | Control.NEW_SETPOINT | Control.CHANGE_IMMEDIATELY)
QUICK_STOP: Final = int(ENABLE & ~Control.NO_QUICK_STOP)
"""0x000B. Without power it asks for nothing that moves: it is the word for a drive that is not enabled."""
FAULT_RESET: Final = int(Control.FAULT_RESET)

_SPEED: Final = SET_POINT[Mode.VELOCITY]
_POSITION: Final = SET_POINT[Mode.POSITION]

SMALLEST_MOVE_QC: Final = 2
"""A target that changed by less is not sent again: it is the rounding of the steering's arithmetic."""


class SetPoint(Protocol):
    """The set-point frame of one drive."""

    def word(self, controlword: int) -> Packet:
        """Return a frame with this controlword and a target that moves nothing."""

    def demand(self, demand: Demand) -> Packet:
        """Return the frame for a demand; a drive that is not enabled is never told to move."""

    def release(self) -> Packet | None:
        """Return the frame that ends a handshake; None where none is open."""


def set_point(axis: Axis, heard: Heard, travel: Travel | None) -> SetPoint:
    """Return the kind of set-point that the axis's mode needs."""
    if axis.mode is Mode.VELOCITY:
        return VelocitySetPoint(axis, heard)
    return PositionSetPoint(axis, heard, travel)


class VelocitySetPoint:
    """Controlword and target velocity in rpm."""

    __slots__ = ("_cob_id", "_heard", "_highest_rpm", "_rpm_per_rad_s")

    def __init__(self, axis: Axis, heard: Heard) -> None:
        self._cob_id = SET_POINT_COB_ID[Mode.VELOCITY] + axis.node
        self._heard = heard
        self._rpm_per_rad_s = axis.direction * axis.gear_ratio * RPM_PER_RAD_S
        self._highest_rpm = axis.profile.max_velocity_rpm

    def word(self, controlword: int) -> Packet:
        """Return a frame with this controlword and speed 0."""
        return self._frame(controlword, 0)

    def demand(self, demand: Demand) -> Packet:
        """Return the frame for a demand; a position, or what is no finite speed, counts as rest."""
        if demand is Stop.POWER_OFF:
            return self._frame(DISABLE_VOLTAGE, 0)
        if demand is Stop.QUICK_STOP or self._heard.state is not State.OPERATION_ENABLED:
            return self._frame(QUICK_STOP, 0)
        if isinstance(demand, Speed) and math.isfinite(demand.rad_s):
            rpm = demand.rad_s * self._rpm_per_rad_s
            return self._frame(ENABLE, round(min(max(rpm, -self._highest_rpm), self._highest_rpm)))
        return self._frame(ENABLE, 0)

    def release(self) -> None:
        """Do nothing: a velocity has no handshake."""

    def _frame(self, controlword: int, rpm: int) -> Packet:
        return Packet(CAN, self._cob_id, _SPEED.pack(controlword, rpm))


class PositionSetPoint:
    """Controlword and target position in quadcounts.

    A drive takes a target at the rising edge of the new set-point bit, so the bit is released between two.
    """

    __slots__ = ("_bit_is_set", "_cob_id", "_heard", "_target_qc", "_travel", "_under_way")

    def __init__(self, axis: Axis, heard: Heard, travel: Travel | None) -> None:
        self._cob_id = SET_POINT_COB_ID[Mode.POSITION] + axis.node
        self._heard = heard
        self._travel = travel
        self._target_qc = 0
        self._bit_is_set = False
        self._under_way = False
        """Whether the drive moves to, or holds, `_target_qc`."""

    def word(self, controlword: int) -> Packet:
        """Return a frame with this controlword and the actual position."""
        self._under_way = False
        self._target_qc = self._clipped(self._heard.position_qc)
        return self._frame(controlword)

    def demand(self, demand: Demand) -> Packet:
        """Return the frame for a demand; a speed counts as rest."""
        if demand is Stop.POWER_OFF:
            return self.word(DISABLE_VOLTAGE)
        if demand is Stop.QUICK_STOP or self._stopped():
            return self.word(QUICK_STOP)
        if isinstance(demand, Position):
            return self._go(self._clipped(demand.quadcounts))
        self._under_way = False
        return self._frame(HALT)

    def release(self) -> Packet | None:
        """Return the frame that ends the handshake of a new position; None where none is open."""
        if not self._bit_is_set:
            return None
        # In a drive that stopped by itself since, 0x000F would put the power on again.
        return self.demand(Stop.QUICK_STOP) if self._stopped() else self._frame(ENABLE)

    def _go(self, target_qc: int) -> Packet:
        if self._bit_is_set:
            # Not released yet: an edge is not possible now, the next cycle will bring it.
            return self._frame(NEW_POSITION)
        if self._under_way and abs(target_qc - self._target_qc) < SMALLEST_MOVE_QC:
            return self._frame(ENABLE)
        self._target_qc = target_qc
        self._under_way = True
        return self._frame(NEW_POSITION)

    def _stopped(self) -> bool:
        return self._heard.state is not State.OPERATION_ENABLED

    def _clipped(self, position_qc: int) -> int:
        return position_qc if self._travel is None else self._travel.clip(position_qc)

    def _frame(self, controlword: int) -> Packet:
        self._bit_is_set = controlword == NEW_POSITION
        return Packet(CAN, self._cob_id, _POSITION.pack(controlword, self._target_qc))
