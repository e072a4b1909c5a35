"""Any sender: two stations, messages for others, echoes, frames of any kind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge.intent import NEVER_RECEIVED, Answer
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.robots.rars.motion import RarsMotion
from hil_tests.lanes import examples
from hil_tests.unit.teleop.bench import rars
from hil_tests.unit.teleop.received import types

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench


def test_the_newest_of_two_stations_counts(bench: RarsBench) -> None:
    other = Codec(254, 190)
    bench.stick(x=500)
    bench.send(other.encode(dialect.MAVLink_manual_control_message(1, 100, 0x7FFF, 0, 0, 0)))
    assert bench.command.speed_mps == pytest.approx(0.05)
    bench.stick(x=-500)
    assert bench.command.speed_mps == pytest.approx(-0.25)


@pytest.mark.parametrize("target", [0, 1])
def test_sticks_for_us(bench: RarsBench, target: int) -> None:
    bench.stick(x=100, target=target)
    assert bench.command.speed_mps > 0.0


def test_sticks_for_others(bench: RarsBench) -> None:
    bench.stick(x=100, target=2)
    assert (bench.command, bench.operator.intent.received_at) == (RarsMotion(), NEVER_RECEIVED)
    assert bench.operator.dropped.foreign == 1


def test_our_own_words_come_back_unheard(bench: RarsBench) -> None:
    echo = Codec(1, 1).encode(dialect.MAVLink_command_long_message(0, 0, 400, 0, 1, 0, 0, 0, 0, 0, 0))
    assert bench.send(echo) == []
    assert bench.requested == []
    assert bench.operator.dropped.echoed == 1


def test_several_messages_in_one_datagram_are_received_in_order(bench: RarsBench) -> None:
    encode = bench.station.encode
    first = encode(dialect.MAVLink_manual_control_message(1, 100, 0, 0, 0, 0))
    second = encode(dialect.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0))
    third = encode(dialect.MAVLink_manual_control_message(1, 200, 0, 0, 0, 0))
    assert types(bench.send(first + b"noise" + second + third)) == ["COMMAND_ACK"]
    assert bench.command.speed_mps == pytest.approx(0.1)
    assert bench.operator.counters.corrupt == 1


ADDRESSED = [number for number, kind in dialect.mavlink_map.items() if number < 20_000]


@given(
    st.lists(
        st.tuples(
            st.sampled_from(sorted(ADDRESSED)), st.binary(min_size=1, max_size=255), st.binary(max_size=5)
        ),
        max_size=5,
    )
)
@settings(max_examples=examples(300))
def test_whatever_foreign_nodes_send_is_answered_without_an_exception(
    frames: list[tuple[int, bytes, bytes]],
) -> None:
    operator = rars().operator
    datagram = b""
    for number, payload, junk in frames:
        body = bytes([len(payload), 0, 0, 0, 255, 190]) + number.to_bytes(3, "little") + payload
        crc = dialect.x25crc(body)
        crc.accumulate(bytes([dialect.mavlink_map[number].crc_extra]))
        datagram += b"\xfd" + body + crc.crc.to_bytes(2, "little") + junk
    station = Codec(255, 190)
    for reply in operator.receive(datagram, 5, lambda _: Answer(accepted=False, reason="no")):
        [_] = station.decode(reply.payload)


floats = st.floats(width=32)


@given(
    st.sampled_from([400, 185, 5300, 187, 181, 405, 512, 520, 511, 510, 176, 179, 246, 21]),
    st.tuples(*[floats] * 7),
)
@settings(max_examples=examples(300))
def test_every_command_has_exactly_one_answer(command: int, params: tuple[float, ...]) -> None:
    operator, station = rars().operator, Codec(255, 190)
    order = station.encode(dialect.MAVLink_command_long_message(1, 1, command, 0, *params))
    replies = operator.receive(order, 5, lambda _: Answer(accepted=True, reason=""))
    answers = [message for reply in replies for message in station.decode(reply.payload)]
    assert [one.command for one in answers if one.get_type() == "COMMAND_ACK"] == [command]
