"""`monitor --ask`: PDO mappings are read from emulated drives, one request at a time; nothing is written."""

from collections.abc import Iterator

import pytest

from emulators.canopen.slave import CanopenSlave
from emulators.devices import devices
from emulators.gateway import Cluster
from firmware_bridge.canopen.cia301 import SDO_REQUEST
from firmware_bridge.canopen.sdo import UploadRequest, decode_request
from firmware_bridge.cli.monitor import Listening
from firmware_bridge.cli.monitor_mappings import PATIENCE, MappingReader
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds


class Bus:
    """Drives of a robot and the monitor; what each sends, the others receive."""

    def __init__(self) -> None:
        made = devices(find("diff_drive"))
        self.plant = made.plant
        self.drives = Cluster({name: one.node for name, one in made.stations.items()}, made.physics)
        self.nodes = [one.node_id for one in made.nodes(CanopenSlave).values()]
        self.picture = BusPicture(1_000_000)
        self.monitor = MappingReader(Listening(self.picture, lambda _: None, lambda: None), self.picture)
        self.now: Nanoseconds = 0
        self.sent: list[Packet] = []
        self.silent = False

    def runs(self, milliseconds: int) -> None:
        for _ in range(milliseconds):
            self.now += MILLISECOND
            waiting = [*self.drives.wake(self.now).sent]
            self._requested(self.monitor.wake(self.now).sent, waiting)
            while waiting:
                self._requested(self.monitor.receive(waiting.pop(0), self.now).sent, waiting)

    def _requested(self, requests: tuple[Packet, ...], waiting: list[Packet]) -> None:
        for request in requests:
            self.sent.append(request)
            if not self.silent:
                waiting += self.drives.receive(request, self.now).sent


@pytest.fixture
def bus() -> Iterator[Bus]:
    made = Bus()
    yield made
    made.plant.close()


def test_mappings_are_known_after_it_and_nothing_was_written(bus: Bus) -> None:
    bus.runs(500)
    read = [decode_request(packet.payload) for packet in bus.sent]
    assert read
    assert all(isinstance(one, UploadRequest) for one in read)
    assert {packet.address - SDO_REQUEST for packet in bus.sent} == {seen.node for seen in bus.picture.nodes}
    # Without it the bytes of such a frame would be shown as they are.
    bus.picture.note(bus.now, Packet(CAN, 0x181, bytes.fromhex("3702")))
    assert "0x6041" in bus.picture.text_of(Packet(CAN, 0x181, bytes.fromhex("3702")))


def test_one_request_is_under_way_at_each_node(bus: Bus) -> None:
    bus.silent = True
    bus.runs(PATIENCE // MILLISECOND)
    assert sorted(packet.address - SDO_REQUEST for packet in bus.sent) == sorted(bus.nodes)
    bus.runs(2 * PATIENCE // MILLISECOND)
    assert len(bus.sent) == 3 * len(bus.nodes)


def test_it_ends_by_itself(bus: Bus) -> None:
    bus.runs(500)
    before = len(bus.sent)
    bus.runs(1_500)
    assert len(bus.sent) == before
    assert bus.monitor.wake(bus.now).wake_at < NEVER
