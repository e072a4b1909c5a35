"""The guard on a serial line: which commands leave, with which values, and what leaves instead."""

import pytest
from firmware_bridge.drivers.epos2_setup import Travel, configuration, farewell, over_serial
from firmware_bridge.drivers.serial.client import reading, writing
from firmware_bridge.drivers.serial.link import guarding, heartbeat
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.node import CAN, MAXON, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Command
from firmware_bridge.wire.canopen import NmtCommand
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.maxon import messages
from firmware_bridge.wire.maxon.messages import Request, SendCanFrame, SendNmtService
from firmware_bridge.wire.maxon.opcodes import ROWS
from firmware_bridge.wire.maxon.packets import command, request_of
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
    speed,
    target,
    word,
)


@pytest.fixture
def desk() -> SerialBench:
    return SerialBench()


@pytest.mark.parametrize("packet", [
    *(speed(rpm) for rpm in (-TOP, 0, TOP)),
    *(target(STEER.node, end) for end in ENDS["steer"]),
    *(target(LIFT.node, end) for end in ENDS["lift"]),
    *(word(LEFT.node, value) for value in (0, 2, 6, 7, QUICK_STOP, ENABLE, HALT, 0x80)),
    word(STEER.node, NEW_POSITION),
    command(reading(4, at.STATUSWORD)),
    command(heartbeat(ROBOT)),
    command(guarding(ROBOT)),
    *(command(SendNmtService(node, NmtCommand.START)) for node in (0, 1, 2, 3, 4)),
])  # fmt: skip
def test_what_is_listed_leaves_as_it_is(desk: SerialBench, packet: Packet) -> None:
    assert desk.says(packet) == (packet,)
    assert desk.guard.refused == 0


def test_the_whole_set_up_of_every_drive_leaves_as_it_is(desk: SerialBench) -> None:
    for axis, rules in zip(ROBOT.axes, RULES.axes, strict=True):
        travel = Travel(rules.low, rules.high) if axis.command is Command.POSITION else None
        for row in (*configuration(axis, ROBOT.links["drives"], travel, over_serial(axis, ROBOT)), *farewell()):
            packet = command(writing(axis.settings.node, row.address, row.raw))
            assert desk.says(packet) == (packet,), row
    assert desk.guard.refused == 0


@pytest.mark.parametrize(("packet", "reason"), [
    (speed(TOP + 1), f"set to {TOP + 1}, allowed is {-TOP} to {TOP}"),
    (speed(-TOP - 1), f"set to {-TOP - 1}"),
    (target(STEER.node, ENDS["steer"][1] + 1), "0x607A set to"),
    (target(LIFT.node, ENDS["lift"][0] - 1), "0x607A set to"),
    (target(LEFT.node, 0), "0x607A is not an object that may be written"),
    (speed(0, STEER.node), "0x60FF is not an object that may be written"),
    (word(LEFT.node, NEW_POSITION), "0x6040 set to 63"),
    (word(LEFT.node, 0x7F), "0x6040 set to 127"),
    (number(LEFT.node, at.CONTROLWORD, 0x1_000F), "0x6040 written with more than its 2 bytes"),
    (number(LEFT.node, at.PROFILE_ACCELERATION, LEFT.profile.acceleration_rpm_s + 1), "0x6083 set to"),
    (number(LEFT.node, at.CONSUMER_HEARTBEAT_1, 100 << 16 | 200), "0x1016:01 set to"),
    (number(LEFT.node, at.PRODUCER_HEARTBEAT, 100), "0x1017 set to 100"),
    (number(LEFT.node, Address(0x1010, 1), 0x6576_6173), "0x1010:01 is not an object"),
    (speed(0, 5), "node 5 is not listed"),
    (speed(0, 0), "node 0 is not listed"),
    (command(reading(9, at.STATUSWORD)), "node 9 is not listed"),
    (command(SendNmtService(1, NmtCommand.STOP)), "network command 2 is not listed"),
    (command(SendNmtService(7, NmtCommand.START)), "node 7 is not listed"),
    (command(SendNmtService(257, NmtCommand.START)), "node 257 is not listed"),
    (command(SendCanFrame(0x501, 6, bytes(8))), "frame 0x501"),
    (command(SendCanFrame(0x764, 2, b"\x05" + bytes(7))), "frame 0x764"),
    (command(SendCanFrame(0x764, 1, b"\x06" + bytes(7))), "frame 0x764"),
    (command(messages.RequestCanFrame(0x181, 2)), "remote frame 0x181"),
    (command(messages.InitiateSegmentedWrite(0x6040, 0, 1, 2)), "command 0x13"),
    (command(messages.SegmentWrite(2, b"\x0f\x00")), "command 0x15"),
    (command(messages.SendLssFrame(bytes(8))), "command 0x30"),
    (Packet(MAXON, 0x99, b""), "command 0x99"),
    (Packet(MAXON, 0x11, b"\xff\x60\x00"), "command 0x11"),
    (Packet(MAXON, 0x11, speed(5).payload + b"\0\0"), "command 0x11"),
    (Packet(CAN, 0x501, bytes(6)), "link 'can' is not listed"),
])  # fmt: skip
def test_what_is_not_listed_does_not_leave(desk: SerialBench, packet: Packet, reason: str) -> None:
    assert packet not in desk.says(packet)
    assert desk.guard.refused == 1
    assert reason in desk.told[0].reason


def test_the_gateway_watches_another_drive_and_the_others_the_bridge() -> None:
    watched = [ROBOT.watched_by(axis) for axis in ROBOT.axes]
    assert watched == [2, 100, 100, 100]


def test_every_command_of_the_protocol_has_been_judged() -> None:
    """A new opcode must be thought about here: what is not listed is refused."""
    listed = {0x0E, 0x10, 0x11, 0x20, 0x21}
    for row in ROWS:
        if row.opcode not in listed:
            assert RULES.refuses(Packet(MAXON, row.opcode, bytes(8))) is not None


def test_a_refused_speed_becomes_speed_0_and_the_power_stays_on(desk: SerialBench) -> None:
    desk.says(speed(1000), word(LEFT.node, ENABLE))
    assert desk.says(speed(TOP + 1)) == (speed(0), word(LEFT.node, ENABLE))


def test_a_refused_position_becomes_halt(desk: SerialBench) -> None:
    desk.says(target(STEER.node, 100), word(STEER.node, NEW_POSITION))
    assert desk.says(target(STEER.node, ENDS["steer"][1] + 1)) == (word(STEER.node, HALT),)


@pytest.mark.parametrize("before", [0, 6, QUICK_STOP])
def test_the_safe_words_never_put_the_power_on(desk: SerialBench, before: int) -> None:
    desk.says(word(LEFT.node, before))
    assert desk.says(speed(TOP + 1)) == (speed(0), word(LEFT.node, before))


def test_another_refusal_makes_every_axis_with_power_safe(desk: SerialBench) -> None:
    desk.says(word(LEFT.node, ENABLE), word(LIFT.node, HALT))
    sent = desk.says(command(SendCanFrame(0x401, 6, bytes(8))))
    assert sent == (speed(0), word(LEFT.node, ENABLE), word(LIFT.node, HALT))


def test_a_moving_drive_keeps_its_network_state(desk: SerialBench) -> None:
    desk.says(speed(1000), word(LEFT.node, ENABLE))
    assert desk.says(command(SendNmtService(LEFT.node, NmtCommand.RESET_NODE))) == (
        speed(0),
        word(LEFT.node, ENABLE),
    )


def test_the_watch_of_a_drive_with_power_is_not_ended(desk: SerialBench) -> None:
    off = number(LEFT.node, at.CONSUMER_HEARTBEAT_1, 0)
    assert desk.says(off) == (off,)
    desk.says(word(LEFT.node, ENABLE))
    assert off not in desk.says(off)
    assert "0x1016:01 set to 0 while node 1 has power" in desk.told[0].reason


@pytest.mark.parametrize(
    ("network", "after"),
    [
        (NmtCommand.RESET_NODE, 0),
        (NmtCommand.RESET_COMMUNICATION, 0),
        (NmtCommand.ENTER_PRE_OPERATIONAL, HALT),
        (NmtCommand.START, HALT),
    ],
)
@pytest.mark.parametrize("node", [0, STEER.node])
def test_a_drive_that_was_reset_is_without_power(
    desk: SerialBench, network: NmtCommand, after: int, node: int
) -> None:
    """In pre-operational it still hears serial commands, and keeps its power."""
    desk.says(word(STEER.node, HALT))
    told = command(SendNmtService(node, network))
    assert desk.says(told) == (told,)
    assert desk.says(target(STEER.node, ENDS["steer"][1] + 1)) == (word(STEER.node, after),)


def test_network_commands_to_other_drives_leave_while_one_moves_but_none_to_all(desk: SerialBench) -> None:
    desk.says(speed(1000), word(LEFT.node, ENABLE))
    other = command(SendNmtService(LIFT.node, NmtCommand.ENTER_PRE_OPERATIONAL))
    assert desk.says(other) == (other,)
    everybody = command(SendNmtService(0, NmtCommand.ENTER_PRE_OPERATIONAL))
    assert everybody not in desk.says(everybody)


def test_power_is_taken_off_and_a_watch_set_at_any_time(desk: SerialBench) -> None:
    desk.says(word(LEFT.node, ENABLE))
    watch = number(LEFT.node, at.CONSUMER_HEARTBEAT_1, 2 << 16 | 200)
    for packet in (watch, word(LEFT.node, 0)):
        assert desk.says(packet) == (packet,)
    assert desk.guard.refused == 0


def test_the_operator_s_datagrams_pass(desk: SerialBench) -> None:
    datagram = Packet(OPERATOR, 0, b"\xfd")
    assert desk.says(datagram) == (datagram,)


NODES = st.integers(0, 6)
OBJECTS = st.sampled_from([at.CONTROLWORD, at.TARGET_VELOCITY, at.TARGET_POSITION, at.MODE])
RAW = st.one_of(
    st.binary(min_size=4, max_size=4), st.integers(0, 0x13F).map(lambda value: value.to_bytes(4, "little"))
)
REQUESTS: st.SearchStrategy[Request] = st.one_of(
    st.builds(writing, NODES, OBJECTS, RAW),
    st.builds(SendCanFrame, st.integers(0x180, 0x77F), st.just(8), st.binary(min_size=8, max_size=8)),
    st.builds(SendNmtService, NODES, st.integers(0, 255)),
)


@given(st.lists(REQUESTS, max_size=20))
def test_whatever_the_node_says_no_target_beyond_its_bounds_leaves(said: list[Request]) -> None:
    desk = SerialBench()
    for request in said:
        for packet in desk.says(command(request)):
            left = request_of(packet)
            assert left is not None
            assert RULES.refuses(packet) is None
            if isinstance(left, messages.WriteObject) and left.index == at.TARGET_VELOCITY.index:
                assert abs(int.from_bytes(left.raw, "little", signed=True)) <= TOP
