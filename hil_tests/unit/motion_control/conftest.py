"""One drive without a bus: object store, motion control, servo axis and a motor, advanced by hand."""

from collections.abc import Callable
from dataclasses import dataclass, field

import pytest

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.control.motion_control import MotionControl
from emulators.epos2.control.power_states import Delays
from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.winding import DIODES_MV
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.units import MILLISECOND, Nanoseconds

# maxon RE25 20 W, values from memory of the catalog (assumed), with a small load.
STEERING = DcMotor(2.32, 0.238e-3, 0.0234, 1.3e-6, friction=1.5e-3, damping=4e-7)
SETTINGS = {
    od.MOTOR_TYPE: 1,
    at.CURRENT_P: 180,
    at.CURRENT_I: 297,
    at.VELOCITY_P: 400,
    at.VELOCITY_I: 40,
    at.POSITION_P: 200,
    at.POSITION_I: 800,
    at.POSITION_D: 220,
    at.POSITION_ACCELERATION_FEEDFORWARD: 55,
    at.CONTINUOUS_CURRENT_LIMIT: 1200,
    at.OUTPUT_CURRENT_LIMIT: 3000,
    od.PROFILE_VELOCITY: 3000,
    od.PROFILE_ACCELERATION: 30_000,
    od.PROFILE_DECELERATION: 15_000,
    od.QUICK_STOP_DECELERATION: 60_000,
}
SHUTDOWN, SWITCH_ON, ENABLE, QUICK_STOP, DISABLE = 0x06, 0x07, 0x0F, 0x02, 0x00


@dataclass
class Drive:
    """A test's access to the drive: commands and readings."""

    store: ObjectStore
    axis: ServoAxis
    plant: DcMotors
    bank: ServoBank
    control: MotionControl
    reported: list[int]
    now: Nanoseconds = 0
    words: list[int] = field(default_factory=list)
    """Each statusword that differed from the one before."""

    def write(self, address: Address, value: int) -> None:
        size = EPOS2_70_10.objects[address].type.size
        self.store.write(address, (value & (1 << 8 * size) - 1).to_bytes(size, "little"))
        self._look()
        self.control.refresh(self.now)
        self._look()

    def carries(self, *values: tuple[Address, int]) -> None:
        """Take what a receive PDO carries."""
        for address, value in values:
            self.store.cell(address).accept(value)
        self._look()
        self.control.refresh(self.now)
        self._look()

    def read(self, address: Address) -> int:
        return self.store.live(address)

    def command(self, *words: int) -> None:
        for word in words:
            self.write(od.CONTROLWORD, word)

    def enable(self, mode: int | None = None) -> None:
        if mode is not None:
            self.write(od.MODE, mode)
        self.command(SHUTDOWN, SWITCH_ON, ENABLE)

    def run(self, milliseconds: float) -> None:
        end = self.now + round(milliseconds * MILLISECOND)
        while self.now < end:
            wake = self.control.wake_at()
            self.now, woken = self.bank.advance(wake if self.now < wake < end else end)
            if woken or self.control.wake_at() <= self.now:
                self.control.refresh(self.now)
                self._look()

    def runs_until(self, condition: Callable[[], bool], longest_ms: int = 5000) -> int:
        """Return the milliseconds it took."""
        for ms in range(longest_ms):
            if condition():
                return ms
            self.run(1)
        raise AssertionError("never comes true")

    @property
    def statusword(self) -> int:
        return self.read(od.STATUSWORD)

    @property
    def state(self) -> PowerState:
        return self.control.state

    def stands_in(self, state: PowerState) -> bool:
        return self.control.state is state

    @property
    def rpm(self) -> float:
        """Speed of the plant's shaft."""
        return self.plant.outputs[2] * 9.549296585513721

    def _look(self) -> None:
        if not self.words or self.words[-1] != self.statusword:
            self.words.append(self.statusword)


Make = Callable[..., Drive]


def make_drive(
    delays: Delays | None = None,
    *,
    motor: DcMotor = STEERING,
    boot: bool = True,
    each_write_counts: bool = True,
) -> Drive:
    plant = DcMotors((motor,))
    axis = ServoAxis("steer", 2000)
    bank = ServoBank(plant, [axis])
    store = ObjectStore(EPOS2_70_10.objects, 3, SETTINGS)
    reported: list[int] = []
    control = MotionControl(store, axis, reported.append, delays, each_write_counts=each_write_counts)
    drive = Drive(store, axis, plant, bank, control, reported)
    control.nmt_changed(operational=True)
    if boot:
        drive.run(10)
    return drive


@pytest.fixture
def make() -> Make:
    return make_drive


@pytest.fixture
def drive() -> Drive:
    return make_drive()


LAGS = STEERING.inductance * STEERING.torque_constant**2 / (STEERING.resistance**2 * STEERING.inertia)
"""Excess of a braking current over that of the present speed: winding's over mechanical time constant."""


def into_the_supply(drive: Drive) -> float:
    """Return the current in A, at most, that a back-EMF beyond supply and diodes drives through them."""
    beyond = (
        STEERING.torque_constant * abs(drive.plant.outputs[2]) - (drive.axis.supply_mv + DIODES_MV) / 1000
    )
    return (1.0 + LAGS) * max(0.0, beyond) / STEERING.resistance
