"""A line whose protocol was left open: the drive speaks as its host does."""

import pytest

from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.epos2.serial.serial_drive import SerialEpos2
from emulators.servo.axis import ServoAxis
from firmware_bridge.families.epos2.maxon.frame import Generation, encode_v1, encode_v2
from firmware_bridge.families.epos2.maxon.messages import ReadObject
from firmware_bridge.families.epos2.maxon.opcodes import encode_request
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.unit.epos2.quiet_motion import QuietMotion

REQUESTED = encode_request(ReadObject(0x1000, 0, 0))
V1, V2 = encode_v1(REQUESTED), encode_v2(REQUESTED)
DEVICE_TYPE = bytes.fromhex("92010200")
QUIET = 500 * MILLISECOND


@pytest.fixture
def drive() -> SerialEpos2:
    made = SerialEpos2(1, ServoAxis("one", 2000), EPOS2_70_10, QuietMotion, generation=None)
    made.wake(0)
    made.wake(SECOND)
    return made


def receives(drive: SerialEpos2, raw: bytes, now: Nanoseconds) -> bytes:
    drive.wake(now)
    return b"".join(it.payload for it in drive.receive(Packet(SERIAL, 0, raw), now).sent)


def answer(drive: SerialEpos2, generation: Generation, now: Nanoseconds) -> bytes:
    """Request the device type in one protocol, and return the last output."""
    if generation is Generation.V2:
        return receives(drive, V2, now)
    assert receives(drive, V1[:1], now) == b"O"
    assert receives(drive, V1[1:], now) == b"O\0"
    sent = receives(drive, b"O", now)
    receives(drive, b"O", now)
    return sent


def test_each_host_is_answered_in_its_own(drive: SerialEpos2) -> None:
    at = 2 * SECOND
    for generation in (Generation.V1, Generation.V2, Generation.V2, Generation.V1, Generation.V2):
        assert DEVICE_TYPE in answer(drive, generation, at), generation
        at += QUIET


def test_byte_by_byte_too(drive: SerialEpos2) -> None:
    sent = b"".join(receives(drive, bytes((byte,)), 2 * SECOND) for byte in V2)
    assert DEVICE_TYPE in sent


def test_what_follows_a_frame_of_usb_at_once_is_noise_and_no_opcode_of_rs232(drive: SerialEpos2) -> None:
    receives(drive, V2, 2 * SECOND)
    assert receives(drive, V1[:1], 2 * SECOND + QUIET - 1) == b""
    assert DEVICE_TYPE in receives(drive, V2, 2 * SECOND + QUIET)


def test_a_command_that_has_begun_is_not_left_for_the_other_protocol(drive: SerialEpos2) -> None:
    receives(drive, V1[:1], 2 * SECOND)
    receives(drive, V2, 2 * SECOND)
    assert drive.wake(2 * SECOND + QUIET).sent == ()
    assert DEVICE_TYPE in receives(drive, V2, 3 * SECOND)


def test_where_it_was_stated_the_other_one_is_refused() -> None:
    drive = SerialEpos2(1, ServoAxis("one", 2000), EPOS2_70_10, QuietMotion, generation=Generation.V1)
    drive.wake(0)
    drive.wake(SECOND)
    assert receives(drive, V2[:1], 2 * SECOND) == b"F"
