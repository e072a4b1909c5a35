"""Supervision of a motor below a drive: with the stage off its winding takes no energy from the shaft."""

from typing import Final

from emulators.servo.axis import ServoAxis
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.winding import DIODES_MV
from firmware_bridge.units import MILLISECOND, Nanoseconds

DIED_OUT: Final[Nanoseconds] = 5 * MILLISECOND
"""Time after which an inductive current has died out: at most some 0.5 ms against the supply."""
LEAK_A: Final = 0.05
"""A millivolt of rounding, and what friction slows the shaft down by within one tick."""
SHARE, LITTLE_J = 1e-4, 2e-5


class WatchedWinding:
    """One motor without a load of its own: its energy (J) and current (A) from advance to advance."""

    def __init__(self, plant: DcMotors, motor: DcMotor, axis: ServoAxis) -> None:
        self.most_a = 0.0
        """The largest current that was seen with the stage off, once the inductive one had died."""
        self.off_frames = 0
        self._plant: Final = plant
        self._motor: Final = motor
        self._axis: Final = axis
        self._off_since: Nanoseconds | None = 0
        self._before = 0.0

    def stored(self) -> float:
        """Return the energy of winding and rotor."""
        current, _, speed = self._plant.outputs[:3]
        return (self._motor.inductance * current**2 + self._motor.inertia * speed**2) / 2

    def begins(self) -> None:
        """Remember what is there before an advance."""
        if self._axis.powered:
            self._off_since = None
        elif self._off_since is None:
            self._off_since = self._axis.now
        self._before = self.stored()

    def ends(self) -> None:
        """Judge what the advance has done to a winding whose stage was off; AssertionError."""
        current, _, speed = self._plant.outputs[:3]
        widest = (self._axis.supply_mv + DIODES_MV) / 1000
        back_emf = self._motor.torque_constant * abs(speed)
        assert abs(current) <= (widest + back_emf) / self._motor.resistance
        if self._off_since is None:
            return
        self.off_frames += 1
        after = self.stored()
        assert after <= self._before * (1 + SHARE) + LITTLE_J, (
            f"{after - self._before:g} J with the stage off"
        )
        if self._axis.now - self._off_since > DIED_OUT:
            into_the_supply = max(0.0, back_emf - widest) / self._motor.resistance
            self.most_a = max(self.most_a, abs(current))
            assert abs(current) <= LEAK_A + into_the_supply, f"{current:g} A with the stage off"
