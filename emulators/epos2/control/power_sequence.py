"""The power sequence: transitions in their order, what they do to stage and brake, ramps before power goes.

The rules are rows in `power_states`; here is their order in time. Not known here: who commands and which
errors stand, and objects other than the option codes and decelerations that its ramps need.
"""

from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.option_codes import RAMP_OPTIONS
from emulators.canopen.power_states import Happening, PowerStageEffect, RampOption, Transition, Trigger
from emulators.drive.mode_selector import ModeSelector
from emulators.epos2.control.power_states import LEAVING, TIMED, Delays
from emulators.epos2.io.drive_pins import Pins
from emulators.servo.axis import ServoAxis
from emulators.servo.sensors import align
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import ControlwordCommand, PowerState
from firmware_bridge.families.epos2.wire.functions import OutputFunction
from firmware_bridge.families.epos2.wire.power_states import STATUSWORDS
from firmware_bridge.units import NEVER, Nanoseconds

_FAULTS: Final = frozenset(
    {PowerState.FAULT, PowerState.FAULT_REACTION_ENABLED, PowerState.FAULT_REACTION_DISABLED}
)


class PowerSequence:
    """The state of one drive, and what moves it."""

    def __init__(
        self, store: ObjectStore, axis: ServoAxis, modes: ModeSelector, pins: Pins, delays: Delays
    ) -> None:
        self._store = store
        self._outputs = pins.outputs
        self._brake = pins.brake
        self._axis = axis
        self._modes = modes
        self._delays = delays
        self.state = PowerState.START
        self.word = STATUSWORDS[PowerState.START]
        """The state's bits of the statusword."""
        self.controlword = 0
        """The latest one; a halt in it counts once the drive is enabled."""
        self.releasing = False
        """The holding brake is on its way to be released."""
        self._ways_out = LEAVING[self.state]
        self._due: Nanoseconds = NEVER
        """Time at which the present state ends by itself."""
        self._completing: Transition | None = None
        """A transition whose slow-down ramp runs."""

    @property
    def due(self) -> Nanoseconds:
        """Time at which a state or the brake's action ends by itself."""
        return min(self._due, self._brake.due)

    @property
    def free(self) -> bool:
        """True if it is enabled, and no transition is under way: the modes may move the shaft."""
        enabled = self.state is PowerState.OPERATION_ENABLED
        return enabled and self._completing is None and not self.releasing

    @property
    def under_way(self) -> bool:
        """True if a slow-down ramp or the brake holds up a command."""
        return self._completing is not None or self.releasing

    def heeds(self, trigger: Trigger) -> bool:
        """Return whether this leads out of the present state now."""
        return self._completing is None and trigger in self._ways_out

    def restart(self) -> None:
        """Transition 19: begin as after power-on."""
        self.controlword = 0
        self._completing = None
        self.releasing = False
        self._enter(PowerState.START)

    def go(self, trigger: Trigger) -> None:
        """Follow the row that leads out of the present state on this, if there is one."""
        row = self._ways_out.get(trigger)
        if row is None:
            return
        # A fitted brake closes before a command removes the power; a fault with reaction D waits for nothing.
        held = (
            row.stage is PowerStageEffect.OFF
            and isinstance(trigger, ControlwordCommand)
            and self._brake.fitted
        )
        if held or self._slows_down(row.ramp):
            self._completing = row
            # Transition 12: the ramp with 0x6085 is under way, and 0x6084 must not replace it.
            if self.state is not PowerState.QUICK_STOP_ACTIVE:
                self._modes.shaft.brake()
            return
        self._complete(row)
        if row.goes_on:
            self.go(trigger)

    def fault(self, deceleration: Address | None) -> None:
        """Execute transitions 13 and 17: brake with the object's deceleration, or without one power off."""
        # Transition 17 replaces a slow-down (605B, 605C) that is under way.
        self._completing = None
        self.give_up_release()
        self.go(Happening.FAULT)
        if self.state is PowerState.FAULT_REACTION_ENABLED:
            if deceleration is None:
                # Reaction D of the emergency table: no ramp, transition 18 at once.
                self.go(Happening.REACTED)
            else:
                self._stop(deceleration)

    def give_up_release(self) -> None:
        """Wait for the holding brake no longer."""
        self.releasing = False
        self._brake.interrupt()

    def complete_one(self) -> bool:
        """Complete one thing that is due: a timed state, a release, a ramp; say whether there was one."""
        # One step per call: each may make the next one due, and the caller looks at the inputs in between.
        if self.state in TIMED and self._axis.now >= self._due:
            self.go(TIMED[self.state])
        elif self.releasing and self._brake.released():
            self.releasing = False
            self._modes.begin(self.controlword)
        elif self._completing is not None and self._at_rest():
            self._complete(self._completing)
        elif self.state is PowerState.FAULT_REACTION_ENABLED and self._at_rest():
            self.go(Happening.REACTED)
        else:
            return False
        return True

    def _at_rest(self) -> bool:
        return self._modes.shaft.stopped and self._brake.closes()

    def _slows_down(self, ramp: RampOption) -> bool:
        return ramp is not RampOption.NONE and self._store.get(RAMP_OPTIONS[ramp]) == 1

    def _complete(self, row: Transition) -> None:
        self._completing = None
        if row.stage is PowerStageEffect.ON:
            self._axis.switch_on()
            # Transition 20: sinus commutation starts from the
            # present hall pattern, before a current is demanded.
            align(self._axis)
        # Most rows with OFF start from a stage that is off already: brake and modes stay as they are.
        elif row.stage is PowerStageEffect.OFF and self._axis.powered:
            self._brake.close()
            self.releasing = False
            self._axis.switch_off()
            self._modes.forget()
        self._enter(row.target)

    def _enter(self, state: PowerState) -> None:
        self.state, self.word, self._ways_out = state, STATUSWORDS[state], LEAVING[state]
        self._outputs.show(OutputFunction.READY, active=state not in _FAULTS)
        self._due = NEVER
        if state in TIMED:
            self._due = self._axis.now + self._delays.of(state, self._store.get(od.MOTOR_TYPE))
        elif state is PowerState.OPERATION_ENABLED:
            # The motor holds the load by itself until the brake is open: set-points wait for 0x2100:1.
            self.releasing = self._brake.release()
            if self.releasing:
                self._modes.hold()
            else:
                self._modes.begin(self.controlword)
        elif state is PowerState.QUICK_STOP_ACTIVE:
            # The EPOS2 has no 0x605A: a quick stop ramps with 0x6085 and stays in this state, powered.
            self._stop(od.QUICK_STOP_DECELERATION)

    def _stop(self, deceleration: Address) -> None:
        self._modes.forget()
        self._modes.shaft.brake(deceleration)
