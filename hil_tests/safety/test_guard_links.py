"""Several links behind one guard: each packet by its link's rules, rules over axes across them."""

import math
import struct
from typing import Any, Final

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen_drive.guard.can import DriveCanRules
from firmware_bridge.families.epos2.guard.serial import Epos2SerialRules
from firmware_bridge.families.epos2.maxon.messages import ReadObject, WriteObject
from firmware_bridge.families.epos2.maxon.packets import command
from firmware_bridge.families.epos2.settings import Epos2Link
from firmware_bridge.node import LINE_LOST
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard import Guarded
from firmware_bridge.units import MILLISECOND, NEVER
from hil_tests.safety.guard_bench import Bench
from hil_tests.safety.guard_robots import AnAxis, robot_with

CYCLE: Final = 50 * MILLISECOND
RPM: Final = math.tau / 60.0
ENABLE, HALT, GO = 0x000F, 0x010F, 0x003F


def made(**rules: Any) -> AnyRobot:
    """A wheel on one bus; on another one, with the same nodes, a wheel and an arm."""
    return robot_with(
        (
            AnAxis("front", 1, "base", top_speed=1000.0, ratio=RPM),
            AnAxis("rear", 1, "tail", top_speed=500.0, ratio=RPM),
            AnAxis("arm", 2, "tail", travel=(-1.0, 1.0)),
        ),
        **rules,
    )


def speed(link: str, rpm: int, node: int = 1, word: int = ENABLE) -> Packet:
    return Packet(link, 0x500 + node, struct.pack("<Hi", word, rpm))


def arm(counts: int, word: int = GO, link: str = "tail") -> Packet:
    return Packet(link, 0x402, struct.pack("<Hi", word, counts))


@pytest.fixture
def bench() -> Bench:
    return Bench(made(sums={"both": ({"front": 1.0, "rear": 1.0}, 1200.0)}, exclusive=(("front",), ("arm",))))


def test_each_link_has_its_own_rules(bench: Bench) -> None:
    assert bench.states(speed("base", 1000)) == (speed("base", 1000),)
    assert bench.states(speed("base", 0)) == (speed("base", 0),)
    assert bench.refuses(speed("tail", 501))[0] == "target 501 rpm is not within -500 to 500 rpm"
    assert bench.states(arm(1)) == (arm(1),)
    assert bench.refuses(arm(1, link="base"))[0] == "identifier 0x402 is not listed"


@pytest.mark.parametrize("link", ["bass", "", "can"])
def test_a_link_that_is_not_listed_stops_all(bench: Bench, link: str) -> None:
    bench.states(speed("base", 100), speed("tail", 100))
    stops = (speed("base", 0), speed("tail", 0))
    assert bench.refuses(speed(link, 1)) == (f"link '{link}' is not listed", stops)


def test_what_is_not_listed_on_one_link_stops_the_axes_of_all(bench: Bench) -> None:
    bench.states(speed("base", 100), speed("tail", 100))
    assert bench.refuses(Packet("tail", 0x123, b""))[1] == (speed("base", 0), speed("tail", 0))


def test_a_network_command_is_for_its_link(bench: Bench) -> None:
    bench.states(speed("base", 100), speed("tail", 0))
    leave = Packet("tail", 0x000, b"\x80\x00")
    assert bench.states(leave) == (leave,)
    stays = Packet("base", 0x000, b"\x80\x00")
    assert bench.refuses(stays)[0] == "node 1 moves and would receive no more set-points"


def test_a_statusword_is_of_its_link_s_drive(bench: Bench) -> None:
    bench.receives(Packet("tail", 0x181, b"\x37\x01"))
    assert bench.refuses(Packet("base", 0x123, b""))[1] == (speed("tail", 0, word=0x000B),)


def test_a_sum_spans_links_and_its_refusal_too(bench: Bench) -> None:
    bench.states(speed("base", 1000), speed("tail", 200))
    assert bench.states(speed("base", 900), speed("tail", 300), now=1) == (
        speed("base", 900),
        speed("tail", 300),
    )
    bench.states(speed("base", 900), now=2)
    reason, sent = bench.refuses(speed("tail", 301), 2)
    assert reason == "both of 1201.0000 is beyond 1200.0000"
    assert sent == (speed("base", 0), speed("tail", 0))


def test_sides_exclude_each_other_across_links(bench: Bench) -> None:
    bench.states(speed("base", 1), arm(0, ENABLE))
    assert bench.refuses(arm(100)) == ("one: arm may not move while front may", (arm(0, HALT),))
    assert bench.states(speed("tail", 1)) == (speed("tail", 1),), "the rear wheel excludes nothing"


def test_each_axis_is_overdue_by_its_own_link_s_cycle() -> None:
    bench = Bench(made(every={"tail": 4}))
    both = (speed("base", 100), speed("tail", 100), arm(5))
    assert bench.states(*both) == both
    now = 3 * CYCLE
    assert bench.guard.wake(0).wake_at == now
    assert bench.states(speed("base", 100), now=now - 1) == (speed("base", 100),)
    assert bench.guard.wake(now).sent == ()
    for cycle in range(3, 11):
        assert bench.states(speed("base", 100), now=cycle * CYCLE) == (speed("base", 100),)
    now = 12 * CYCLE
    assert bench.guard.wake(now - 1) == Reaction((), now)
    stops = (speed("base", 0), speed("tail", 0), arm(5, HALT))
    assert bench.guard.wake(now).sent == stops
    assert bench.refusals[-1].reason == "no set-point for 600 ms: rear, arm"
    assert bench.guard.wake(now + 1).wake_at == now + CYCLE


def test_the_quickest_link_s_silence_stops_all() -> None:
    bench = Bench(made(every={"tail": 4}))
    bench.states(speed("base", 100), speed("tail", 100), arm(5))
    assert len(bench.guard.wake(3 * CYCLE).sent) == 3
    assert bench.refusals[-1].reason == "no set-point for 150 ms: front"


def test_the_rules_are_one_for_each_link(bench: Bench) -> None:
    assert list(bench.guard.links) == ["base", "tail"]
    assert [axis.axis.name for rules in bench.guard.links.values() for axis in rules.axes] == [
        "front", "rear", "arm",
    ]  # fmt: skip


def writing(address: Address, value: int) -> Packet:
    raw = (value & 0xFFFF_FFFF).to_bytes(4, "little")
    return command(WriteObject(address.index, address.subindex, 1, raw), "tail")


@pytest.fixture
def mixed() -> Bench:
    """The same, but the tail is on a serial line."""
    robot = made(sums={"both": ({"front": 1.0, "rear": 1.0}, 1200.0)})
    return Bench(robot.with_links({"tail": Epos2Link.of_link(robot, "tail").over_serial(1, None, None)}))


def test_a_bus_and_a_serial_line_live_side_by_side(mixed: Bench) -> None:
    kinds = {name: type(rules) for name, rules in mixed.guard.links.items()}
    assert kinds == {"base": DriveCanRules, "tail": Epos2SerialRules}
    stated = (speed("base", 900), writing(od.TARGET_VELOCITY, 300), writing(od.CONTROLWORD, ENABLE))
    assert mixed.states(*stated) == stated


def test_on_a_mixed_robot_the_node_is_answered_for_what_it_requested_on_the_line(mixed: Bench) -> None:
    mixed.states(speed("base", 900), writing(od.TARGET_VELOCITY, 300), writing(od.CONTROLWORD, ENABLE))
    done = Packet("tail", 0x11, bytes(4))
    assert received(mixed.guard, done)
    assert received(mixed.guard, done)
    mixed.states(speed("base", 900), now=1)
    _, sent = mixed.refuses(writing(od.TARGET_VELOCITY, 301), 1)
    assert sent == (speed("base", 0), writing(od.TARGET_VELOCITY, 0), writing(od.CONTROLWORD, ENABLE))
    assert not received(mixed.guard, done)
    assert received(mixed.guard, done)


def test_a_line_that_stands_keeps_the_guard_s_words_from_piling_up_and_no_other_link_s(mixed: Bench) -> None:
    mixed.states(speed("base", 900), writing(od.TARGET_VELOCITY, 300), writing(od.CONTROLWORD, ENABLE))
    stops = (writing(od.TARGET_VELOCITY, 0), writing(od.CONTROLWORD, ENABLE))
    assert mixed.states(now=3 * CYCLE) == (speed("base", 0), *stops)
    assert mixed.states(now=4 * CYCLE) == (speed("base", 0),)
    mixed.guard.receive(Packet("tail", LINE_LOST, b""), 4 * CYCLE)
    assert mixed.states(now=5 * CYCLE) == (speed("base", 0), *stops)


def test_no_link_s_packets_are_taken_for_another_s(mixed: Bench) -> None:
    requested = command(ReadObject(0x6041, 0, 1), "tail")
    mixed.states(requested)
    assert received(mixed.guard, Packet("base", 0x10, bytes(8)))
    assert received(mixed.guard, Packet("tail", 0x10, bytes(4) + b"\x37\x01\x00\x00"))
    assert not received(mixed.guard, Packet("tail", 0x10, bytes(8)))


def received(guard: Guarded, packet: Packet) -> bool:
    node: Any = guard.node
    node.received.clear()
    reaction = guard.receive(packet, 1)
    assert reaction.wake_at <= NEVER
    return [packet for packet, _ in node.received] == [packet]


def test_where_several_are_silent_the_shortest_patience_is_reported() -> None:
    bench = Bench(made(every={"tail": 4}))
    bench.states(speed("base", 100), speed("tail", 100), arm(5))
    bench.guard.wake(12 * CYCLE)
    assert bench.refusals[-1].reason == "no set-point for 150 ms: front, rear, arm"


def test_a_target_on_the_line_counts_once_it_is_in_force(mixed: Bench) -> None:
    mixed.states(writing(od.TARGET_VELOCITY, 100), writing(od.CONTROLWORD, ENABLE), speed("base", 100))
    mixed.states(writing(od.TARGET_VELOCITY, 500), now=1)
    assert mixed.states(speed("base", 700), now=1) == (speed("base", 700),)
    mixed.states(writing(od.TARGET_VELOCITY, 500), now=2)
    assert mixed.refuses(speed("base", 701), 2)[0] == "both of 1201.0000 is beyond 1200.0000"


def test_a_sum_that_the_line_s_axis_passes_is_stopped_after_a_cycle(mixed: Bench) -> None:
    mixed.states(speed("base", 900), writing(od.TARGET_VELOCITY, 300), writing(od.CONTROLWORD, ENABLE))
    beyond = writing(od.TARGET_VELOCITY, 301)
    assert mixed.states(beyond, now=1) == (beyond,)
    stops = (speed("base", 0), writing(od.TARGET_VELOCITY, 0), writing(od.CONTROLWORD, ENABLE))
    assert mixed.guard.wake(CYCLE).sent == ()
    assert mixed.guard.wake(CYCLE + 1).sent == stops
