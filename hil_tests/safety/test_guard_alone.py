"""Refusals of the guard by itself, with no bridge before it, over CAN and serial: the worst for RARS."""

from typing import Final

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND
from hil_tests.safety.guard_bench import Bench, position, sample, status, wheel, write
from hil_tests.safety.guard_robots import RARS
from hil_tests.safety.serial_bench import SerialBench, done, number, reading, speed, target, value, word

CYCLE: Final = 50 * MILLISECOND
ENABLE, HALT, GO, OFF, QUICK_STOP = 0x000F, 0x010F, 0x003F, 0x0000, 0x000B
POWERED: Final = (0x0737, 0x0717, 0x071F)
"""Operation enabled, quick stop active, fault reaction active."""
TOP: Final = 3972


def serial_desk() -> SerialBench:
    """All four enabled at rest, as the drives have confirmed."""
    desk = SerialBench()
    for node in (1, 2, 3, 4):
        stated = word(node, ENABLE)
        assert desk.states(stated) == (stated,)
        desk.receives(done(stated))
    return desk


def in_force(sent: tuple[Packet, ...], before: dict[int, int]) -> dict[int, int]:
    """The wheels' speeds after these frames, in rpm."""
    rpm = dict(before)
    for packet in sent:
        if packet.address in (0x501, 0x502):
            rpm[packet.address - 0x500] = int.from_bytes(packet.payload[2:6], "little", signed=True)
    return rpm


@pytest.mark.parametrize("rpm", [4000, -4000, TOP, -TOP, 2600])
def test_over_can_both_wheels_never_go_faster_than_the_base_may(rpm: int) -> None:
    bench = Bench(RARS)
    in_use = in_force(bench.states(wheel(1, ENABLE, 0), wheel(2, ENABLE, 0)), {})
    for cycle in range(1, 6):
        sent = bench.states(wheel(1, ENABLE, rpm), wheel(2, ENABLE, rpm), now=cycle * CYCLE)
        in_use = in_force(sent, in_use)
        assert abs(in_use[1] + in_use[2]) * 0.025 * 2 * 3.14159265 / 60 / 26 < 0.502
    assert bench.guard.refused


@pytest.mark.parametrize("rpm", [4000, -4000, TOP, 2600])
def test_over_a_serial_line_neither(rpm: int) -> None:
    desk = serial_desk()
    rates = {1: 0, 2: 0}
    for cycle in range(1, 6):
        for node in (1, 2):
            for packet in desk.states(speed(rpm, node), now=cycle * CYCLE):
                for each in (1, 2):
                    for value_ in (0, rpm):
                        rates[each] = value_ if packet == speed(value_, each) else rates[each]
                desk.receives(done(packet), cycle * CYCLE)
    assert abs(rates[1] + rates[2]) * 0.025 * 2 * 3.14159265 / 60 / 26 < 0.502
    assert desk.refusals


def test_over_can_wheels_and_lift_never_move_together_whichever_is_first() -> None:
    bench = Bench(RARS)
    bench.states(*(wheel(node, ENABLE, 0) for node in (1, 2)), position(4, ENABLE, 0))
    bench.states(wheel(1, ENABLE, 100), wheel(2, ENABLE, 100))
    assert bench.states(position(4, GO, 90_000), now=CYCLE) == (position(4, HALT, 0),)
    bench = Bench(RARS)
    bench.states(*(wheel(node, ENABLE, 0) for node in (1, 2)), position(4, GO, 90_000))
    assert bench.states(wheel(1, ENABLE, 100), now=CYCLE) == (wheel(1, ENABLE, 0),)
    assert bench.states(wheel(2, ENABLE, -100), now=CYCLE) == (wheel(2, ENABLE, 0),)


def test_over_a_serial_line_neither_do_they() -> None:
    desk = serial_desk()
    assert desk.states(speed(100, 1)) == (speed(100, 1),)
    assert desk.states(target(4, 90_000), word(4, GO)) == (target(4, 90_000), word(4, HALT))
    desk = serial_desk()
    assert desk.states(target(4, 90_000), word(4, GO)) == (target(4, 90_000), word(4, GO))
    assert desk.states(speed(100, 1))[0] == speed(0, 1)


def test_over_can_a_watch_ends_only_after_a_word_without_power() -> None:
    ends = write(1, 0x1016, 1, bytes(4))
    bench = Bench(RARS)
    assert bench.states(ends) != (ends,), "what is not known counts as power"
    for powered in POWERED:
        for report in (status(1, powered), sample(1, powered)):
            bench.receives(status(1, 0x0140), report)
            assert bench.states(ends) != (ends,), hex(powered)
    bench.receives(status(2, 0x0140))
    assert bench.states(ends) != (ends,), "another drive's word"
    bench.states(wheel(1, OFF, 0))
    assert bench.states(ends) != (ends,), "what was sent is no confirmation"
    bench.receives(status(1, 0x0140))
    assert bench.states(ends) == (ends,)
    bench.states(wheel(1, ENABLE, 0))
    assert bench.states(ends) != (ends,), "power was requested since"


def test_over_a_serial_line_it_is_the_same() -> None:
    ends = number(1, od.CONSUMER_HEARTBEAT_1, 0)
    requests = reading(1, od.STATUSWORD)

    def reports(desk: SerialBench, statusword: int) -> None:
        for packet in desk.states(requests):
            desk.receives(value(packet, statusword.to_bytes(2, "little")))

    def leaves(desk: SerialBench) -> bool:
        sent = desk.states(ends)
        for packet in sent:
            desk.receives(done(packet))
        return ends in sent

    desk = SerialBench()
    assert not leaves(desk), "what is not known counts as power"
    for powered in POWERED:
        reports(desk, 0x0140)
        reports(desk, powered)
        assert not leaves(desk), hex(powered)
    off = word(1, OFF)
    for packet in desk.states(off):
        desk.receives(done(packet))
    assert not leaves(desk), "what was sent is no confirmation"
    reports(desk, 0x0140)
    assert leaves(desk)
    on = word(1, ENABLE)
    for packet in desk.states(on):
        desk.receives(done(packet))
    assert not leaves(desk), "power was requested since"
