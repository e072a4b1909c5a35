"""The keys of a terminal: a pseudo-terminal in its place."""

import os
import termios

import pytest

from firmware_bridge.runtime.ports import PortError
from firmware_bridge.runtime.ports.keyboard import KeyboardPort

ECHO_OR_LINES = termios.ECHO | termios.ICANON


def test_keys_come_at_once_are_not_shown_and_the_terminal_is_given_back() -> None:
    person, terminal = os.openpty()
    before = termios.tcgetattr(terminal)
    port = KeyboardPort(terminal)
    assert port.read(0) == []
    os.write(person, b"w")
    assert port.read(0) == [(0, b"w")]
    assert not termios.tcgetattr(terminal)[3] & ECHO_OR_LINES
    assert termios.tcgetattr(terminal)[3] & termios.ISIG, "Ctrl-C must stay what it is"
    assert os.get_blocking(terminal), "others have it open"
    port.close()
    port.close()
    assert termios.tcgetattr(terminal) == before
    os.close(person)
    os.close(terminal)


def test_a_pipe_is_no_keyboard() -> None:
    reader, writer = os.pipe()
    with pytest.raises(PortError, match="no terminal"):
        KeyboardPort(reader)
    os.close(reader)
    os.close(writer)
