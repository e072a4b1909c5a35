"""Interface of motion control to the drive's node, so that either can stand alone in a test."""

from collections.abc import Callable
from typing import Protocol, TypeAlias

from emulators.epos2.objects.store import ObjectStore
from emulators.servo.axis import ServoAxis
from firmware_bridge.units import Nanoseconds


class MotionProtocol(Protocol):
    """Motion control as the node uses it."""

    hung: bool
    """True if set-points and controlwords are received and not carried out."""

    def nmt_changed(self, operational: bool) -> None:  # noqa: FBT001 - as MotionControl has it
        """Follow the network state."""

    def connection_lost(self) -> None:
        """Report and react to a lost heartbeat or guarding."""

    def communication_fault(self, code: int) -> None:
        """Report and react to an error that the bus side found."""

    def communication_reset(self) -> None:
        """Let go of the errors that reset communication cures."""

    def refresh(self, now: Nanoseconds) -> None:
        """Bring statusword and actual values up to date."""

    def wake_at(self) -> Nanoseconds:
        """Return when to refresh next, whatever happens."""

    def reset(self) -> None:
        """Begin as after power-on."""


MotionFactory: TypeAlias = Callable[[ObjectStore, ServoAxis, Callable[[int], None]], MotionProtocol]
