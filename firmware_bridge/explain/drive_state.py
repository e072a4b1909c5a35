"""A drive as the frames of a recording show it: its words, its mode, its targets, and what was done in vain.

The states and commands are those of CiA 402. The reasons why it does not move are in
`firmware_bridge.explain.reasons`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.canopen.cia402 import (
    STATES,
    ControlwordBit,
    ControlwordCommand,
    Mode,
    PowerState,
    command_of,
)
from firmware_bridge.explain.incident import Evidence
from firmware_bridge.units import Nanoseconds

_SHUTDOWN = ControlwordCommand.SHUTDOWN
_SWITCH_ON = ControlwordCommand.DISABLE_OPERATION
_ENABLE = ControlwordCommand.ENABLE_OPERATION
_DISABLE = ControlwordCommand.DISABLE_VOLTAGE
_QUICK = ControlwordCommand.QUICK_STOP

REACHED: Final[Mapping[PowerState, Mapping[ControlwordCommand, PowerState]]] = MappingProxyType(
    {
        PowerState.SWITCH_ON_DISABLED: {_SHUTDOWN: PowerState.READY_TO_SWITCH_ON},
        PowerState.READY_TO_SWITCH_ON: {
            _SWITCH_ON: PowerState.SWITCHED_ON,
            _ENABLE: PowerState.OPERATION_ENABLED,
            _QUICK: PowerState.SWITCH_ON_DISABLED,
            _DISABLE: PowerState.SWITCH_ON_DISABLED,
        },
        PowerState.SWITCHED_ON: {
            _ENABLE: PowerState.OPERATION_ENABLED,
            _SHUTDOWN: PowerState.READY_TO_SWITCH_ON,
            _QUICK: PowerState.SWITCH_ON_DISABLED,
            _DISABLE: PowerState.SWITCH_ON_DISABLED,
        },
        PowerState.OPERATION_ENABLED: {
            _SWITCH_ON: PowerState.SWITCHED_ON,
            _SHUTDOWN: PowerState.READY_TO_SWITCH_ON,
            _QUICK: PowerState.QUICK_STOP_ACTIVE,
            _DISABLE: PowerState.SWITCH_ON_DISABLED,
        },
        PowerState.QUICK_STOP_ACTIVE: {
            _ENABLE: PowerState.OPERATION_ENABLED,
            _DISABLE: PowerState.SWITCH_ON_DISABLED,
        },
    }
)
"""State after a command, by the state before it; a command that is not named has no transition there.

The table of the transitions with their effects is the emulated drive's, `emulators.canopen.power_states`.
"""
STATE_BITS: Final = 0x6F
"""Statusword bits of the state."""
FAULTS: Final = frozenset(
    {PowerState.FAULT, PowerState.FAULT_REACTION_ENABLED, PowerState.FAULT_REACTION_DISABLED}
)
MAX_MOTOR_SPEED: Final = Address(0x6080)
TARGETS: Final[Mapping[int, Address]] = MappingProxyType(
    {
        Mode.PROFILE_POSITION: od.TARGET_POSITION,
        Mode.PROFILE_VELOCITY: od.TARGET_VELOCITY,
        Mode.CYCLIC_POSITION: od.TARGET_POSITION,
        Mode.CYCLIC_VELOCITY: od.TARGET_VELOCITY,
        # Modes of a maker.
        -1: Address(0x2062),
        -2: Address(0x206B),
    }
)
"""The target of each mode that has one."""
POSITIONS: Final = frozenset({od.TARGET_POSITION, TARGETS[-1]})
"""Targets that are positions."""
_ALL_TARGETS: Final = frozenset(TARGETS.values())


@dataclass(slots=True)
class DriveState:
    """One drive."""

    node: int
    network: NmtState | None = None
    controlword: int | None = None
    control: Evidence | None = None
    """The last frame that brought a controlword."""
    statusword: int | None = None
    state: PowerState | None = None
    expected_state: PowerState | None = None
    """The state that the commands since the last statusword lead to."""
    enabled_once: bool = False
    enable_requested: bool = False
    values: dict[Address, int] = field(default_factory=dict)
    """What was written to it, and what it reports."""
    targets: dict[Address, Nanoseconds] = field(default_factory=dict)
    """Instants at which a target got another value."""
    edge_at: Nanoseconds | None = None
    """Of controlword bit 4, from 0 to 1."""
    edge_enabled: bool = False
    """Whether the drive was enabled at that edge."""
    no_transition: tuple[Evidence, int, PowerState] | None = None
    """A command without a transition: frame, controlword, state."""
    invalid_pdo: tuple[Evidence, str, Address] | None = None
    """A set-point for a PDO that is switched off: frame, PDO, its COB-ID's object."""
    ignored_pdo: Evidence | None = None
    """A set-point for a node that is not operational."""
    waits_for_sync: str = ""
    """The PDO with set-points that takes them at SYNC; empty where there is none."""
    sync_since: bool = False
    """Whether SYNC came since such a set-point."""

    @property
    def mode(self) -> int | None:
        """The mode that it reports, or else the written one."""
        shown = self.values.get(od.MODE_DISPLAY)
        return self.values.get(od.MODE) if shown is None else shown

    @property
    def enabled(self) -> bool:
        """Whether the power stage is on and set-points are taken."""
        return self.state is PowerState.OPERATION_ENABLED

    @property
    def command(self) -> ControlwordCommand | None:
        """The command of the last controlword."""
        return None if self.controlword is None else command_of(self.controlword)

    @property
    def target(self) -> Address | None:
        """The target object of its mode; None where the mode has none, or is not known."""
        mode = self.mode
        return None if mode is None else TARGETS.get(mode)

    @property
    def written_targets(self) -> list[Address]:
        """The targets that were written."""
        return [address for address in self.targets if address in _ALL_TARGETS]

    def bit(self, bit: int) -> bool:
        """Return a bit of the last controlword."""
        return self.controlword is not None and bool(self.controlword & bit)

    def shows(self, bit: int) -> bool:
        """Return a bit of the last statusword."""
        return self.statusword is not None and bool(self.statusword & bit)

    def write(self, at: Nanoseconds, address: Address, value: int) -> None:
        """Take an object that was written, the controlword aside."""
        if address in _ALL_TARGETS and self.values.get(address) != value:
            self.targets[address] = at
        self.values[address] = value

    def control_with(self, at: Nanoseconds, value: int) -> ControlwordCommand | None:
        """Take a controlword; return its command where the state has no transition for it."""
        before, self.controlword = self.controlword or 0, value
        command = command_of(value)
        state = self.expected_state
        if value & ~before & ControlwordBit.NEW_SETPOINT:
            self.edge_at, self.edge_enabled = at, state is PowerState.OPERATION_ENABLED
        self.enable_requested |= command is _ENABLE
        if state is None or state not in REACHED:
            return None
        reached = REACHED[state].get(command)
        if reached is not None:
            self.expected_state = reached
            return None
        # The same word again, and one that only repeats the state, are no mistakes.
        towards = command in {_ENABLE, _SWITCH_ON} and state is not PowerState.OPERATION_ENABLED
        return (
            command if towards and not (command is _SWITCH_ON and state is PowerState.SWITCHED_ON) else None
        )

    def report_status(self, value: int) -> None:
        """Take a statusword."""
        self.statusword = value
        self.state = self.expected_state = STATES.state_of(value)
        if self.enabled:
            self.enabled_once, self.no_transition = True, None

    def restart(self) -> None:
        """Take a restart: nothing of before counts."""
        self.controlword = self.control = self.statusword = None
        self.state = self.expected_state = None
        self.values.clear()
        self.targets.clear()
        self.edge_at = None
        self.no_transition = self.invalid_pdo = self.ignored_pdo = None
        self.enabled_once = self.enable_requested = False
        self.waits_for_sync = ""
