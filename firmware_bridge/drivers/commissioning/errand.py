"""What can be asked of a drive over any link, and how that can end.

It refuses to know the links; `can_link` and `serial_link` carry errands out.
"""

from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.abort import AbortCode, meaning_of
from firmware_bridge.wire.canopen import NmtCommand
from firmware_bridge.wire.epos2.address import Address

STORING: Final = frozenset({0x1010, 0x1011})
"""Indexes whose writes take as long as the drive's memory needs."""
STORE_TIMEOUT: Final[Nanoseconds] = 6 * SECOND
"""For these; maxon's command library waits 5 s."""


@dataclass(frozen=True, slots=True)
class Read:
    """Read an object."""

    address: Address

    def __str__(self) -> str:
        """Say it for people."""
        return f"reading {self.address}"


@dataclass(frozen=True, slots=True)
class Write:
    """Write an object with one to four bytes, low byte first."""

    address: Address
    raw: bytes

    def __str__(self) -> str:
        """Say it for people."""
        return f"writing {self.address}"


@dataclass(frozen=True, slots=True)
class Network:
    """Send a network command to a node, 0 for all; nobody answers."""

    command: NmtCommand
    node: int

    def __str__(self) -> str:
        """Say it for people."""
        return f"network command {self.command.name.lower().replace('_', ' ')}"


Errand: TypeAlias = Read | Write | Network


class ErrandError(Exception):
    """An errand that did not succeed; `errand` is the one."""

    def __init__(self, errand: Errand, problem: str) -> None:
        super().__init__(errand, problem)
        self.errand = errand
        self.problem = problem
        self.unheard = False
        """Whether the drive itself said nothing at all, so that asking for more is of no use."""

    def __str__(self) -> str:
        """Say it in one line."""
        return f"{self.errand}: {self.problem}"


class RefusedError(ErrandError):
    """The drive, or the one on the line in its place, said no."""

    def __init__(self, errand: Errand, code: int) -> None:
        super().__init__(errand, f"refused with {meaning_of(code)}")
        self.code = code
        self.unheard = code == AbortCode.TIMEOUT


class SilentError(ErrandError):
    """Nobody answered."""

    def __init__(self, errand: Errand, waited: Nanoseconds) -> None:
        super().__init__(errand, f"no answer within {waited // MILLISECOND} ms")
        self.waited = waited
        self.unheard = True


class BrokenAnswerError(ErrandError):
    """Something answered that breaks the protocol."""


Outcome: TypeAlias = bytes | ErrandError
"""What was read (empty after anything else), or why not."""


def patience(errand: Errand, usual: Nanoseconds) -> Nanoseconds:
    """Return how long to wait for an answer: the link's usual time, or what storing takes."""
    storing = isinstance(errand, Write) and errand.address.index in STORING
    return STORE_TIMEOUT if storing else usual


def attempts(errand: Errand, usual: int) -> int:
    """Return how often to ask: what stores is not asked twice."""
    return 1 if patience(errand, 0) else usual
