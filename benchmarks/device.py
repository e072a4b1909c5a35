"""One emulated drive as a CANopen device, beside two libraries that others use for such.

`canopen` (LocalNode) and `durand` come with `make bench`. They serve a real bus in real time, and
python-can's virtual bus knows neither bits nor arbitration.
"""

import importlib.util
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import count, cycle, islice
from typing import Final

from benchmarks import foreign_stations
from benchmarks.drives import BIT_RATE
from benchmarks.figure import Figure
from benchmarks.measure import both_clocks, interleaved, processor_seconds
from emulators.canopen.sdo_server import SdoServer
from emulators.epos2.drive import Epos2
from emulators.servo.axis import ServoAxis
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen.address import Address
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds

QUADCOUNTS: Final = 2_000
"""Edges of the encoder in one turn."""
REQUESTS: Final = 20_000
OBJECTS: Final = tuple(Address(index) for index in foreign_stations.INDEXES)
ROUND_TRIPS: Final = 2_000
FRAMES: Final = 40_000
FILLED: Final[Nanoseconds] = 5 * SECOND
LEAST_SERVED: Final = 100_000
LEAST_FRAMES: Final = 100_000
WANTED: Final = "what is wanted"
LEAST_TIMES: Final = 50.0

Served = Callable[[bytes], bytes | None]
"""A request's bytes in, the answer's bytes out."""


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of request, always answered alike."""

    name: str
    requests: tuple[bytes, ...]


KINDS: Final = (
    Kind("read a number", tuple(sdo.encode_upload(each) for each in OBJECTS)),
    Kind(
        "write a number",
        tuple(
            sdo.encode_download(each, value.to_bytes(4, "little"))
            for value in range(1000, 1064)
            for each in OBJECTS
        ),
    ),
    Kind("object that is not there", (sdo.encode_upload(Address(0x5FFF)),)),
)


def drive() -> Epos2:
    """Return a whole drive, with every object and hook that it has."""
    return Epos2(foreign_stations.NODE, ServoAxis("motor", QUADCOUNTS))


def served_often(served: Served, kind: Kind) -> Callable[[], None]:
    """Return a run that has these requests served again and again."""

    def run() -> None:
        for request in islice(cycle(kind.requests), REQUESTS):
            served(request)

    return run


def whole_drive() -> Served:
    """Return a drive that is up: each request half a millisecond after the one before."""
    node = drive()
    now = count(SECOND, MILLISECOND // 2)
    node.wake(0)

    def served(request: bytes) -> bytes | None:
        reaction = node.receive(Packet(CAN, cia301.SDO_REQUEST + foreign_stations.NODE, request), next(now))
        return reaction.sent[0].payload if reaction.sent else None

    return served


def rates_of(kind: Kind, servers: Mapping[str, Served]) -> dict[str, float]:
    """Return requests a second by the name of who serves them."""
    times = interleaved([served_often(served, kind) for served in servers.values()])
    return dict(zip(servers, (REQUESTS / spent for spent in times), strict=True))


def beside(ours: Served, makers: Mapping[str, Callable[[], Served]]) -> dict[str, Served]:
    """Return ours and those third-party servers that are here."""
    return {"ours": ours} | {name: make() for name, make in makers.items() if installed(name)}


def pure_server() -> Iterator[Figure]:
    """Compare servers and nodes without a bus, which ours has its whole table of objects for."""
    servers = beside(SdoServer(drive().store).answer, foreign_stations.SERVERS)
    for kind in KINDS:
        rates = rates_of(kind, servers)
        yield _wanted(f"SDO server: {kind.name}", rates["ours"], LEAST_SERVED)
        yield from _against(f"SDO server: {kind.name}", rates, None)
    whole = rates_of(KINDS[0], beside(whole_drive(), foreign_stations.WHOLE))
    yield from _against(f"whole node: {KINDS[0].name}", whole, None)


def _wanted(name: str, rate: float, least: float) -> Figure:
    """Give a rate that shall be so large at least."""
    return Figure(name=name, value=rate, unit="/s", against=WANTED, reference=least, goal=1.0, at_least=True)


def _against(name: str, rates: Mapping[str, float], goal: float | None) -> Iterator[Figure]:
    """Give our rate beside each of the others'; nothing where none of them is installed."""
    for other in foreign_stations.SERVERS:
        if other in rates:
            yield Figure(
                name=f"{name}, against {other}",
                value=rates["ours"],
                unit="/s",
                against=other,
                reference=rates[other],
                goal=goal,
                at_least=True,
            )


class Client:
    """Client that sends the next request as soon as it has an answer."""

    def __init__(self) -> None:
        self.answers = 0
        self._request = Packet(CAN, cia301.SDO_REQUEST + foreign_stations.NODE, KINDS[0].requests[0])

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Count an answer, and ask."""
        del now
        if packet.address != cia301.SDO_RESPONSE + foreign_stations.NODE:
            return Reaction((), SECOND)
        self.answers += 1
        return Reaction((self._request,))

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send the first request when the drive is up."""
        return Reaction((self._request,)) if now >= SECOND else Reaction((), SECOND)


def round_trips() -> Iterator[Figure]:
    """Compare a client and a node on the bus that each has, by the wall's time.

    Ours has stuff bits, arbitration and a trace; theirs is python-can's virtual bus, with threads.
    """
    world, wire, client = World(), CanWire(BIT_RATE), Client()
    world.attach("drive", drive(), {CAN: wire})
    world.attach("client", client, {CAN: wire})
    world.run(SECOND)
    before = client.answers
    spent = both_clocks(partial(world.run, 4 * SECOND))[1]
    rates = {"ours": (client.answers - before) / spent}
    for name, make in foreign_stations.NODES.items():
        if installed(name):
            run = foreign_stations.round_trips(make, KINDS[0].requests[0], ROUND_TRIPS)
            rates[name] = ROUND_TRIPS / both_clocks(run)[1]
    yield from _against("SDO over a bus", rates, LEAST_TIMES)


class Talker:
    """Node that keeps the bus full: a frame of its own in each period."""

    def __init__(self, node: int, every: Nanoseconds) -> None:
        self._address = cia301.TRANSMIT_PDO[0] + node
        self._every = every
        self._count = 0

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Ignore the frame; the next one stays due."""
        del packet
        return Reaction((), now - now % self._every + self._every)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send one frame; its payload is another each time."""
        self._count += 1
        frame = Packet(CAN, self._address, self._count.to_bytes(8, "little"))
        return Reaction((frame,), now - now % self._every + self._every)


class Ear:
    """Node that receives, and sends nothing."""

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Receive a frame."""
        del packet, now
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        """Send nothing."""
        del now
        return Reaction((), NEVER)


def frames() -> Iterator[Figure]:
    """Measure the bus alone, beside one without bits or arbitration."""
    rate = FRAMES / processor_seconds(partial(foreign_stations.frames, FRAMES))
    for talkers in (1, 4):
        world, wire = World(), CanWire(BIT_RATE)
        for node in range(1, talkers + 1):
            world.attach(f"talker{node}", Talker(node, talkers * 140_000), {CAN: wire})
        world.attach("ear", Ear(), {CAN: wire})
        before = wire.frames
        spent = processor_seconds(partial(world.run, FILLED))
        name, carried = f"frames through the timed bus, {talkers} sending", (wire.frames - before) / spent
        yield _wanted(name, carried, LEAST_FRAMES)
        yield Figure(
            name=f"{name}, against python-can",
            value=carried,
            unit="/s",
            against="its virtual bus, untimed",
            reference=rate,
        )


def installed(name: str) -> bool:
    """Return True if a third-party server is installed."""
    return importlib.util.find_spec(name) is not None


def figures() -> Iterator[Figure]:
    """Measure servers, round trips and frames."""
    yield from pure_server()
    yield from round_trips()
    yield from frames()
