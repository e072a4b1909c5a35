"""The toy drive on the bench: driven and stopped, guarded, and on its own when the bridge is dead."""

import ast
from itertools import pairwise
from pathlib import Path

import pytest
from emulators.testing.rig import VirtualRig
from firmware_bridge.node import DTR_UP
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find
from firmware_bridge.safety.guard import Refusal, guarded
from firmware_bridge.units import NEVER, Nanoseconds

import toy_drive.guard
from toy_drive.bench import OFF, ON, STOPPED, ToyDrive
from toy_drive.family import FAMILY
from toy_drive.settings import ToyDriver

SPEED_MPS = 0.5
WATCHDOG_S = 0.25


@pytest.fixture
def rig_robot() -> str:
    return "toy_trolley"


def drive_of(rig: VirtualRig) -> ToyDrive:
    return rig.bench.devices.motors(ToyDrive)["trolley"]


def moving(rig: VirtualRig) -> None:
    rig.operator.drives(SPEED_MPS)
    rig.runs_until(lambda: rig.body.speed > 0.95 * SPEED_MPS, within=2.0)


def test_it_is_driven_to_a_speed_and_stopped(rig: VirtualRig) -> None:
    moving(rig)
    rig.runs(1.0)
    assert rig.body.speed == pytest.approx(SPEED_MPS, rel=0.05)
    rig.operator.returns_to_neutral()
    rig.runs_until(lambda: abs(rig.body.speed) < 0.01, within=1.5)
    assert drive_of(rig).state == ON
    assert rig.bench.guard.refused == 0


def test_an_emergency_stop_brings_it_to_standstill_without_power(rig: VirtualRig) -> None:
    moving(rig)
    rig.operator.does(emergency_stop=True)
    rig.runs_until(lambda: abs(rig.body.speed) < 0.01, within=1.5)
    (guarded_axis,) = rig.bench.guard.links["line"].axes
    assert guarded_axis.powered
    rig.runs_until(lambda: drive_of(rig).state == OFF, within=5.0)
    rig.runs(0.1)
    assert not guarded_axis.powered


def test_without_the_bridge_the_device_stops_by_itself(rig: VirtualRig) -> None:
    moving(rig)
    rig.fault("bridge_ends", how="killed")
    rig.runs(0.8 * WATCHDOG_S)
    assert rig.body.speed > 0.9 * SPEED_MPS
    assert drive_of(rig).state == ON
    rig.runs(WATCHDOG_S + SPEED_MPS / 6.0)
    assert drive_of(rig).state == STOPPED
    assert abs(rig.body.speed) < 0.02


def test_a_motor_that_runs_away_is_noticed_and_loses_its_power(rig: VirtualRig) -> None:
    moving(rig)
    drive_of(rig).swap_channels(swapped=True)
    rig.runs_until(lambda: drive_of(rig).state == OFF, within=2.0)
    drive_of(rig).swap_channels(swapped=False)
    rig.operator.arms()
    moving(rig)


def test_a_line_that_is_pulled_stops_both_sides(rig: VirtualRig) -> None:
    moving(rig)
    rig.bench.adapters[0].plugged = False
    rig.runs(1.0)
    assert abs(rig.body.speed) < 0.02
    assert "link lost: line" in rig.interlock_events
    rig.bench.adapters[0].plugged = True
    rig.runs(1.0)
    assert drive_of(rig).state == OFF, "set up again, and not enabled"


class Sends:
    """A bridge that sends what it was given, a packet at each wake-up."""

    def __init__(self, *packets: Packet) -> None:
        self.packets = list(packets)

    def receive(self, _packet: Packet, _now: Nanoseconds) -> Reaction:
        return Reaction()

    def wake(self, _now: Nanoseconds) -> Reaction:
        return Reaction((self.packets.pop(0),), NEVER)


def left(*lines: bytes, address: int = 0) -> tuple[bytes, str]:
    """Return what leaves in the place of the last of these lines, and why it was refused."""
    refusals: list[Refusal] = []
    node = guarded(
        Sends(*(Packet("line", address, it) for it in lines)), find("toy_trolley"), refusals.append
    )
    reactions = [node.wake(0) for _ in lines]
    reason = refusals[-1].reason if refusals else ""
    return b"".join(packet.payload for packet in reactions[-1].sent), reason


@pytest.mark.parametrize("line", [b"Q\n", b"P0\n", b"P1\n", b"S\n", b"V0\n", b"V27300\n", b"V-27300\n"])
def test_the_guard_lets_listed_lines_leave_up_to_the_bound(line: bytes) -> None:
    assert left(line) == (line, "")


@pytest.mark.parametrize("line", [b"V27301\n", b"V-27301\n"])
def test_a_speed_above_the_bound_is_replaced_by_standstill(line: bytes) -> None:
    sent, reason = left(b"P1\n", line)
    assert sent == b"V0\n"
    assert "is beyond 1.05" in reason


@pytest.mark.parametrize("line", [b"R\n", b"Q", b"Q\nV9\n", b"V1e3\n", b"V1.5\n", b"V+5\n", b"", b"v0\n"])
def test_a_line_that_is_not_listed_does_not_leave_and_a_powered_axis_is_stopped(line: bytes) -> None:
    sent, reason = left(b"P1\n", line)
    assert sent == b"V0\n"
    assert reason == f"the line {line!r} is not listed"


def test_power_is_not_given_while_a_speed_is_in_force_and_no_reset_leaves() -> None:
    assert "power on while" in left(b"P1\n", b"V100\n", b"P1\n")[1]
    assert "not listed" in left(b"", address=DTR_UP)[1]


def test_the_guard_imports_nothing_of_the_package() -> None:
    tree = ast.parse(Path(toy_drive.guard.__file__).read_text(encoding="utf-8"))
    names = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    names += [one.name for node in ast.walk(tree) if isinstance(node, ast.Import) for one in node.names]
    assert names
    assert not [name for name in names if name.startswith(("toy_drive", "firmware_bridge.drivers"))]


def test_traffic_is_decoded_however_it_is_cut() -> None:
    traffic = b"V-1250 1 -3310 -1248\nwhat\n"
    for cut in range(len(traffic)):
        reader = FAMILY.protocols[ToyDriver.TOY_DRIVE].reader()
        parts = [reader.read("device", Packet("line", 0, it)) for it in (traffic[:cut], traffic[cut:])]
        text = "; ".join(part for part in parts if part != "part of a line")
        assert text == "V-1250: power on, -3310, -1248 mrad/s; no answer that is known: b'what'"
    assert reader.read("bridge", Packet("line", 0, b"V-1250\n")) == "V-1250"


def test_its_stop_stages_end_without_power() -> None:
    robot = find("toy_trolley")
    stages = FAMILY.stop_stages(robot, robot.axis("trolley"))
    assert [stage.ends_power for stage in stages] == [False, False, True]
    assert all(one.within > 0 for one in stages)
    assert all(before.deceleration is not None for before, _ in pairwise(stages))
