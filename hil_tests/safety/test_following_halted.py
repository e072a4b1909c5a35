"""A wheel that turned as commanded, and then shows not one bit of its way: its encoder is off."""

import pytest

from firmware_bridge.drivers.driver import Position, SetPoint, Speed, Stop
from firmware_bridge.safety.tracking import bounds_of
from hil_tests.safety.following_bench import RARS, STEERING, Axle, settled, still


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("part", [1.0, 0.01])
def test_a_wheel_that_turned_and_shows_not_one_bit_of_its_way_has_halted(sign: float, part: float) -> None:
    """Cut off between two samples, the last one that moved shows a part of its way."""
    one = settled(Speed(sign * 3.0), sign * 3.0)
    assert not one.does(sign * 3.0 * part).halted
    assert one.does(0.0).halted
    assert one.does(0.0, 3).halted, "until it moves"
    assert not one.does(sign * 1e-9).halted
    assert not one.does(0.0).halted, "it has not turned since"


@pytest.mark.parametrize(
    ("reported", "turned"),
    [
        pytest.param(Speed(3.0), (1.499999,), id="it turned too slowly"),
        pytest.param(Speed(3.0), (-3.0,), id="it turned the other way"),
        pytest.param(Speed(3.0), (3.0, 0.1, 0.1), id="it slowed down before"),
        pytest.param(Speed(0.9), (0.9,), id="its backlog is no more than it may creep"),
        pytest.param(Speed(0.0), (0.5,), id="it need not move"),
        pytest.param(Stop.STANDSTILL, (3.0,), id="it is commanded to stop"),
    ],
)
def test_a_wheel_that_stands_for_another_reason_has_not_halted(
    reported: SetPoint, turned: tuple[float, ...]
) -> None:
    one = settled(reported, turned[0])
    for speed in turned:
        one.does(speed)
    assert not one.does(0.0).halted


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_half_the_least_speed_that_it_may_have_is_turning(sign: float) -> None:
    one = settled(Speed(sign * 3.0), sign * 3.0)
    known = one.follower.following
    one.does(0.5 * (known.low if sign > 0.0 else known.high), 4)
    assert one.does(0.0).halted
    one = settled(Speed(sign * 2.0), sign * 2.0)
    one.commanded(Speed(sign * 4.0))
    one.does(sign * 1.3, 2)
    assert one.does(0.0).halted, "the least is still less than 2.6 rad/s"


def test_what_it_may_creep_it_may_owe_to_the_last_bit() -> None:
    one = settled(Speed(0.125), 0.125)
    least = one.follower.following.low
    for creeps, halted in ((least, False), (least * (1.0 - 1e-12), True)):
        one = still(Speed(0.125), standstill_below=creeps, within_ms=50)
        moved = one.does(0.125, 200).sampled_at
        known = one.does(0.0)
        assert (known.halted, known.settled_at) == (halted, moved if halted else one.now)


def test_a_wheel_that_has_not_begun_to_turn_has_not_halted() -> None:
    one = still(Speed(14.0), standstill_below=0.1, within_ms=10)
    assert not any(one.does(0.0).halted for _ in range(8))


@pytest.mark.parametrize("speed", [0.5, 2.9])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_while_it_need_not_move_it_does_not_turn(sign: float, speed: float) -> None:
    """Blocked, it has a backlog; then it is commanded to stand, and shows a speed without a way."""
    one = still(Speed(sign * 3.0))
    one.does(0.0, 8)
    one.commanded(Speed(0.0))
    assert not any(one.known_later(sign * speed).halted for _ in range(3))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_on_its_way_to_a_position_has_not_turned(sign: float) -> None:
    """A halt is judged of speeds only: on its way to a position an axis may wait."""
    one = Axle(STEERING)
    one.position = sign * 0.2
    one.commanded(Position(sign * 0.2))
    one.does(0.0, 3)
    one.commanded(Position(sign * 4.0))
    one.does(sign * 0.25, 8)
    known = [one.does(0.0) for _ in range(4)]
    assert known[1].backlog > bounds_of(RARS, STEERING).creep
    assert not any(sample.halted for sample in known)


def test_however_slowly_it_turns_it_turns() -> None:
    one = still(Speed(1e-3), standstill_below=1e-4, within_ms=10)
    one.does(1e-3, 400)
    assert one.does(0.0).halted
