"""Device control: controlwords, input pins and errors, one after the other, each moves the power state.

Source: CiA 402-2, device control. What a transition does to power stage and brake is `power_sequence`'s.
"""

from collections.abc import Callable
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.option_codes import DECELERATIONS, ErrorReaction
from emulators.canopen.power_states import Happening
from emulators.drive.inputs import DriveInputs
from emulators.drive.mode_selector import ModeSelector
from emulators.drive.power_sequence import PowerSequence
from emulators.drive.supervision import StandingErrors, Supervision
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen.cia402 import ControlwordBit, ControlwordCommand, PowerState, command_of
from firmware_bridge.canopen.emergency import NO_ERROR

# The controlword's bits as plain numbers: flags are slow, and every frame is looked at.
_FAULT_RESET: Final = int(ControlwordBit.FAULT_RESET)
_NEW_SETPOINT: Final = int(ControlwordBit.NEW_SETPOINT)


class DeviceControl:
    """Device control of one drive: commands and faults that change its state."""

    def __init__(
        self,
        store: ObjectStore,
        axis: ServoAxis,
        modes: ModeSelector,
        inputs: DriveInputs,
        power: PowerSequence,
        *,
        supervision: Supervision,
        report: Callable[[int], None],
    ) -> None:
        """`report` takes emergency codes, and NO_ERROR when a fault was reset."""
        self._store = store
        self._axis = axis
        self._modes = modes
        self._inputs = inputs
        self._power = power
        self._report = report
        self.errors: Final = StandingErrors(store, axis, supervision)
        self._delayed: tuple[int, int] | None = None
        """A controlword that waits until the present command is completed, and the one before it."""

    def restart(self) -> None:
        """Begin as after power-on."""
        self._delayed = None
        self.errors.clear()
        self._power.restart()
        self._advance()

    def attend(self) -> None:
        """Take in findings, pins and time, then a set-point that waits; mostly there is none of them."""
        inputs, modes, power = self._inputs, self._modes, self._power
        inputs.refresh()
        if self._axis.flags & self.errors.watched:
            for code in self.errors.found(power.state):  # each is reported once until it is reset
                self.fail(code)
        self._heed()
        # Power states before modes: a timed state that ends now may make the drive free in this same ms.
        self._advance()
        if power.free:
            modes.advance(power.controlword)
            # A set-point taken just now may be impossible: that is a fault of this ms, not of the next one.
            self._heed()
        if inputs.executed:
            self._heed_limits()

    # Commands

    def command(self, word: int, *, written: bool = False) -> None:
        """Take a controlword. The latest one waits for a command under way; a fault reaction heeds none.

        One that was `written`, not carried by a PDO, is a new set-point with bit 4 up where the mode goes by
        writes, whatever stood there before.
        """
        power = self._power
        # The controlword is noted in every state: an edge counts against the one before, carried out or not.
        before, power.controlword = power.controlword, word
        if written and self._modes.mode.goes_by_writes:
            # A client that never lowers bit 4 moves once only, by the edge alone.
            before &= ~_NEW_SETPOINT
        if power.state is PowerState.FAULT:
            # CiA 402 transition 15 takes the rising edge: by level,
            # a master that never lowers bit 7 would work here only.
            if word & ~before & _FAULT_RESET:
                self._reset_fault()
        elif power.releasing and command_of(word) is not ControlwordCommand.ENABLE_OPERATION:
            # The brake is still opening: a command that disables does not wait for the rise time 0x2100:1.
            power.give_up_release()
            self._obey(word, before)
        elif power.under_way or power.timed:
            # What waits keeps its edges: a set-point that comes while the drive enables is taken then.
            self._delayed = word, before if self._delayed is None else self._delayed[1]
        elif power.state is not PowerState.FAULT_REACTION_ENABLED:
            self._obey(word, before)

    def _obey(self, word: int, before: int) -> None:
        """Carry out a controlword's command, then its mode bits; with bit 7 up it holds neither."""
        # Every other command of CiA 402 requires bit 7 = 0: 0x0086 is no shutdown.
        if word & _FAULT_RESET:
            return
        power = self._power
        # The controlword that enables the drive is no set-point:
        # the bits of the mode count from the next one on.
        was_free = power.free
        power.go(self._admitted(command_of(word)))
        contradiction = self.errors.supervision.contradiction(self._store, power.state)
        if contradiction is not None:
            self.fail(contradiction)
        self._advance()
        if was_free and power.free:
            self._modes.controls(word, before)
            self._heed()

    def _admitted(self, command: ControlwordCommand) -> ControlwordCommand:
        """Return a master's command, or the stronger one that the input pins give."""
        # Disable voltage is the strongest command: no input may
        # turn it into a quick stop, which keeps the power on.
        pins = self._inputs.restriction
        return command if pins is None or command is ControlwordCommand.DISABLE_VOLTAGE else pins

    def _obeys_pins(self) -> bool:
        """Carry out the command that the input pins give; say whether that has moved the drive."""
        command = self._inputs.restriction
        if command is None or not self._power.heeds(command):
            return False
        self._power.give_up_release()
        self._power.go(command)
        return True

    def _obeys_delayed(self) -> bool:
        """Carry out the controlword that has waited, if its time has come; say whether it has."""
        delayed, power = self._delayed, self._power
        if delayed is None or power.under_way or power.timed:
            return False
        self._delayed = None
        self._obey(*delayed)
        return True

    def _advance(self) -> None:
        """Heed the pins, and complete what is due; then the waiting command."""
        power = self._power
        # The usual case, at each frame: enabled, nothing waits, no input restricts.
        if power.free and self._delayed is None and self._inputs.restriction is None:
            return
        # By priority: an input that stops wins over a ramp
        # that ends, and both over the controlword that waits.
        while self._obeys_pins() or power.complete_one() or self._obeys_delayed():
            pass

    # Errors

    def fail(self, code: int, reaction: ErrorReaction | None = None) -> None:
        """Report an error and stop the motor; without a reaction given, as in the emergency table."""
        # Reported before the reaction: a code without one (8150) is in the history 0x1003, too.
        self._report(code)
        if reaction is None:
            reaction = self.errors.reaction_to(code)
        if reaction is ErrorReaction.NONE:
            return
        self.errors.note(code)
        if code in self.errors.supervision.position_lost:
            self._modes.shaft.referenced = False
        # Before the stop drops the moves: homing reports an error only if one was under way.
        self._modes.mode.fail()
        # A controlword that has waited for a ramp must not enable the drive again after the fault.
        self._delayed = None
        self._power.fault(DECELERATIONS.get(reaction))
        self._advance()

    def _heed(self) -> None:
        """Report what the mode cannot do."""
        shaft = self._modes.shaft
        if shaft.error:
            self.fail(shaft.take_error())

    def _heed_limits(self) -> None:
        """Stop at a limit switch; called with every new set-point, for it may lead into one."""
        inputs, modes = self._inputs, self._modes
        # The ramp of a fault reaction still heads into the switch: that must not report it again.
        if not self._axis.powered or self._power.state is PowerState.FAULT_REACTION_ENABLED:
            return
        met = inputs.limits_met(modes.shaft.heading, modes.mode.sought)
        if met and not inputs.risen:
            # The switch was closed before: the move that leads into it ends before the shaft has followed.
            modes.shaft.forget_demand()
        for code in met:
            self.fail(code)

    def _reset_fault(self) -> None:
        # CiA 402 transition 15 needs the cause gone; else the drive stays in Fault, and reports nothing.
        if self.errors.curable:
            self.errors.clear()
            self._power.go(Happening.FAULT_RESET)
            self._report(NO_ERROR)
