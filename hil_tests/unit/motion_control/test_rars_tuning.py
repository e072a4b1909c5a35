"""The gains and profiles of the robot file RARS against the plant: four drives, no bus."""

from collections.abc import Callable, Iterator

import pytest

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.control.motion_control import MotionControl
from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank, plant_inputs, plant_outputs
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.robot import Axis, CommandForm
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, Nanoseconds
from fmu.build import ensure
from fmu.plant import FmuPlant

EXTRA = ("battery_voltage", "speed")
WINDOW_MS = 50
WHEELS = ("left", "right")


def objects_of(axis: Axis) -> dict[Address, int | bytes]:
    settings = Epos2Axis.of(axis)
    gains, profile = settings.gains, settings.profile
    return {
        od.MODE: 3 if axis.command is CommandForm.SPEED else 1,
        od.MOTOR_TYPE: settings.motor_type,
        at.ENCODER_PULSES: settings.encoder_lines,
        at.CURRENT_P: gains.current_p,
        at.CURRENT_I: gains.current_i,
        at.VELOCITY_P: gains.velocity_p,
        at.VELOCITY_I: gains.velocity_i,
        at.VELOCITY_FEEDFORWARD: gains.velocity_feedforward,
        at.VELOCITY_ACCELERATION_FEEDFORWARD: gains.acceleration_feedforward,
        at.POSITION_P: gains.position_p,
        at.POSITION_I: gains.position_i,
        at.POSITION_D: gains.position_d,
        at.POSITION_VELOCITY_FEEDFORWARD: gains.position_velocity_feedforward,
        at.POSITION_ACCELERATION_FEEDFORWARD: gains.position_acceleration_feedforward,
        at.CONTINUOUS_CURRENT_LIMIT: settings.continuous_current_ma,
        at.OUTPUT_CURRENT_LIMIT: settings.peak_current_ma,
        at.THERMAL_TIME_CONSTANT: settings.thermal_time_constant_100ms,
        od.PROFILE_VELOCITY: profile.velocity_rpm,
        od.PROFILE_ACCELERATION: profile.acceleration_rpm_s,
        od.PROFILE_DECELERATION: profile.deceleration_rpm_s,
        od.QUICK_STOP_DECELERATION: profile.quick_stop_rpm_s,
        od.MAX_PROFILE_VELOCITY: profile.max_velocity_rpm,
        od.MAX_FOLLOWING_ERROR: profile.max_following_error_qc,
    }


class Rars:
    """The robot's four drives on its plant."""

    def __init__(self, **parameters: float) -> None:
        robot = find("rars")
        names = [axis.name for axis in robot.axes]
        outputs = (*plant_outputs(names), *EXTRA)
        self.plant = FmuPlant(ensure("rars"), plant_inputs(names), outputs, parameters)
        axes = [ServoAxis(axis.name, Epos2Axis.of(axis).counts_per_turn) for axis in robot.axes]
        self.axes = dict(zip(names, axes, strict=True))
        self.bank = ServoBank(self.plant, axes, supply=outputs.index("battery_voltage"))
        self.reported: list[tuple[str, int]] = []
        self.stores = {
            axis.name: ObjectStore(EPOS2_70_10.objects, Epos2Axis.of(axis).node, objects_of(axis))
            for axis in robot.axes
        }
        self.drives = {
            name: MotionControl(self.stores[name], self.axes[name], self._reporter(name)) for name in names
        }
        self.now: Nanoseconds = 0
        self.speeds: list[float] = []
        self.run(10)
        for word in (0x06, 0x07, 0x0F):
            for name in names:
                self.write(name, od.CONTROLWORD, word)
        self.run(50)

    def _reporter(self, name: str) -> Callable[[int], None]:
        return lambda code: self.reported.append((name, code))

    def write(self, name: str, address: Address, value: int) -> None:
        size = 2 if address == od.CONTROLWORD else 4
        self.stores[name].write(address, value.to_bytes(size, "little", signed=value < 0))
        self.drives[name].refresh(self.now)

    def run(self, milliseconds: int) -> None:
        for _ in range(milliseconds):
            end = self.now + MILLISECOND
            while self.now < end:
                self.now, woken = self.bank.advance(end)
                for name in woken or self.drives:
                    self.drives[name].refresh(self.now)
            self.speeds.append(self.plant.outputs[-1])

    def largest_acceleration(self) -> float:
        """Return the largest change of speed over 50 ms, m/s2."""
        speeds = self.speeds
        changes = (abs(b - a) for a, b in zip(speeds, speeds[WINDOW_MS:], strict=False))
        return max(changes) / (WINDOW_MS / 1000)


@pytest.fixture
def rars() -> Iterator[Rars]:
    robot = Rars()
    yield robot
    robot.plant.close()


@pytest.mark.parametrize(("left", "right"), [(2480, 2480), (-2480, -2480), (3700, 1200), (100, 100)])
@pytest.mark.parametrize("quick_stop", [0, 1], ids=["ramp down", "quick stop"])
def test_the_platform_accelerates_less_than_its_limit(
    rars: Rars, left: int, right: int, quick_stop: int
) -> None:
    for name, rpm in zip(WHEELS, (left, right), strict=True):
        rars.write(name, od.TARGET_VELOCITY, rpm)
    rars.run(800)
    for name in WHEELS:
        if quick_stop:
            rars.write(name, od.CONTROLWORD, 0x02)
        else:
            rars.write(name, od.TARGET_VELOCITY, 0)
    rars.run(800)
    # Thesis 2.3.1: 0.144 g.
    assert rars.largest_acceleration() < 0.144 * 9.81
    assert rars.reported == []


@pytest.mark.parametrize("payload", [0.0, 10.0])
def test_the_wheels_hold_their_speed(payload: float) -> None:
    rars = Rars(platform_mass=70.0 + payload)
    for name in WHEELS:
        rars.write(name, od.TARGET_VELOCITY, 1490)
    rars.run(1000)
    # 300 mm/s; the thesis' wheel radius and gear.
    assert min(rars.speeds[-200:]) == pytest.approx(0.3, rel=0.01)
    assert max(rars.speeds[-200:]) == pytest.approx(0.3, rel=0.01)
    rars.plant.close()


def test_the_wheels_are_quiet_at_rest(rars: Rars) -> None:
    for name in WHEELS:
        rars.write(name, od.TARGET_VELOCITY, 1000)
    rars.run(500)
    for name in WHEELS:
        rars.write(name, od.TARGET_VELOCITY, 0)
    rars.run(1000)
    axis = rars.axes["left"]
    positions = []
    for _ in range(1000):
        rars.run(1)
        positions.append(axis.position)
    # One quadcount is 6 um of way.
    assert max(positions) - min(positions) <= 3
    assert abs(axis.current_average >> 16) < 500


@pytest.mark.parametrize(
    ("name", "targets"),
    [("steer", (100, 40_000, -40_000, -40_010)), ("lift", (500, 20_000, 200_000, 0))],
)
def test_steering_and_lift_reach_their_targets(rars: Rars, name: str, targets: tuple[int, ...]) -> None:
    for target in targets:
        way = abs(target - rars.axes[name].position)
        rars.write(name, od.TARGET_POSITION, target)
        rars.write(name, od.CONTROLWORD, 0x3F)
        rars.run(25)
        rars.write(name, od.CONTROLWORD, 0x0F)
        rars.run(way // 20 + 500)
        seen = []
        for _ in range(100):
            rars.run(1)
            seen.append(rars.axes[name].position)
        assert max(abs(position - target) for position in seen) <= 10
        assert rars.stores[name].get(od.STATUSWORD) & 0x0400
    assert rars.reported == []
