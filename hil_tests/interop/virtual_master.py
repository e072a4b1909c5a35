"""A python-can bus and a receiver for the `canopen` library, above the virtual bus.

Each send lets the world run until the answers are there, so the library's own time-outs, which read the real
clock, never come into play. Where the library waits for a PDO, in one thread as it does on any bus, the
world's time goes on in another. Nothing of the library is replaced.
"""

import threading
from pathlib import Path
from typing import Any, Final

import can
import canopen
from canopen.profiles.p402 import BaseNode402

from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.canopen.cia301 import SYNC
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from firmware_bridge.wire.can import REMOTE, identifier

PATIENCE_S: Final = 30.0
SYNC_PERIOD: Final[Nanoseconds] = 10 * MILLISECOND


class Listener:
    """The master's ear on the wire, and its SYNC where it has been given a period."""

    def __init__(self, network: canopen.Network) -> None:
        self.network = network
        self.received: list[Packet] = []
        self.synchronizes = False

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self.received.append(packet)
        if not packet.address & REMOTE:
            self.network.notify(identifier(packet.address), bytearray(packet.payload), now / 1e9)
        return Reaction((), now - now % SYNC_PERIOD + SYNC_PERIOD)

    def wake(self, now: Nanoseconds) -> Reaction:
        return Reaction((Packet(CAN, SYNC, b""),) if self.synchronizes else (), now + SYNC_PERIOD)


class VirtualBus:
    """Stand-in for a python-can bus in `canopen`."""

    def __init__(self, world: World, wire: CanWire, station: Any) -> None:
        self.world, self.wire, self.station = world, wire, station
        self.turns = threading.RLock()
        """Lock of the thread that moves the world."""

    def send(self, message: can.Message) -> None:
        address = message.arbitration_id | (REMOTE if message.is_remote_frame else 0)
        with self.turns:
            self.wire.carry(self.station, Packet(CAN, address, bytes(message.data or b"\0" * message.dlc)))
            self.runs(0.002)

    def runs(self, seconds: float) -> None:
        with self.turns:
            self.world.run(self.world.now + from_seconds(seconds))


class Master:
    """A `canopen` network with one CiA 402 node on a virtual bus; its boot-up was received."""

    def __init__(self, world: World, wire: CanWire, node: int, objects: Any) -> None:
        self.world, self.wire = world, wire
        self.network = canopen.Network()
        self.ear = Listener(self.network)
        self.bus = VirtualBus(world, wire, world.attach("master", self.ear, {CAN: wire}))
        self.network.bus = self.bus  # what `connect` would set
        self.node: Any = BaseNode402(node, objects)
        self.network.add_node(self.node)
        self.bus.runs(0.5)


class PdoMaster(Master):
    """Master that knows the drive by a data sheet, and receives its statusword with every SYNC."""

    def __init__(self, world: World, wire: CanWire, sheet: Path | canopen.ObjectDictionary) -> None:
        """`sheet`: a file, or what was read from one."""
        read = canopen.import_od(str(sheet), node_id=1) if isinstance(sheet, Path) else sheet
        super().__init__(world, wire, 1, read)
        # The library's limits are of the machine's clock; time is virtual here, and the machine may be busy.
        self.node.TIMEOUT_CHECK_TPDO = PATIENCE_S
        self._over = threading.Event()
        self._clock = threading.Thread(target=self._goes_on, daemon=True)
        self._clock.start()

    def ready(self) -> None:
        """Have `canopen` read the PDO settings, and start the node, which then sends its statusword."""
        self.node.nmt.state = "PRE-OPERATIONAL"
        self.node.setup_402_state_machine(read_pdos=True)
        reported = self.node.tpdo[1]
        reported.trans_type = 1
        reported.save()
        self.ear.synchronizes = True
        self.node.nmt.state = "OPERATIONAL"
        self.bus.runs(0.03)

    def close(self) -> None:
        """End the thread, and let go of the bus."""
        self._over.set()
        self._clock.join()
        self.network.bus = None

    def _goes_on(self) -> None:
        """Let the world run while the library waits for a PDO, and only then."""
        waits = [pdo.receive_condition for pdo in self.node.tpdo.values()]
        while not self._over.wait(0.0005):
            # There is no public notice of a waiting thread; the condition is looked at, and left as it is.
            while any(each._waiters for each in waits) and not self._over.is_set():  # noqa: SLF001 - looked at
                self.bus.runs(0.005)
