"""The arm's true position: the effect of each pulse, and the state of its switches.

A motor that needs more torque than it has at that speed stays where it is, and so does one at its stop: the
step is lost, and the board has no feedback of it. Without current none moves.

Where the sources are silent:
* a step is lost when the weight at the joint alone is more than the motor's torque at its mean speed over 8
  pulses: they are the turn of its field, by which a rotor may be out before it falls behind. The links' own
  inertia is left out, and so is the fall of an arm that nothing holds.
"""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Final

from emulators.arduino_omni.ar2.axes import AXES, HALF_STEPS, JOINTS, OVERDRIVE
from emulators.arduino_omni.ar2.gravity import weight
from emulators.arduino_omni.mega.pins import Shafts
from firmware_bridge.units import SECOND, Nanoseconds

Weight = Callable[[Sequence[float]], Sequence[float]]
FIELD: Final = 8
"""Half steps in a turn of a motor's field."""
_SWITCHES: Final = {axis.switch_pin: place for place, axis in enumerate(JOINTS)}


class Joints(Shafts):
    """Seven axes on their drivers."""

    def __init__(
        self,
        load: Weight = weight,
        places: Sequence[int] | None = None,
        on_count: Callable[[int, int, Nanoseconds], None] | None = None,
    ) -> None:
        """Begin at `places`, in steps from the lower end; by default at the rest positions.

        `load` is in N m by angles in degrees. `on_count` is called for each pulse with the axis, the
        direction (1 for ahead, or -1) and the time.
        """
        super().__init__(())
        self.places: Final = [axis.rest for axis in AXES] if places is None else list(places)
        self.pulses: Final = [0] * len(AXES)
        """Pulses that each driver has received."""
        self.lost: Final = [0] * len(AXES)
        self.open_switches: Final[set[int]] = set()
        """Joints, from 0, whose switch's wire is broken: such a one reads as reached."""
        self.swings = False
        """True if the arm moves between two pulses, too."""
        self.powered = True
        """True if the drivers have their current."""
        self._load: Final = load
        self._on_count: Final = on_count
        self._pulsed_at: Final = [deque([-SECOND], FIELD) for _ in AXES]

    @property
    def angles(self) -> tuple[float, ...]:
        """Angles of the six joints, in degrees."""
        return tuple(axis.angle(place) for axis, place in zip(JOINTS, self.places, strict=False))

    def reached(self, joint: int) -> bool:
        """Return whether a joint is at its switch."""
        axis, place = JOINTS[joint], self.places[joint]
        return place >= axis.steps - OVERDRIVE if axis.switch_at_most else place <= OVERDRIVE

    def level(self, pin: int) -> bool | None:
        """Return what a switch puts on a pin: it opens where it is reached, and the pull-up makes it high."""
        joint = _SWITCHES.get(pin)
        return None if joint is None else joint in self.open_switches or self.reached(joint)

    def pulse(self, axis: int, level: int, at: Nanoseconds) -> None:
        """Take a rise of a driver's step pin, with its direction pin at `level`."""
        row = AXES[axis]
        ahead = 1 if level == row.ahead_level else -1
        pulsed_at = self._pulsed_at[axis]
        # Full steps a second, mean of the last eight half steps.
        speed = len(pulsed_at) * SECOND / HALF_STEPS / max(at - pulsed_at[0], 1)
        pulsed_at.append(at)
        self.pulses[axis] += 1
        if self._on_count is not None:
            self._on_count(axis, ahead, at)
        place = self.places[axis] + ahead
        # The switches lie 21 steps before the stops.
        if self._moves(axis, ahead, speed) and -OVERDRIVE <= place <= row.steps + OVERDRIVE:
            self.places[axis] = place
        else:
            self.lost[axis] += 1

    def _moves(self, axis: int, ahead: int, full_steps_per_s: float) -> bool:
        if not self.powered:
            return False
        if axis >= len(JOINTS):
            return True
        torque = AXES[axis].torque(full_steps_per_s)
        return torque > 0.0 and ahead * self._load(self.angles)[axis] <= torque
