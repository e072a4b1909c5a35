"""The power machine at work: one controlword after the other, ramps before power goes, faults, resets.

The rules are rows in `emulators.epos2.power`; here is their order in time. It refuses to know objects other
than the option codes and decelerations that its ramps need.
"""

from collections.abc import Callable
from typing import Final

from emulators.epos2 import contradictions, supervision
from emulators.epos2.modes.motion import Motion
from emulators.epos2.pins import Pins
from emulators.epos2.power import LEAVING, TIMED, Delays, Happening, Ramp, Stage, Transition, Trigger
from emulators.epos2.standing_errors import StandingErrors
from emulators.epos2.store import ObjectStore
from emulators.epos2.supervision import WATCHED, Reaction
from emulators.servo.axis import ServoAxis
from emulators.servo.sensors import align
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.cia402 import Command, Control, State, command_of
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2 import emergency
from firmware_bridge.wire.epos2.functions import OutputFunction

# The controlword's bits as plain numbers: flags are slow, and every frame is looked at.
_FAULT_RESET: Final = int(Control.FAULT_RESET)
_NEW_SETPOINT: Final = int(Control.NEW_SETPOINT)
_TRANSIENT: Final = frozenset({*TIMED, State.FAULT_REACTION_ENABLED})
"""States that complete a command or a reaction; a controlword waits for their end."""
_FAULTS: Final = frozenset({State.FAULT, State.FAULT_REACTION_ENABLED, State.FAULT_REACTION_DISABLED})
_WAITING: Final = _TRANSIENT | {State.FAULT}


class PowerMachine:
    """The state of one drive, and what moves it."""

    def __init__(
        self,
        store: ObjectStore,
        axis: ServoAxis,
        motion: Motion,
        pins: Pins,
        report: Callable[[int], None],
        *,
        delays: Delays,
    ) -> None:
        self._store = store
        self._inputs = pins.inputs
        self._outputs = pins.outputs
        self._brake = pins.brake
        self._axis = axis
        self._motion = motion
        self._report = report
        self._delays = delays
        self.state = State.START
        self.word = State.START.value
        """The state's bits of the statusword."""
        self._ways_out = LEAVING[self.state]
        self._due: Nanoseconds = NEVER
        """When the present state ends by itself."""
        self.errors: Final = StandingErrors(store, axis)
        self._controlword = 0
        self._delayed: tuple[int, int] | None = None
        """A controlword that waits until the present command is completed, and the one before it."""
        self._completing: Transition | None = None
        """A transition whose slow-down ramp runs."""
        self._latching = False
        """A rising edge of bit 4 whose target is taken when the whole write has arrived."""
        self._releasing = False
        """The holding brake is on its way to be released."""

    @property
    def due(self) -> Nanoseconds:
        """When something ends by itself."""
        return min(self._due, self._brake.due)

    @property
    def free(self) -> bool:
        """Enabled, and neither on the way in nor out: the modes may move the shaft."""
        enabled = self.state is State.OPERATION_ENABLED
        return enabled and self._completing is None and not self._releasing

    @property
    def _under_way(self) -> bool:
        return self._completing is not None or self._releasing

    def restart(self) -> None:
        """Transition 19: begin as after power-on."""
        self._controlword = 0
        self._delayed = self._completing = None
        self._latching = self._releasing = False
        self.errors.clear()
        self._enter(State.START)
        self.advance()

    # Controlword

    def command(self, word: int) -> None:
        """Take a controlword. While a command is being completed the latest one waits."""
        before, self._controlword = self._controlword, word
        if self.state is State.FAULT:
            if word & ~before & _FAULT_RESET:
                self._reset_fault()
        elif self._releasing and command_of(word) is not Command.ENABLE_OPERATION:
            self._give_up_release()
            self._obey(word, before)
        elif self._under_way or self.state in _TRANSIENT:
            # What waits for the brake keeps its edges; other states have none to keep.
            since = before if self._delayed is None else self._delayed[1]
            self._delayed = word, since if self._releasing else word
        else:
            self._obey(word, before)

    def drop_setpoint(self) -> None:
        """Forget a rising edge of bit 4 that has not been heeded."""
        self._latching = False

    def _obey(self, word: int, before: int) -> None:
        """Carry out a controlword's command, then its mode bits; with bit 7 up it holds neither."""
        if word & _FAULT_RESET:
            return
        was_free = self.free
        self._go(self._admitted(command_of(word)))
        self.advance()
        if was_free and self.free:
            if self._motion.controls(word, before):
                self._latching = True
                # The target may follow in the same PDO: it is taken at the next refresh, in 1 ms at most.
                self._axis.call = 1
            elif not word & _NEW_SETPOINT:
                self._latching = False
            self._heed()

    def _obeys_pins(self) -> bool:
        """Carry out the command that the input pins give; say whether that has moved the machine."""
        command = self._inputs.restriction
        if command is None or self._completing is not None or command not in self._ways_out:
            return False
        self._give_up_release()
        self._go(command)
        return True

    def _give_up_release(self) -> None:
        self._releasing = False
        self._brake.interrupt()

    def _admitted(self, command: Command) -> Command:
        """Return a master's command, or the stronger one that the input pins give."""
        pins = self._inputs.restriction
        return command if pins is None or command is Command.DISABLE_VOLTAGE else pins

    # Transitions

    def _go(self, trigger: Trigger) -> None:
        row = self._ways_out.get(trigger)
        if row is None:
            return
        held = row.stage is Stage.OFF and isinstance(trigger, Command) and self._brake.fitted
        if held or self._slows_down(row.ramp):
            self._completing = row
            if self.state is not State.QUICK_STOP_ACTIVE:
                self._motion.shaft.brake()
            return
        self._complete(row)
        if row.goes_on:
            self._go(trigger)

    def _slows_down(self, ramp: Ramp) -> bool:
        return ramp is not Ramp.NONE and self._store.get(supervision.RAMP_OPTIONS[ramp]) == 1

    def _complete(self, row: Transition) -> None:
        self._completing = None
        if row.stage is Stage.ON:
            self._axis.switch_on()
            align(self._axis)
        elif row.stage is Stage.OFF and self._axis.powered:
            self._brake.close()
            self._releasing = False
            self._axis.switch_off()
            self._motion.forget()
            self._latching = False
        self._enter(row.target)

    def _enter(self, state: State) -> None:
        self.state, self.word, self._ways_out = state, state.value, LEAVING[state]
        self._outputs.show(OutputFunction.READY, active=state not in _FAULTS)
        self._due = NEVER
        if state in TIMED:
            self._due = self._axis.now + self._delays.of(state, self._store.get(at.MOTOR_TYPE))
        if state is State.REFRESH:
            contradiction = contradictions.found(self._store)
            if contradiction is not None:
                self.fail(contradiction)
        elif state is State.OPERATION_ENABLED:
            self._releasing = self._brake.release()
            if self._releasing:
                self._motion.hold()
            else:
                self._motion.begin(self._controlword)
        elif state is State.QUICK_STOP_ACTIVE:
            self._stop(at.QUICK_STOP_DECELERATION)

    def _stop(self, deceleration: at.Address) -> None:
        self._motion.forget()
        self._latching = False
        self._motion.shaft.brake(deceleration)

    def advance(self) -> None:
        """Complete what is due: timed states, slow-down ramps, fault reactions; then the waiting command."""
        if self.free and self._delayed is None and self._inputs.restriction is None:
            return
        while self._complete_one():
            pass

    def _complete_one(self) -> bool:
        if self.state in TIMED and self._axis.now >= self._due:
            self._go(TIMED[self.state])
        elif self._obeys_pins():
            pass
        elif self._releasing and self._brake.released():
            self._releasing = False
            self._motion.begin(self._controlword)
        elif self._completing is not None and self._motion.shaft.stopped and self._brake.closes():
            self._complete(self._completing)
        elif (
            self.state is State.FAULT_REACTION_ENABLED and self._motion.shaft.stopped and self._brake.closes()
        ):
            self._delayed = None
            self._go(Happening.REACTED)
        elif self._delayed is not None and self.state not in _WAITING and not self._under_way:
            delayed, self._delayed = self._delayed, None
            self._obey(*delayed)
        else:
            return False
        return True

    def attend(self) -> None:
        """Take in findings, pins and time, then a set-point that waits; mostly there is none of them."""
        inputs, motion = self._inputs, self._motion
        inputs.refresh()
        if self._axis.flags & WATCHED:
            for code in self.errors.found(self.state):  # each is told once until it is reset
                self.fail(code)
        self._heed()
        self.advance()
        if self.free:
            motion.mode.advance()
            # A rising edge of bit 4 counts with the target that the object holds by now.
            if self._latching and motion.mode.take_setpoint(self._controlword):
                self._latching = False
            self._heed()
        if inputs.executed:
            self._heed_limits()

    # Faults

    def _heed_limits(self) -> None:
        """Stop at a limit switch; asked when every set-point is taken, for it may lead into one."""
        inputs, motion = self._inputs, self._motion
        if not self._axis.powered or self.state is State.FAULT_REACTION_ENABLED:
            return
        met = inputs.limits_met(motion.shaft.heading, motion.mode.sought)
        if met and not inputs.risen:
            motion.shaft.forget_demand()
        for code in met:
            self.fail(code)

    def fail(self, code: int, reaction: Reaction | None = None) -> None:
        """Report an error and bring the motor to rest; without a reaction given, as the table says."""
        self._report(code)
        if reaction is None:
            reaction = self.errors.reaction_to(code)
        if reaction is Reaction.NONE:
            return
        self.errors.note(code)
        if code in supervision.POSITION_LOST:
            self._motion.shaft.referenced = False
        self._motion.mode.fail()
        self._completing = None
        self._delayed = None
        self._give_up_release()
        self._go(Happening.FAULT)
        if self.state is State.FAULT_REACTION_ENABLED:
            if reaction is Reaction.DISABLE:
                self._go(Happening.REACTED)
            else:
                self._stop(supervision.DECELERATIONS[reaction])
        self.advance()

    def _heed(self) -> None:
        """Report what the mode cannot do."""
        shaft = self._motion.shaft
        if shaft.error:
            self.fail(shaft.take_error())

    def _reset_fault(self) -> None:
        if self.errors.curable:
            self.errors.clear()
            self._go(Happening.FAULT_RESET)
            self._report(emergency.NO_ERROR)
