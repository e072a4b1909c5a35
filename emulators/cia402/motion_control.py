"""Motion control of the servo: its objects on one side, the servo axis on the other, CiA 402 between them."""

from collections.abc import Callable
from functools import partial
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.power_states import CIA_402, Happening, leaving
from emulators.cia402 import errors
from emulators.cia402 import objects as at
from emulators.cia402.cyclic import PER_MILLE, CyclicMode, CyclicPosition, CyclicTorque, CyclicVelocity
from emulators.cia402.inputs import ServoInputs
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
from firmware_bridge.canopen.cia402 import STATES, ControlwordCommand, Mode, PowerState, Status
from firmware_bridge.canopen.emergency import NO_ERROR
from firmware_bridge.units import MILLISECOND, NEVER, QUADCOUNTS_PER_LINE, Nanoseconds

MODES: Final[dict[int, type[ModeOfOperation]]] = {
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


class MotionControl:
    """The servo's power states, modes and supervision: an `emulators.canopen.application.Application`."""

    def __init__(self, store: ObjectStore, axis: ServoAxis, report: Callable[[int], None]) -> None:
        """Set hooks in the store; `report` takes emergency codes, and NO_ERROR when a fault was reset."""
        self.hung = False
        """A bench test's fault: controlwords and set-points are taken and not carried out."""
        self._store: Final = store
        self._axis: Final = axis
        self._report_to: Final = report
        self._inputs: Final = ServoInputs(axis)
        self._modes: Final = ModeSelector(Shaft(store, axis, self._inputs, errors.IMPOSSIBLE), MODES)
        states = PowerStates(
            leaving=leaving(CIA_402),
            words=WORDS,
            timed=TIMED,
            lasts=lambda state: SELF_TEST if state is PowerState.NOT_READY_TO_SWITCH_ON else 0,
            entered=lambda _state: None,
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
        self._settings: Final = Settings()
        self._operational = False
        self._apart_since: Nanoseconds = NEVER
        """Begin of the present following error."""
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
        self._control.attend()
        self._follow_error()
        self._publish()

    def wake_at(self) -> Nanoseconds:
        """Return when `refresh` is needed next even if the axis raises no event."""
        return min(self._power.due, self._apart_until)

    def reset(self) -> None:
        """Begin as after power-on, with the store's present values."""
        self._axis.restart()
        self._apart_since = NEVER
        for address, name in SETTINGS.items():
            setattr(self._settings, name, self._store.get(address))
        self._settings.encoder_pulses = self._store.get(at.ENCODER_COUNTS) // QUADCOUNTS_PER_LINE
        self._limit_current({})
        self._inputs.reset()
        self._modes.restart(self._store.get(od.MODE))
        self._store.set(od.MODE_DISPLAY, self._modes.number)
        self._store.set(at.ERROR_CODE, 0)
        self._control.restart()
        self._publish()

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
        store.on_write(od.HOMING_METHOD, self._check_method)
        for address in HEEDED:
            store.on_write(address, partial(self._take_value, address))

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
        if not self.hung:
            self._control.command(word)
            self._publish()

    def _take_mode(self, number: int) -> None:
        if number not in MODES and number != Mode.NONE:
            raise SdoAbort(AbortCode.RANGE, od.MODE)
        self._modes.change(number, enabled=self._power.free)
        self._store.set(od.MODE_DISPLAY, number)
        self._publish()

    def _take_value(self, address: Address, value: int) -> None:
        if self._power.free and not self.hung:
            self._modes.written(address, value)

    @staticmethod
    def _check_method(method: int) -> None:
        if method not in HomingMode.methods:
            raise SdoAbort(AbortCode.RANGE, od.HOMING_METHOD)

    # Statusword

    def _publish(self) -> None:
        word, mode = self._power.word | int(Status.REMOTE), self._modes.mode
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
        self._store.set(od.STATUSWORD, word)
