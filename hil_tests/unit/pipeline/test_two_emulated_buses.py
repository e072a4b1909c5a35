"""The toy over emulated drives on two CAN buses, behind the guard: all of it, from MAVLink to the motors."""

from typing import Any, Final

import pytest

from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.single import DrivesOrder, drives
from emulators.wires import CanWire, DatagramWire
from emulators.wires.ends import Observer
from emulators.world import World
from firmware_bridge.bridge import Bridge, Life
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.mavlink.modes import number_of_own
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Robot
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds
from hil_tests.unit.pipeline.cart import ROBOT_TYPE, TOOL, WHEELS, Sizes, cart

SYNC: Final = 0x080
ARM: Final = dialect.MAV_CMD_COMPONENT_ARM_DISARM
MODE: Final = dialect.MAV_CMD_DO_SET_MODE
STOP: Final = 5300
"""DO_SET_SAFETY_SWITCH_STATE; 0 is safe."""


class Ground:
    """A station that keeps the received messages."""

    def __init__(self) -> None:
        self.codec: Final = Codec(255, 190)
        self.acknowledged: list[int] = []

    def wake(self, _now: Nanoseconds) -> Reaction:
        return Reaction()

    def receive(self, packet: Packet, _now: Nanoseconds) -> Reaction:
        for message in self.codec.decode(packet.payload):
            if message.get_type() == "COMMAND_ACK":
                self.acknowledged.append(message.result)
        return Reaction()


class TwoBuses:
    """Bridge, guard, three emulated drives on two buses, and a station in the test's hand."""

    def __init__(self, robot: Robot[Sizes]) -> None:
        names = [axis.name for axis in robot.axes]
        nodes = [Epos2Axis.of(axis).node for axis in robot.axes]
        self.drives, bank = drives(DrivesOrder(nodes, PROFILES["70/10"], 1_000_000, axes=names))
        self.world: Final = World(bank)
        self.bridge: Final = Bridge(robot, ROBOT_TYPE)
        self.guard: Final = guarded(self.bridge, robot)
        self.buses: Final = {
            name: CanWire(link.bit_rate, name) for name, link in Epos2Link.all_of(robot).items()
        }
        self.sent: Final[dict[str, list[Packet]]] = {name: [] for name in robot.links}
        for name, bus in self.buses.items():
            bus.observe(self._noting(name))
        self.air: Final = DatagramWire()
        self.ground: Final = Ground()
        for axis in robot.axes:
            self.world.attach(axis.name, self.drives[axis.name], {CAN: self.buses[axis.link]})
        self.world.attach("bridge", self.guard, {**self.buses, OPERATOR: self.air})
        self.place: Final = self.world.attach("ground", self.ground, {OPERATOR: self.air})
        self.ahead = self.brush = 0.0

    def runs(self, seconds: float) -> None:
        """Let time pass; the station sends its stick every 50 ms."""
        until = self.world.now + from_seconds(seconds)
        while self.world.now < until:
            x, r = round(self.ahead * 1000), round(-self.brush * 1000)
            self.states(dialect.MAVLink_manual_control_message(1, x, 0x7FFF, 0x7FFF, r, 0))
            self.world.run(min(self.world.now + 50 * MILLISECOND, until))

    def states(self, message: Any) -> None:
        self.air.carry(self.place, Packet(OPERATOR, 0, self.ground.codec.encode(message)))

    def commands(self, command: int, *params: float) -> int:
        """Send a command; return the MAV_RESULT."""
        padded = (*params, *(0.0,) * (7 - len(params)))
        self.states(dialect.MAVLink_command_long_message(1, 1, command, 0, *padded))
        self.world.run(self.world.now + 2 * MILLISECOND)
        return self.ground.acknowledged[-1]

    def speed(self, axis: str) -> float:
        """Return the bridge's value of an axis's speed, rad/s."""
        return self.bridge.seen.facts.axes[axis].velocity

    def held(self) -> set[str]:
        return {event.name for event in self.bridge.interlock_events}

    def _noting(self, link: str) -> Observer:
        def note(_now: Nanoseconds, sender: str, packet: Packet) -> None:
            if sender == "bridge":
                self.sent[link].append(packet)

        return note


def started(change: Any = lambda _table: None) -> TwoBuses:
    bench = TwoBuses(cart(change))
    bench.runs(2.0)
    assert bench.bridge.phase is Life.RUNNING, bench.bridge.failure
    return bench


def sweeping(change: Any = lambda _table: None) -> TwoBuses:
    bench = started(change)
    assert bench.commands(ARM, 1.0) == dialect.MAV_RESULT_ACCEPTED
    bench.ahead = bench.brush = 0.5
    bench.runs(1.0)
    assert bench.speed("left") == pytest.approx(5.0, abs=0.1)
    assert bench.speed("brush") == pytest.approx(5.0, abs=0.1)
    return bench


def every_second(table: dict[str, Any]) -> None:
    table["links"][TOOL]["every"] = 2


def stops_itself(table: dict[str, Any]) -> None:
    table["links"][TOOL]["stops"] = ["tool"]


def test_a_link_of_every_second_cycle_is_synchronized_half_as_often() -> None:
    bench = sweeping(every_second)
    before = {name: len(sent) for name, sent in bench.sent.items()}
    bench.runs(2.0)
    syncs = {
        name: sum(packet.address == SYNC for packet in sent[before[name] :])
        for name, sent in bench.sent.items()
    }
    assert syncs == {WHEELS: 40, TOOL: 20}
    assert bench.guard.refusals == ()


@pytest.mark.long(keeps=["50"])
@pytest.mark.parametrize("after_ms", [0, 20, 50, 70])
def test_an_emergency_stop_is_on_a_slow_link_before_its_next_cycle(after_ms: int) -> None:
    bench = sweeping(every_second)
    bench.runs(after_ms / 1000)
    before = len(bench.sent[TOOL])
    assert bench.commands(STOP, 0.0) == dialect.MAV_RESULT_ACCEPTED
    words = [packet.payload for packet in bench.sent[TOOL][before:] if packet.address == 0x501]
    assert words, "within 2 ms"
    assert words[-1][2:6] == bytes(4)
    bench.runs(0.5)
    assert bench.speed("brush") == pytest.approx(0.0, abs=0.5)
    assert bench.guard.refusals == ()


def test_a_drive_that_falls_silent_on_its_own_link_stops_its_group_alone() -> None:
    bench = sweeping(stops_itself)
    bench.world.silence("brush", bench.world.now)
    bench.runs(1.0)
    assert "axis timeout: brush" in bench.held()
    assert bench.bridge.seen.facts.armed
    assert bench.speed("left") == pytest.approx(5.0, abs=0.1)
    assert bench.guard.refusals == ()


def test_without_that_line_in_the_file_it_stops_the_robot() -> None:
    bench = sweeping()
    bench.world.silence("brush", bench.world.now)
    bench.runs(1.5)
    assert not bench.bridge.seen.facts.armed
    assert bench.speed("left") == pytest.approx(0.0, abs=0.05)


def test_after_a_failed_brush_the_cart_goes_on_in_another_mode() -> None:
    bench = sweeping()
    bench.ahead = bench.brush = 0.0
    bench.world.silence("brush", bench.world.now)
    bench.runs(1.5)
    assert bench.commands(ARM, 1.0) == dialect.MAV_RESULT_TEMPORARILY_REJECTED
    assert bench.commands(MODE, 1.0, number_of_own(1)) == dialect.MAV_RESULT_ACCEPTED
    bench.runs(0.5)
    assert bench.held() == {"not armed"}
    assert bench.commands(ARM, 1.0) == dialect.MAV_RESULT_ACCEPTED
    bench.ahead = 0.5
    bench.runs(1.0)
    assert bench.speed("left") == pytest.approx(5.0, abs=0.1)
    assert bench.guard.refusals == ()


def test_a_brush_that_races_latches_and_all_drives_stop() -> None:
    bench = sweeping()
    bench.brush = 0.9
    bench.runs(0.5)
    bench.brush = 0.0
    bench.runs(1.5)
    assert {"emergency stop", "not armed"} <= bench.held()
    assert [bench.speed(axis) for axis in ("left", "right", "brush")] == pytest.approx([0.0] * 3, abs=0.5)
    assert bench.commands(ARM, 1.0) == dialect.MAV_RESULT_DENIED
    bench.ahead = 0.0
    bench.runs(0.5)
    assert bench.commands(STOP, 1.0) == dialect.MAV_RESULT_ACCEPTED
    assert bench.guard.refusals == ()
