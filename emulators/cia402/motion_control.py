"""Motion control of the servo: its objects on one side, the servo axis on the other, CiA 402 between them."""

from collections.abc import Callable
from functools import partial
from typing import ClassVar, Final

from emulators.canopen.homing_methods import NOTHING_TO_DO
from emulators.canopen.object_store import ObjectStore
from emulators.canopen.power_states import CIA_402, Happening, leaving
from emulators.cia402 import errors
from emulators.cia402.cyclic import PER_MILLE, CyclicMode, CyclicPosition, CyclicTorque, CyclicVelocity
from emulators.cia402.inputs import ServoInputs
from emulators.cia402.variations import PLAIN, Traits
from emulators.drive.brake import Brake
from emulators.drive.device_control import DeviceControl
from emulators.drive.homing import HomingMode
from emulators.drive.mode import ModeOfOperation
from emulators.drive.mode_selector import ModeSelector
from emulators.drive.power_sequence import PowerSequence, PowerStates
from emulators.drive.profile_position import ProfilePosition
from emulators.drive.profile_velocity import ProfileVelocity
from emulators.drive.shaft import Shaft
from emulators.servo.axis import CURRENT_LIMITED, FOLLOWING_ERROR, POSITION, ServoAxis
from emulators.servo.scaling import Settings, configure, raw_speed_rpm, speed_rpm
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import (
    STATES,
    ControlwordBit,
    ControlwordCommand,
    Mode,
    PowerState,
    Status,
    command_of,
)
from firmware_bridge.canopen.emergency import NO_ERROR
from firmware_bridge.families.cia402.wire import address as at
from firmware_bridge.units import MILLISECOND, NEVER, QUADCOUNTS_PER_LINE, Nanoseconds


class Standing(ModeOfOperation):
    """No mode: it holds the shaft, and notes a halt for the mode that follows."""

    heeds_halt: ClassVar[bool] = True


MODES: Final[dict[int, type[ModeOfOperation]]] = {
    Mode.NONE: Standing,
    Mode.PROFILE_POSITION: ProfilePosition,
    Mode.PROFILE_VELOCITY: ProfileVelocity,
    Mode.HOMING: HomingMode,
    Mode.CYCLIC_POSITION: CyclicPosition,
    Mode.CYCLIC_VELOCITY: CyclicVelocity,
    Mode.CYCLIC_TORQUE: CyclicTorque,
}
HEEDED: Final = tuple(sorted({address for mode in MODES.values() for address in mode.heeds}))
SETTINGS: Final = {
    od.MAX_FOLLOWING_ERROR: "following_error",
    od.POSITION_WINDOW: "position_window",
    od.POSITION_WINDOW_TIME: "position_window_time",
    od.VELOCITY_WINDOW: "velocity_window",
    od.VELOCITY_WINDOW_TIME: "velocity_window_time",
    at.STANDSTILL_WINDOW: "standstill_window",
    at.STANDSTILL_TIME: "standstill_time",
    at.MAX_MOTOR_SPEED: "max_speed",
}
CURRENTS: Final = (at.MAX_TORQUE, at.MAX_CURRENT, at.RATED_CURRENT)
"""Objects that limit the current together."""
WORDS: Final = {state: STATES.words.get(state, 0) for state in PowerState}
TIMED: Final = {
    PowerState.START: Happening.STARTED,
    PowerState.NOT_READY_TO_SWITCH_ON: Happening.INITIALIZED,
}
SELF_TEST: Final[Nanoseconds] = 5 * MILLISECOND
"""How long Not ready to switch on lasts (assumed)."""
VOLTAGE_ENABLED: Final = 1 << 4
NO_REACTION, FAULT_SIGNAL, DISABLE_VOLTAGE = 0, 1, 2
"""Values of 0x6007; 3 is a quick stop."""


SYNCHRONIZES: Final = -1
"""0x6061 while a mode is not taken yet, of a drive that takes its time."""


class AddedOffset(HomingMode):
    """Homing after which the position at home is 0x607C itself."""

    @property
    def home_position(self) -> int:
        """The position that counts at home, qc."""
        return self.shaft.store.get(od.HOME_OFFSET)


def _modes(traits: Traits) -> dict[int, type[ModeOfOperation]]:
    return MODES | {Mode.HOMING: AddedOffset} if traits.offset_added else MODES


class MotionControl:
    """The servo's power states, modes and supervision: an `emulators.canopen.application.Application`."""

    def __init__(
        self,
        store: ObjectStore,
        axis: ServoAxis,
        report: Callable[[int], None],
        traits: Traits = PLAIN,
        settings: Settings | None = None,
    ) -> None:
        """Set hooks in the store; `report` takes emergency codes, and NO_ERROR when a fault was reset.

        `settings` are its tuning.
        """
        self.hung = False
        """A bench test's fault: controlwords and set-points are taken and not carried out."""
        self._store: Final = store
        self._axis: Final = axis
        self._report_to: Final = report
        self._traits: Final = traits
        self._inputs: Final = ServoInputs(axis)
        self._modes: Final = ModeSelector(Shaft(store, axis, self._inputs, errors.IMPOSSIBLE), _modes(traits))
        states = PowerStates(
            leaving=leaving(CIA_402),
            words=WORDS,
            timed=TIMED,
            lasts=lambda state: SELF_TEST if state is PowerState.NOT_READY_TO_SWITCH_ON else 0,
            entered=lambda _state: None,
            quick_stop_lasts=traits.resumes,
        )
        self._power: Final = PowerSequence(store, axis, self._modes, Brake(), states)
        self._control: Final = DeviceControl(
            store,
            axis,
            self._modes,
            self._inputs,
            self._power,
            supervision=errors.SUPERVISION,
            report=self._report,
        )
        self._settings: Final = settings or Settings()
        self._operational = False
        self._apart_since: Nanoseconds = NEVER
        """Begin of the present following error."""
        self._period_written = False
        self._commanded_at: Nanoseconds = -traits.controlword_gap
        """Time of the newest controlword that was seen."""
        self._mode_due: Nanoseconds = NEVER
        """Time at which a mode that was written is taken."""
        self._factor_written = False
        """A factor of the positions was written since the settings were taken."""
        self._acknowledged = False
        """Bit 12 as it is after enabling."""
        self._hook()
        self.reset()

    @property
    def state(self) -> PowerState:
        """The power state."""
        return self._power.state

    # As its node uses it

    def nmt_changed(self, operational: bool) -> None:  # noqa: FBT001 - as in the protocol
        """React by 0x6007 where the network leaves Operational."""
        left, self._operational = self._operational and not operational, operational
        if left:
            self._abort_connection(NO_ERROR)
        self._publish()

    def connection_lost(self) -> None:
        """Report a failure of heartbeat or guarding, and react by 0x6007."""
        self._abort_connection(errors.CONNECTION_LOST)

    def communication_fault(self, code: int) -> None:
        """Report an error found on the bus side, and react by its row."""
        self._control.fail(code)
        self._publish()

    def communication_reset(self) -> None:
        """Keep every error: each is cured by a fault reset."""

    def refresh(self, now: Nanoseconds) -> None:
        """Take in what the axis found, what the time brought, and what a whole PDO has written."""
        self._axis.now = max(self._axis.now, now)
        if self._factor_written:
            self._load_settings()
            configure(self._axis, self._settings)
        self._control.attend()
        self._follow_error()
        if self._axis.now >= self._mode_due:
            self._mode_due = NEVER
            self._change_mode(self._store.get(od.MODE))
        self._publish()

    def wake_at(self) -> Nanoseconds:
        """Return when `refresh` is needed next even if the axis raises no event."""
        return min(self._power.due, self._apart_until, self._mode_due)

    def reset(self) -> None:
        """Begin as after power-on, with the store's present values."""
        self._axis.restart()
        self._apart_since = self._mode_due = NEVER
        self._period_written = self._acknowledged = False
        self._commanded_at = self._axis.now - self._traits.controlword_gap
        self._settings.encoder_pulses = self._axis.encoder_resolution // QUADCOUNTS_PER_LINE
        self._load_settings()
        self._limit_current({})
        self._inputs.reset()
        self._modes.restart(self._store.get(od.MODE))
        self._store.set(od.MODE_DISPLAY, self._modes.number)
        self._store.set(at.ERROR_CODE, 0)
        self._control.restart()
        self._publish()

    def _load_settings(self) -> None:
        self._factor_written = False
        for address, name in SETTINGS.items():
            setattr(self._settings, name, self._store.get(address))

    def _abort_connection(self, code: int) -> None:
        option = self._store.get(od.ABORT_CONNECTION_OPTION)
        if code != NO_ERROR and option != FAULT_SIGNAL:
            self._report(code)
        if option == FAULT_SIGNAL:
            # Leaving Operational without power is no fault: there is nothing to be stopped.
            if code != NO_ERROR or self._axis.powered:
                self._control.fail(code or errors.CONNECTION_LOST)
        elif option != NO_REACTION:
            off = option == DISABLE_VOLTAGE
            self._power.go(ControlwordCommand.DISABLE_VOLTAGE if off else ControlwordCommand.QUICK_STOP)
        self._publish()

    def _report(self, code: int) -> None:
        self._store.set(at.ERROR_CODE, code)
        self._report_to(code)

    # Following error: 0x6065 for the time 0x6066

    @property
    def _apart_until(self) -> Nanoseconds:
        if self._apart_since == NEVER:
            return NEVER
        return self._apart_since + self._store.get(at.FOLLOWING_ERROR_TIME) * MILLISECOND

    def _follow_error(self) -> None:
        apart = self._axis.flags & FOLLOWING_ERROR and self._power.free
        if not apart:
            self._apart_since = NEVER
            return
        if self._apart_since == NEVER:
            self._apart_since = self._axis.now
        if self._axis.now >= self._apart_until:
            self._apart_since = NEVER
            self._control.fail(errors.FOLLOWING_ERROR)

    # Objects

    def _hook(self) -> None:
        store, axis = self._store, self._axis
        for address, value in (
            (od.POSITION_DEMAND, self._position_demand),
            (at.POSITION_INTERNAL, lambda: axis.position),
            (od.POSITION_ACTUAL, lambda: axis.position),
            (at.FOLLOWING_ERROR, lambda: self._position_demand() - axis.position),
            (od.VELOCITY_DEMAND, lambda: speed_rpm(axis, axis.velocity_demand) if axis.powered else 0),
            (od.VELOCITY_ACTUAL, lambda: raw_speed_rpm(axis)),
            (at.TORQUE_DEMAND, lambda: self._per_mille(axis.current_demand_ma)),
            (at.TORQUE_ACTUAL, lambda: self._per_mille(axis.current_ma)),
            (od.CURRENT_ACTUAL, lambda: self._per_mille(axis.current_ma)),
            (at.SUPPLY, lambda: axis.forced_supply_mv or axis.supply_mv),
            (at.INPUTS, self._inputs.shown),
        ):
            store.on_read(address, value)
        for address in SETTINGS:
            store.on_write(address, partial(self._take_setting, address))
        for address in CURRENTS:
            store.on_write(address, partial(self._take_current, address))
        store.on_write(od.CONTROLWORD, self._take_controlword)
        store.on_write(od.MODE, self._take_mode)
        store.on_write(at.PERIOD, self._take_period)
        store.on_write(od.HOMING_METHOD, self._check_method)
        for address in HEEDED:
            store.on_write(address, partial(self._take_value, address))
        for address in at.FACTORS:
            store.on_write(address, self._take_factor)

    def _position_demand(self) -> int:
        axis = self._axis
        if axis.regulator != POSITION:
            return axis.position
        return (axis.position_demand + (1 << axis.fraction >> 1)) >> axis.fraction

    def _per_mille(self, milliamperes: int) -> int:
        rated = max(1, self._store.get(at.RATED_CURRENT))
        return max(-0x8000, min(0x7FFF, milliamperes * PER_MILLE // rated))

    def _take_setting(self, address: Address, value: int) -> None:
        setattr(self._settings, SETTINGS[address], value)
        configure(self._axis, self._settings)

    def _take_current(self, address: Address, value: int) -> None:
        self._limit_current({address: value})

    def _limit_current(self, new: dict[Address, int]) -> None:
        torque, current, rated = (new.get(each, self._store.get(each)) for each in CURRENTS)
        self._settings.continuous_current = rated
        self._settings.peak_current = min(torque, current) * rated // PER_MILLE
        configure(self._axis, self._settings)

    def _take_controlword(self, word: int) -> None:
        if self.hung or self._axis.now - self._commanded_at < self._traits.controlword_gap:
            return
        self._commanded_at = self._axis.now
        if self._may_not_enable and command_of(word) is ControlwordCommand.ENABLE_OPERATION:
            return
        was_free, before = self._power.free, self._power.controlword
        self._control.command(word)
        if self._power.free and not was_free:
            self._acknowledged = self._traits.acknowledged_when_enabled
        elif (word ^ before) & ControlwordBit.NEW_SETPOINT:
            self._acknowledged = False
        self._publish()

    @property
    def _may_not_enable(self) -> bool:
        traits = self._traits
        without = traits.period_first and not self._period_written
        return without or (traits.mode_first and self._modes.number == Mode.NONE)

    def _take_mode(self, number: int) -> None:
        if number not in MODES:
            raise SdoAbort(AbortCode.RANGE, od.MODE)
        traits = self._traits
        halted = traits.mode_not_halted and self._power.controlword & ControlwordBit.HALT
        if halted or (traits.mode_without_power and self._power.state is PowerState.OPERATION_ENABLED):
            return
        if traits.mode_takes:
            self._mode_due = self._axis.now + traits.mode_takes
            self._store.set(od.MODE_DISPLAY, SYNCHRONIZES)
            return
        self._change_mode(number)

    def _change_mode(self, number: int) -> None:
        self._modes.change(number, enabled=self._power.free)
        self._store.set(od.MODE_DISPLAY, number)
        self._publish()

    def _take_factor(self, _value: int) -> None:
        if self._power.state is PowerState.OPERATION_ENABLED:
            raise SdoAbort(AbortCode.DEVICE_STATE)
        self._factor_written = True

    def _take_period(self, _value: int) -> None:
        self._period_written = True

    def _take_value(self, address: Address, value: int) -> None:
        if self._power.free and not self.hung:
            self._modes.written(address, value)

    def _check_method(self, method: int) -> None:
        if method not in HomingMode.methods or (method == NOTHING_TO_DO and self._traits.no_method_0):
            raise SdoAbort(AbortCode.RANGE, od.HOMING_METHOD)

    # Statusword

    def _publish(self) -> None:
        word, mode = self._power.word, self._modes.mode
        if self._operational or not self._traits.remote_when_operational:
            word |= Status.REMOTE
        if not self._axis.flags & errors.SUPPLY_LOW:
            word |= VOLTAGE_ENABLED
        if self._power.free and mode.arrived:
            word |= Status.TARGET_REACHED
        limited = isinstance(mode, CyclicMode) and mode.limited
        if limited or self._axis.flags & CURRENT_LIMITED:
            word |= Status.INTERNAL_LIMIT
        failed = errors.FOLLOWING_ERROR in self._control.errors.codes or self._apart_since != NEVER
        if self._power.free or failed:
            word |= mode.status(failed=failed)
        if self._acknowledged and self._power.free:
            word |= Status.SETPOINT_ACKNOWLEDGED
        self._store.set(od.STATUSWORD, word)
