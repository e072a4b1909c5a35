"""A plant without an FMU: DC motors with a rigid load each, solved exactly from tick to tick.

Linear between ticks (voltage and friction torque constant), so the step is one 3x3 matrix per motor. It
serves tests of the regulators and single drives; robots come as FMUs.
"""

from array import array
from dataclasses import dataclass
from math import copysign
from typing import Final

from emulators.servo.axis import TICK
from firmware_bridge.units import Nanoseconds, to_seconds

_TERMS: Final = 24
_HALVINGS: Final = 6


@dataclass(frozen=True, slots=True)
class DcMotor:
    """Winding and load at the shaft: Ohm, H, N m/A, kg m2, N m, N m s/rad."""

    resistance: float
    inductance: float
    torque_constant: float
    inertia: float
    friction: float = 0.0
    damping: float = 0.0


MOTOR: Final = DcMotor(
    resistance=1.0, inductance=0.5e-3, torque_constant=0.04, inertia=2e-5, friction=1e-3, damping=1e-5
)
"""A motor that the drive's default gains can turn, and no particular one: Ohm, H, N m/A, kg m2, N m."""
SUPPLY_MV: Final = 24_000
"""Supply of that motor."""


class DcMotors:
    """Motors side by side. Inputs: voltages; outputs: currents, angles, speeds, each in the motors' order."""

    def __init__(self, motors: tuple[DcMotor, ...], step: Nanoseconds = TICK) -> None:
        count = len(motors)
        self.inputs = array("d", [0.0] * count)
        self.outputs = array("d", [0.0] * (3 * count))
        self.load = [0.0] * count
        """External torque at each shaft, N m, positive with the motor."""
        self.steps_done = 0
        self._tick = step
        self._motors = motors
        self._solutions = [_solution(motor, to_seconds(step)) for motor in motors]

    def becomes(self, at: int, motor: DcMotor) -> None:
        """Put another motor in the place of one: a short in its winding, a broken belt."""
        self._motors = (*self._motors[:at], motor, *self._motors[at + 1 :])
        self._solutions[at] = _solution(motor, to_seconds(self._tick))

    def step(self) -> None:
        """Advance one tick with the voltages in `inputs`."""
        count, inputs, outputs = len(self._motors), self.inputs, self.outputs
        for k, motor in enumerate(self._motors):
            current, speed, volts, load = outputs[k], outputs[2 * count + k], inputs[k], self.load[k]
            if current == speed == volts == load == 0.0:
                continue  # it stands, and nothing moves it
            drive = motor.torque_constant * current + load
            if speed == 0.0:
                stuck = abs(drive) <= motor.friction
                torque = -drive if stuck else load - copysign(motor.friction, drive)
                # The matrix adds the motor's own torque: at a stuck shaft the sum has to be 0.
                torque = -motor.torque_constant * current if stuck else torque
            else:
                stuck = False
                torque = load - copysign(motor.friction, speed)
            row_i, row_w, row_a = self._solutions[k]
            after = row_w[0] * current + row_w[1] * speed + row_w[2] * volts + row_w[3] * torque
            # Friction stops a shaft; it does not turn it back.
            if stuck or (motor.friction > 0.0 and after * speed < 0.0):
                after = 0.0
            outputs[k] = row_i[0] * current + row_i[1] * speed + row_i[2] * volts + row_i[3] * torque
            if not stuck:
                turned = row_a[0] * current + row_a[1] * speed + row_a[2] * volts + row_a[3] * torque
                outputs[count + k] += turned
            outputs[2 * count + k] = after
        self.steps_done += 1


def _solution(motor: DcMotor, step: float) -> list[tuple[float, ...]]:
    """Return rows for current, speed and turned angle over (current, speed, voltage, torque)."""
    winding, inertia = 1.0 / motor.inductance, 1.0 / motor.inertia
    # State: current, speed, angle, voltage (constant), torque (constant).
    rates = [
        [-motor.resistance * winding, -motor.torque_constant * winding, 0.0, winding, 0.0],
        [motor.torque_constant * inertia, -motor.damping * inertia, 0.0, 0.0, inertia],
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0] * 5,
        [0.0] * 5,
    ]
    # Scaling and squaring: for 1/64 of the step 24 terms of the series are plenty.
    part = step / 2**_HALVINGS
    total = [[float(i == j) for j in range(5)] for i in range(5)]
    term = total
    for order in range(1, _TERMS):
        term = _product(term, [[value * part / order for value in row] for row in rates])
        total = [[a + b for a, b in zip(x, y, strict=True)] for x, y in zip(total, term, strict=True)]
    for _ in range(_HALVINGS):
        total = _product(total, total)
    return [tuple(total[row][column] for column in (0, 1, 3, 4)) for row in (0, 1, 2)]


def _product(left: list[list[float]], right: list[list[float]]) -> list[list[float]]:
    columns = list(zip(*right, strict=True))
    return [[sum(a * b for a, b in zip(row, column, strict=True)) for column in columns] for row in left]
