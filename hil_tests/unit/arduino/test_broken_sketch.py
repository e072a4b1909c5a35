"""Sketches that would let time stand still: an error with the sketch's name, and no hanging program."""

import pytest

from emulators.arduino_omni.mega.jobs import Call, Delay
from emulators.arduino_omni.mega.mega import BOOT, Mega, SketchError
from emulators.arduino_omni.usb_board import UsbBoard
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds

pytestmark = pytest.mark.timeout(20)


class Stubborn:
    """A broken sketch: it is always due, and its loop takes no time."""

    def __init__(self, mega: Mega, behind: Nanoseconds) -> None:
        self._mega = mega
        self._behind = behind

    def setup(self) -> None:
        pass

    def loop(self, now: Nanoseconds) -> None:
        pass

    def due(self, now: Nanoseconds) -> Nanoseconds:
        return now - self._behind


class Chain(Stubborn):
    """Another: a job that gives a job."""

    def setup(self) -> None:
        self._again(0)

    def _again(self, _now: Nanoseconds) -> None:
        self._mega.do(Call(self._again))


class Busy(Stubborn):
    """No broken one: it never rests, but what it does takes time."""

    def loop(self, now: Nanoseconds) -> None:
        del now
        self._mega.do(Delay(MICROSECOND))


@pytest.mark.parametrize("behind", [0, 1, SECOND])
@pytest.mark.parametrize("broken", [Stubborn, Chain])
def test_a_sketch_that_never_gets_on_is_an_error_with_its_name(broken: type[Stubborn], behind: int) -> None:
    board = UsbBoard(Mega(lambda mega: broken(mega, behind), 57_600))
    board.wake(0)
    with pytest.raises(SketchError, match=f"{broken.__name__} .* at 1.1000"):
        board.wake(2 * SECOND)


def test_a_sketch_that_never_rests_is_none() -> None:
    mega = Mega(lambda mega: Busy(mega, 0), 57_600)
    mega.reset(0)
    mega.advance(BOOT + 200 * MILLISECOND)
    assert mega.due > BOOT + 200 * MILLISECOND
