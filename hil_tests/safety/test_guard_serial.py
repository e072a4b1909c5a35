"""The guard on a serial line: which commands leave, with which values, and what leaves instead."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen_drive.driver.setup import farewell
from firmware_bridge.families.epos2.driver.product import configuration, through_gateway
from firmware_bridge.families.epos2.driver.serial.link import guarding, heartbeat
from firmware_bridge.families.epos2.maxon import messages
from firmware_bridge.families.epos2.maxon.messages import Request, SendCanFrame, SendNmtService, WriteObject
from firmware_bridge.families.epos2.maxon.opcodes import ROWS
from firmware_bridge.families.epos2.maxon.packets import request_of
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link
from firmware_bridge.node import CAN, LINE_BACK, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.safety.guard_bench import LINK
from hil_tests.safety.serial_bench import (
    ENABLE,
    ENDS,
    HALT,
    LEFT,
    LIFT,
    NEW_POSITION,
    QUICK_STOP,
    ROBOT,
    RULES,
    STEER,
    TOP,
    SerialBench,
    number,
    reading,
    speed,
    states,
    target,
    value,
    word,
    writing,
)

NODES = (1, 2, 3, 4)


@pytest.fixture
def desk() -> SerialBench:
    return SerialBench()


@pytest.mark.parametrize("packet", [
    *(speed(rpm) for rpm in (-TOP, 0, TOP)),
    *(target(STEER, end) for end in ENDS[STEER]),
    *(target(LIFT, end) for end in ENDS[LIFT]),
    *(word(LEFT, value) for value in (0, 2, 6, 7, QUICK_STOP, ENABLE, HALT, 0x80)),
    word(STEER, NEW_POSITION),
    reading(4, od.STATUSWORD),
    states(heartbeat(Epos2Link.of_link(ROBOT, LINK))),
    states(guarding(Epos2Link.of_link(ROBOT, LINK), NODES)),
    *(states(SendNmtService(node, NmtCommand.START)) for node in (0, 1, 2, 3, 4)),
])  # fmt: skip
def test_what_is_listed_leaves_as_it_is(desk: SerialBench, packet: Packet) -> None:
    assert desk.states(packet) == (packet,)
    assert desk.guard.refused == 0


def confirms_no_power(desk: SerialBench, node: int) -> None:
    """Let a drive answer that it is switched off; earlier requests are answered first."""
    requested = reading(node, od.STATUSWORD)
    desk.guard.receive(Packet(LINK, LINE_BACK, b""), 0)
    desk.states(requested)
    desk.receives(value(requested, b"\x40\x01"))


def test_the_whole_set_up_of_every_drive_leaves_as_it_is(desk: SerialBench) -> None:
    link = Epos2Link.of_link(ROBOT, LINK)
    for axis in ROBOT.axes:
        flows = through_gateway(axis, link, NODES)
        confirms_no_power(desk, Epos2Axis.of(axis).node)
        for row in (*configuration(axis, link, traffic=flows), *farewell()):
            packet = writing(Epos2Axis.of(axis).node, row.address, row.raw)
            assert desk.states(packet) == (packet,), row
    assert desk.guard.refused == 0


@pytest.mark.parametrize(("packet", "reason"), [
    (speed(TOP + 1), f"set to {TOP + 1}, allowed is {-TOP} to {TOP}"),
    (speed(-TOP - 1), f"set to {-TOP - 1}"),
    (target(STEER, ENDS[STEER][1] + 1), "0x607A set to"),
    (target(LIFT, ENDS[LIFT][0] - 1), "0x607A set to"),
    (target(LEFT, 0), "0x607A is not an object that may be written"),
    (speed(0, STEER), "0x60FF is not an object that may be written"),
    (word(LEFT, NEW_POSITION), "0x6040 set to 63"),
    (word(LEFT, 0x7F), "0x6040 set to 127"),
    (number(LEFT, od.CONTROLWORD, 0x1_000F), "0x6040 written with more than its 2 bytes"),
    (number(LEFT, od.PROFILE_ACCELERATION, 5_701), "0x6083 set to"),
    (number(LEFT, od.CONSUMER_HEARTBEAT_1, 100 << 16 | 200), "0x1016:01 set to"),
    (number(LEFT, od.PRODUCER_HEARTBEAT, 100), "0x1017 set to 100"),
    (number(LEFT, Address(0x1010, 1), 0x6576_6173), "0x1010:01 is not an object"),
    (speed(0, 5), "node 5 is not listed"),
    (speed(0, 0), "node 0 is not listed"),
    (reading(9, od.STATUSWORD), "node 9 is not listed"),
    (states(SendNmtService(1, NmtCommand.STOP)), "network command 2 is not listed"),
    (states(SendNmtService(7, NmtCommand.START)), "node 7 is not listed"),
    (states(SendNmtService(257, NmtCommand.START)), "node 257 is not listed"),
    (states(SendCanFrame(0x501, 6, bytes(8))), "frame 0x501"),
    (states(SendCanFrame(0x764, 2, b"\x05" + bytes(7))), "frame 0x764"),
    (states(SendCanFrame(0x764, 1, b"\x06" + bytes(7))), "frame 0x764"),
    (states(messages.RequestCanFrame(0x181, 2)), "remote frame 0x181"),
    (states(messages.InitiateSegmentedWrite(0x6040, 0, 1, 2)), "command 0x13"),
    (states(messages.SegmentWrite(2, b"\x0f\x00")), "command 0x15"),
    (states(messages.SendLssFrame(bytes(8))), "command 0x30"),
    (Packet(LINK, 0x99, b""), "command 0x99"),
    (Packet(LINK, 0x11, b"\xff\x60\x00"), "command 0x11"),
    (Packet(LINK, 0x11, speed(5).payload + b"\0\0"), "command 0x11"),
    (Packet(CAN, 0x501, bytes(6)), "link 'can' is not listed"),
])  # fmt: skip
def test_what_is_not_listed_does_not_leave(desk: SerialBench, packet: Packet, reason: str) -> None:
    assert packet not in desk.states(packet)
    assert desk.guard.refused == 1
    assert reason in desk.refusals[0].reason


def test_the_gateway_watches_another_drive_and_the_others_the_bridge() -> None:
    watched = [Epos2Link.of_link(ROBOT, LINK).watched_by(node, NODES) for node in NODES]
    assert watched == [2, 100, 100, 100]


def test_every_command_of_the_protocol_has_been_judged() -> None:
    """A new opcode must be thought about here: what is not listed is refused."""
    listed = {0x0E, 0x10, 0x11, 0x20, 0x21}
    for row in ROWS:
        if row.opcode not in listed:
            assert RULES.refuses(Packet(LINK, row.opcode, bytes(8)), 0) is not None


def test_a_refused_speed_becomes_speed_0_and_the_power_stays_on(desk: SerialBench) -> None:
    desk.states(speed(1000), word(LEFT, ENABLE))
    assert desk.states(speed(TOP + 1)) == (speed(0), word(LEFT, ENABLE))


def test_a_refused_position_becomes_halt(desk: SerialBench) -> None:
    desk.states(target(STEER, 100), word(STEER, NEW_POSITION))
    assert desk.states(target(STEER, ENDS[STEER][1] + 1)) == (word(STEER, HALT),)


@pytest.mark.parametrize("before", [0, 6, QUICK_STOP])
def test_the_safe_words_never_put_the_power_on(desk: SerialBench, before: int) -> None:
    desk.states(word(LEFT, before))
    assert desk.states(speed(TOP + 1)) == (speed(0), word(LEFT, before))


def test_another_refusal_makes_every_axis_with_power_safe(desk: SerialBench) -> None:
    desk.states(word(LEFT, ENABLE), word(LIFT, HALT))
    sent = desk.states(states(SendCanFrame(0x401, 6, bytes(8))))
    assert sent == (speed(0), word(LEFT, ENABLE), word(LIFT, HALT))


def test_a_moving_drive_keeps_its_network_state(desk: SerialBench) -> None:
    desk.states(speed(1000), word(LEFT, ENABLE))
    assert desk.states(states(SendNmtService(LEFT, NmtCommand.RESET_NODE))) == (
        speed(0),
        word(LEFT, ENABLE),
    )


def test_the_watch_of_a_drive_with_power_is_not_ended(desk: SerialBench) -> None:
    off = number(LEFT, od.CONSUMER_HEARTBEAT_1, 0)
    assert off not in desk.states(off), "it has sent nothing yet"
    confirms_no_power(desk, LEFT)
    assert desk.states(off) == (off,)
    desk.states(word(LEFT, ENABLE))
    assert off not in desk.states(off)
    assert {refusal.reason for refusal in desk.refusals} == {"0x1016:01 set to 0 while node 1 may have power"}


@pytest.mark.parametrize(
    ("network", "after"),
    [
        (NmtCommand.RESET_COMMUNICATION, 0),
        (NmtCommand.ENTER_PRE_OPERATIONAL, HALT),
        (NmtCommand.START, HALT),
    ],
)
@pytest.mark.parametrize("node", [0, STEER])
def test_a_drive_that_was_reset_is_without_power(
    desk: SerialBench, network: NmtCommand, after: int, node: int
) -> None:
    """In pre-operational it still receives serial commands, and keeps its power."""
    desk.states(word(STEER, HALT))
    reported = states(SendNmtService(node, network))
    assert desk.states(reported) == (reported,)
    assert desk.states(target(STEER, ENDS[STEER][1] + 1)) == (word(STEER, after),)


def test_a_drive_is_reset_where_it_has_not_confirmed_in_its_time(desk: SerialBench) -> None:
    reset = states(SendNmtService(STEER, NmtCommand.RESET_NODE))
    desk.states(word(STEER, HALT))
    assert reset not in desk.states(reset, now=SECOND)
    desk.states(word(STEER, 0), now=SECOND)
    assert reset not in desk.states(reset, now=SECOND + 700 * MILLISECOND - 1)
    assert desk.states(reset, now=SECOND + 700 * MILLISECOND) == (reset,)
    everybody = states(SendNmtService(0, NmtCommand.RESET_NODE))
    assert everybody not in desk.states(everybody, now=3 * SECOND)


def test_network_commands_to_other_drives_leave_while_one_moves_but_none_to_all(desk: SerialBench) -> None:
    desk.states(speed(1000), word(LEFT, ENABLE))
    other = states(SendNmtService(LIFT, NmtCommand.ENTER_PRE_OPERATIONAL))
    assert desk.states(other) == (other,)
    everybody = states(SendNmtService(0, NmtCommand.ENTER_PRE_OPERATIONAL))
    assert everybody not in desk.states(everybody)


def test_power_is_taken_off_and_a_watch_set_at_any_time(desk: SerialBench) -> None:
    desk.states(word(LEFT, ENABLE))
    watch = number(LEFT, od.CONSUMER_HEARTBEAT_1, 2 << 16 | 200)
    for packet in (watch, word(LEFT, 0)):
        assert desk.states(packet) == (packet,)
    assert desk.guard.refused == 0


def test_the_operator_s_datagrams_pass(desk: SerialBench) -> None:
    datagram = Packet(OPERATOR, 0, b"\xfd")
    assert desk.states(datagram) == (datagram,)


ANY_NODE = st.integers(0, 6)
OBJECTS = st.sampled_from([od.CONTROLWORD, od.TARGET_VELOCITY, od.TARGET_POSITION, od.MODE])
RAW = st.one_of(
    st.binary(min_size=4, max_size=4), st.integers(0, 0x13F).map(lambda value: value.to_bytes(4, "little"))
)
REQUESTS: st.SearchStrategy[Request] = st.one_of(
    st.builds(
        lambda node, where, raw: WriteObject(where.index, where.subindex, node, raw), ANY_NODE, OBJECTS, RAW
    ),
    st.builds(SendCanFrame, st.integers(0x180, 0x77F), st.just(8), st.binary(min_size=8, max_size=8)),
    st.builds(SendNmtService, ANY_NODE, st.integers(0, 255)),
)


@given(st.lists(REQUESTS, max_size=20))
def test_whatever_the_node_states_no_target_beyond_its_bounds_leaves(stated: list[Request]) -> None:
    desk = SerialBench()
    for request in stated:
        for packet in desk.states(states(request)):
            left = request_of(packet)
            assert left is not None
            # Rules on the drives' own reports are for a guard that receives them.
            assert RULES.refuses(packet, 0) is None
            if isinstance(left, messages.WriteObject) and left.index == od.TARGET_VELOCITY.index:
                assert abs(int.from_bytes(left.raw, "little", signed=True)) <= TOP
