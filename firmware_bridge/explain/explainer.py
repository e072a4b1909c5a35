"""A recording explained: its frames in their order go to the watchers, and incidents and remarks come out.

The kind of a frame is decided once for each identifier; PDOs are decoded once for each payload.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.address import Address
from firmware_bridge.dissector.expected import Expected
from firmware_bridge.explain.bus_state import BusState
from firmware_bridge.explain.drives import Drives
from firmware_bridge.explain.followed import FollowedBus, Pdo
from firmware_bridge.explain.incident import Incident, Incidents
from firmware_bridge.explain.nodes import NodesWatch
from firmware_bridge.explain.proofs import Proofs
from firmware_bridge.explain.source import Frame
from firmware_bridge.explain.traffic import SPAN, Traffic
from firmware_bridge.explain.transfers import Transfers
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.can import ERROR, EXTENDED, REMOTE

Handler: TypeAlias = Callable[[Nanoseconds, int, bytes], None]
_NODES: Final = range(cia301.FIRST_NODE, cia301.LAST_NODE + 1)
_PDOS: Final = range(cia301.TRANSMIT_PDO[0] + 1, cia301.SDO_RESPONSE + 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """What is known of a bus before its first frame."""

    bit_rate: int = 1_000_000
    device: str = ""
    """Family of nodes whose mapping was not seen to be written."""
    sheet: Mapping[Address, int] | None = None
    expected: tuple[Expected, ...] = ()


@dataclass(frozen=True, slots=True)
class Explained:
    """What a recording shows."""

    incidents: tuple[Incident, ...]
    frames: int
    nodes: tuple[int, ...]
    began_at: Nanoseconds
    ended_at: Nanoseconds
    remarks: tuple[str, ...] = ()
    lines: str = ""
    """The serial lines of the recording, as text; empty for frames of a bus."""


class BusExplainer:
    """One bus."""

    def __init__(self, setup: Setup, name: str = "") -> None:
        reader = FollowedBus(setup.device, sheet=setup.sheet, expected=setup.expected)
        titles = {one.node: one.title for one in setup.expected if one.title}
        incidents = Incidents(titles, f"bus {name}" if name else "the bus")
        self.state = BusState(reader, incidents, setup.bit_rate)
        self._drives = Drives(self.state)
        self._proofs = Proofs(self.state)
        self._nodes = NodesWatch(self.state, self._proofs)
        self._transfers = Transfers(self.state, self._drives)
        self._traffic = Traffic(self.state)
        self._handlers: dict[int, Handler] = {}
        self._tick_at: Nanoseconds = 0

    def take(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take a frame; an instant may step back, as in a recording that was merged."""
        if at >= self._tick_at:
            self._tick(at)
        self._traffic.count(address, len(payload))
        handler = self._handlers.get(address)
        if handler is None:
            handler = self._handlers[address] = self._handler(address)
            self._traffic.first(at, address, payload)
        handler(at, address, payload)

    @property
    def found(self) -> Sequence[Incident]:
        """The incidents so far, in the order in which they were found."""
        return self.state.incidents.found

    def end(self) -> None:
        """Judge what the recording ends with."""
        now = self.state.now
        self._traffic.tick(now, 1)
        self._transfers.tick(now)
        self._nodes.end(now)
        self._proofs.end()
        self._drives.end(now)

    def _tick(self, at: Nanoseconds) -> None:
        state = self.state
        if state.first_at is None:
            state.first_at = at
            self._tick_at = at
        spans = (at - self._tick_at) // SPAN + 1
        # Judged at the end of the span that is over, before a silence that may follow it.
        state.now = at
        self._traffic.tick(at, spans)
        self._nodes.tick(at)
        self._transfers.tick(at)
        self._drives.tick(at)
        self._tick_at += spans * SPAN

    def _handler(self, address: int) -> Handler:
        if address & ERROR:
            return self._traffic.error
        if address & EXTENDED:
            return _nothing
        if address & REMOTE:
            guarded = (address & cia301.COB_ID_MASK) - cia301.ERROR_CONTROL in _NODES
            return self._nodes.guarded if guarded else _nothing
        return self._service(address)

    def _service(self, address: int) -> Handler:
        if address in _PDOS:
            return self._pdo
        if address == cia301.NMT:
            return self._nodes.command
        if address == cia301.SYNC:
            return self._sync
        for base, handler in (
            (cia301.EMERGENCY, self._nodes.emergency),
            (cia301.SDO_RESPONSE, self._transfers.answered),
            (cia301.SDO_REQUEST, self._transfers.requested),
            (cia301.ERROR_CONTROL, self._nodes.beat),
        ):
            if address - base in _NODES:
                return handler
        return _nothing

    def _pdo(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        pdos: tuple[Pdo, ...] = self.state.reader.pdos(address)
        for pdo in pdos:
            if not pdo.known:
                self.state.undecoded.add(pdo.node)
            if pdo.transmit:
                self._drives.sent(at, address, payload, pdo)
            else:
                self._drives.received(at, address, payload, pdo)
        if pdos and not pdos[0].transmit:
            self._traffic.set_point(at, address, payload, pdos[0])

    def _sync(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        self._drives.synchronized()
        self._traffic.sync(at, address, payload)


def _nothing(_at: Nanoseconds, _address: int, _payload: bytes) -> None:
    """Take a frame that is none of CANopen's."""


def explain(frames: Iterable[Frame], setup: Setup, channel: str | None = None) -> Explained:
    """Explain the frames of a recording; of several buses each by itself, or one of them."""
    buses: dict[str, BusExplainer] = {}
    count, began, at = 0, None, 0
    for at, bus, address, payload in frames:
        if channel is not None and bus != channel:
            continue
        one = buses.get(bus)
        if one is None:
            one = buses[bus] = BusExplainer(setup, bus)
        if began is None:
            began = at
        count += 1
        one.take(at, address, payload)
    for one in buses.values():
        one.state.now = max(one.state.now, at)
        one.end()
    found = [incident for one in buses.values() for incident in one.state.incidents.found]
    seen = sorted({node.node for one in buses.values() for node in one.state.nodes.values() if node.seen})
    return Explained(
        tuple(sorted(found, key=lambda incident: incident.at)),
        count,
        tuple(seen),
        began or 0,
        at,
        tuple(text for one in buses.values() for text in remarks(one.state)),
    )


def remarks(state: BusState) -> Iterable[str]:
    """Yield what is no incident: proofs, PDOs that are not decoded, drives that have nowhere to go."""
    yield from state.remarks
    if state.undecoded:
        nodes = ", ".join(map(str, sorted(state.undecoded)))
        yield f"PDOs of node {nodes} are not decoded: no mapping is known; use --robot, --device or --eds"
    for node in sorted(state.nodes.values(), key=lambda one: one.node):
        drive = node.drive
        if not drive.enabled or node.motion.ever_moved or drive.target not in drive.targets:
            continue
        if state.incidents.any_of(node.node):
            continue
        where, value = state.incidents.where(node.node), drive.values.get(drive.target)
        yield f"{where} was enabled and never moved: its target {drive.target} is {value}"
