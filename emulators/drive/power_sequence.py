"""The power sequence: transitions in their order, what they do to stage and brake, ramps before power goes.

The rules are rows of a product's `PowerStates`; here is their order in time. Not known here: who commands
and which errors stand, and objects other than the option codes and decelerations that its ramps need.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.option_codes import RAMP_OPTIONS, QuickStop
from emulators.canopen.power_states import Happening, PowerStageEffect, RampOption, Transition, Trigger
from emulators.drive.brake import Brake
from emulators.drive.mode_selector import ModeSelector
from emulators.servo.axis import ServoAxis
from emulators.servo.sensors import align
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import ControlwordCommand, PowerState
from firmware_bridge.units import NEVER, Nanoseconds


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerStates:
    """The power states of a product."""

    leaving: Mapping[PowerState, Mapping[Trigger, Transition]]
    """The rows by the state that they leave, and by what they follow."""
    words: Mapping[PowerState, int]
    """The state's bits of the Statusword."""
    timed: Mapping[PowerState, Happening]
    """States that end by themselves; a command that arrives in one waits until then."""
    lasts: Callable[[PowerState], Nanoseconds]
    """How long one of them lasts."""
    entered: Callable[[PowerState], None]
    """Called with each state that begins."""
    quick_stop_lasts: bool = False
    """True if Quick stop active lasts whatever 0x605A holds."""


RESUMES: Final = 16
"""The transition from Quick stop active back to Operation enabled."""


class PowerSequence:
    """The state of one drive, and what moves it."""

    def __init__(
        self, store: ObjectStore, axis: ServoAxis, modes: ModeSelector, brake: Brake, states: PowerStates
    ) -> None:
        self._store = store
        self._brake = brake
        self._axis = axis
        self._modes = modes
        self._states = states
        self._quick_stop: Final = QuickStop(store, lasts=states.quick_stop_lasts)
        self.state = PowerState.START
        self.word = states.words[PowerState.START]
        """The state's bits of the statusword."""
        self.controlword = 0
        """The latest one; a halt in it counts once the drive is enabled."""
        self.releasing = False
        """The holding brake is on its way to be released."""
        self._ways_out = states.leaving[self.state]
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

    @property
    def timed(self) -> bool:
        """True if the present state ends by itself."""
        return self.state in self._states.timed

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
        # Transition 16 is for a quick stop that ends in its own state.
        if row is None or (row.number == RESUMES and not self._quick_stop.lasts):
            return
        # A fitted brake closes before a command removes the power; a fault with reaction D waits for nothing.
        held = (
            row.stage is PowerStageEffect.OFF
            and isinstance(trigger, ControlwordCommand)
            and self._brake.fitted
        )
        if held or self._slows_down(row.ramp):
            self._completing = row
            # Transition 12: the ramp of the quick stop is under way, and 0x6084 must not replace it.
            if self.state is not PowerState.QUICK_STOP_ACTIVE:
                self._modes.shaft.brake()
            return
        self._complete(row)
        if row.goes_on:
            self.go(trigger)

    def fault(self, deceleration: Address | None) -> None:
        """Go to a fault: brake with the object's deceleration, or without one power off."""
        # It replaces a slow-down (605B, 605C) that is under way.
        self._completing = None
        self.give_up_release()
        self.go(Happening.FAULT)
        if self.state is PowerState.FAULT_REACTION_ENABLED:
            if deceleration is None or not self._axis.powered:
                # Without a ramp the reaction is over at once.
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
        if self.timed and self._axis.now >= self._due:
            self.go(self._states.timed[self.state])
        elif self.releasing and self._brake.released():
            self.releasing = False
            self._modes.begin(self.controlword)
        elif self._completing is not None and self._at_rest():
            self._complete(self._completing)
        elif self.state is PowerState.FAULT_REACTION_ENABLED and self._at_rest():
            self.go(Happening.REACTED)
        elif self.heeds(Happening.STOPPED) and not self._quick_stop.lasts and self._at_rest():
            self.go(Happening.STOPPED)
        else:
            return False
        return True

    def _at_rest(self) -> bool:
        return self._modes.shaft.stopped and self._brake.closes()

    def _slows_down(self, ramp: RampOption) -> bool:
        return ramp is not RampOption.NONE and self._store.get_or(RAMP_OPTIONS[ramp], 0) == 1

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
        states = self._states
        self.state, self.word, self._ways_out = state, states.words[state], states.leaving[state]
        states.entered(state)
        self._due = NEVER
        if state in states.timed:
            self._due = self._axis.now + states.lasts(state)
        elif state is PowerState.OPERATION_ENABLED:
            # The motor holds the load by itself until the brake is open: set-points wait for 0x2100:1.
            self.releasing = self._brake.release()
            if self.releasing:
                self._modes.hold()
            else:
                self._modes.begin(self.controlword)
        elif state is PowerState.QUICK_STOP_ACTIVE:
            deceleration = self._quick_stop.deceleration
            if deceleration is not None:
                self._stop(deceleration)
            else:
                self.go(Happening.STOPPED)

    def _stop(self, deceleration: Address) -> None:
        self._modes.forget()
        self._modes.shaft.brake(deceleration)
