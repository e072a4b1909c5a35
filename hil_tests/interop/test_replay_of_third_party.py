"""A third party's session, recorded by a real bus's clock, plays again into the drives to the microsecond."""

from collections.abc import Iterator
from pathlib import Path

import canopen
import pytest

from emulators.devices import devices
from emulators.epos2.drive import Epos2
from emulators.family import Devices
from emulators.replay import Into, ReplayOrder, replay
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.node import CAN
from firmware_bridge.recording import candump_line
from firmware_bridge.robot_types import find
from firmware_bridge.units import SECOND
from hil_tests.interop.virtual_master import PdoMaster

RARS = find("rars")
REAL = 1_700_000_000 * SECOND


@pytest.fixture
def emulated() -> Iterator[Devices]:
    made = devices(RARS)
    yield made
    made.plant.close()


def session(emulated: Devices, sheet: Path) -> list[str]:
    """Set the first drive up, drive it at 300 rpm by PDOs, make a mistake, switch it off; return the log.

    `hil_tests/recordings/rars/canopen-master.log.xz` is such a session.
    """
    log: list[str] = []
    world, wire = World(emulated.physics), CanWire(RARS.links["drives"].rate)
    wire.observe(lambda now, _, packet: log.append(candump_line(now, packet, "can0", REAL)))
    for name, drive in emulated.nodes(Epos2).items():
        world.attach(name, drive, {CAN: wire})
    master = PdoMaster(world, wire, sheet)
    node = master.node
    node.sdo["Motor Type"].raw = 1
    master.ready()
    node.op_mode = "PROFILED VELOCITY"
    node.state = "OPERATION ENABLED"
    target = node.rpdo[4]
    target[0x6040].raw = 0x000F
    target[0x60FF].raw = 300
    target.transmit()
    master.bus.runs(0.5)
    assert node.sdo["Manufacturer Device Name"].raw == "EPOS2"
    assert node.sdo["Velocity Actual Value Averaged"].raw > 100
    with pytest.raises(canopen.SdoAbortedError):
        node.sdo["Statusword"].raw = 1
    node.state = "SWITCH ON DISABLED"
    master.network.bus = None
    return log


def test_a_third_party_session_plays_again(emulated: Devices, sheet: Path, tmp_path: Path) -> None:
    log = session(emulated, sheet)
    file = tmp_path / "third_party.log"
    file.write_text("\n".join(log) + "\n", encoding="ascii")
    outcome = replay(ReplayOrder(RARS, file))
    assert outcome.into is Into.DRIVES
    assert outcome.difference is None
    assert (outcome.compared, outcome.played) == (len(log) - outcome.played, outcome.played)
    assert outcome.compared > 50
