"""A third party drives the plain servo: `canopen`'s profile for CiA 402, by PDOs, in virtual time.

It knows the objects by a dictionary that has their types and access, as from a data sheet, and no values.
"""

from collections.abc import Iterator
from itertools import groupby
from typing import Any

import canopen
import pytest
from canopen.objectdictionary import ODArray, ODRecord, ODVariable

from emulators.cia402.servo import Servo
from emulators.cia402.single import with_motors
from emulators.servo.motor import MOTOR
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.canopen.object_dictionary import ObjectDictionary
from firmware_bridge.families.cia402.wire.objects import objects_of
from firmware_bridge.node import CAN
from hil_tests.interop.virtual_master import PdoMaster

COUNTS = 2000


def known(objects: ObjectDictionary) -> canopen.ObjectDictionary:
    """Return the objects as the library has them."""
    made = canopen.ObjectDictionary()
    made.node_id = 1
    for index, group in groupby(objects.values(), lambda row: row.address.index):
        rows = list(group)
        variables = []
        for row in rows:
            variable = ODVariable(row.name, index, row.address.subindex)
            variable.data_type, variable.access_type = row.type.code, row.access.value
            variable.pdo_mappable = row.mappable
            if isinstance(row.default, int):
                variable.default = variable.value = row.default_for(1)
            variables.append(variable)
        if len(rows) == 1 and not rows[0].address.subindex:
            made.add_object(variables[0])
            continue
        record: Any = (ODArray if index in {0x1003, 0x1016} else ODRecord)(rows[0].name, index)
        for variable in variables:
            record.add_member(variable)
        made.add_object(record)
    return made


class Bench(PdoMaster):
    """A servo, and a master that is ready to drive it."""

    def __init__(self) -> None:
        made, self.bank = with_motors(
            (1,), lambda node, axis: Servo(node, axis, bus_rate=1_000_000), MOTOR, counts=COUNTS
        )
        world, wire = World(self.bank), CanWire(1_000_000)
        for name, servo in made.items():
            world.attach(name, servo, {CAN: wire})
        super().__init__(world, wire, known(objects_of(COUNTS)))
        # The library takes a PDO that has come twice for a periodic one, and waits for the next.
        self.node.sdo[0x1801][5].raw = 20
        self.ready()

    def powered(self, mode: str) -> Any:
        self.node.op_mode = mode
        assert self.node.op_mode == mode
        self.node.state = "OPERATION ENABLED"
        return self.node


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    made.close()


def test_every_state_is_reached_and_left(bench: Bench) -> None:
    node = bench.node
    for state in ("READY TO SWITCH ON", "SWITCHED ON", "OPERATION ENABLED", "SWITCH ON DISABLED"):
        node.state = state
        assert node.state == state


def test_it_finds_the_supported_modes(bench: Bench) -> None:
    for mode in (
        "PROFILED POSITION",
        "PROFILED VELOCITY",
        "HOMING",
        "CYCLIC SYNCHRONOUS POSITION",
        "CYCLIC SYNCHRONOUS VELOCITY",
        "CYCLIC SYNCHRONOUS TORQUE",
    ):
        assert bench.node.is_op_mode_supported(mode)
        bench.node.op_mode = mode
        assert bench.node.op_mode == mode
    assert not bench.node.is_op_mode_supported("INTERPOLATED POSITION")


def test_it_moves_to_a_position(bench: Bench) -> None:
    node = bench.powered("PROFILED POSITION")
    node.sdo[0x607A].raw = 2 * COUNTS
    for word in (0x1F, 0x0F):
        node.controlword = word
        bench.bus.runs(0.01)
    bench.bus.runs(0.6)
    assert node.statusword & 0x0400
    assert abs(node.sdo[0x6064].raw - 2 * COUNTS) <= 10


def test_it_turns_at_a_velocity_and_stops(bench: Bench) -> None:
    node = bench.powered("PROFILED VELOCITY")
    node.sdo[0x60FF].raw = 500
    bench.bus.runs(0.3)
    assert abs(node.sdo[0x606C].raw - 500) <= 60
    node.state = "SWITCHED ON"
    bench.bus.runs(0.3)
    assert node.sdo[0x606C].raw == 0


@pytest.mark.parametrize("method", [35, 37, 34])
def test_it_homes(bench: Bench, method: int) -> None:
    node = bench.node
    node.sdo[0x6098].raw = method
    assert node.homing()
    assert abs(node.sdo[0x6064].raw) <= 30


def test_a_fault_is_reset(bench: Bench) -> None:
    node = bench.powered("PROFILED POSITION")
    node.sdo[0x607D][2].raw = 100
    node.sdo[0x607A].raw = 101
    node.controlword = 0x1F
    bench.bus.runs(0.05)
    assert node.state == "FAULT"
    node.reset_from_fault()
    assert node.state == "OPERATION ENABLED"
