"""The same chain in two processes on a real SocketCAN bus, driven by a third party: pymavlink over UDP."""

import shutil
import signal
import subprocess
import time
from typing import Final

import can
import pytest

from hil_tests.scenarios.real_bus import DISABLED, SOCKETCAN, Bench, sleep

pytestmark = [pytest.mark.vcan, pytest.mark.timeout(180)]

TSHARK: Final = shutil.which("tshark") or "tshark: not installed"


def test_a_client_drives_is_killed_and_the_robot_stops_then_ctrl_c(bench: Bench) -> None:
    log = bench.folder / "can.log"
    candump = bench.runs("candump", log, ["candump", "-L", SOCKETCAN[1]])
    bench.emulates()
    bridge = bench.drives()
    client = bench.joins()
    client.arms()
    bench.gets_under_way(client, 0.1)
    client.states(0.1, 0.3)
    assert client.x > 0.05
    client.link.close()
    sleep(0.6)
    at_standstill = bench.eye.metres()
    sleep(0.3)
    assert bench.eye.metres() == pytest.approx(at_standstill, abs=0.001), (
        "it stands 0.6 s after the last word"
    )
    assert bridge.ends() == 0, bridge.printed
    for node in (1, 2, 3, 4):
        assert bench.eye.state(node) in DISABLED, (node, bridge.printed)
    candump.ends(signal.SIGTERM)
    frames = log.read_text(encoding="ascii")
    assert " vcan0 501#0F00" in frames
    assert " vcan0 281#" in frames
    found = subprocess.run(
        [TSHARK, "-r", str(log), "-d", "can.subdissector,canopen", "-Y", "_ws.malformed"],
        capture_output=True,
        check=True,
        text=True,
    )
    assert found.stdout == ""


def test_the_climber_climbs_on_a_bus_too(bench: Bench) -> None:
    bench.robot, bench.last_node, bench.zeros = "climber", 2, ()
    bench.emulates()
    bridge = bench.drives()
    client = bench.joins()
    client.arms()
    began = [bench.eye.ask(node, 0x6064) or 0 for node in (1, 2)]
    client.states(0.04, 4.0, full=0.06)
    client.states(0.0, 1.0)
    rolled = [(bench.eye.ask(node, 0x6064) or 0) - first for node, first in zip((1, 2), began, strict=True)]
    counts_per_m = 2000 * 84 / (2 * 3.141592653589793 * 0.05)
    assert all(0.05 < way / counts_per_m < 0.2 for way in rolled), (rolled, client.texts, bridge.printed)
    assert bridge.ends() == 0, bridge.printed
    for node in (1, 2):
        assert bench.eye.state(node) in DISABLED, (node, bridge.printed)


def test_the_drives_stop_by_themselves_when_the_bridge_is_killed(bench: Bench) -> None:
    bench.emulates()
    bridge = bench.drives()
    client = bench.joins()
    client.arms()
    bench.gets_under_way(client, 0.3)
    bridge.ends(signal.SIGKILL)
    sleep(0.8)
    at_standstill = bench.eye.metres()
    sleep(0.3)
    assert bench.eye.metres() == pytest.approx(at_standstill, abs=0.001)
    for node in (1, 2):
        assert bench.eye.state(node) != 0x0137, "enabled operation is over"


def test_a_drive_that_falls_silent_stops_the_robot_and_is_named(bench: Bench) -> None:
    emulator = bench.emulates("--silence", "3@25")
    began = time.monotonic()
    bench.drives()
    client = bench.joins()
    client.arms()
    bench.gets_under_way(client, 0.2)
    assert time.monotonic() - began < 24, "the bench was too slow to get under way"
    while bench.eye.ask(3, 0x1000) is not None:
        client.states(0.2, 0.2)
    client.states(0.2, 1.0)
    assert any("3" in text and "steering" in text for text in client.texts), (client.texts, emulator.printed)
    at_standstill = bench.eye.metres()
    client.states(0.2, 0.3)
    assert bench.eye.metres() == pytest.approx(at_standstill, abs=0.001)


def test_the_kernel_s_broadcast_manager_sends_a_master_s_heartbeat(bench: Bench) -> None:
    """python-can's periodic sends: without can-bcm in the kernel they are refused."""
    bench.emulates()
    heartbeat = can.Message(arbitration_id=0x77F, data=[5], is_extended_id=False)
    with can.Bus(interface=SOCKETCAN[0], channel=SOCKETCAN[1]) as listener:
        task = bench.eye.bus.send_periodic(heartbeat, 0.05)
        received = [listener.recv(5.0) for _ in range(3)]
        task.stop()
    assert [message and message.arbitration_id for message in received] == [0x77F] * 3
