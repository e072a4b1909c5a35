"""Position, velocity and current mode: the set value goes to the regulator as it is, or an analog one does.

In these modes halt is not heeded, and no profile shapes the way to a new value.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial
from typing import ClassVar

from emulators.drive.mode import ModeOfOperation
from emulators.drive.shaft import Shaft
from emulators.epos2.modes.analogue import (
    CURRENT_SETPOINT,
    POSITION_SETPOINT,
    VELOCITY_SETPOINT,
    AnalogueSetpoint,
)
from emulators.servo.axis import CURRENT, DIRECT
from emulators.servo.commands import regulate_position, regulate_velocity
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire import address as at


class DirectMode(ModeOfOperation, ABC):
    """Starts with the set value that its object holds; each has its own regulator."""

    setting: ClassVar[Address]
    """The object with the set value."""
    analogue: ClassVar[AnalogueSetpoint]

    def __init__(self, shaft: Shaft) -> None:
        super().__init__(shaft)
        measured = partial(self.analogue.measured, shaft.axis, shaft.store)
        shaft.store.on_read(self.analogue.value, measured)

    def enter(self) -> None:
        """Give the regulator the shaft, and the set value."""
        self.regulate()
        self.shaft.axis.profile = DIRECT
        self._choose(self.shaft.store.get)

    def forget(self) -> None:
        """Let go of the analog input."""
        self.shaft.axis.analogue_input = 0

    def written(self, address: Address, value: int) -> None:
        """Take a set value, or what makes one of the analog input."""
        store = self.shaft.store
        if address != self.setting:
            # The store still has the former value of this object: hooks run before it takes one.
            self._choose(lambda each: value if each == address else store.get(each))
        elif not self.shaft.axis.analogue_input:
            self.take(value)

    def _choose(self, get: Callable[[Address], int]) -> None:
        """Take the analog input or the set value, whichever counts; `get` reads the objects."""
        axis = self.shaft.axis
        low, high = self.shaft.limits()
        axis.lowest, axis.highest = low << axis.fraction, high << axis.fraction
        axis.cruise = self.shaft.fastest()
        if not self.analogue.load(axis, get):
            self.take(get(self.setting))

    @abstractmethod
    def regulate(self) -> None:
        """Let the mode's regulator take over."""

    @abstractmethod
    def take(self, value: int) -> None:
        """Give the regulator a set value."""


class PositionMode(DirectMode):
    """Mode that regulates to the position 0x2062, within 0x607D."""

    setting: ClassVar[Address] = at.POSITION_MODE_SETTING
    analogue: ClassVar[AnalogueSetpoint] = POSITION_SETPOINT
    heeds: ClassVar[tuple[Address, ...]] = (setting, *analogue.shaped_by)

    def regulate(self) -> None:
        """Regulate the position."""
        regulate_position(self.shaft.axis)

    def take(self, value: int) -> None:
        """Take a position in qc."""
        axis = self.shaft.axis
        low, high = self.shaft.limits()
        axis.position_demand = axis.target_position = max(low, min(high, value)) << axis.fraction
        axis.velocity_demand = 0


class VelocityMode(DirectMode):
    """Mode that regulates to the velocity 0x206B, within 0x607F and 0x6410:4."""

    setting: ClassVar[Address] = at.VELOCITY_MODE_SETTING
    analogue: ClassVar[AnalogueSetpoint] = VELOCITY_SETPOINT
    heeds: ClassVar[tuple[Address, ...]] = (setting, *analogue.shaped_by)

    def regulate(self) -> None:
        """Regulate the velocity."""
        regulate_velocity(self.shaft.axis)

    def take(self, value: int) -> None:
        """Take a velocity in rpm. Assumed: 0x607F limits it, as it does in the modes with a profile."""
        axis = self.shaft.axis
        axis.velocity_demand = axis.target_velocity = self.shaft.bounded(value)


class CurrentMode(DirectMode):
    """Mode that regulates to the current 0x2030, within 0x6410."""

    setting: ClassVar[Address] = at.CURRENT_MODE_SETTING
    analogue: ClassVar[AnalogueSetpoint] = CURRENT_SETPOINT
    heeds: ClassVar[tuple[Address, ...]] = (setting, *analogue.shaped_by)

    def regulate(self) -> None:
        """Regulate the current alone."""
        self.shaft.axis.regulator = CURRENT
        self.shaft.axis.velocity_demand = 0

    def take(self, value: int) -> None:
        """Take a current in mA."""
        self.shaft.axis.current_setting_ma = value
