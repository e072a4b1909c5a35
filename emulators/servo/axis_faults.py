"""Faults around one axis, for a bench test to set: rails, air, its sensors' wires, the motor that is mounted.

All of it is state of the axis, so it is kept and put back with everything else. It does not know the drive's
reaction.
"""

from collections.abc import Collection
from dataclasses import dataclass
from enum import Enum
from typing import Final

from emulators.servo.axis import SWAPPED, ServoAxis
from emulators.servo.sensors import (
    AUXILIARY_SWAPPED,
    BROKEN,
    HALL_HIGH,
    HALL_LOW,
    INDEX_MISSING,
    INDEX_SPURIOUS,
    PER_MILLE,
)

HALL_SENSORS: Final = (1, 2, 3)


class IndexPulse(Enum):
    """State of the encoder's index."""

    SOUND = 0
    MISSING = INDEX_MISSING
    SPURIOUS = INDEX_SPURIOUS


@dataclass(frozen=True, slots=True)
class SensorWires:
    """The cables between an axis' sensors and its drive; as it stands, nothing is wrong with them."""

    broken: bool = False
    """The encoder's cable is cut."""
    swapped: bool = False
    """The encoder's channels A and B are exchanged."""
    index: IndexPulse = IndexPulse.SOUND
    lost_per_mille: int = 0
    """Number of quadcounts in a thousand that do not arrive."""
    auxiliary_swapped: bool = False
    """The auxiliary encoder's channels are exchanged."""
    hall_high: Collection[int] = ()
    """Hall sensors, 1 to 3, that always show 1; all three of them: no cable."""
    hall_low: Collection[int] = ()
    """Hall sensors that always show 0."""

    def __post_init__(self) -> None:
        """Refuse what no cable does: ValueError."""
        if not 0 <= self.lost_per_mille <= PER_MILLE:
            raise ValueError(f"of 1000 counts 0 to 1000 are lost, not {self.lost_per_mille}")
        if strange := {*self.hall_high, *self.hall_low} - {*HALL_SENSORS}:
            raise ValueError(f"hall sensors are 1, 2 and 3, not {sorted(strange)}")


class AxisFaults:
    """The world around one axis. Temperatures in degree Celsius, voltages in V."""

    def __init__(self, axis: ServoAxis) -> None:
        self._axis: Final = axis

    def air(self, celsius: float) -> None:
        """Set the temperature at the drive's heat sink."""
        self._axis.ambient_mc = round(celsius * 1000)

    def logic_supply(self, volts: float) -> None:
        """Set the drive's own 5 V supply, which a short in a sensor's cable pulls down."""
        self._axis.logic_mv = round(volts * 1000)

    def gate_supply(self, volts: float) -> None:
        """Set the supply of the power stage's gate drivers."""
        self._axis.gate_mv = round(volts * 1000)

    def wires(self, sensors: SensorWires) -> None:
        """Lay these cables in the place of the present ones."""
        faults = (BROKEN if sensors.broken else 0) | (SWAPPED if sensors.swapped else 0) | sensors.index.value
        faults |= AUXILIARY_SWAPPED if sensors.auxiliary_swapped else 0
        for first, stuck in ((HALL_HIGH, sensors.hall_high), (HALL_LOW, sensors.hall_low)):
            for sensor in stuck:
                faults |= 1 << first + sensor - 1
        self._axis.sensor_faults = faults
        self._axis.encoder_loss = sensors.lost_per_mille

    def motor(self, *, pole_pairs: int) -> None:
        """Mount a motor with so many pole pairs; 0: those in 0x6410:3."""
        self._axis.mounted_pole_pairs = pole_pairs
