"""A third party as master: the `canopen` library from PyPI talks to one emulated drive, in virtual time.

Its frames are carried by the virtual bus: each send lets the world run until the answers are there, so the
library's own time-outs, which read the real clock, never come into play.
"""

from collections.abc import Iterator
from typing import Any, Final

import canopen
import pytest
from canopen.objectdictionary import ODArray, ODRecord, ODVariable, datatypes

from emulators.epos2.drive import Epos2
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank
from emulators.servo.motor import DcMotor, DcMotors
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.node import CAN
from firmware_bridge.units import MILLISECOND
from hil_tests.interop.virtual_master import Master

NODE: Final = 1
# RE50 with the platform's mass behind the gear, all at the motor's shaft.
MOTOR: Final = DcMotor(0.103, 0.072e-3, 0.0385, 200e-6, friction=0.004)

# The master's own dictionary, by hand from CiA 301 and CiA 402: nothing of it comes from the drive's table.
OBJECTS: Final = (
    (0x1000, "device_type", datatypes.UNSIGNED32),
    (0x1001, "error_register", datatypes.UNSIGNED8),
    (0x1008, "device_name", datatypes.VISIBLE_STRING),
    (0x1017, "producer_heartbeat", datatypes.UNSIGNED16),
    (0x6040, "controlword", datatypes.UNSIGNED16),
    (0x6041, "statusword", datatypes.UNSIGNED16),
    (0x6060, "modes_of_operation", datatypes.INTEGER8),
    (0x6061, "modes_of_operation_display", datatypes.INTEGER8),
    (0x6064, "position_actual", datatypes.INTEGER32),
    (0x606C, "velocity_actual", datatypes.INTEGER32),
    (0x607A, "target_position", datatypes.INTEGER32),
    (0x6081, "profile_velocity", datatypes.UNSIGNED32),
    (0x6502, "supported_drive_modes", datatypes.UNSIGNED32),
    (0x60FF, "target_velocity", datatypes.INTEGER32),
)
SUBOBJECTS: Final = (
    (0x1018, "identity", (datatypes.UNSIGNED32,) * 4),
    (0x60F6, "current_gains", (datatypes.INTEGER16,) * 2),
    (0x60F9, "velocity_gains", (datatypes.INTEGER16,) * 2),
    (0x60FB, "position_gains", (datatypes.INTEGER16,) * 3),
    (0x6410, "motor_data", (datatypes.UNSIGNED16, datatypes.UNSIGNED16)),
)
PDO_PARAMETERS: Final = (
    (0x1400, (datatypes.UNSIGNED32, datatypes.UNSIGNED8)),
    (0x1800, (datatypes.UNSIGNED32, datatypes.UNSIGNED8, datatypes.UNSIGNED16)),
)
PDO_MAPPINGS: Final = (0x1600, 0x1A00)
TUNED: Final = {0x60F6: (50, 20), 0x60F9: (4000, 80), 0x60FB: (600, 60, 900)}


class Bench(Master):
    def __init__(self) -> None:
        axis = ServoAxis("motor", 2000)
        self.plant = DcMotors((MOTOR,))
        world, wire = World(ServoBank(self.plant, [axis])), CanWire(1_000_000)
        self.drive = Epos2(NODE, axis)
        world.attach("motor", self.drive, {CAN: wire})
        super().__init__(world, wire, NODE, dictionary())

    def speed_rpm(self) -> float:
        return float(self.plant.outputs[2]) * 60.0 / 6.283185307179586

    def tune(self) -> None:
        for index, values in TUNED.items():
            for subindex, value in enumerate(values, start=1):
                self.node.sdo[index][subindex].raw = value

    def enabled(self) -> Any:
        """Take the tuned node to Operation enabled by SDO."""
        self.tune()
        self.node.nmt.state = "OPERATIONAL"
        self.node.setup_402_state_machine(read_pdos=False)
        self.node.state = "OPERATION ENABLED"
        self.bus.runs(0.1)
        return self.node


def dictionary() -> Any:
    objects = canopen.ObjectDictionary()
    for index, name, kind in OBJECTS:
        objects.add_object(variable(name, index, 0, kind))
    for index, name, kinds in SUBOBJECTS:
        objects.add_object(collection(ODRecord(name, index), kinds))
    for number in range(4):
        for base, kinds in PDO_PARAMETERS:
            objects.add_object(collection(ODRecord(f"pdo_{base + number:x}", base + number), kinds))
        for base in PDO_MAPPINGS:
            mapped = ODArray(f"pdo_{base + number:x}", base + number)
            objects.add_object(collection(mapped, (datatypes.UNSIGNED32,)))
    return objects


def collection(of: Any, kinds: tuple[int, ...]) -> Any:
    for subindex, kind in enumerate((datatypes.UNSIGNED8, *kinds)):
        of.add_member(variable(f"entry_{of.index:x}_{subindex}", of.index, subindex, kind))
    return of


def variable(name: str, index: int, subindex: int, kind: int) -> Any:
    made = ODVariable(name, index, subindex)
    made.data_type = kind
    made.access_type = "rw"
    return made


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    made.network.bus = None


def test_the_identity_is_that_of_a_70_10(bench: Bench) -> None:
    sdo = bench.node.sdo
    assert sdo[0x1000].raw == 0x0002_0192
    assert sdo[0x1018][1].raw == 0xFB
    assert sdo[0x1018][2].raw == 0x6420_0000
    assert sdo[0x6502].raw == 0x003F_0065


def test_the_name_is_read_in_segments(bench: Bench) -> None:
    assert bench.node.sdo[0x1008].raw == "EPOS2"


def test_what_is_written_is_read_back(bench: Bench) -> None:
    bench.node.sdo[0x6081].raw = 2500
    assert bench.node.sdo[0x6081].raw == 2500


@pytest.mark.parametrize(
    ("index", "subindex", "code"),
    [(0x5555, 0, 0x0602_0000), (0x60F9, 3, 0x0609_0011), (0x1018, 9, 0x0609_0011)],
)
def test_what_is_not_there_is_refused_by_its_code(bench: Bench, index: int, subindex: int, code: int) -> None:
    with pytest.raises(canopen.SdoAbortedError) as refusal:
        bench.node.sdo.upload(index, subindex)
    assert refusal.value.code == code


def test_a_read_only_object_is_not_written(bench: Bench) -> None:
    with pytest.raises(canopen.SdoAbortedError) as refusal:
        bench.node.sdo.download(0x6041, 0, b"\0\0")
    assert refusal.value.code == 0x0601_0002


def test_the_network_states_follow_the_master(bench: Bench) -> None:
    bench.node.sdo[0x1017].raw = 100
    for state, code in (("OPERATIONAL", 5), ("PRE-OPERATIONAL", 0x7F), ("STOPPED", 4)):
        bench.node.nmt.state = state
        bench.ear.received.clear()
        bench.bus.runs(0.15)
        beats = [packet.payload for packet in bench.ear.received if packet.address == 0x700 + NODE]
        assert beats, state
        assert set(beats) == {bytes([code])}


def test_the_drive_is_taken_through_its_states_and_turns(bench: Bench) -> None:
    node = bench.node
    bench.tune()
    node.nmt.state = "OPERATIONAL"
    node.setup_402_state_machine(read_pdos=False)
    assert node.state == "SWITCH ON DISABLED"
    for state in ("READY TO SWITCH ON", "SWITCHED ON", "OPERATION ENABLED"):
        node.state = state
        bench.bus.runs(0.1)
        assert node.state == state
    node.sdo[0x6060].raw = 3
    assert node.op_mode == "PROFILED VELOCITY"
    node.sdo[0x60FF].raw = 1000
    bench.bus.runs(1.0)
    assert bench.speed_rpm() == pytest.approx(1000, abs=15)
    assert node.sdo[0x606C].raw == pytest.approx(1000, abs=60)


def test_a_positioning_reaches_its_target_and_states_so(bench: Bench) -> None:
    node = bench.enabled()
    node.sdo[0x6060].raw = 1
    node.sdo[0x607A].raw = 20_000
    node.sdo[0x6040].raw = 0x001F
    bench.bus.runs(0.01)
    assert node.sdo[0x6041].raw & 0x1400 == 0x1000, "taken, and not there yet"
    bench.bus.runs(2.0)
    assert node.sdo[0x6041].raw & 0x0400
    assert node.sdo[0x6064].raw == pytest.approx(20_000, abs=10)


def test_a_quick_stop_is_left_only_by_command(bench: Bench) -> None:
    node = bench.enabled()
    node.sdo[0x6060].raw = 3
    node.sdo[0x60FF].raw = 1000
    bench.bus.runs(0.5)
    node.sdo[0x6040].raw = 0x000B
    bench.bus.runs(3.0)
    assert node.state == "QUICK STOP ACTIVE"
    assert bench.speed_rpm() == pytest.approx(0, abs=1)


def test_the_foreign_node_sees_the_drive_die(bench: Bench) -> None:
    node = bench.enabled()
    node.sdo.download(0x1016, 1, (100 | 0x7F << 16).to_bytes(4, "little"))
    bench.network.send_message(0x700 + 0x7F, b"\x05")
    bench.bus.runs(0.5)
    assert [error.code for error in node.emcy.log] == [0x8130]
    assert node.state in ("FAULT", "QUICK STOP ACTIVE")


def test_milliseconds_are_all_it_takes() -> None:
    bench = Bench()
    before = bench.world.now
    bench.node.sdo.upload(0x1000, 0)
    assert bench.world.now - before == 2 * MILLISECOND
