"""A client with our data sheet in hand: `canopen` drives a single EPOS2 by PDOs, through states and modes.

Nothing of the drive's table is used but the EDS that we write; `canopen` reads the PDO settings by itself.
"""

import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import canopen
import pytest

from emulators.epos2.objects.device_profile import EPOS2_70_10, realistic
from emulators.epos2.single import DrivesOrder, drives
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.node import CAN
from firmware_bridge.recording import candump_line
from hil_tests.interop.virtual_master import PdoMaster

NODES = (1, 2)


class Bench(PdoMaster):
    """Two drives that answer with the published latency, and a master for the first."""

    def __init__(self, sheet: Path) -> None:
        made, self.bank = drives(DrivesOrder(NODES, realistic(EPOS2_70_10), 1_000_000))
        world, wire = World(self.bank), CanWire(1_000_000)
        self.log: list[str] = []
        wire.observe(lambda now, _, packet: self.log.append(candump_line(now, packet)))
        for name, drive in made.items():
            world.attach(name, drive, {CAN: wire})
        super().__init__(world, wire, sheet)

    def powered(self, mode: str = "PROFILED POSITION") -> Any:
        """Take the node to Operation enabled by PDOs alone.

        The mode comes first: its PDO carries a controlword as well, which `canopen` leaves at 0.
        """
        node = self.node
        node.sdo["Motor Type"].raw = 1
        self.ready()
        node.op_mode = mode
        assert node.op_mode == mode
        node.state = "OPERATION ENABLED"
        return node


@pytest.fixture
def bench(sheet: Path) -> Iterator[Bench]:
    made = Bench(sheet)
    yield made
    made.close()


def test_every_state_is_reached_and_left_by_pdos(bench: Bench) -> None:
    node = bench.node
    bench.ready()
    before = len(bench.log)
    for state in (
        "READY TO SWITCH ON",
        "SWITCHED ON",
        "OPERATION ENABLED",
        "QUICK STOP ACTIVE",
        "SWITCH ON DISABLED",
    ):
        node.state = state
        assert node.state == state
    frames = bench.log[before:]
    assert any(" 201#" in line for line in frames)
    assert not any(" 601#2B4060" in line for line in frames), "no controlword by SDO"


def test_a_positioning_by_pdos(bench: Bench) -> None:
    node = bench.powered("PROFILED POSITION")
    target = node.rpdo[3]
    for word, ms in ((0x000F, 10), (0x003F, 2000)):
        target[0x6040].raw = word
        target[0x607A].raw = 40_000
        target.transmit()
        bench.bus.runs(ms / 1000)
    assert node.sdo["Position Actual Value"].raw == pytest.approx(40_000, abs=20)
    assert node.statusword & 0x1400 == 0x1400


def test_a_speed_by_pdos(bench: Bench) -> None:
    node = bench.powered("PROFILED VELOCITY")
    target = node.rpdo[4]
    target[0x6040].raw = 0x000F
    target[0x60FF].raw = -1500
    target.transmit()
    bench.bus.runs(2.0)
    assert node.sdo["Velocity Actual Value Averaged"].raw == pytest.approx(-1500, abs=40)
    assert node.statusword & 0x0400


def test_a_remapped_pdo_arrives_with_each_sync(bench: Bench) -> None:
    node = bench.node
    node.nmt.state = "PRE-OPERATIONAL"
    node.tpdo.read()
    mapped = node.tpdo[2]
    mapped.clear()
    for name in ("Statusword", "Position Actual Value", "Current Actual Value Averaged"):
        mapped.add_variable(name)
    mapped.trans_type, mapped.enabled = 1, True
    mapped.save()
    node.nmt.state = "OPERATIONAL"
    got = []
    mapped.add_callback(lambda pdo: got.append(len(pdo.data)))
    for _ in range(3):
        bench.network.send_message(0x080, b"")
    assert got == [8, 8, 8]


def test_heartbeat_and_emergency_reach_the_foreign_node(bench: Bench) -> None:
    node = bench.powered()
    node.sdo["Producer Heartbeat Time"].raw = 50
    bench.ear.received.clear()
    bench.bus.runs(0.5)
    beats = [packet for packet in bench.ear.received if packet.address == 0x701]
    assert 9 <= len(beats) <= 11
    bench.bank.axes[0].supply_mv = 5_000
    bench.bus.runs(0.05)
    assert [(error.code, error.register) for error in node.emcy.log] == [(0x3220, 0x04)]
    assert node.state == "FAULT"
    bench.bank.axes[0].supply_mv = 24_000
    bench.bus.runs(0.05)
    node.reset_from_fault()
    assert node.state == "OPERATION ENABLED", "canopen goes on to where it was"
    assert node.emcy.active == []


def test_the_other_drive_is_left_alone(bench: Bench) -> None:
    bench.powered()
    answered = [packet for packet in bench.ear.received if packet.address in {0x582, 0x182}]
    assert [packet.payload for packet in bench.ear.received if packet.address == 0x702] == [b"\0"]
    assert len(answered) <= 1, "its statusword once, when the network starts"


def test_layer_setting_by_canopens_own_master(bench: Bench) -> None:
    lss = bench.network.lss
    bench.network.nmt.state = "STOPPED"
    assert lss.send_switch_state_selective(0xFB, 0x6420_0000, 0x2126_0000, 0x8001_5955)
    assert lss.inquire_node_id() == 1
    assert lss.inquire_lss_address(0x5A) == 0xFB
    lss.configure_node_id(9)
    lss.send_switch_state_global(lss.WAITING_STATE)


@pytest.mark.tshark
def test_tshark_finds_nothing_malformed(bench: Bench, tmp_path: Path) -> None:
    node = bench.powered("PROFILED VELOCITY")
    node.rpdo[4][0x60FF].raw = 500
    node.rpdo[4].transmit()
    node.sdo["Manufacturer Device Name"].raw  # noqa: B018 - a transfer in segments
    with pytest.raises(canopen.SdoAbortedError):
        node.sdo.upload(0x5555, 0)
    bench.bank.axes[0].supply_mv = 5_000
    bench.bus.runs(0.1)
    log = tmp_path / "can.log"
    log.write_text("\n".join(bench.log) + "\n", encoding="ascii")
    command = ["tshark", "-r", str(log), "-d", "can.subdissector,canopen", "-T", "fields"]
    fields = ["-e", "_ws.malformed", "-e", "_ws.col.Protocol", "-e", "_ws.expert.severity"]
    done = subprocess.run([*command, *fields], capture_output=True, text=True, check=True)
    rows = [line.split("\t") for line in done.stdout.splitlines()]
    assert len(rows) == len(bench.log) > 60
    assert {row[1] for row in rows} == {"CANopen"}
    assert not [row for row in rows if row[0]]
