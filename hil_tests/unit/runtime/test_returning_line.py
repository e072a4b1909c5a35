"""A serial port that is unplugged and comes back: a pseudo-terminal that is closed and made again."""

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import PortError, PseudoTerminal, ReturningLine
from firmware_bridge.runtime.ports.returning_line import TRY_EVERY
from firmware_bridge.units import NEVER, SECOND

BAUD = 115_200


@pytest.fixture
def device(tmp_path: Path) -> Callable[[], PseudoTerminal]:
    """Plug the adapter in."""
    return lambda: PseudoTerminal(tmp_path / "adapter")


def news(line: ReturningLine) -> list[tuple[int, bytes]]:
    """Return the next input, within a second."""
    clock = Clock()
    assert clock.wait([line.fileno()], SECOND), "nothing came"
    return line.read(clock.now())


def test_it_must_be_there_at_the_start(tmp_path: Path) -> None:
    with pytest.raises(PortError, match="there is no such device"):
        ReturningLine(str(tmp_path / "adapter"), BAUD)


def test_bytes_pass_both_ways(device: Callable[[], PseudoTerminal], tmp_path: Path) -> None:
    with closing(device()) as other, closing(ReturningLine(str(tmp_path / "adapter"), BAUD)) as line:
        other.write(0, b"\x00\xff\r\n", 0)
        assert news(line) == [(0, b"\x00\xff\r\n")]
        line.write(0, b"\x90\x02", 0)
        assert line.retry_at == NEVER
        clock = Clock()
        assert clock.wait([other.fileno()], SECOND)
        assert other.read(0) == [(0, b"\x90\x02")]


def test_it_is_lost_and_comes_back_behind_the_same_file(
    device: Callable[[], PseudoTerminal], tmp_path: Path
) -> None:
    other = device()
    with closing(ReturningLine(str(tmp_path / "adapter"), BAUD)) as line:
        fileno = line.fileno()
        for _ in range(3):
            other.close()
            assert news(line) == [(LINE_LOST, b"")]
            assert 0 < line.retry_at < NEVER
            line.write(0, b"into the void", SECOND)
            line.flush(SECOND)
            assert line.retry_at == SECOND + TRY_EVERY
            assert not Clock().wait([line.fileno()], 0)
            other = device()
            line.flush(SECOND + TRY_EVERY)
            assert news(line) == [(LINE_BACK, b"")]
            other.write(0, b"hello", 0)
            assert news(line) == [(0, b"hello")]
            assert line.fileno() == fileno
            assert line.retry_at == NEVER
    other.close()


def test_a_loss_that_is_noticed_while_writing_is_reported_as_soon(
    device: Callable[[], PseudoTerminal], tmp_path: Path
) -> None:
    other = device()
    with closing(ReturningLine(str(tmp_path / "adapter"), BAUD)) as line:
        other.close()
        line.write(0, b"anybody there?", 0)
        assert news(line) == [(LINE_LOST, b"")]


def test_it_is_closed_in_any_state_and_twice(device: Callable[[], PseudoTerminal], tmp_path: Path) -> None:
    other = device()
    line = ReturningLine(str(tmp_path / "adapter"), BAUD)
    other.close()
    news(line)
    line.close()
    line.close()
