"""Interface of a device's application to its node, so that either can stand alone in a test."""

from typing import Protocol

from firmware_bridge.units import Nanoseconds


class Application(Protocol):
    """Application of a device, as the node uses it: of a servo, its motion control."""

    hung: bool
    """True while it goes on with its last command and takes no new one: a fault."""

    def nmt_changed(self, operational: bool) -> None:  # noqa: FBT001 - as MotionControl has it
        """Follow the network state."""

    def connection_lost(self) -> None:
        """Report and react to a lost heartbeat or guarding."""

    def communication_fault(self, code: int) -> None:
        """Report and react to an error that the bus side found."""

    def communication_reset(self) -> None:
        """Drop the errors that reset communication ends."""

    def refresh(self, now: Nanoseconds) -> None:
        """Bring statusword and actual values up to date."""

    def wake_at(self) -> Nanoseconds:
        """Return when to refresh next, whatever happens."""

    def reset(self) -> None:
        """Begin as after power-on."""
