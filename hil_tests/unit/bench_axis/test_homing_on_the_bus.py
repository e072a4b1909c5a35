"""A homing by frames: the same bits from both servos, and again when time is put back."""

import pytest

from emulators.epos2.profile import EPOS2_70_10
from emulators.servo import kernel
from emulators.single import Order, drives
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.epos2.objects import OBJECTS
from fmu.build import ensure
from fmu.single_axis.parameters import SETS
from hil_tests.unit.bench_axis.axis_bench import TUNED, TURN
from hil_tests.unit.world.players import Player

# NMT start; 0x6098 := 2; RPDO2 shutdown and homing mode; then RPDO1 enable, and start.
START = ((0x000, "0100"), (0x601, "2f98600002"), (0x301, "060006"), (0x201, "0F00"), (0x201, "1F00"))


class Run:
    """One drive on the bench axis, and a master that says what stands above."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, servo: str) -> None:
        monkeypatch.setenv(kernel.VARIABLE, servo)
        plant, parameters = ensure("single_axis"), SETS["between_stops"]
        order = Order((1,), EPOS2_70_10, 1_000_000, plant=plant, plant_parameters=parameters, axes=("axis",))
        made, self.bank = drives(order)
        assert self.bank.native == (servo == kernel.NATIVE)
        self.world, wire = World(self.bank), CanWire(1_000_000)
        self.master = Player(
            *(
                (100 * MILLISECOND + 10 * MILLISECOND * k, Packet(CAN, address, bytes.fromhex(text)))
                for k, (address, text) in enumerate(START)
            )
        )
        self.world.attach("axis", made["axis"], {CAN: wire})
        self.world.attach("master", self.master, {CAN: wire})
        self.world.run(50 * MILLISECOND)
        for address, value in TUNED.items():
            made["axis"].store.write(address, value.to_bytes(OBJECTS[address].type.size, "little"))

    def ends(self) -> tuple[int, bytes, str]:
        """Run to the end; return where home is, the axis' record, and the hash of all packets."""
        self.world.run(5 * SECOND)
        axis = self.bank.axes[0]
        return axis.encoder - axis.position, bytes(axis), self.world.trace_sha256


def test_both_servos_find_the_same_home_with_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    twin, native = (Run(monkeypatch, servo).ends() for servo in (kernel.TWIN, kernel.NATIVE))
    assert twin == native
    assert twin[0] == 7 * TURN


@pytest.mark.parametrize("instant_ms", [141, 900, 1800, 2600])
def test_a_homing_goes_on_as_it_went_when_time_is_put_back(
    monkeypatch: pytest.MonkeyPatch, instant_ms: int
) -> None:
    run = Run(monkeypatch, kernel.NATIVE)
    run.world.run(instant_ms * MILLISECOND)
    before = run.world.snapshot()
    first = run.ends()
    run.world.restore(before)
    assert run.ends() == first
    assert first[0] == 7 * TURN


def test_the_end_of_a_homing_is_told_on_the_bus(monkeypatch: pytest.MonkeyPatch) -> None:
    run = Run(monkeypatch, kernel.NATIVE)
    run.ends()
    words = [packet.payload.hex() for _, packet in run.master.heard if packet.address == 0x181]
    # Enabled and at rest, homing, attained and referenced.
    assert words[-3:] == ["3707", "3703", "3797"]
