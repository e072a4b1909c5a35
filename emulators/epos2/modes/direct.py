"""Position, velocity and current mode: the set value goes to the regulator as it is."""

from typing import ClassVar

from emulators.epos2.modes.mode import ModeOfOperation
from emulators.servo.axis import CURRENT, DIRECT
from emulators.servo.commands import regulate_position, regulate_velocity
from emulators.servo.scaling import speed_units
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address


class Direct(ModeOfOperation):
    """Starts with the set value that its object holds; each has its own regulator."""

    def enter(self) -> None:
        """Give the regulator the shaft, and the set value."""
        self.regulate()
        self.shaft.axis.profile = DIRECT
        (address,) = self.heeds
        self.written(address, self.shaft.store.get(address))

    def regulate(self) -> None:
        """Let the mode's regulator take over."""
        raise NotImplementedError


class Position(Direct):
    """Holds the position 0x2062, within 0x607D."""

    heeds: ClassVar[tuple[Address, ...]] = (at.POSITION_MODE_SETTING,)

    def regulate(self) -> None:
        """Regulate the position."""
        regulate_position(self.shaft.axis)

    def written(self, address: Address, value: int) -> None:
        """Take a position in qc."""
        del address
        axis = self.shaft.axis
        low, high = self.shaft.limits()
        axis.position_demand = axis.target_position = max(low, min(high, value)) << axis.fraction
        axis.velocity_demand = 0


class Velocity(Direct):
    """Keeps the velocity 0x206B, within 0x6410:4."""

    heeds: ClassVar[tuple[Address, ...]] = (at.VELOCITY_MODE_SETTING,)

    def regulate(self) -> None:
        """Regulate the velocity."""
        regulate_velocity(self.shaft.axis)

    def written(self, address: Address, value: int) -> None:
        """Take a velocity in rpm."""
        del address
        axis = self.shaft.axis
        limit = axis.speed_limit
        axis.velocity_demand = max(-limit, min(limit, speed_units(axis, value)))
        axis.target_velocity = axis.velocity_demand


class Current(Direct):
    """Keeps the current 0x2030, within 0x6410."""

    heeds: ClassVar[tuple[Address, ...]] = (at.CURRENT_MODE_SETTING,)

    def regulate(self) -> None:
        """Regulate the current alone."""
        self.shaft.axis.regulator = CURRENT
        self.shaft.axis.velocity_demand = 0

    def written(self, address: Address, value: int) -> None:
        """Take a current in mA."""
        del address
        self.shaft.axis.current_setting_ma = value
