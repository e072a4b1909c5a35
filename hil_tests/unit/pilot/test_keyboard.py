"""From a terminal's bytes to the operator's commands: keys down, keys let go, and nothing assumed."""

from itertools import pairwise

import pytest

from firmware_bridge.pilot.driver import NO_EXTRAS, ButtonRequest, Extras, Stick
from firmware_bridge.pilot.keyboard import BEGINS, REPEATS, Keyboard
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.units import MILLISECOND, Nanoseconds

LINK = PilotLink()


def reported(hand: Keyboard, chunk: bytes, at: Nanoseconds = 0) -> list[ButtonRequest]:
    return list(hand.handle(chunk, at))


def command(hand: Keyboard, at: Nanoseconds) -> Stick:
    return hand.command(LINK, at, armed=True)


def rested(share: float, extras: Extras = NO_EXTRAS) -> Keyboard:
    """A keyboard that was seen at rest since the robot was armed."""
    hand = Keyboard(share, extras)
    command(hand, 0)
    return hand


@pytest.mark.parametrize(
    ("keys", "stick"),
    [
        (b"w", Stick(0.5)),
        (b"\x1b[A", Stick(0.5)),
        (b"W", Stick(0.5)),
        (b"s", Stick(-0.5)),
        (b"\x1b[B", Stick(-0.5)),
        (b"a", Stick(left=0.1)),
        (b"\x1b[D\x1b[D", Stick(left=0.2)),
        (b"d\x1b[C", Stick(left=-0.2)),
        (b"a" * 30, Stick(left=1.0)),
        (b"aaax", Stick()),
        (b"w ", Stick()),
        (b"wr", Stick(up=1.0, buttons=8)),  # drives or lifts, never both by one key
        (b"f", Stick(up=-1.0, buttons=8)),
        (b"2", Stick(buttons=2)),
        (b"3", Stick()),  # there is none
        (b"0q\t\x1b[Z", Stick()),
        (b"w\r", Stick()),
    ],
)
def test_keys_are_the_stick(keys: bytes, stick: Stick) -> None:
    for cut in range(len(keys)):
        hand = rested(0.5, Extras(switches=(0, 1), up_button=3))
        reported(hand, keys[:cut])
        reported(hand, keys[cut:])
        assert command(hand, 1) == stick, cut


def test_a_key_that_is_kept_down_drives_from_its_press_on_without_a_gap() -> None:
    hand = rested(1.0)
    pressed = [0, *range(660 * MILLISECOND, 2000 * MILLISECOND, 40 * MILLISECOND)]
    for before, after in pairwise(pressed):
        reported(hand, b"w", before)
        assert command(hand, after - 1).forward == 1.0


def test_a_key_that_is_let_go_lets_the_robot_go() -> None:
    hand = rested(1.0)
    reported(hand, b"w", 0)
    assert (command(hand, BEGINS - 1).forward, command(hand, BEGINS).forward) == (1.0, 0.0)
    reported(hand, b"w", 0)
    reported(hand, b"w", 100 * MILLISECOND)
    end = 100 * MILLISECOND + REPEATS
    assert (command(hand, end - 1).forward, command(hand, end).forward) == (1.0, 0.0)


def test_a_turn_of_the_helm_keeps_a_robot_driving_and_starts_none() -> None:
    hand = rested(1.0)
    reported(hand, b"w", 0)
    reported(hand, b"a", BEGINS - 1)
    assert command(hand, 2 * BEGINS - 2) == Stick(1.0, 0.1)
    assert command(hand, 2 * BEGINS) == Stick(0.0, 0.1)
    reported(hand, b"a", 2 * BEGINS)
    assert command(hand, 2 * BEGINS).forward == 0.0


def test_a_switch_is_pressed_for_one_word() -> None:
    hand = rested(1.0, Extras(switches=(5,)))
    reported(hand, b"1")
    assert [command(hand, at).buttons for at in (1, 2)] == [1 << 5, 0]


def test_before_the_robot_is_armed_the_true_keys_are_stated() -> None:
    """So the bridge sees what is down, and refuses to arm."""
    hand = Keyboard(1.0, Extras(up_button=3))
    reported(hand, b"w")
    assert hand.command(LINK, 1, armed=False) == Stick(1.0)
    reported(hand, b"ra")
    assert hand.command(LINK, 1, armed=False) == Stick(0.0, 0.1, 1.0, 1 << 3)


def test_a_key_that_is_down_when_it_is_armed_counts_when_it_was_let_go() -> None:
    hand = Keyboard(1.0)
    reported(hand, b"a")
    for at in range(0, 10 * REPEATS, REPEATS // 2):
        reported(hand, b"w", at)
        assert command(hand, at) == Stick()
    assert command(hand, 20 * REPEATS) == Stick()
    reported(hand, b"w", 20 * REPEATS)
    assert command(hand, 20 * REPEATS) == Stick(1.0), "the helm has not been brought back"
    reported(hand, b"x", 20 * REPEATS)
    command(hand, 20 * REPEATS)
    reported(hand, b"a", 20 * REPEATS)
    assert command(hand, 20 * REPEATS) == Stick(1.0, 0.1)


@pytest.mark.parametrize(
    ("key", "requested"),
    [(b"p", ButtonRequest.ARM), (b"\r", ButtonRequest.STOP), (b"\n", ButtonRequest.STOP)],
)
def test_keys_arm_and_stop(key: bytes, requested: ButtonRequest) -> None:
    assert reported(Keyboard(1.0), b"w" + key) == [requested]


def test_the_emergency_stop_is_no_order_to_arm() -> None:
    """A key at rest after it has not been at rest since another station armed."""
    hand = Keyboard(1.0)
    reported(hand, b"\r")
    hand.command(LINK, 0, armed=False)
    reported(hand, b"w")
    assert command(hand, 1) == Stick()
