"""One emulated drive as a CANopen device, beside two libraries that others use for such; then 127 drives.

Usage: python -m benchmarks.device

`canopen` (LocalNode) and `durand` come with `make bench`; without them a table shows "not installed". They
serve a real bus in real time, and python-can's virtual bus knows neither bits nor arbitration; ours does that
work, too, wherever a row has "timed bus". Each table names the compared tasks.
"""

import ctypes
import importlib.util
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import count, cycle, islice
from pathlib import Path
from typing import Final

from benchmarks import foreign_stations
from benchmarks.drives import BIT_RATE, crowd, only_sync
from benchmarks.measure import both_clocks, interleaved, processor_seconds, show
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
from hil_tests.unit.servo.side_by_side import PLANT, compiled

QUADCOUNTS: Final = 2_000
"""Edges of the encoder in one turn."""
REQUESTS: Final = 20_000
OBJECTS: Final = tuple(Address(index) for index in foreign_stations.INDEXES)
ROUND_TRIPS: Final = 2_000
FRAMES: Final = 40_000
FILLED: Final[Nanoseconds] = 5 * SECOND
NODES: Final = 127
PERIOD: Final[Nanoseconds] = 100 * MILLISECOND
LEAST_REQUESTS: Final = 100_000
LEAST_FRAMES: Final = 100_000
LEAST_TIMES: Final = 50
MISSING: Final = "not installed"
NAMES: Final = ("ours", *foreign_stations.SERVERS)

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


def pure_server() -> bool:
    """Compare servers and nodes without a bus; whether ours is as fast as it is meant to be."""
    servers = beside(SdoServer(drive().store).answer, foreign_stations.SERVERS)
    rates = {f"server: {kind.name}": rates_of(kind, servers) for kind in KINDS}
    slowest = min(row["ours"] for row in rates.values())
    rates["whole node: read a number"] = rates_of(KINDS[0], beside(whole_drive(), foreign_stations.WHOLE))
    show(
        "SDO without a bus: bytes of a request in, bytes of the answer out; requests a second",
        ("request", *NAMES),
        [[title, *(reported(row.get(name)) for name in NAMES)] for title, row in rates.items()],
        "four objects in turn, 64 values; ours has the drive's whole table and checks access, size, range;"
        " the whole node also supervises motion and looks for process data that have changed",
    )
    return slowest >= LEAST_REQUESTS


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


def round_trips() -> bool:
    """Compare a client and a node on the bus that each has; whether ours is so many times faster."""
    world, wire, client = World(), CanWire(BIT_RATE), Client()
    world.attach("drive", drive(), {CAN: wire})
    world.attach("client", client, {CAN: wire})
    world.run(SECOND)
    before = client.answers
    spent = {"ours": both_clocks(partial(world.run, 4 * SECOND))}
    rates = {"ours": [(client.answers - before) / each for each in spent["ours"]]}
    for name, make in foreign_stations.NODES.items():
        if installed(name):
            run = foreign_stations.round_trips(make, KINDS[0].requests[0], ROUND_TRIPS)
            rates[name] = [ROUND_TRIPS / each for each in both_clocks(run)]
    rows = []
    for place, clock in enumerate(("of the processor's time", "of the wall's time")):
        row = {name: each[place] for name, each in rates.items()}
        rows.append([f"a second {clock}", *(reported(row.get(name)) for name in NAMES)])
        times = {name: f"{row['ours'] / rate:.1f}" for name, rate in row.items()}
        rows.append(["  ours, times theirs", *(times.get(name, MISSING) for name in NAMES)])
    show(
        "SDO, a client and a node on a bus: requests answered",
        ("", *NAMES),
        rows,
        "ours: timed bus with stuff bits, arbitration, trace; theirs: python-can's virtual bus, with threads",
    )
    ours = rates.pop("ours")
    return all(ours[1] >= LEAST_TIMES * theirs[1] for theirs in rates.values())


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


def frames() -> bool:
    """Measure the bus alone; whether it carries as many frames as it is meant to."""
    rows = []
    best = 0.0
    for talkers in (1, 4):
        world, wire = World(), CanWire(BIT_RATE)
        for node in range(1, talkers + 1):
            world.attach(f"talker{node}", Talker(node, talkers * 140_000), {CAN: wire})
        world.attach("ear", Ear(), {CAN: wire})
        before = wire.frames
        spent = processor_seconds(partial(world.run, FILLED))
        rate = (wire.frames - before) / spent
        best = max(best, rate)
        rows.append([f"timed bus: {talkers} sending, all receive", reported(rate)])
    rate = FRAMES / processor_seconds(partial(foreign_stations.frames, FRAMES))
    rows.append(["python-can's virtual bus, untimed: one sends, one receives", reported(rate)])
    show("CAN frames a second of the processor's time", ("bus", "frames/s"), rows)
    return best >= LEAST_FRAMES


def full_bus() -> bool:
    """Run 127 drives; whether one core can keep up with the time."""
    rows = []
    factors = []
    with tempfile.TemporaryDirectory() as folder:
        motors = ctypes.CDLL(str(compiled(Path(folder), PLANT, "-O2")))
        for name, library in (("without motors", None), ("with motors, each regulated at 10 kHz", motors)):
            heartbeat = PERIOD // MILLISECOND
            many = crowd(NODES, motors=library, every=PERIOD, heartbeat_ms=heartbeat, cycle=only_sync)
            before = many.wire.frames
            spent = processor_seconds(many.runs_a_second)
            carried = many.wire.frames - before
            factors.append(1.0 / spent)
            rows.append([name, reported(carried), f"{factors[-1]:.2f}", reported(carried / spent)])
    show(
        f"{NODES} drives on one bus: a heartbeat and one transmit PDO each, every {PERIOD // MILLISECOND} ms",
        ("drives", "frames in a second", "real-time factor", "frames/s of processor"),
        rows,
    )
    return min(factors) >= 1.0


def installed(name: str) -> bool:
    """Return True if a third-party server is installed."""
    return importlib.util.find_spec(name) is not None


def reported(rate: float | None) -> str:
    """Return a rate for people."""
    return MISSING if rate is None else f"{rate:,.0f}"


def main() -> int:
    """Print all, and which goals are missed: another machine may reach them."""
    goals: Sequence[tuple[str, Callable[[], bool]]] = (
        (f"{LEAST_REQUESTS:,} SDO requests a second, pure server work", pure_server),
        (f"{LEAST_TIMES} times as many round trips as the others", round_trips),
        (f"{LEAST_FRAMES:,} frames a second through the timed bus", frames),
        (f"{NODES} drives in real time", full_bus),
    )
    for goal, measured in goals:
        if not measured():
            print(f"missed: {goal}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
