"""Exchanges in the manner of clients that are in use: what they take for granted, a drive must bear.

None is copied from a program: each is the order of reads and writes by which such a client goes about it.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import canopen
import pytest

from emulators.epos2.documents.eds import dcf
from emulators.epos2.drive import Epos2
from emulators.epos2.objects.choices import chosen
from emulators.epos2.objects.device_profile import EPOS2_70_10, DeviceProfile, numbered, realistic
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import MOTOR, DcMotors
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.families.epos2.maxon.messages import (
    Done,
    ObjectRead,
    ReadObject,
    SendNmtService,
    WriteObject,
)
from firmware_bridge.families.epos2.wire.differences import objects_of
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.interop.virtual_master import Master
from hil_tests.unit.epos2.quiet_motion import powered
from hil_tests.unit.epos2_serial.serial_desk import FAR, NEAR, SerialDesk, both
from hil_tests.unit.world.players import Player

# A mode and a speed, as a client sets them up before it begins; the default gains fit the motor.
MODE = ((0x6402, 0, 1, 2), (0x6060, 0, 1, 1))
PROFILE = ((0x6081, 0, 3000, 4),)
NEAR_QC = 40
ENABLED = (0x06, 0x0F, 0x010F)
ABSOLUTE_AT_ONCE, RELATIVE_AT_ONCE = 0x3F, 0x7F

Write = Callable[[int, int, int, int], None]


def moves(write: Write, waits: Callable[[], None], position: Callable[[], int]) -> None:
    """Move as maxon's library does: 0x607A, then the controlword with bit 4, which is never lowered."""
    for index, subindex, value, size in (*MODE, *PROFILE):
        write(index, subindex, value, size)
    for word in ENABLED:
        write(0x6040, 0, word, 2)
        waits()
    for target in (1000, -2000, 3000):
        write(0x607A, 0, target, 4)
        write(0x6040, 0, ABSOLUTE_AT_ONCE, 2)
        waits()
        assert position() == pytest.approx(target, abs=NEAR_QC)
    for _ in range(2):
        write(0x607A, 0, -500, 4)
        write(0x6040, 0, RELATIVE_AT_ONCE, 2)
        waits()
    assert position() == pytest.approx(2000, abs=NEAR_QC)


@pytest.mark.parametrize(
    ("generation", "node"), [(Generation.V1, NEAR), (Generation.V2, FAR)], ids=["own", "gateway"]
)
def test_a_client_on_the_line_that_never_lowers_bit_4(generation: Generation, node: int) -> None:
    desk = SerialDesk(generation, moving=True)

    def write(index: int, subindex: int, value: int, _size: int) -> None:
        raw = (value & 0xFFFF_FFFF).to_bytes(4, "little")
        assert desk.requests(WriteObject(index, subindex, node, raw)) == Done(0)

    def position() -> int:
        answer = desk.requests(ReadObject(0x6064, 0, node))
        assert isinstance(answer, ObjectRead)
        return int.from_bytes(answer.raw, "little", signed=True)

    moves(write, lambda: desk.waits(700 * MILLISECOND), position)
    still = desk.far if node != FAR else desk.drive
    assert still.store.get(od.CONTROLWORD) == 0


class Bench(Master):
    """One drive with a motor, and a master that knows it by its data sheet or a configuration file."""

    def __init__(self, sheet: Path, profile: DeviceProfile = EPOS2_70_10) -> None:
        axis = ServoAxis("motor", 2000)
        world, wire = World(ServoBank(DcMotors((MOTOR,)), [axis])), CanWire(1_000_000)
        self.drive = Epos2(1, axis, profile)
        world.attach("motor", self.drive, {CAN: wire})
        super().__init__(world, wire, 1, canopen.import_od(str(sheet), node_id=1))

    def values(self) -> dict[Any, int | bytes]:
        """Return what can be read of the drive, as `epos2 dcf` reads it."""
        store = self.drive.store
        return {
            row.address: row.type.decode(raw) if row.type.size else raw
            for row in objects_of().values()
            if row.access.readable and row.type is not DataType.DOMAIN
            for raw in (store.read(row.address),)
        }


@pytest.fixture
def bench(sheet: Path) -> Iterator[Bench]:
    made = Bench(sheet)
    yield made
    made.network.bus = None


def test_a_client_on_can_that_never_lowers_bit_4(bench: Bench) -> None:
    sdo = bench.node.sdo

    def write(index: int, subindex: int, value: int, size: int) -> None:
        sdo.download(index, subindex, (value & (1 << 8 * size) - 1).to_bytes(size, "little"))

    moves(write, lambda: bench.bus.runs(0.7), lambda: int(sdo[0x6064].raw))


def test_a_client_that_remaps_a_pdo_which_is_valid() -> None:
    # A published driver sets only the number of entries to 0, and leaves bit 31 of the COB-ID as it is.
    desk = powered()
    for index, entries in ((0x1600, (0x6040_0010, 0x607A_0020)), (0x1A00, (0x6041_0010, 0x6064_0020))):
        assert desk.writes(index, 0, b"\0") == "ok"
        for place, entry in enumerate(entries, start=1):
            assert desk.writes(index, place, entry.to_bytes(4, "little")) == "ok"
        assert desk.writes(index, 0, b"\2") == "ok"
    assert desk.receives("000#0101") == ["181#400700000000"]
    desk.receives("201#0600D2040000")
    assert desk.store.get(od.TARGET_POSITION) == 1234
    assert desk.motion.written == [6]


def test_a_client_that_loads_our_configuration_file(bench: Bench, tmp_path: Path) -> None:
    # Someone has set the drive up, remapped a PDO of it, written its file and loads that into another drive.
    bench.drive.store.write(od.PROFILE_VELOCITY, (777).to_bytes(4, "little"))
    entries = (bytes.fromhex(each) for each in ("10004060", "2000ff60"))
    for index, raw in ((0, b"\0"), *enumerate(entries, start=1), (0, b"\2")):
        bench.node.sdo.download(0x1602, index, raw)
    bench.drive.store.write(od.CONTROLWORD, b"\x06\0")
    text = dcf(EPOS2_70_10, 1, 1_000_000, bench.values())
    path = tmp_path / "node1.dcf"
    path.write_text(text, encoding="ascii")
    other = Bench(path)
    other.node.nmt.state = "PRE-OPERATIONAL"
    try:
        other.node.load_configuration()
        assert other.node.sdo[0x6081].raw == 777
        assert other.drive.store.read(od.CONTROLWORD) == b"\0\0", "a command is no configuration"
        differing = {
            str(address): (value, other.values()[address])
            for address, value in bench.values().items()
            if objects_of()[address].access.writable
            and address != od.CONTROLWORD
            and other.values()[address] != value
        }
        assert differing == {}
    finally:
        other.network.bus = None


COMMANDS = (0x1010, 0x1011, 0x6040, 0x607A, 0x60FF, 0x2062, 0x206B, 0x2030, 0x20C1, 0x2010)


@pytest.mark.parametrize("index", COMMANDS)
def test_the_configuration_file_has_no_value_of_a_command(bench: Bench, index: int) -> None:
    lines = dcf(EPOS2_70_10, 1, 1_000_000, bench.values()).splitlines()
    begun = [place for place, line in enumerate(lines) if line.startswith(f"[{index:04X}")]
    assert begun
    for place in begun:
        section = lines[place + 1 : lines.index("", place)]
        writable = any(line in {"AccessType=rw", "AccessType=rww", "AccessType=wo"} for line in section)
        assert not (writable and any(line.startswith("ParameterValue") for line in section))


@pytest.mark.parametrize(
    ("profile", "receives"),
    [
        (realistic(EPOS2_70_10), True),
        (chosen(realistic(EPOS2_70_10), ["boot-time=20ms"]), True),
        (EPOS2_70_10, False),
    ],
    ids=["realistic", "chosen", "at once"],
)
def test_a_client_that_listens_for_the_boot_up_1_ms_after_the_reset(
    profile: DeviceProfile, *, receives: bool
) -> None:
    world, wire = World(), CanWire(1_000_000)
    reset = SECOND
    master = Player((reset, Packet(CAN, 0x000, b"\x81\x01")))
    world.attach("drive", Epos2(1, ServoAxis("drive", 2000), profile), {CAN: wire})
    world.attach("master", master, {CAN: wire})
    world.run(2 * SECOND)
    listened = [
        moment
        for moment, packet in master.received
        if packet.address == 0x701 and moment > reset + MILLISECOND
    ]
    assert bool(listened) is receives
    if profile.boot_time:
        assert listened[0] - reset == pytest.approx(profile.boot_time, abs=MILLISECOND)


@both
def test_a_client_that_resets_and_polls_the_error_register(generation: Generation) -> None:
    # maxon's library: reset, 100 ms, then 0x1001 until it is answered, for 8 s at most.
    desk = SerialDesk(generation, realistic(EPOS2_70_10))
    desk.waits(SECOND)
    desk.requests(SendNmtService(FAR, 0x81))
    desk.waits(100 * MILLISECOND)
    for _ in range(20):
        answer = desk.requests(ReadObject(0x1001, 0, FAR))
        if isinstance(answer, ObjectRead) and answer.error == 0:
            return
    pytest.fail("it has not come back")


def test_the_serial_number_that_is_reported_is_the_one_that_answers() -> None:
    profile = numbered(EPOS2_70_10, NEAR + 6)
    reported = profile.differing(NEAR + 6)
    drive = Epos2(NEAR + 6, ServoAxis("drive", 2000), profile)
    for address in (od.SERIAL_NUMBER, Address(0x2004)):
        assert int.from_bytes(drive.store.read(address), "little") == reported[address]
