"""The guard on a serial line: which commands leave, with which values, and what leaves instead."""

from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.drivers.epos2_setup import Travel, configuration, farewell, over_serial
from firmware_bridge.drivers.serial.client import reading, writing
from firmware_bridge.drivers.serial.link import guarding, heartbeat
from firmware_bridge.node import CAN, LINE_BACK, LINE_LOST, MAXON, OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Mode, Role, find
from firmware_bridge.safety.guard import Guarded, Refusal, guarded
from firmware_bridge.safety.guard_serial_rules import serial_rules_for
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.canopen import NmtCommand
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.maxon import messages
from firmware_bridge.wire.maxon.frame import Answered
from firmware_bridge.wire.maxon.messages import Done, Request, SendCanFrame, SendNmtService
from firmware_bridge.wire.maxon.opcodes import ROWS, encode_answer
from firmware_bridge.wire.maxon.packets import command, outcome_packet, request_of
from hil_tests.safety.guard_bench import Puppet

ROBOT: Final = find("rars").over_serial()
RULES: Final = serial_rules_for(ROBOT)
LEFT, STEER, LIFT = (ROBOT.axis(role) for role in (Role.LEFT_WHEEL, Role.STEERING, Role.LIFT))
TOP: Final = LEFT.profile.max_velocity_rpm
ENDS: Final = {rules.axis.name: (rules.low, rules.high) for rules in RULES.axes}
ENABLE, HALT, NEW_POSITION, QUICK_STOP = 0x000F, 0x010F, 0x003F, 0x000B


def word(node: int, controlword: int) -> Packet:
    return command(writing(node, at.CONTROLWORD, controlword.to_bytes(2, "little")))


def number(node: int, address: Address, value: int) -> Packet:
    return command(writing(node, address, value.to_bytes(4, "little", signed=value < 0)))


def speed(rpm: int, node: int = LEFT.node) -> Packet:
    return number(node, at.TARGET_VELOCITY, rpm)


def target(node: int, quadcounts: int) -> Packet:
    return number(node, at.TARGET_POSITION, quadcounts)


def done(packet: Packet) -> Packet:
    request = request_of(packet)
    assert request is not None
    return outcome_packet(packet.address, Answered(encode_answer(request, Done(0))))


class Bench:
    def __init__(self) -> None:
        self.puppet = Puppet()
        self.told: list[Refusal] = []
        self.guard: Guarded = guarded(self.puppet, ROBOT, self.told.append)

    def says(self, *packets: Packet, now: Nanoseconds = 0) -> tuple[Packet, ...]:
        self.puppet.says = packets
        return self.guard.wake(now).sent

    def hears(self, packet: Packet, now: Nanoseconds = 0) -> bool:
        """Whether the node is shown a packet."""
        before = len([heard for heard, _ in self.puppet.heard if heard is not None])
        self.guard.receive(packet, now)
        return len([heard for heard, _ in self.puppet.heard if heard is not None]) > before


@pytest.fixture
def desk() -> Bench:
    return Bench()


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
def test_what_is_listed_leaves_as_it_is(desk: Bench, packet: Packet) -> None:
    assert desk.says(packet) == (packet,)
    assert desk.guard.refused == 0


def test_the_whole_set_up_of_every_drive_leaves_as_it_is(desk: Bench) -> None:
    for axis, rules in zip(ROBOT.axes, RULES.axes, strict=True):
        travel = Travel(rules.low, rules.high) if axis.mode is Mode.POSITION else None
        for row in (*configuration(axis, ROBOT.bus, travel, over_serial(axis, ROBOT)), *farewell()):
            packet = command(writing(axis.node, row.address, row.raw))
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
def test_what_is_not_listed_does_not_leave(desk: Bench, packet: Packet, reason: str) -> None:
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


def test_a_refused_speed_becomes_speed_0_and_the_power_stays_on(desk: Bench) -> None:
    desk.says(speed(1000), word(LEFT.node, ENABLE))
    assert desk.says(speed(TOP + 1)) == (speed(0), word(LEFT.node, ENABLE))


def test_a_refused_position_becomes_halt(desk: Bench) -> None:
    desk.says(target(STEER.node, 100), word(STEER.node, NEW_POSITION))
    assert desk.says(target(STEER.node, ENDS["steer"][1] + 1)) == (word(STEER.node, HALT),)


@pytest.mark.parametrize("before", [0, 6, QUICK_STOP])
def test_the_safe_words_never_put_the_power_on(desk: Bench, before: int) -> None:
    desk.says(word(LEFT.node, before))
    assert desk.says(speed(TOP + 1)) == (speed(0), word(LEFT.node, before))


def test_another_refusal_makes_every_axis_with_power_safe(desk: Bench) -> None:
    desk.says(word(LEFT.node, ENABLE), word(LIFT.node, HALT))
    sent = desk.says(command(SendCanFrame(0x401, 6, bytes(8))))
    assert sent == (speed(0), word(LEFT.node, ENABLE), word(LIFT.node, HALT))


def test_a_moving_drive_keeps_its_network_state(desk: Bench) -> None:
    desk.says(speed(1000), word(LEFT.node, ENABLE))
    assert desk.says(command(SendNmtService(LEFT.node, NmtCommand.RESET_NODE))) == (
        speed(0),
        word(LEFT.node, ENABLE),
    )


def test_the_watch_of_a_drive_with_power_is_not_ended(desk: Bench) -> None:
    off = number(LEFT.node, at.CONSUMER_HEARTBEAT_1, 0)
    assert desk.says(off) == (off,)
    desk.says(word(LEFT.node, ENABLE))
    assert off not in desk.says(off)
    assert "0x1016:01 set to 0 while node 1 has power" in desk.told[0].reason


def test_a_bridge_that_is_silent_is_spoken_for(desk: Bench) -> None:
    desk.says(speed(1000), word(LEFT.node, ENABLE))
    assert desk.says(now=150 * MILLISECOND - 1) == ()
    assert desk.says(now=150 * MILLISECOND) == (speed(0), word(LEFT.node, ENABLE))
    assert "no set-point for 150 ms" in desk.told[0].reason


def test_the_guard_does_not_pile_up_words_on_a_line_that_stands(desk: Bench) -> None:
    desk.says(speed(1000), word(LEFT.node, ENABLE))
    for now in range(150, 1000, 10):
        desk.says(now=now * MILLISECOND)
    assert desk.guard.refused == 1
    spoken = desk.told[0].sent
    assert desk.says(now=1000 * MILLISECOND) == ()
    later = 1001 * MILLISECOND
    assert desk.hears(done(speed(1000)), later)
    assert desk.hears(done(word(LEFT.node, ENABLE)), later)
    for packet in spoken:
        assert not desk.hears(done(packet), later)
    assert desk.says(now=1100 * MILLISECOND) == spoken


def test_answers_to_the_guard_s_own_words_are_not_the_node_s(desk: Bench) -> None:
    desk.says(word(LIFT.node, HALT))
    assert desk.hears(done(word(LIFT.node, HALT)))
    desk.says(command(reading(1, at.STATUSWORD)), command(messages.SendLssFrame(bytes(8))))
    assert desk.hears(Packet(MAXON, 0x10, bytes(8)))
    assert not desk.hears(done(word(LIFT.node, HALT)))


def test_the_answer_to_the_last_safe_word_is_that_to_the_refused_set_point(desk: Bench) -> None:
    """Or the node would wait for it, and say nothing meanwhile."""
    first, last = desk.says(speed(TOP + 1))
    assert not desk.hears(done(first))
    assert desk.hears(done(last))


def test_what_left_before_the_line_was_lost_is_answered_no_more(desk: Bench) -> None:
    desk.says(speed(TOP + 1), word(LEFT.node, ENABLE))
    assert desk.hears(Packet(MAXON, LINE_LOST, b""))
    desk.says(speed(TOP + 1))
    assert desk.hears(Packet(MAXON, LINE_BACK, b""))
    desk.says(command(reading(1, at.STATUSWORD)))
    assert desk.hears(Packet(MAXON, 0x10, bytes(8)))


def test_an_answer_that_nobody_has_asked_for_is_not_the_node_s(desk: Bench) -> None:
    assert not desk.hears(Packet(MAXON, 0x10, bytes(8)))


def test_an_answer_that_is_kept_from_the_node_lets_it_act_on_the_time(desk: Bench) -> None:
    desk.puppet.wake_at = 7 * MILLISECOND
    reaction = desk.guard.receive(Packet(MAXON, 0x10, bytes(8)), 3 * MILLISECOND)
    assert reaction == Reaction((), 7 * MILLISECOND)
    assert desk.puppet.heard == [(None, 3 * MILLISECOND)]


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
    desk: Bench, network: NmtCommand, after: int, node: int
) -> None:
    """In pre-operational it still hears serial commands, and keeps its power."""
    desk.says(word(STEER.node, HALT))
    told = command(SendNmtService(node, network))
    assert desk.says(told) == (told,)
    assert desk.says(target(STEER.node, ENDS["steer"][1] + 1)) == (word(STEER.node, after),)


def test_network_commands_to_other_drives_leave_while_one_moves_but_none_to_all(desk: Bench) -> None:
    desk.says(speed(1000), word(LEFT.node, ENABLE))
    other = command(SendNmtService(LIFT.node, NmtCommand.ENTER_PRE_OPERATIONAL))
    assert desk.says(other) == (other,)
    everybody = command(SendNmtService(0, NmtCommand.ENTER_PRE_OPERATIONAL))
    assert everybody not in desk.says(everybody)


def test_power_is_taken_off_and_a_watch_set_at_any_time(desk: Bench) -> None:
    desk.says(word(LEFT.node, ENABLE))
    watch = number(LEFT.node, at.CONSUMER_HEARTBEAT_1, 2 << 16 | 200)
    for packet in (watch, word(LEFT.node, 0)):
        assert desk.says(packet) == (packet,)
    assert desk.guard.refused == 0


def test_the_operator_s_datagrams_pass(desk: Bench) -> None:
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
    desk = Bench()
    for request in said:
        for packet in desk.says(command(request)):
            left = request_of(packet)
            assert left is not None
            assert RULES.refuses(packet) is None
            if isinstance(left, messages.WriteObject) and left.index == at.TARGET_VELOCITY.index:
                assert abs(int.from_bytes(left.raw, "little", signed=True)) <= TOP
