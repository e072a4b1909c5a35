"""Device control: controlwords, input pins and errors, one after the other, each moves the power machine.

Source: CiA 402, device control; maxon's part of it in `power_states`. It refuses to know what a transition
does to power stage and brake.
"""

from collections.abc import Callable
from typing import Final

from emulators.epos2.control import enable_checks, supervision
from emulators.epos2.control.power_sequence import PowerMachine
from emulators.epos2.control.power_states import TIMED, Happening
from emulators.epos2.control.standing_errors import StandingErrors
from emulators.epos2.control.supervision import WATCHED, Reaction
from emulators.epos2.io.pins import Pins
from emulators.epos2.modes.mode_selector import Motion
from emulators.epos2.objects.store import ObjectStore
from emulators.servo.axis import ServoAxis
from firmware_bridge.wire.cia402 import Command, Control, State, command_of
from firmware_bridge.wire.epos2 import emergency

# The controlword's bit as a plain number: flags are slow, and every frame is looked at.
_FAULT_RESET: Final = int(Control.FAULT_RESET)


class DeviceControl:
    """What commands the state of one drive."""

    def __init__(
        self,
        store: ObjectStore,
        axis: ServoAxis,
        motion: Motion,
        pins: Pins,
        machine: PowerMachine,
        *,
        report: Callable[[int], None],
    ) -> None:
        """`report` takes emergency codes, and NO_ERROR when a fault was reset."""
        self._store = store
        self._axis = axis
        self._motion = motion
        self._inputs = pins.inputs
        self._machine = machine
        self._report = report
        self.errors: Final = StandingErrors(store, axis)
        self._delayed: tuple[int, int] | None = None
        """A controlword that waits until the present command is completed, and the one before it."""

    def restart(self) -> None:
        """Begin as after power-on."""
        self._delayed = None
        self.errors.clear()
        self._machine.restart()
        self._advance()

    def attend(self) -> None:
        """Take in findings, pins and time, then a set-point that waits; mostly there is none of them."""
        inputs, motion, machine = self._inputs, self._motion, self._machine
        inputs.refresh()
        if self._axis.flags & WATCHED:
            for code in self.errors.found(machine.state):  # each is told once until it is reset
                self.fail(code)
        self._heed()
        self._advance()
        if machine.free:
            motion.advance(machine.controlword)
            self._heed()
        if inputs.executed:
            self._heed_limits()

    # Commands

    def command(self, word: int) -> None:
        """Take a controlword. The latest one waits for a command under way; a fault reaction heeds none."""
        machine = self._machine
        before, machine.controlword = machine.controlword, word
        if machine.state is State.FAULT:
            if word & ~before & _FAULT_RESET:
                self._reset_fault()
        elif machine.releasing and command_of(word) is not Command.ENABLE_OPERATION:
            machine.give_up_release()
            self._obey(word, before)
        elif machine.under_way or machine.state in TIMED:
            # What waits for the brake keeps its edges; other states have none to keep.
            since = before if self._delayed is None else self._delayed[1]
            self._delayed = word, since if machine.releasing else word
        elif machine.state is not State.FAULT_REACTION_ENABLED:
            self._obey(word, before)

    def _obey(self, word: int, before: int) -> None:
        """Carry out a controlword's command, then its mode bits; with bit 7 up it holds neither."""
        if word & _FAULT_RESET:
            return
        machine = self._machine
        was_free = machine.free
        machine.go(self._admitted(command_of(word)))
        if machine.state is State.REFRESH:  # just entered: in it every command waits
            contradiction = enable_checks.found(self._store)
            if contradiction is not None:
                self.fail(contradiction)
        self._advance()
        if was_free and machine.free:
            self._motion.controls(word, before)
            self._heed()

    def _admitted(self, command: Command) -> Command:
        """Return a master's command, or the stronger one that the input pins give."""
        pins = self._inputs.restriction
        return command if pins is None or command is Command.DISABLE_VOLTAGE else pins

    def _obeys_pins(self) -> bool:
        """Carry out the command that the input pins give; say whether that has moved the machine."""
        command = self._inputs.restriction
        if command is None or not self._machine.heeds(command):
            return False
        self._machine.give_up_release()
        self._machine.go(command)
        return True

    def _obeys_delayed(self) -> bool:
        """Carry out the controlword that has waited, if its time has come; say whether it has."""
        delayed, machine = self._delayed, self._machine
        if delayed is None or machine.under_way or machine.state in TIMED:
            return False
        self._delayed = None
        self._obey(*delayed)
        return True

    def _advance(self) -> None:
        """Heed the pins, and complete what is due; then the waiting command."""
        machine = self._machine
        if machine.free and self._delayed is None and self._inputs.restriction is None:
            return
        while self._obeys_pins() or machine.complete_one() or self._obeys_delayed():
            pass

    # Errors

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
        self._delayed = None
        self._machine.fault(supervision.DECELERATIONS.get(reaction))
        self._advance()

    def _heed(self) -> None:
        """Report what the mode cannot do."""
        shaft = self._motion.shaft
        if shaft.error:
            self.fail(shaft.take_error())

    def _heed_limits(self) -> None:
        """Stop at a limit switch; asked when every set-point is taken, for it may lead into one."""
        inputs, motion = self._inputs, self._motion
        if not self._axis.powered or self._machine.state is State.FAULT_REACTION_ENABLED:
            return
        met = inputs.limits_met(motion.shaft.heading, motion.mode.sought)
        if met and not inputs.risen:
            motion.shaft.forget_demand()
        for code in met:
            self.fail(code)

    def _reset_fault(self) -> None:
        if self.errors.curable:
            self.errors.clear()
            self._machine.go(Happening.FAULT_RESET)
            self._report(emergency.NO_ERROR)
