"""The guard on a capture link: only a listener's words leave, only to the system that the file names."""

import pytest

from emulators.bench.faults import read
from firmware_bridge.families.motion_capture.driver.natnet import CONNECT
from firmware_bridge.families.motion_capture.guard import CaptureRules
from firmware_bridge.families.motion_capture.wire.messages import MessageId, packet, text_payload
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find
from firmware_bridge.safety.guard import Refusal, guarded
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.capture_driver.captured_diff_drive import CAMERAS, captured_diff_drive

SERVER = number_of("192.168.1.10", 1510)
OTHER = number_of("192.168.1.11", 1510)
LISTENS = ["CONNECT", "KEEPALIVE", "REQUEST_MODELDEF", "ECHOREQUEST"]


class States:
    """A bridge that sends what it was given, once."""

    def __init__(self, *packets: Packet) -> None:
        self.packets = packets
        self.received: list[Packet] = []

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        del now
        self.received.append(packet)
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        del now
        return Reaction(self.packets, NEVER)


def left(*packets: Packet) -> tuple[Packet, ...]:
    return guarded(States(*packets), captured_diff_drive()).wake(0).sent


@pytest.mark.parametrize("message", MessageId, ids=lambda it: it.name)
def test_a_listener_s_words_leave_and_no_others(message: MessageId) -> None:
    stated = Packet(CAMERAS, SERVER, packet(message))
    assert left(stated) == ((stated,) if message.name in LISTENS else ())


@pytest.mark.parametrize(
    "stated",
    [
        Packet(CAMERAS, OTHER, CONNECT),
        Packet(CAMERAS, number_of("192.168.1.10", 1511), CONNECT),
        Packet(CAMERAS, 0, CONNECT),
        Packet(CAMERAS, SERVER, b""),
        Packet(CAMERAS, SERVER, b"\x0a\0\0"),
        Packet(CAMERAS, SERVER, packet(MessageId.REQUEST, text_payload("StopRecording"))),
    ],
)
def test_nothing_else_leaves_and_nothing_else_stops_for_it(stated: Packet) -> None:
    beside = Packet(OPERATOR, 0, b"telemetry")
    refusals: list[Refusal] = []
    node = guarded(States(stated, beside), captured_diff_drive(), refusals.append)
    assert node.wake(0).sent == (beside,)
    assert [(one.packet, one.sent) for one in refusals] == [(stated, ())]


def test_what_comes_in_is_the_bridge_s() -> None:
    bridge = States()
    received = Packet(CAMERAS, SERVER, b"whatever")
    guarded(bridge, captured_diff_drive()).receive(received, 0)
    assert bridge.received == [received]


def test_a_fault_of_cameras_wants_cameras() -> None:
    for kind in ("body_hidden", "markers_swapped"):
        fault = read({"kind": kind, "at_s": 1.0, "until_s": 2.0})
        assert list(fault.problems(captured_diff_drive())) == []
        assert list(fault.problems(find("rars"))) == [("kind", "rars has no link to a capture system")]


def test_what_follows_a_listener_s_number_does_not_matter_and_the_number_is_of_two_bytes() -> None:
    rules = CaptureRules(captured_diff_drive(), CAMERAS)
    assert not rules.waiting
    keep = int(MessageId.KEEPALIVE)
    more = Packet(CAMERAS, SERVER, keep.to_bytes(2, "little") + (3).to_bytes(2, "little") + b"abc")
    assert rules.refuses(more, 0) is None
    other = Packet(CAMERAS, SERVER, (keep + 256).to_bytes(2, "little") + bytes(2))
    assert rules.refuses(other, 0) is not None
