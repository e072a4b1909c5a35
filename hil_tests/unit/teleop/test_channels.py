"""RC_CHANNELS_OVERRIDE: a stick for stations that have no MANUAL_CONTROL, under the same rules."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.teleop.setpoints import channels_of, stick_of_channels
from firmware_bridge.teleop.station import USUAL_CHANNELS, Channel, Stick, StickAxis, Unusable
from firmware_bridge.units import MILLISECOND, SECOND
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.teleop.received import texts
from hil_tests.unit.teleop.stations import ARM, Hand

if TYPE_CHECKING:
    from hil_tests.unit.teleop.bench import RarsBench

KEPT, RELEASED, RELEASED_ABOVE = 0xFFFF, 0, 0xFFFE
HERE, THERE = number_of("10.0.0.1", 14550), number_of("10.0.0.2", 14550)


def override(**values: int) -> Any:
    """Return a message with these channels, as ch3=1600; all others are left unset."""
    raw = [values.get(f"ch{number}", KEPT) for number in range(1, 19)]
    return dialect.MAVLink_rc_channels_override_message(1, 1, *raw)


@pytest.mark.parametrize(
    ("values", "speed", "steer"),
    [
        ({"ch3": 1500, "ch1": 1500}, 0.0, 0.0),
        ({"ch3": 2000}, 0.5, None),
        ({"ch3": 1000}, -0.5, None),
        ({"ch3": 1750, "ch1": 2000}, 0.25, -60.0),
        ({"ch3": 1550, "ch1": 1000}, 0.05, 60.0),
        ({"ch3": 2100}, 0.5, None),
        ({"ch3": 900}, -0.5, None),
    ],
)
def test_channels_are_a_stick(
    bench: RarsBench, values: dict[str, int], speed: float, steer: float | None
) -> None:
    assert bench.say(override(**values)) == []
    assert bench.command.speed_mps == pytest.approx(speed)
    angle = bench.command.steer_rad
    assert angle is None if steer is None else angle == pytest.approx(math.radians(steer))
    assert bench.operator.intent.neutral is (speed == 0.0)


@pytest.mark.parametrize("value", [1, 899, 2101, 0x7FFF, 0xFFFE])
def test_what_no_stick_sends_moves_nothing_and_is_no_sign_of_life(bench: RarsBench, value: int) -> None:
    before = bench.operator.intent
    reported = texts(bench.say(override(ch3=value)))
    assert f"channel 3 = {value} us" in "".join(reported)
    assert bench.operator.intent is before
    assert bench.operator.dropped.refused == 1


@pytest.mark.parametrize(("value", "neutral"), [(1525, True), (1526, False), (1475, True), (1474, False)])
def test_a_hand_that_rests_on_it_holds_it_at_zero(bench: RarsBench, value: int, *, neutral: bool) -> None:
    bench.say(override(ch3=value))
    assert bench.operator.intent.neutral is neutral


def test_a_channel_that_is_given_back_is_let_go_at_once(bench: RarsBench) -> None:
    bench.say(override(ch3=1800, ch1=1300))
    bench.now += 20 * MILLISECOND
    bench.say(override(ch3=RELEASED))
    assert bench.command.speed_mps == 0.0
    assert not bench.operator.intent.neutral, "the other one is held"
    bench.say(override(ch1=RELEASED, ch3=RELEASED))
    assert bench.operator.intent.neutral


def test_a_channel_that_is_left_as_it_is_stays(bench: RarsBench) -> None:
    bench.say(override(ch3=1800))
    bench.now += 20 * MILLISECOND
    bench.say(override(ch1=1000))
    assert bench.command.speed_mps == pytest.approx(0.3)
    assert bench.command.steer_rad == pytest.approx(1.0472, abs=1e-4)


@pytest.mark.parametrize(("silence", "held"), [(499, True), (500, False)])
def test_a_channel_of_which_no_one_speaks_is_given_back_as_after_a_silence(
    bench: RarsBench, silence: int, *, held: bool
) -> None:
    bench.say(override(ch3=1800))
    bench.now += silence * MILLISECOND
    bench.say(override(ch1=1500))
    assert (bench.command.speed_mps > 0.0) is held


@pytest.mark.parametrize("values", [{}, {"ch2": 1900, "ch5": 1900, "ch18": 1900}])
def test_what_sends_nothing_of_driving_is_no_sign_of_life(bench: RarsBench, values: dict[str, int]) -> None:
    bench.say(override(ch3=1800))
    received_at = bench.operator.intent.received_at
    bench.now += 100 * MILLISECOND
    bench.say(override(**values))
    assert bench.operator.intent.received_at == received_at


def test_an_overtaken_one_is_forgotten(bench: RarsBench) -> None:
    early = bench.station.encode(override(ch3=2000))
    bench.say(override(ch3=1500))
    bench.now += 20 * MILLISECOND
    bench.send(early)
    assert (bench.command.speed_mps, bench.operator.dropped.overtaken) == (0.0, 1)


def test_who_does_not_drive_moves_nothing_with_it(bench: RarsBench) -> None:
    driver, other = Hand(bench, HERE), Hand(bench, THERE)
    driver.say(override(ch3=1500))
    assert driver.result(ARM, 1) == 0
    before = bench.operator.intent
    bench.now += 100 * MILLISECOND
    assert "RC_CHANNELS_OVERRIDE of " in "".join(texts(other.say(override(ch3=2000))))
    assert bench.operator.intent is before
    driver.say(override(ch3=2000))
    assert bench.command.speed_mps == 0.5


def test_each_station_holds_its_own_channels(bench: RarsBench) -> None:
    first, second = Hand(bench, HERE), Hand(bench, THERE)
    first.say(override(ch3=2000))
    second.say(override(ch1=1500))
    assert bench.command.speed_mps == 0.0


@given(st.integers(0, 0xFFFF))
def test_from_the_ninth_channel_on_nought_sends_nothing_and_65534_gives_it_back(value: int) -> None:
    row = Channel(9, StickAxis.FORWARD, 1)
    found = channels_of(override(ch9=value), (row,))
    if value in (KEPT, RELEASED):
        assert found == {}
    elif value == RELEASED_ABOVE:
        assert found == {9: None}
    else:
        assert found == {9: value} if 900 <= value <= 2100 else isinstance(found, Unusable)


@given(st.dictionaries(st.sampled_from([1, 3, 4]), st.integers(900, 2100)))
def test_whatever_the_channels_are_the_stick_is_within_its_stops(channels: dict[int, int]) -> None:
    stick, _ = stick_of_channels(channels, USUAL_CHANNELS, 0.05)
    for share in (stick.forward, stick.left, stick.turn):
        assert share is None or -1.0 <= share <= 1.0
    assert stick.up is None
    assert (stick == Stick(None, None, None, None)) is (not channels)


@pytest.mark.parametrize(
    "channels",
    [
        (Channel(0, StickAxis.FORWARD, 1),),
        (Channel(19, StickAxis.FORWARD, 1),),
        (Channel(3, StickAxis.FORWARD, 2),),
        (Channel(3, StickAxis.FORWARD, 1), Channel(3, StickAxis.TURN, 1)),
    ],
)
def test_channels_that_there_are_not_are_refused_where_they_are_made(
    bench: RarsBench, channels: tuple[Channel, ...]
) -> None:
    with pytest.raises(ValueError, match="channels"):
        replace(bench.rows, channels=channels)


def test_after_ten_seconds_of_silence_an_old_channel_arms_nothing(bench: RarsBench) -> None:
    bench.say(override(ch3=2000))
    bench.now += 10 * SECOND
    bench.order(ARM, 1)
    assert bench.operator.intent.neutral
