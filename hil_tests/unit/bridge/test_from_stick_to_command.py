"""From a stick to the robot's command: how far a reader has to follow it."""

import sys
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

import pytest

import firmware_bridge
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet

if TYPE_CHECKING:
    from hil_tests.unit.bridge.bench import Bench

HERE = Path(firmware_bridge.__file__).parent
MOST_CALLS, MOST_FILES = 25, 6
pytestmark = pytest.mark.interpreted


def test_a_stick_becomes_a_command_in_few_calls(armed: "Bench") -> None:
    """Count the calls of the project's own functions from the datagram's arrival to the changed command."""
    armed.runs(0.2)
    driving = armed.bridge.operator.driving
    stick = dialect.MAVLink_manual_control_message(1, 500, 0, 0, 300, 0)
    packet, before, calls = Packet(OPERATOR, 0, armed.station.codec.encode(stick)), driving.intent, []

    def note(frame: FrameType, event: str, _arg: object) -> None:
        file = Path(frame.f_code.co_filename)
        if event == "call" and driving.intent is before and file.is_relative_to(HERE):
            calls.append((str(file.relative_to(HERE)), frame.f_code.co_qualname))

    sys.setprofile(note)
    try:
        armed.bridge.receive(packet, armed.now)
    finally:
        sys.setprofile(None)
    assert driving.intent.command.speed_mps == pytest.approx(0.25)
    assert len(calls) <= MOST_CALLS, calls
    assert len({file for file, _ in calls}) <= MOST_FILES, calls
