"""Motion control of one drive: the objects on one side, the servo axis on the other, CiA 402 between them.

It is independent of frames and protocols: writes reach it through the store, and errors leave by a callback.
"""

from collections.abc import Callable
from functools import partial
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.option_codes import ABORT_CONNECTION
from emulators.drive.device_control import DeviceControl
from emulators.drive.mode_selector import ModeSelector
from emulators.drive.power_sequence import PowerSequence, PowerStates
from emulators.drive.shaft import Shaft
from emulators.epos2.control.power_states import LEAVING, TIMED, Delays
from emulators.epos2.control.sensing import Sensing
from emulators.epos2.control.supervision import NOT_CARRIED_OUT, SETPOINTS_IN_A_MILLISECOND, SUPERVISION
from emulators.epos2.io.data_recorder import DataRecorder
from emulators.epos2.io.drive_pins import Pins
from emulators.epos2.modes.table import HEEDED, IMPOSSIBLE, MODES
from emulators.epos2.objects.axis_parameters import (
    ACTUAL_VALUES,
    ONLY_WITHOUT_POWER,
    PARAMETERS,
    AxisParameter,
)
from emulators.servo.axis import CURRENT_LIMITED, ServoAxis
from emulators.servo.scaling import Settings, configure
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState, Status
from firmware_bridge.canopen.emergency import NO_ERROR
from firmware_bridge.families.epos2.wire import emergency
from firmware_bridge.families.epos2.wire.functions import OutputFunction
from firmware_bridge.families.epos2.wire.power_states import REFERENCED, STATUSWORDS
from firmware_bridge.units import MILLISECOND, Nanoseconds

# The statusword's bits as plain numbers: it is put together with every frame, and flags are slow to join.
_STAGE_ON: Final = 1 << 4
_REMOTE: Final = int(Status.REMOTE)
_TARGET_REACHED: Final = int(Status.TARGET_REACHED)
_INTERNAL_LIMIT: Final = int(Status.INTERNAL_LIMIT)
_FAULTS: Final = frozenset(
    {PowerState.FAULT, PowerState.FAULT_REACTION_ENABLED, PowerState.FAULT_REACTION_DISABLED}
)


class MotionControl:
    """One drive's power states, modes and supervision."""

    def __init__(
        self,
        store: ObjectStore,
        axis: ServoAxis,
        report: Callable[[int], None],
        delays: Delays | None = None,
        *,
        each_write_counts: bool = True,
    ) -> None:
        """Set hooks in the store; `report` takes emergency codes, and NO_ERROR when a fault was reset.

        `each_write_counts`: a controlword that is written with bit 4 is a set-point, edge or not, where the
        mode goes by writes.
        """
        self._each_write_counts = each_write_counts
        self._store = store
        self._axis = axis
        self._recorder = DataRecorder(store, axis)
        self._report_to = report
        self.pins: Final = Pins(store, axis)
        self._modes = ModeSelector(Shaft(store, axis, self.pins.inputs, IMPOSSIBLE), MODES)
        delays = delays or Delays()
        states = PowerStates(
            leaving=LEAVING,
            words=STATUSWORDS,
            timed=TIMED,
            lasts=lambda state: delays.of(state, store.get(od.MOTOR_TYPE)),
            entered=self._entered,
        )
        self._power = PowerSequence(store, axis, self._modes, self.pins.brake, states)
        self._control = DeviceControl(
            store,
            axis,
            self._modes,
            self.pins.inputs,
            self._power,
            supervision=SUPERVISION,
            report=self._report,
        )
        self._settings = Settings()
        self._operational = False
        self.hung = False
        """A bench test's fault: controlwords and set-points are taken and not carried out."""
        self._busy = (0, 0)
        """A ms, and how many new set values it has brought."""
        self._hook()
        # After `_hook`: its refusal under power (0x08000022)
        # must come before the sensors take the same write.
        self._sensing = Sensing(store, axis)
        self.reset()

    @property
    def state(self) -> PowerState:
        """The power state of CiA 402."""
        return self._power.state

    def nmt_changed(self, operational: bool) -> None:  # noqa: FBT001 - one fact, and the method names it
        """Follow the network state: statusword bit 9. Assumed: leaving Operational stops no motion."""
        self._operational = operational
        self._publish()

    def connection_lost(self) -> None:
        """Report a failure of heartbeat or guarding, and react by 0x6007."""
        option = self._store.get(od.ABORT_CONNECTION_OPTION)
        self._control.fail(emergency.CONNECTION_LOST, ABORT_CONNECTION.get(option))
        self._publish()

    def communication_fault(self, code: int) -> None:
        """Report an error found on the bus side, and react by the emergency table."""
        self._control.fail(code)
        self._publish()

    def communication_reset(self) -> None:
        """Network command reset communication: errors that only this cures are gone."""
        self._control.errors.cured_by_communication_reset()

    def refresh(self, now: Nanoseconds) -> None:
        """Take in what the axis found, what the time brought, and what a whole PDO has written."""
        # The axis may have run beyond this frame's instant already; its clock does not go back.
        self._axis.now = max(self._axis.now, now)
        self._control.attend()
        self._publish()

    def wake_at(self) -> Nanoseconds:
        """Return when `refresh` is needed next even if the axis raises no event."""
        return self._power.due

    def reset(self) -> None:
        """Begin as after power-on, with the store's present values (transition 19)."""
        self._axis.restart()
        self._recorder.reset()
        for row in PARAMETERS:
            setattr(self._settings, row.setting, self._store.get(row.address))
        configure(self._axis, self._settings)
        self._sensing.apply()
        self.pins.reset()
        self._modes.restart(self._store.get(od.MODE))
        self._store.set(od.MODE_DISPLAY, self._modes.number)
        # The power states last: Start ends at once (0 ms), and what follows looks at pins and modes.
        self._control.restart()
        self._publish()

    def _entered(self, state: PowerState) -> None:
        self.pins.outputs.show(OutputFunction.READY, active=state not in _FAULTS)

    def _report(self, code: int) -> None:
        if code != NO_ERROR:
            self._recorder.error()
        self._report_to(code)

    # Objects

    def _hook(self) -> None:
        store = self._store
        for address, value in ACTUAL_VALUES:
            store.on_read(address, partial(value, self._axis))
        shaping = {row.address for row in PARAMETERS}
        for row in PARAMETERS:
            store.on_write(row.address, partial(self._take_parameter, row))
        for address in ONLY_WITHOUT_POWER:
            # A parameter refuses in its own hook: a second one would run after the axis had taken the value.
            if address not in shaping:
                store.on_write(address, partial(self._refuse_with_power, address))
        store.on_write(od.CONTROLWORD, self._take_controlword)
        store.on_write(od.MODE, self._take_mode)
        for address, code in NOT_CARRIED_OUT.items():
            store.on_write(address, partial(self._take_start, code))
        for address in HEEDED:
            store.on_write(address, partial(self._take_value, address))

    def _take_parameter(self, row: AxisParameter, value: int) -> None:
        if row.address in ONLY_WITHOUT_POWER:
            self._refuse_with_power(row.address, value)
        setattr(self._settings, row.setting, value)
        configure(self._axis, self._settings)

    def _refuse_with_power(self, address: Address, _value: int) -> None:
        if self._axis.powered:
            raise SdoAbort(AbortCode.DEVICE_STATE, address)

    def _take_controlword(self, word: int) -> None:
        if self.hung:
            return
        self._control.command(word, written=self._each_write_counts and self._store.requested)
        self._publish()

    def _take_mode(self, mode: int) -> None:
        # Other drives accept the write and leave 0x6061 unchanged; the refusal shows a master at once.
        if mode not in MODES:
            raise SdoAbort(AbortCode.RANGE, od.MODE)
        self._modes.change(mode, enabled=self._power.free)
        self._store.set(od.MODE_DISPLAY, mode)
        self._publish()

    def _take_value(self, address: Address, value: int) -> None:
        if self._power.free and not self.hung:
            self._modes.written(address, value)
            self._count_setpoint()

    def _take_start(self, code: int, value: int) -> None:
        if value:
            self._control.fail(code)
            self._publish()

    def _count_setpoint(self) -> None:
        millisecond, count = self._axis.now // MILLISECOND, 1
        if millisecond == self._busy[0]:
            count += self._busy[1]
        self._busy = (millisecond, count)
        if count > SETPOINTS_IN_A_MILLISECOND:
            self._control.fail(emergency.OVERLOADED)

    # Statusword

    def _publish(self) -> None:
        power, modes = self._power, self._modes
        word, mode = power.word, modes.mode
        # Recorded: bit 10 is 1 while the drive is disabled.
        if not word & _STAGE_ON or mode.arrived:
            word |= _TARGET_REACHED
        if self._operational:
            word |= _REMOTE
        if modes.shaft.referenced:
            word |= REFERENCED
        if self._axis.flags & CURRENT_LIMITED:
            word |= _INTERNAL_LIMIT
        self.pins.refresh()
        # Bit 13 follows the emergency 8611, not the present error: it stays until the fault reset.
        failed = emergency.FOLLOWING_ERROR_TOO_LARGE in self._control.errors.codes
        self._store.set(od.STATUSWORD, word | mode.status(failed=failed))
