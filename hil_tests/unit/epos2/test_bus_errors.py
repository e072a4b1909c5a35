"""CAN error states at the drive: passive, bus off, overruns, each with its emergency and its way back."""

from typing import Final

import pytest

from emulators.epos2.drive import Epos2
from emulators.servo.axis import ServoAxis
from emulators.wires import Disturbance, FaultyCanWire
from emulators.wires.confinement import Condition
from emulators.world import World
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire.power_states import STATUSWORDS
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.can import ERROR
from firmware_bridge.wire.can_error import Loss
from hil_tests.unit.world.players import Player

ENABLE: Final = (
    (10, 0x000, "0100"),
    (20, 0x601, "2b02640001000000"),
    (30, 0x201, "0600"),
    (40, 0x201, "0F00"),
)
BEAT: Final = (5, 0x601, "2b17100005000000")


class Bench:
    """A drive that sends a heartbeat every 5 ms, and a master that has enabled it after 50 ms."""

    def __init__(self, *more: tuple[int, int, str], depth: int | None = None) -> None:
        story = (BEAT, *ENABLE, *more)
        self.master = Player(*((t * MILLISECOND, Packet(CAN, a, bytes.fromhex(b))) for t, a, b in story))
        self.axis = ServoAxis("drive", 2000)
        self.drive = Epos2(1, self.axis)
        self.wire = FaultyCanWire(1_000_000, depth=depth)
        self.world = World()
        self.world.attach("drive", self.drive, {CAN: self.wire})
        self.world.attach("master", self.master, {CAN: self.wire})
        self.world.run(60 * MILLISECOND)

    def until(self, ms: int) -> None:
        self.world.run(ms * MILLISECOND)

    def reported(self) -> list[str]:
        received = (packet for _, packet in self.master.received if not packet.address & ERROR)
        return [packet.payload.hex() for packet in received if packet.address == 0x081]

    @property
    def state(self) -> int:
        return self.drive.store.get(od.STATUSWORD) & 0x417F


def frame(code: int) -> str:
    return code.to_bytes(2, "little").hex() + "1000000000" + "00"


def test_the_bench_is_enabled() -> None:
    assert Bench().state == 0x0137


@pytest.mark.emergency(0x8120)
def test_an_error_passive_drive_states_so_and_stops_until_communication_is_reset() -> None:
    bench = Bench((120, 0x201, "0000"), (130, 0x201, "8000"), (150, 0x000, "8200"))
    bench.wire.disturb(Disturbance(sender="drive", begin=60 * MILLISECOND, count=16))
    bench.until(110)
    assert bench.reported() == [frame(0x8120)]
    assert bench.state == STATUSWORDS[PowerState.FAULT]
    assert not bench.axis.powered
    bench.until(140)
    assert bench.state == STATUSWORDS[PowerState.FAULT], "a fault reset alone does not reset it"
    assert bench.drive.store.get(od.ERROR_REGISTER) == 0x10
    bench.until(160)
    assert bench.drive.store.get(od.ERROR_REGISTER) == 0
    for payload in ("0000", "8000"):
        bench.drive.receive(Packet(CAN, 0x000, b"\x01\x01"), bench.world.now)
        bench.drive.receive(Packet(CAN, 0x201, bytes.fromhex(payload)), bench.world.now)
    assert bench.state == STATUSWORDS[PowerState.SWITCH_ON_DISABLED]


@pytest.mark.emergency(0x81FD)
def test_a_drive_that_was_off_the_bus_states_so_when_it_is_back() -> None:
    bench = Bench()
    begin: Nanoseconds = 60 * MILLISECOND
    bench.wire.disturb(Disturbance(sender="drive", begin=begin, count=32))
    while bench.wire.confinement("drive").condition is not Condition.OFF:
        bench.world.run(bench.world.now + MILLISECOND // 10)
        assert bench.world.now < begin + 20 * MILLISECOND
    assert bench.reported() == [], "no one receives it any more"
    assert bench.state == STATUSWORDS[PowerState.FAULT], "it stops all the same"
    bench.until(100)
    assert bench.reported() == [frame(0x81FD)]
    assert bench.drive.store.get(od.ERROR_HISTORY_COUNT) == 2, (
        "passive came first, and was lost with the rest"
    )


@pytest.mark.emergency(0x8110, 0x8111, 0x81FE)
@pytest.mark.parametrize(
    ("loss", "code"), [(Loss.OBJECT, 0x8110), (Loss.UNKNOWN, 0x8111), (Loss.QUEUE, 0x81FE)]
)
def test_an_overrun_is_an_emergency_and_stops_the_drive(loss: Loss, code: int) -> None:
    bench = Bench((100, 0x201, "0000"), (110, 0x201, "8000"))
    bench.wire.overrun("drive", loss)
    bench.until(90)
    assert bench.reported() == [frame(code)]
    assert bench.state == STATUSWORDS[PowerState.FAULT]
    bench.until(120)
    assert bench.state == STATUSWORDS[PowerState.SWITCH_ON_DISABLED]
    assert bench.reported()[1:] == ["00" * 8]


@pytest.mark.emergency(0x81FF)
def test_a_drive_that_cannot_get_rid_of_its_frames_stops_and_keeps_it_in_its_history() -> None:
    bench = Bench(depth=4)
    # Someone fills the bus with frames of the highest rank; the drive's heartbeats pile up behind them.
    flood = Player(*((60 * MILLISECOND + k * 45_000, Packet(CAN, 0x001, b"")) for k in range(1000)))
    bench.world.attach("flood", flood, {CAN: bench.wire})
    bench.until(75)
    assert bench.state == 0x0137
    bench.until(90)
    assert bench.state == STATUSWORDS[PowerState.FAULT]
    assert bench.drive.store.get(Address(0x1003, 1)) == 0x81FF
    assert bench.drive.store.get(od.ERROR_HISTORY_COUNT) == 1, "reported once, not for every frame"
    bench.until(150)
    assert frame(0x81FF) not in bench.reported(), "its message was one frame too many"
