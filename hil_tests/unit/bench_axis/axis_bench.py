"""The bench axis between its stops, with a drive on it and no bus: what a test writes, and where all is."""

from collections.abc import Callable, Mapping
from math import tau
from typing import Final

from emulators.epos2.control.motion_control import MotionControl
from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.epos2.single import DrivesOrder, drives
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.units import MILLISECOND, Nanoseconds
from fmu.build import ensure
from fmu.single_axis.parameters import SETS

TURN: Final = 2000
GEAR: Final = 26.0
NEGATIVE, POSITIVE, HOME_IN, HOME_OUT = (round(angle * GEAR * TURN / tau) for angle in (-0.9, 1.9, 0.4, 0.6))
"""Positions of the motor where the load is at an edge of a switch, but for the backlash, in counts."""
STOP_LOW, STOP_HIGH = (round(angle * GEAR * TURN / tau) for angle in (-1.0, 2.0))
TUNED: Final = {
    od.MOTOR_TYPE: 1,
    at.CURRENT_P: 50,
    at.CURRENT_I: 20,
    at.POSITION_P: 900,
    at.POSITION_I: 3000,
    at.POSITION_D: 1500,
    od.HOMING_SPEED_SWITCH: 300,
    od.HOMING_SPEED_ZERO: 60,
    od.HOMING_ACCELERATION: 2000,
    at.HOMING_CURRENT: 4000,
}
START: Final = 0x1F
ENABLED: Final = 0x0F


class AxisBench:
    """One drive above the FMU, at `angle` rad of the motor to begin with."""

    def __init__(self, angle: float = 0.0, plant: Mapping[str, float] | None = None) -> None:
        values = {**SETS["between_stops"], **(plant or {}), "angle_axis": angle}
        order = DrivesOrder(
            (1,), EPOS2_70_10, 1_000_000, plant=ensure("single_axis"), plant_parameters=values, axes=("axis",)
        )
        made, self.bank = drives(order)
        self.drive = made["axis"]
        self.axis = self.bank.axes[0]
        self.store = self.drive.store
        assert isinstance(self.drive.motion, MotionControl)
        self.control = self.drive.motion
        self.drive.wake(0)
        self.control.nmt_changed(operational=True)
        self.now: Nanoseconds = 0
        self.run(20)
        for address, value in TUNED.items():
            self.write(address, value)

    def write(self, address: Address, value: int) -> None:
        size = EPOS2_70_10.objects[address].type.size
        self.store.write(address, (value & (1 << 8 * size) - 1).to_bytes(size, "little"))
        self.control.refresh(self.now)

    def read(self, address: Address) -> int:
        return self.store.live(address)

    @property
    def word(self) -> int:
        return self.read(od.STATUSWORD)

    @property
    def offset(self) -> int:
        """Offset that the drive adds to the encoder's count to have its position."""
        return self.axis.position - self.axis.encoder

    def run(self, milliseconds: int) -> None:
        end = self.now + milliseconds * MILLISECOND
        while self.now < end:
            wake = self.control.wake_at()
            self.now, woken = self.bank.advance(wake if self.now < wake < end else end)
            if woken or self.control.wake_at() <= self.now:
                self.control.refresh(self.now)

    def runs_until(self, condition: Callable[[], bool], longest_ms: int = 60_000) -> int:
        for ms in range(longest_ms):
            if condition():
                return ms
            self.run(1)
        raise AssertionError("never comes true")

    def enable(self, mode: int = Mode.HOMING) -> None:
        self.write(od.MODE, mode)
        for word in (0x06, 0x07, ENABLED):
            self.write(od.CONTROLWORD, word)
        assert self.control.state is PowerState.OPERATION_ENABLED

    def starts(self, method: int) -> None:
        self.write(od.HOMING_METHOD, method)
        self.write(od.CONTROLWORD, ENABLED)
        self.write(od.CONTROLWORD, START)

    def homes(self, method: int) -> int:
        """Home, and return the encoder's count that has the position 0."""
        self.starts(method)
        self.runs_until(lambda: bool(self.word & 0x3000))
        assert self.word & 0xB400 == 0x9400, hex(self.word)
        return -self.offset
