"""One drive on the bench axis, behind a bus, and a master that sends the given frames one by one."""

from collections.abc import Iterable

import pytest

from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.epos2.single import DrivesOrder, drives
from emulators.servo import kernel
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND
from fmu.build import ensure
from fmu.single_axis.parameters import SETS
from hil_tests.unit.bench_axis.axis_bench import TUNED
from hil_tests.unit.world.players import Player


class AxisOnBus:
    """Master that sends its frames, identifiers and bytes in hexadecimal, every 10 ms from 100 ms on."""

    def __init__(
        self, monkeypatch: pytest.MonkeyPatch, servo: str, frames: Iterable[tuple[int, str]]
    ) -> None:
        monkeypatch.setenv(kernel.VARIABLE, servo)
        plant, parameters = ensure("single_axis"), SETS["between_stops"]
        order = DrivesOrder(
            (1,), EPOS2_70_10, 1_000_000, plant=plant, plant_parameters=parameters, axes=("axis",)
        )
        made, self.bank = drives(order)
        assert self.bank.native == (servo == kernel.NATIVE)
        self.world, wire = World(self.bank), CanWire(1_000_000)
        self.master = Player(
            *(
                (100 * MILLISECOND + 10 * MILLISECOND * k, Packet(CAN, address, bytes.fromhex(text)))
                for k, (address, text) in enumerate(frames)
            )
        )
        self.store = made["axis"].store
        self.world.attach("axis", made["axis"], {CAN: wire})
        self.world.attach("master", self.master, {CAN: wire})
        self.world.run(50 * MILLISECOND)
        for address, value in TUNED.items():
            self.store.write(address, value.to_bytes(EPOS2_70_10.objects[address].type.size, "little"))
