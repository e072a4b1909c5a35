"""Scan of a bus, or of the nodes behind a serial line: each node's identity is read, one after the other.

It only reads. A node's own frames meanwhile, its heartbeat or its answer to another master's node guarding,
are received, too; the scan requests none, because a remote request begins a node's own watch over its master
(CiA 301).
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Final, TypeAlias

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NODE_MASK, NmtState
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.client import Ask, Do, Script, Wait, need
from firmware_bridge.families.epos2.commissioning.job import JobError, Outcome, ReadJob
from firmware_bridge.families.epos2.commissioning.network_command import SDO_SERVER
from firmware_bridge.families.epos2.commissioning.overview import network_states
from firmware_bridge.families.epos2.commissioning.serial_access import OWN, SerialAccess
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.families.epos2.wire.hardware import MAXON
from firmware_bridge.families.epos2.wire.power_states import state_of
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, Nanoseconds

TIMEOUT: Final[Nanoseconds] = 50 * MILLISECOND
"""For one answer on the bus. The drive needs 1 to 13 ms, by the bit rate (EPOS2 Application Notes, p. 168).
Assumed: an adapter behind USB, and a busy machine, add less than the rest."""
DRIVES_PROFILE: Final = 402
SOFTWARE: Final = Address(0x2003, 1)
HARDWARE: Final = Address(0x2003, 2)
SERIAL_NUMBER: Final = Address(0x2004)
_PROFILE_MASK: Final = 0xFFFF


class ScannedNode:
    """The answers of one node."""

    def __init__(self, node: int, *, alone: bool) -> None:
        """Take `alone`: it is on its own line, which answers in every network state."""
        self.node: Final = node
        self._alone = alone
        self.outcomes: dict[Address, Outcome] = {}
        """Outcome of each request, in the order of the requests."""
        self.received: NmtState | None = None
        """The state that it has reported without a request of ours."""

    @property
    def answers(self) -> bool:
        """True where it has answered any request."""
        return bool(self.outcomes)

    def value(self, address: Address) -> int | str | None:
        """Return what it has answered; None where it has not, or refused."""
        raw = self.outcomes.get(address)
        return ANY_TYPE.decoded(address, raw) if isinstance(raw, bytes) else None

    def number(self, address: Address) -> int | None:
        """Return what it has answered where that is a number."""
        value = self.value(address)
        return value if isinstance(value, int) else None

    @property
    def maxon(self) -> bool:
        """True where maxon has made it."""
        return self.value(od.VENDOR_ID) == MAXON

    @property
    def profile(self) -> int | None:
        """The number of its device profile, 402 for a drive; 0 where it follows none (CiA 301, 0x1000)."""
        kind = self.number(od.DEVICE_TYPE)
        return None if kind is None else kind & _PROFILE_MASK

    @property
    def state(self) -> PowerState | None:
        """State of a drive's power state machine; None where no Statusword gives one."""
        word = self.number(od.STATUSWORD)
        return None if word is None else state_of(word)

    @property
    def network(self) -> tuple[NmtState, ...]:
        """Network states that it may be in: the reported one, or, of an EPOS2, those of its Statusword."""
        word = self.number(od.STATUSWORD)
        if self.received is not None:
            return (self.received,)
        return network_states(word, alone=self._alone) if self.maxon and word is not None else ()

    def next_question(self) -> Address | None:
        """Return the first object of interest that was not requested; None when all were."""
        wanted = (address for of, rows in _QUESTIONS if of(self) for address in rows)
        return next((address for address in wanted if address not in self.outcomes), None)


_Of: TypeAlias = Callable[[ScannedNode], bool]
_QUESTIONS: Final[tuple[tuple[_Of, tuple[Address, ...]], ...]] = (
    (
        lambda _found: True,
        (od.DEVICE_TYPE, od.VENDOR_ID, od.PRODUCT_CODE, od.REVISION, od.SERIAL_NUMBER, od.DEVICE_NAME),
    ),
    (lambda found: found.maxon, (SOFTWARE, HARDWARE, SERIAL_NUMBER)),
    (lambda found: found.profile == DRIVES_PROFILE, (od.STATUSWORD,)),
)
"""The objects to request, by the node's answers so far."""


class Scan:
    """The questions, and who has answered. Its script can be carried out once."""

    def __init__(self, link: CanAccess | SerialAccess, nodes: Sequence[int], listen: Nanoseconds = 0) -> None:
        """Take `listen`: time without requests in which heartbeats are received."""
        self.requested: list[int] = []
        self.own: int | None = None
        """The number of the drive on a serial line."""
        self._link = link
        self._nodes = tuple(nodes)
        self._listen = listen
        self._found: dict[int, ScannedNode] = {}

    @property
    def found(self) -> tuple[ScannedNode, ...]:
        """The nodes that have answered or were received, by number."""
        return tuple(found for _, found in sorted(self._found.items()))

    @property
    def silent(self) -> tuple[int, ...]:
        """The nodes that have not answered a request, nor were received."""
        return tuple(node for node in sorted(self.requested) if node not in self._found)

    def script(self) -> Script:
        """Listen, and query all nodes; on a serial line its drive first, without whose answer it ends."""
        if isinstance(self._link, SerialAccess):
            self._link.node = OWN
            return (Ask(ReadJob(SDO_SERVER), need(self._begin)),)
        listening = (Wait(self._listen),) if self._listen else ()
        return (*listening, *self._all(self._nodes))

    def overhear(self, packet: Packet) -> None:
        """Take note of a packet that is no one's answer to a question."""
        node = packet.address - cia301.ERROR_CONTROL
        if packet.link != CAN or not cia301.FIRST_NODE <= node <= cia301.LAST_NODE:
            return
        state = cia301.decode_heartbeat(packet.payload)
        if state is not None:
            self._of(node).received = state

    def _begin(self, raw: bytes) -> Script:
        """Go on from the drive on the line, whose number is in the identifier of its SDO server."""
        self.own = int.from_bytes(raw, "little") & NODE_MASK
        others = (node for node in self._nodes if node != self.own)
        return self._all((self.own, *others))

    def _all(self, nodes: Sequence[int]) -> Script:
        return tuple(Do(partial(self._begin_with, node)) for node in nodes)

    def _begin_with(self, node: int) -> Script:
        self._link.node = OWN if node == self.own else node
        self.requested.append(node)
        return (Ask(ReadJob(od.DEVICE_TYPE), partial(self._on_answer, node, od.DEVICE_TYPE)),)

    def _on_answer(self, node: int, address: Address, outcome: Outcome) -> Script:
        if isinstance(outcome, JobError) and outcome.unheard:
            # A node that is not there costs one time limit, and not one for each object.
            return ()  # nor would it answer the next one
        found = self._of(node)
        found.outcomes[address] = outcome
        following = found.next_question()
        return (
            () if following is None else (Ask(ReadJob(following), partial(self._on_answer, node, following)),)
        )

    def _of(self, node: int) -> ScannedNode:
        return self._found.setdefault(node, ScannedNode(node, alone=node == self.own))
