"""A third party homes a drive: `canopen`'s own homing, on an axis between stops, in virtual time.

It has our EDS and nothing else. Where home is, the plant's parameters say.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

from emulators.epos2.objects.device_profile import EPOS2_70_10, realistic
from emulators.epos2.single import DrivesOrder, drives
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.node import CAN
from fmu.build import ensure
from fmu.single_axis.parameters import SETS
from hil_tests.interop.virtual_master import PdoMaster

TURN: Final = 2000
TUNED: Final = {
    (0x6402, 0): 1,
    (0x60F6, 1): 50,
    (0x60F6, 2): 20,
    (0x60FB, 1): 900,
    (0x60FB, 2): 3000,
    (0x60FB, 3): 1500,
    (0x6099, 1): 300,
    (0x6099, 2): 60,
    (0x609A, 0): 2000,
    (0x2080, 0): 4000,
}


class Bench(PdoMaster):
    """One drive above the bench axis, and a master."""

    def __init__(self, sheet: Path) -> None:
        order = DrivesOrder(
            (1,),
            realistic(EPOS2_70_10),
            1_000_000,
            plant=ensure("single_axis"),
            plant_parameters=SETS["between_stops"],
            axes=("axis",),
        )
        made, self.bank = drives(order)
        world, wire = World(self.bank), CanWire(1_000_000)
        world.attach("axis", made["axis"], {CAN: wire})
        super().__init__(world, wire, sheet)
        for (index, subindex), value in TUNED.items():
            place = self.node.sdo[index]
            (place[subindex] if subindex else place).raw = value
        self.ready()
        self.bus.runs(0.01)

    @property
    def zero(self) -> int:
        """The encoder's count that has the position 0."""
        axis = self.bank.axes[0]
        return axis.encoder - axis.position


@pytest.fixture
def bench(sheet: Path) -> Iterator[Bench]:
    made = Bench(sheet)
    yield made
    made.close()


@pytest.mark.parametrize(("method", "turns"), [(1, -3), (2, 7), (7, 1), (34, 1), (-1, 8), (-2, -4)])
def test_a_third_party_homing_finds_the_index(bench: Bench, method: int, turns: int) -> None:
    bench.node.sdo[0x6098].raw = method
    assert bench.node.homing()
    assert bench.zero == turns * TURN
    assert bench.node.is_homed()
    assert bench.node.statusword & 0x8000


def test_the_foreign_node_reads_that_there_is_no_home_switch_that_way(bench: Bench) -> None:
    bench.node.sdo[0x6098].raw = 11
    assert not bench.node.homing()
    assert not bench.node.is_homed()
    assert [error.code for error in bench.node.emcy.log] == [0x8611]
