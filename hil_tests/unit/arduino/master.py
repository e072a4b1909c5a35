"""A bus with one motor shield, and someone who does one thing after the other."""

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.jobs import Delay, OnBus
from emulators.arduino_omni.shield.i2c import I2cBus, Transfer, TransferResult, write
from emulators.arduino_omni.shield.motor_shield import MotorShield
from emulators.arduino_omni.shield.tb6612 import BridgeDuty
from firmware_bridge.units import MICROSECOND, Nanoseconds

ADDRESS = 0x60
BIT = 10 * MICROSECOND


class Master:
    """A bus with one shield, and someone who does one thing after the other."""

    def __init__(self) -> None:
        self.shield = MotorShield()
        self.chip = self.shield.chip
        self.bus = I2cBus([self.chip])
        self.now: Nanoseconds = 0

    def do(self, transfer: Transfer) -> TransferResult:
        self.bus.begin(transfer, self.now)
        while True:
            self.now = self.bus.due
            result = self.bus.advance(self.now)
            if result is not None:
                return result

    def write(self, text: str, address: int = ADDRESS) -> TransferResult:
        return self.do(write(address, bytes.fromhex(text)))

    def begin(self) -> "Master":
        for job in library.begin(ADDRESS):
            if isinstance(job, OnBus):
                self.do(job.transfer)
            elif isinstance(job, Delay):
                self.now += job.duration
        return self

    def motors(self) -> tuple[BridgeDuty, ...]:
        return self.shield.outputs(self.now)
