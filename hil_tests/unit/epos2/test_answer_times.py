"""Request and reply together take what maxon has published, at all seven bit rates.

Source: EPOS2 Application Notes Collection, April 2013, p. 168: times of one read or write over CAN.
"""

import pytest

from emulators.epos2.drive import Epos2
from emulators.epos2.objects.device_profile import BIT_RATES, EPOS2_70_10, DeviceProfile, realistic
from emulators.servo.axis import ServoAxis
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.rows import every
from hil_tests.unit.world.players import Player

PUBLISHED_MS = {
    1_000_000: 0.794,
    800_000: 0.850,
    500_000: 1.0,
    250_000: 1.5,
    125_000: 2.4,
    50_000: 5.3,
    20_000: 12.4,
}
REQUESTS = {
    "read the device type": "4000100000000000",
    "read the statusword": "4041600000000000",
    "read the position": "4064600000000000",
    "write the controlword": "2B40600006000000",
    "write the target": "237A600010270000",
}
REQUESTED = 500 * MILLISECOND


def answer_time(bit_rate: int, request: str, node: int, profile: DeviceProfile) -> Nanoseconds:
    world, wire = World(), CanWire(bit_rate)
    master = Player((REQUESTED, Packet(CAN, 0x600 + node, bytes.fromhex(request))))
    world.attach("drive", Epos2(node, ServoAxis("drive", 2000), profile), {CAN: wire})
    world.attach("master", master, {CAN: wire})
    world.run(2 * SECOND)
    (answered,) = [at for at, packet in master.received if packet.address == 0x580 + node]
    return answered - REQUESTED


@every("bit_rate", PUBLISHED_MS)
@every("node", [1, 5, 127])
@every("what", REQUESTS)
def test_a_transfer_takes_the_published_time(bit_rate: int, node: int, what: str) -> None:
    taken = answer_time(bit_rate, REQUESTS[what], node, realistic(EPOS2_70_10))
    assert taken / MILLISECOND == pytest.approx(PUBLISHED_MS[bit_rate], rel=0.05)


def test_without_latency_only_the_bus_takes_time() -> None:
    taken = answer_time(1_000_000, REQUESTS["read the statusword"], 1, EPOS2_70_10)
    assert taken / MILLISECOND == pytest.approx(0.24, abs=0.01)


def test_every_bit_rate_of_the_drive_is_published() -> None:
    assert set(PUBLISHED_MS) == set(BIT_RATES.values())


def test_only_the_drives_part_is_assumed() -> None:
    mark = EPOS2_70_10.known("sdo_latency")
    assert mark.provenance.value == "assumed"
    assert "p. 168" in mark.source
