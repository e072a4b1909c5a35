"""The joints of an arm on an FMU: what each pulse does to its motor's field, and where that takes the arm.

The plant is the truth here: a rotor follows its field or does not, and a switch closes where the joint is. It
goes on in steps of half a millisecond, and a pulse counts from the step in which it falls.
"""

import math
from collections.abc import Sequence
from typing import Final

from emulators.arduino_omni.ar2.axes import AXES, JOINTS, OVERDRIVE
from emulators.arduino_omni.ar2.board import Ar2Board
from emulators.arduino_omni.ar2.joints import Joints
from firmware_bridge.units import MICROSECOND, Nanoseconds
from fmu.plant import FmuPlant

STEP: Final[Nanoseconds] = 500 * MICROSECOND
HALF_STEP: Final = math.tau / 400.0
"""Half step of a motor's shaft, rad."""
FIELDS: Final = tuple(f"field_j{joint}" for joint in range(1, 7))
ANGLES: Final = tuple(f"angle_j{joint}" for joint in range(1, 7))
CURRENT: Final = "current_on"
INPUTS: Final = (*FIELDS, CURRENT)


class PlantJoints(Joints):
    """Joints whose places are the plant's; the track is not on it."""

    def __init__(self, plant: FmuPlant, *, leads: bool = True) -> None:
        """Stand where the plant begins. `leads`: they step the plant; otherwise another device does."""
        super().__init__()
        self.swings = True
        self._plant: Final = plant
        self._fields: Final = [plant.input_names.index(name) for name in FIELDS]
        self._angles: Final = [plant.output_names.index(name) for name in ANGLES]
        self._current: Final = plant.input_names.index(CURRENT)
        self._leads: Final = leads
        self._reached: Nanoseconds = 0
        # The arm's drivers have their current before the board runs, or it would fall at the start.
        plant.inputs[self._current] = 1.0
        self._look()

    def reach(self, now: Nanoseconds) -> None:
        """Let the arm go on up to `now`, in whole steps."""
        while self._leads and self._reached + STEP <= now:
            self._plant.step()
            self._reached += STEP

    def reached(self, joint: int) -> bool:
        """Return whether a joint is at its switch."""
        self._look()
        return super().reached(joint)

    def pulse(self, axis: int, level: int, at: Nanoseconds) -> None:
        """Turn a motor's field by half a step; the track moves nothing."""
        self.pulses[axis] += 1
        if axis >= len(JOINTS):
            return
        # The field turns at the pulse's own step, not at that of the next look.
        self.reach(at)
        ahead = 1.0 if level == AXES[axis].ahead_level else -1.0
        place = self._fields[axis]
        self._plant.inputs[place] = self._plant.inputs[place : place + 1][0] + ahead * HALF_STEP

    def switch_current(self, *, on: bool) -> None:
        """Give the drivers their current, or take it: the arm falls then."""
        self.powered = on
        self._plant.inputs[self._current] = float(on)

    def _look(self) -> None:
        for joint, axis in enumerate(JOINTS):
            output = self._angles[joint]
            angle = math.degrees(self._plant.outputs[output : output + 1][0])
            place = round((angle - axis.least_deg) / axis.per_step_deg)
            # Within what the switches and stops of the count know; the plant's stops are elastic.
            self.places[joint] = min(max(place, -OVERDRIVE), axis.steps + OVERDRIVE)


class StepperMotor:
    """One joint's motor on its driver, which keeps its current whatever the board does."""

    def __init__(self, name: str, board: Ar2Board) -> None:
        self.name: Final = name
        self._board: Final = board

    @property
    def powered(self) -> bool:
        """True while its board is in the middle of a move."""
        return self._board.moves

    def swap_channels(self, *, swapped: bool) -> None:
        """Do nothing: it has no encoder."""


class SteppedJoints:
    """Physics between two events: the board with its arm."""

    def __init__(self, board: Ar2Board, joints: PlantJoints, axes: Sequence[str]) -> None:
        self.axes: Final = tuple(StepperMotor(name, board) for name in axes)
        self._board: Final = board
        self._joints: Final = joints

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Advance to `until`; the board requests its own wake when it may have something to send."""
        self._board.advance(until)
        self._joints.reach(until)
        return until, ()
