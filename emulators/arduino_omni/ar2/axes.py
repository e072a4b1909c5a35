"""Six joints and a track in numbers: how far each goes, in how many steps, on which pins, and how strongly.

Sources: Chris-Annin/AR2, AR2_2.0: the sketch's pins and directions, the GUI's limits, steps and places of
rest.

Where they are silent:
* motors' torques and their fall with the speed, gears' efficiency: orders of magnitude of the kind of motor.
* a switch closes 21 steps before the end of the way, so that the overdrive ends where the GUI counts from;
  the stop is 21 steps behind the end.
* the track has no switch, begins at 0, and never loses a step.
"""

import math
from dataclasses import dataclass
from typing import Final

OVERDRIVE: Final = 21
"""Pulses after a switch was reached."""
STEPS_PER_TURN: Final = 400
"""Half steps of a motor per turn."""
HALF_STEPS: Final = 2
EFFICIENCY: Final = 0.7
NO_TORQUE_AT: Final = 1_500.0
"""Full steps a second at which a motor has no torque left."""


@dataclass(frozen=True, slots=True)
class Axis:
    """A joint, or the track."""

    name: str
    letter: str
    least_deg: float
    """mm for the track, as is all that is in degrees."""
    most_deg: float
    steps: int
    """Number of steps from one end to the other."""
    rest: int
    """Position after the GUI's calibration, in steps from the lower end."""
    step_pin: int
    direction_pin: int
    ahead_digit: int
    """The sketch's `rotdir`: the direction's digit for which it makes the direction's pin LOW."""
    switch_pin: int | None = None
    switch_at_most: bool = False
    """True if the limit switch is at the upper end."""
    torque_nm: float = math.inf
    """Torque of the motor, at rest."""

    @property
    def per_step_deg(self) -> float:
        """Angle of one step."""
        return (self.most_deg - self.least_deg) / self.steps

    @property
    def gear(self) -> float:
        """Turns of the motor for one of the joint."""
        return 360.0 / self.per_step_deg / STEPS_PER_TURN

    @property
    def ahead_level(self) -> int:
        """The direction's pin for more degrees, which are digit 1 as the GUI has its motors."""
        return 1 - self.ahead_digit

    def angle(self, place: int) -> float:
        """Return the angle in degrees of a place in steps."""
        return self.least_deg + place * self.per_step_deg

    def torque(self, full_steps_per_s: float) -> float:
        """Return what is left behind the gear, in N m; none where the motor turns too fast."""
        share = 1.0 - full_steps_per_s / NO_TORQUE_AT
        return self.torque_nm * self.gear * EFFICIENCY * share if share > 0.0 else 0.0


AXES: Final = (
    Axis("J1", "A", -170.0, 170.0, 15_200, 7_600, 2, 3, 1, 14, torque_nm=0.45),
    Axis("J2", "B", -132.0, 0.0, 7_300, 2_322, 4, 5, 1, 15, torque_nm=1.16),
    Axis("J3", "C", 1.0, 141.0, 7_850, 0, 6, 7, 1, 16, switch_at_most=True, torque_nm=0.45),
    Axis("J4", "D", -165.0, 165.0, 15_200, 7_600, 8, 9, 0, 17, torque_nm=0.45),
    Axis("J5", "E", -105.0, 105.0, 4_575, 2_287, 10, 11, 1, 18, torque_nm=0.45),
    Axis("J6", "F", -155.0, 155.0, 6_625, 3_312, 12, 13, 1, 19, switch_at_most=True, torque_nm=0.14),
    Axis("track", "T", 0.0, 403.0, 10_100, 0, 20, 21, 0),
)
JOINTS: Final = AXES[:6]
