"""What the shaft does in each mode of operation, once the drive is enabled.

Profile position, profile velocity, position, velocity and current mode. In the other modes that an EPOS2
lists (homing, interpolated position, diagnostic, master encoder, step/direction) the drive shows the mode and
holds its position, as a real one does before its start signal; the start signal is not heeded yet.
Source: EPOS Firmware Specification, chapters of the modes (by analogy).
"""

from typing import Final

from emulators.epos2.store import ObjectStore
from emulators.servo.axis import (
    CURRENT,
    DIRECT,
    IDLE,
    MOVE,
    PROFILE_DONE,
    RAMP,
    TARGET_REACHED,
    ServoAxis,
)
from emulators.servo.commands import brake, judge_anew, regulate_position, regulate_velocity
from emulators.servo.profile import stopping_distance
from emulators.servo.scaling import acceleration_units, speed_units
from firmware_bridge.wire.cia402 import Control, Mode
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address

# The controlword's bits as plain numbers: flags are slow, and every set-point is looked at.
_HALT: Final = int(Control.HALT)
_NEW_SETPOINT: Final = int(Control.NEW_SETPOINT)
_CHANGE_IMMEDIATELY: Final = int(Control.CHANGE_IMMEDIATELY)
_RELATIVE: Final = int(Control.RELATIVE)
LOWEST: Final = -(1 << 31)
HIGHEST: Final = (1 << 31) - 1


class Motion:
    """Commands one axis in the mode that is set. Every method but `setpoint_taken` needs power."""

    def __init__(self, store: ObjectStore, axis: ServoAxis) -> None:
        self._store = store
        self._axis = axis
        self.mode = int(Mode.PROFILE_POSITION)
        self.halted = False
        self.acknowledged = False
        """Bit 12 of profile position mode: the set-point was taken and bit 4 is still up."""
        self._waiting: tuple[int, bool] | None = None
        """The set-point after the present one: target (qc) and whether it is relative."""
        self._interrupted = False
        self.out_of_limits = False
        """A target lay outside the software position limits 0x607D; cleared by who heeds it."""

    def forget(self) -> None:
        """Drop what was going on: the power stage is off, or a stop has cut in."""
        self.halted = False
        self.acknowledged = False
        self._waiting = None
        self._interrupted = False

    @property
    def arrived(self) -> bool:
        """Bit 10: the target is reached, or the halt has come to its end."""
        flags = self._axis.flags
        if self.halted:
            return bool(flags & PROFILE_DONE) and self._axis.velocity_demand == 0
        return bool(flags & TARGET_REACHED) and self._waiting is None

    @property
    def stopped(self) -> bool:
        """A braking ramp has come to its end."""
        axis = self._axis
        if axis.profile != RAMP or axis.regulator == IDLE:
            return True
        return axis.velocity_demand == 0 and axis.target_velocity == 0

    def begin(self, controlword: int) -> None:
        """Start from standstill or from where the shaft is: the drive has become enabled."""
        self.forget()
        self.halted = bool(controlword & _HALT)
        if self.mode == Mode.PROFILE_VELOCITY:
            regulate_velocity(self._axis)
            self.velocity_target(self._store.get(at.TARGET_VELOCITY))
        elif not self._direct():
            regulate_position(self._axis)
            self.brake(self._store.get(at.PROFILE_DECELERATION))

    def change(self, mode: int, *, enabled: bool) -> None:
        """Take a mode over; under way, the shaft is first brought to rest with 0x6084 (ASSUME)."""
        if mode == self.mode:
            return
        self.mode = mode
        if not enabled:
            return
        halted = self.halted
        self.forget()
        self.halted = halted
        if mode == Mode.PROFILE_VELOCITY:
            regulate_velocity(self._axis)
        elif self._direct():
            return
        else:
            regulate_position(self._axis)
        self.brake(self._store.get(at.PROFILE_DECELERATION))

    def controls(self, controlword: int, before: int) -> bool:
        """Heed halt and the mode's own bits while enabled; say whether a set-point awaits `take_setpoint`."""
        halt = bool(controlword & _HALT)
        profiled = self.mode in (Mode.PROFILE_POSITION, Mode.PROFILE_VELOCITY)
        if halt != self.halted and profiled:
            self.halted = halt
            if halt:
                self._halt()
            elif self.mode == Mode.PROFILE_POSITION:
                self._release()
        if self.mode == Mode.PROFILE_VELOCITY:
            self.velocity_target(self._store.get(at.TARGET_VELOCITY))
            return False
        if not controlword & _NEW_SETPOINT:
            self.acknowledged = False
            return False
        rising = not before & _NEW_SETPOINT
        return self.mode == Mode.PROFILE_POSITION and rising

    # Profile velocity mode

    def velocity_target(self, rpm: int) -> None:
        """Ramp to a velocity within 0x607F and 0x6410:4; in a halt the ramp goes to 0."""
        axis = self._axis
        if self.mode != Mode.PROFILE_VELOCITY:
            return
        limit = self._fastest()
        wish = 0 if self.halted else max(-limit, min(limit, speed_units(axis, rpm)))
        if wish != axis.target_velocity or axis.profile != RAMP:
            judge_anew(axis, there=wish == axis.velocity_demand)
        axis.target_velocity = wish
        axis.profile = RAMP
        axis.acceleration = self._acceleration(at.PROFILE_ACCELERATION)
        axis.deceleration = self._acceleration(at.PROFILE_DECELERATION)

    # Profile position mode

    def take_setpoint(self, controlword: int) -> bool:
        """Take the target position: start it, or keep it until the present one is done; False: no room yet.

        In a halt the new set-point takes the place of the interrupted one, and starts when the halt ends.
        """
        setpoint = self._store.get(at.TARGET_POSITION), bool(controlword & _RELATIVE)
        at_once = bool(controlword & _CHANGE_IMMEDIATELY)
        if self.halted:
            self._waiting = setpoint
        elif at_once or self._axis.flags & PROFILE_DONE:
            self._waiting = None
            self._start(*setpoint)
        elif self._waiting is None:
            self._waiting = setpoint
        else:
            return False
        self.acknowledged = True
        return True

    def follow_up(self) -> None:
        """Start the waiting set-point once the present one is done."""
        if self._waiting is not None and not self.halted and self._axis.flags & PROFILE_DONE:
            setpoint, self._waiting = self._waiting, None
            self._start(*setpoint)

    def _start(self, target: int, relative: bool) -> None:  # noqa: FBT001 - the pair that waits, unpacked
        axis = self._axis
        if relative:
            target += (axis.position_demand + (1 << axis.fraction >> 1)) >> axis.fraction
        low, high = self._limits()
        if not max(low, LOWEST) <= target <= min(high, HIGHEST):
            self.out_of_limits = True
            return
        axis.target_position = target << axis.fraction
        self._go_on()

    def _go_on(self) -> None:
        axis = self._axis
        axis.cruise = min(speed_units(axis, self._store.get(at.PROFILE_VELOCITY)), self._fastest())
        axis.acceleration = self._acceleration(at.PROFILE_ACCELERATION)
        axis.deceleration = self._acceleration(at.PROFILE_DECELERATION)
        axis.stopping_distance = stopping_distance(axis.cruise, axis.deceleration)
        axis.profile = MOVE
        judge_anew(axis, there=False)

    # Halt and other braking

    def _halt(self) -> None:
        axis = self._axis
        self._interrupted = axis.profile == MOVE and not axis.flags & PROFILE_DONE
        self.brake(self._store.get(at.PROFILE_DECELERATION))

    def _release(self) -> None:
        """End a halt: go on with what it interrupted, or with the set-point that came meanwhile."""
        if self._waiting is not None:
            setpoint, self._waiting = self._waiting, None
            self._start(*setpoint)
        elif self._interrupted:
            self._go_on()

    def brake(self, rpm_per_second: int) -> None:
        """Ramp to standstill and hold."""
        brake(self._axis, rpm_per_second)

    # Direct modes

    def setting(self, address: Address, value: int) -> None:
        """Take a new set value of position, velocity or current mode."""
        axis = self._axis
        if address == at.POSITION_MODE_SETTING and self.mode == Mode.POSITION:
            low, high = self._limits()
            axis.position_demand = axis.target_position = max(low, min(high, value)) << axis.fraction
            axis.velocity_demand = 0
        elif address == at.VELOCITY_MODE_SETTING and self.mode == Mode.VELOCITY:
            limit = axis.speed_limit
            axis.velocity_demand = max(-limit, min(limit, speed_units(axis, value)))
            axis.target_velocity = axis.velocity_demand
        elif address == at.CURRENT_MODE_SETTING and self.mode == Mode.CURRENT:
            axis.current_setting_ma = value

    def _direct(self) -> bool:
        """Start position, velocity or current mode with the value that its object holds."""
        if self.mode == Mode.POSITION:
            regulate_position(self._axis)
            address = at.POSITION_MODE_SETTING
        elif self.mode == Mode.VELOCITY:
            regulate_velocity(self._axis)
            address = at.VELOCITY_MODE_SETTING
        elif self.mode == Mode.CURRENT:
            self._axis.regulator = CURRENT
            self._axis.velocity_demand = 0
            address = at.CURRENT_MODE_SETTING
        else:
            return False
        self._axis.profile = DIRECT
        self.setting(address, self._store.get(address))
        return True

    def _limits(self) -> tuple[int, int]:
        return self._store.get(at.MIN_POSITION_LIMIT), self._store.get(at.MAX_POSITION_LIMIT)

    def _fastest(self) -> int:
        return min(speed_units(self._axis, self._store.get(at.MAX_PROFILE_VELOCITY)), self._axis.speed_limit)

    def _acceleration(self, address: Address) -> int:
        return acceleration_units(self._axis, self._store.get(address))
