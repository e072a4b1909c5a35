"""The seam: a node receives packets with their instants; it returns packets to send and its next wake-up.

The carrier of its packets is not known to a node: the virtual world, a real port, a recorder or a test.
"""

from typing import Final, Protocol, runtime_checkable

from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import Nanoseconds

CAN: Final = "can"
SERIAL: Final = "serial"
"""Commands of maxon's serial protocol on their way to or from a line; see `families.epos2.maxon.packets`."""
OPERATOR: Final = "operator"
LINE_LOST: Final = 1
LINE_BACK: Final = 2
DTR_UP: Final = 3
DTR_DOWN: Final = 4
"""State of a host's DTR on a serial line, as an empty packet with this address."""


class Node(Protocol):
    """Anything that sits on a link: a drive, the bridge, an operator, a recorder around one of them."""

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take one packet that has wholly arrived at `now`."""

    def wake(self, now: Nanoseconds) -> Reaction:
        """Act on the time: the first call starts the node; later ones come at its `wake_at`, or earlier."""


@runtime_checkable
class Selective(Protocol):
    """A node behind an acceptance filter, as a CAN controller has one: the rest need not be brought to it."""

    def listens(self, packet: Packet) -> bool:
        """Return whether `receive` would do anything with this packet now."""


@runtime_checkable
class Clocked(Protocol):
    """A node that sets the rate at its own end of a serial line, and may change it."""

    @property
    def baud(self) -> int:
        """Bit rate at present."""


@runtime_checkable
class Stoppable(Protocol):
    """A node that can be commanded to end in good order: standstill first, then power down."""

    def stop(self, now: Nanoseconds) -> Reaction:
        """Begin to end. Done when a reaction, this one or a later one, has a `wake_at` of `NEVER`."""


@runtime_checkable
class Holding(Protocol):
    """A node that may hold the robot after a command to end, until a further one."""

    @property
    def holding(self) -> bool:
        """True while it does."""


def holds(node: object) -> bool:
    """Return whether a node commanded to end does not before it is commanded again."""
    return isinstance(node, Holding) and node.holding


@runtime_checkable
class Unhurried(Protocol):
    """A node that is not cut short while it ends: what it drives may move until it is done."""

    @property
    def unattended(self) -> str:
        """State of its devices if it is carried no further."""

    def may_leave(self, now: Nanoseconds) -> bool:
        """Take one more request to end while it ends; return whether it is carried no further."""


@runtime_checkable
class Finite(Protocol):
    """A node that has something to do and is done with it, so that its run ends by itself."""

    @property
    def finished(self) -> bool:
        """True where nothing is left to do."""
