"""The CAN bus of a test: which it is, and that no other test is on it meanwhile."""

import tempfile
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import IO, Final, NamedTuple

from emulators.testing.errors import RigError

VCAN: Final = "vcan"
"""Name of SocketCAN's virtual bus for the user."""
SOCKETCAN: Final = "socketcan"
MULTICAST: Final = "loopback_multicast"
PLAIN: Final = "udp_multicast"
"""python-can's own, which is no true bus."""
INTERFACES: Final = Path("/sys/class/net")
GROUPS: Final = tuple(f"239.74.163.{number}" for number in range(16, 32))
"""Administratively scoped (RFC 2365); .2 is left to those who use it by hand."""


class Bus(NamedTuple):
    """A bus by python-can's names."""

    interface: str
    channel: str

    @property
    def words(self) -> tuple[str, ...]:
        """Options of `firmware-bridge` for it."""
        return ("-i", self.interface, "-c", self.channel)


def buses(kind: str | None) -> tuple[Bus, ...]:
    """Return those that a test may have: of this kind, or, for None, those of this machine.

    RigError for what is no kind of bus, or is inside one process only.
    """
    vcan = tuple(Bus(SOCKETCAN, it.name) for it in sorted(INTERFACES.glob(f"{VCAN}*")))
    groups = tuple(Bus(PLAIN if kind == PLAIN else MULTICAST, group) for group in GROUPS)
    if kind is None:
        return vcan or groups
    if kind == VCAN:
        return vcan or (Bus(SOCKETCAN, f"{VCAN}0"),)
    if kind in {MULTICAST, PLAIN}:
        return groups
    interface, _, channel = kind.partition(":")
    if interface == "virtual":
        raise RigError(f"a bus {kind} is inside one process, and drives are another; use {MULTICAST}")
    if not interface or not channel:
        raise RigError(f"there is no bus '{kind}'; use {VCAN}, {MULTICAST} or INTERFACE:CHANNEL")
    return (Bus(interface, channel),)


class Turns:
    """Exclusive use of a bus among all tests of this machine, which may run at once."""

    def __init__(self) -> None:
        self._kept: Final = ExitStack()

    def takes(self, several: tuple[Bus, ...]) -> Bus:
        """Return the first that is free; where none is, wait for the first."""
        for bus in several:
            if self._locked(bus, waits=False):
                return bus
        self._locked(several[0], waits=True)
        return several[0]

    def finish(self) -> None:
        """Give it back."""
        self._kept.close()

    def _locked(self, bus: Bus, *, waits: bool) -> bool:
        name = f"firmware-bridge-{bus.interface}-{bus.channel.replace('/', '-')}.lock"
        file = Path(tempfile.gettempdir(), name).open("ab")  # noqa: SIM115 - it is kept open
        try:
            _lock(file, waits=waits)
        except BlockingIOError:
            file.close()
            return False
        self._kept.callback(file.close)
        return True


def _lock(file: IO[bytes], *, waits: bool) -> None:
    """Lock a file until it is closed; where the system has no such locks, all are let in."""
    with suppress(ImportError):
        import fcntl  # noqa: PLC0415 - not on Windows

        # An advisory lock of the kernel: it ends with the process, however that ends.
        fcntl.flock(file, fcntl.LOCK_EX | (0 if waits else fcntl.LOCK_NB))
