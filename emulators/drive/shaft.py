"""One axis under command, as every mode sees it: the store's limits and ramps, and braking.

Not known here: modes and states.
"""

from dataclasses import dataclass
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.option_codes import HALT
from emulators.drive.inputs import DriveInputs
from emulators.servo import sine
from emulators.servo.axis import (
    CURRENT,
    DIRECT,
    ELECTRONIC_GEAR,
    IDLE,
    MOVE,
    POSITION,
    PROFILE_DONE,
    RAMP,
    SINE,
    SPLINE,
    TARGET_REACHED,
    TRAPEZOID,
    ServoAxis,
)
from emulators.servo.commands import brake, judge_again, regulate_position
from emulators.servo.profile import stopping_distance
from emulators.servo.scaling import acceleration_units, speed_units
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.emergency import NO_ERROR

LONGEST_MOVE_MS: Final = (1 << 31) - 1


@dataclass(frozen=True, slots=True)
class Impossible:
    """A product's emergency codes for moves that cannot be made."""

    outside: int
    """A target outside 0x607D."""
    too_far: int
    """A move longer than the profile's clock runs."""


class Shaft:
    """Axis and store, in the units of the one and the objects of the other."""

    def __init__(
        self, store: ObjectStore, axis: ServoAxis, inputs: DriveInputs, impossible: Impossible
    ) -> None:
        self.store: Final = store
        self.inputs: Final = inputs
        self.axis: Final = axis
        self.impossible: Final = impossible
        self.halted = False
        """Bit 8 of the controlword is up, in a mode that heeds it."""
        self.referenced = False
        """Bit 15: a homing has found where the shaft is. Assumed: by any method; a restart forgets it."""
        self.error = NO_ERROR
        """Emergency code for a request that a mode cannot carry out; see `take_error`."""

    @property
    def stopped(self) -> bool:
        """A braking ramp has come to its end."""
        axis = self.axis
        if axis.profile != RAMP or axis.regulator == IDLE:
            return True
        return axis.velocity_demand == 0 and axis.target_velocity == 0

    @property
    def arrived(self) -> bool:
        """The target is reached, or the halt has come to its end."""
        axis = self.axis
        if self.halted:
            return bool(axis.flags & PROFILE_DONE) and axis.velocity_demand == 0
        return bool(axis.flags & TARGET_REACHED)

    @property
    def heading(self) -> int:
        """The sign of the motion that is demanded, 0 for none."""
        axis = self.axis
        if axis.regulator == CURRENT:
            way = axis.current_setting_ma
        elif axis.profile == MOVE:
            way = axis.target_position - axis.position_demand
        elif axis.profile == DIRECT and axis.regulator == POSITION:
            # Position mode has no profile: its demand is at the
            # target at once, only the shaft shows the direction.
            way = axis.target_position - (axis.position << axis.fraction)
        elif axis.profile in {SPLINE, ELECTRONIC_GEAR}:
            way = axis.velocity_demand
        else:
            way = axis.target_velocity
        return (way > 0) - (way < 0)

    def forget_demand(self) -> None:
        """Take back a demand that the shaft has not followed yet: a stop begins where the shaft is."""
        self.axis.velocity_demand = self.axis.shaft_speed()
        self.axis.position_demand = self.axis.position << self.axis.fraction

    def take_error(self) -> int:
        """Return what a mode cannot do, once."""
        error, self.error = self.error, NO_ERROR
        return error

    def hold(self) -> None:
        """Come to standstill by 0x6084, and hold the position."""
        regulate_position(self.axis)
        self.brake()

    @property
    def halt_deceleration(self) -> Address:
        """The object with the deceleration of a halt: as 0x605D has it, or 0x6084."""
        return HALT.get(self.store.get_or(od.HALT_OPTION, 1), od.PROFILE_DECELERATION)

    def halt(self) -> None:
        """Ramp to standstill as in a halt, and hold."""
        self.brake(self.halt_deceleration)

    def brake(self, address: Address = od.PROFILE_DECELERATION) -> None:
        """Ramp to standstill with the deceleration that an object holds, and hold."""
        rpm_per_second = self.store.get(address)
        if address != od.QUICK_STOP_DECELERATION:
            rpm_per_second = min(rpm_per_second, self.store.get(od.MAX_ACCELERATION))
        axis, shape, before = self.axis, self.axis.shape, self._ramp()
        brake(axis, rpm_per_second)
        # What brakes already goes on: faults that follow each other closely must not begin it ever again.
        if shape == SINE and self._ramp() == before:
            axis.shape = SINE
        else:
            self._shape()

    def move(self, cruise: int, acceleration: Address, deceleration: Address) -> None:
        """Go to the axis' target position with at most `cruise` (velocity units), unless it is too far.

        Assumed: too far is a move beyond the profile's clock of 31 bits of ms.
        """
        axis = self.axis
        axis.cruise = min(cruise, self.fastest())
        # `cruise` is in demand units per ms: the product is the distance of 24.9 days.
        if abs(axis.target_position - axis.position_demand) > axis.cruise * LONGEST_MOVE_MS:
            self.error = self.impossible.too_far
            return
        axis.acceleration = self.acceleration(acceleration)
        axis.deceleration = self.acceleration(deceleration)
        axis.stopping_distance = stopping_distance(axis.cruise, axis.deceleration)
        axis.profile = MOVE
        judge_again(axis, there=False)
        self._shape()

    def ramp(self, velocity: int, acceleration: Address, deceleration: Address) -> None:
        """Go over to `velocity` (velocity units) and keep it."""
        axis = self.axis
        before = self._ramp() if axis.shape == SINE else ()
        if velocity != axis.target_velocity or axis.profile != RAMP:
            judge_again(axis, there=velocity == axis.velocity_demand)
        axis.target_velocity = velocity
        axis.profile = RAMP
        axis.acceleration = self.acceleration(acceleration)
        axis.deceleration = self.acceleration(deceleration)
        # A sin2 ramp that is under way to there already is not begun again.
        if axis.shape != SINE or self._ramp() != before:
            self._shape()

    def _ramp(self) -> tuple[int, ...]:
        axis = self.axis
        shape = self.store.get(od.MOTION_PROFILE_TYPE)
        return axis.profile, axis.target_velocity, axis.acceleration, axis.deceleration, shape

    def _shape(self) -> None:
        """Set the profile of the ramp or move that begins, by 0x6086."""
        if self.store.get(od.MOTION_PROFILE_TYPE) == SINE:
            sine.load(self.axis)
        else:
            self.axis.shape = TRAPEZOID

    def bounded(self, rpm: int) -> int:
        """Return a speed in velocity units, within 0x607F and the motor's."""
        limit = self.fastest()
        return max(-limit, min(limit, speed_units(self.axis, rpm)))

    def fastest(self) -> int:
        """Return the fastest that a profile may go, in velocity units: 0x607F and the motor's."""
        return min(speed_units(self.axis, self.store.get(od.MAX_PROFILE_VELOCITY)), self.axis.speed_limit)

    def acceleration(self, address: Address) -> int:
        """Return the acceleration that an object holds, in units, within 0x60C5.

        Assumed: 0x60C5 limits profiles and halts, and leaves the quick stop 0x6085 as it is.
        """
        limit = self.store.get(od.MAX_ACCELERATION)
        return acceleration_units(self.axis, min(self.store.get(address), limit))

    def limits(self) -> tuple[int, int]:
        """Return the software position limits 0x607D in qc."""
        return self.store.get(od.MIN_POSITION_LIMIT), self.store.get(od.MAX_POSITION_LIMIT)
