"""The guard's rules for a serial line to drives, word by word, and which rules a link has."""

from __future__ import annotations

import pytest

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen_drive.guard.axis import GuardedAxis
from firmware_bridge.canopen_drive.guard.words import NEW_SET_POINT, GuardedSetPoint
from firmware_bridge.families.epos2.guard.serial import Epos2SerialRules
from firmware_bridge.families.epos2.maxon.messages import SendCanFrame, SendNmtService
from firmware_bridge.families.motion_capture.settings import CaptureLink
from firmware_bridge.node import LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find, names
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import MILLISECOND
from hil_tests.safety.guard_bench import LINK, Bench, ScriptedNode, position, wheel
from hil_tests.safety.guard_robots import RARS
from hil_tests.safety.serial_bench import ROBOT, SerialBench, done, reading, speed, states, value, word

ENABLE, START = 0x000F, 0x001F
BEATS = (0x00, 0x04, 0x05, 0x7F)
CYCLE = RARS.cycle


def refusal(packet: Packet, rules: Epos2SerialRules | None = None) -> str | None:
    return (rules or Epos2SerialRules(ROBOT, LINK)).refuses(packet, 0)


@pytest.mark.parametrize("state", range(256))
def test_the_bridge_beats_with_the_states_of_the_standard(state: int) -> None:
    beat = SendCanFrame(0x764, 1, bytes((state,)).ljust(8, b"\0"))
    assert (refusal(states(beat)) is None) is (state in BEATS)


@pytest.mark.parametrize(
    "frame",
    [
        SendCanFrame(0x765, 1, bytes((5,)).ljust(8, b"\0")),
        SendCanFrame(0x764, 2, bytes((5,)).ljust(8, b"\0")),
        SendCanFrame(0x764, 1, bytes((5, 1)).ljust(8, b"\0")),
    ],
)
def test_no_other_frame_goes_through_the_gateway(frame: SendCanFrame) -> None:
    assert f"frame 0x{frame.identifier:X}" in str(refusal(states(frame)))


def test_a_wheel_has_no_zero_to_be_found() -> None:
    assert "0x6040 set to 31" in str(refusal(word(1, START)))


def moving(node: int) -> SerialBench:
    """A line on which one wheel moves, and has been answered."""
    desk = SerialBench()
    for packet in (speed(100, node), word(node, ENABLE)):
        assert desk.states(packet) == (packet,)
        desk.receives(done(packet))
    return desk


@pytest.mark.parametrize("node", [1, 2])
def test_who_moves_is_kept_from_being_made_unable_to_receive_and_may_be_started(node: int) -> None:
    desk = moving(node)
    for command in (NmtCommand.ENTER_PRE_OPERATIONAL, NmtCommand.RESET_COMMUNICATION):
        for whom in (cia301.ALL_NODES, node):
            desk.states(states(SendNmtService(whom, command)))
            reason = f"node {node} moves and would look as if it had restarted"
            assert desk.refusals[-1].reason == reason
            desk = moving(node)
    start = states(SendNmtService(cia301.ALL_NODES, NmtCommand.START))
    assert desk.states(start) == (start,)


def test_all_are_reset_only_where_each_may_be() -> None:
    """The first one is commanded to give up its power for long enough; the second one never was."""
    desk = SerialBench()
    off = word(1, 0x0000)
    assert desk.states(off) == (off,)
    desk.receives(done(off))
    reset = states(SendNmtService(1, NmtCommand.RESET_NODE))
    later = 10_000 * MILLISECOND
    assert desk.guard.links[LINK].refuses(reset, later) is None
    everybody = states(SendNmtService(cia301.ALL_NODES, NmtCommand.RESET_NODE))
    assert "node 2 has been without an order" in str(desk.guard.links[LINK].refuses(everybody, later))


def test_each_position_that_is_read_counts() -> None:
    desk = SerialBench()
    for place in (1_000, 400_000, 900_000):
        read = reading(4, od.POSITION_ACTUAL)
        desk.states(read)
        desk.receives(value(read, place.to_bytes(4, "little")))
        (lift,) = (axis for axis in desk.guard.links[LINK].axes if axis.axis.name == "lift")
        assert isinstance(lift, GuardedAxis)
        assert not lift.moves_with(GuardedSetPoint(NEW_SET_POINT, place + 1)), "near to where it rests"
        assert lift.moves_with(GuardedSetPoint(NEW_SET_POINT, place + 100_000))


def test_an_answer_to_a_write_reports_nothing_of_the_drive() -> None:
    desk = SerialBench()
    stated = word(4, 0x0006)
    desk.states(stated)
    desk.receives(value(stated, (0x0137).to_bytes(2, "little")))
    assert not any(axis.powered for axis in desk.guard.links[LINK].axes)


def test_a_line_that_is_gone_answers_nothing() -> None:
    desk = SerialBench()
    read = reading(1, od.STATUSWORD)
    desk.states(read)
    desk.guard.receive(Packet(LINK, LINE_LOST, b""), 0)
    assert not desk.receives(value(read, (0x0137).to_bytes(2, "little")))


@pytest.mark.parametrize("robot", names())
def test_every_link_of_every_robot_has_rules_and_every_axis_knows_all(robot: str) -> None:
    machine = find(robot)
    guard = guarded(ScriptedNode(), machine)
    assert guard.links.keys() == machine.links.keys() | CaptureLink.all_of(machine).keys()
    axes = [axis for rules in guard.links.values() for axis in rules.axes]
    assert {axis.axis.name for axis in axes} == {axis.name for axis in machine.axes}
    for axis in axes:
        assert list(axis.all) == axes


def test_the_guard_looks_again_when_the_first_axis_is_overdue_whenever_that_is() -> None:
    bench = Bench(RARS)
    for now in range(0, 5 * MILLISECOND, MILLISECOND):
        wheels = [wheel(node, ENABLE, 100) for node in (1, 2)]
        others = [position(node, ENABLE, 0) for node in (3, 4)]
        bench.states(*wheels, *others, now=now)
        assert bench.guard.wake(now).wake_at == now + 3 * CYCLE


def test_a_word_to_all_joints_was_stated_to_each() -> None:
    machine = find("ar2")
    guard = guarded(scripted := ScriptedNode(), machine)
    scripted.states = (Packet("arm", 0, b"TMq1\n"),)
    guard.wake(7 * MILLISECOND)
    assert {axis.commanded_at for axis in guard.links["arm"].axes} == {7 * MILLISECOND}
