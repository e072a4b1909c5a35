"""The SDO client against frames quoted from their sources, and against servers that misbehave."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.sdo_client import (
    ATTEMPTS,
    LARGEST_UPLOAD,
    TIMEOUT,
    SdoClient,
    SdoProtocolError,
    SdoRefusedError,
    SdoTimeoutError,
    Transfer,
)
from firmware_bridge.units import NEVER

# object, bytes written (None: read), request, answer, bytes read; with the source of the two frames.
GOLDEN = [
    # EPOS2 Application Notes Collection, p. 11-164: device type of node 2 through a gateway.
    (od.DEVICE_TYPE, None, "40 00 10 00 00 00 00 00", "43 00 10 00 92 01 02 00", "92 01 02 00"),
    # Recorded from a maxon drive (github.com/machinekit/machinekit, issue 589): statusword 0x0737.
    (od.STATUSWORD, None, "40 41 60 00 00 00 00 00", "4b 41 60 00 37 07 00 00", "37 07"),
    # Frames of a CiA 301 driver used with EPOS2 drives (Pejman712/CRF, docs/Lely): heartbeats.
    (od.CONSUMER_HEARTBEAT_1, "d0 07 01 00", "23 16 10 01 d0 07 01 00", "60 16 10 01 00 00 00 00", ""),
    (od.PRODUCER_HEARTBEAT, "e8 03", "2b 17 10 00 e8 03 00 00", "60 17 10 00 00 00 00 00", ""),
    # Request templates sent to an EPOS2 (SamsonChau, STM32): controlword, COB-ID and type of RPDO1.
    (od.CONTROLWORD, "06 00", "2b 40 60 00 06 00 00 00", "60 40 60 00 00 00 00 00", ""),
    (Address(0x1400, 1), "01 02 00 00", "23 00 14 01 01 02 00 00", "60 00 14 01 00 00 00 00", ""),
    (Address(0x1400, 2), "ff", "2f 00 14 02 ff 00 00 00", "60 00 14 02 00 00 00 00", ""),
]
NAME = Transfer(od.DEVICE_NAME)
STATUS = Transfer(od.STATUSWORD)
ANSWER = bytes.fromhex("4b 41 60 00 37 07 00 00")


def raw(text: str) -> bytes:
    return bytes.fromhex(text)


@pytest.mark.parametrize(("address", "written", "request_frame", "answer", "read"), GOLDEN)
def test_golden_frames(
    address: Address, written: str | None, request_frame: str, answer: str, read: str
) -> None:
    client = SdoClient()
    transfer = Transfer(address, None if written is None else raw(written))
    assert client.start(transfer, 0) == (raw(request_frame),)
    assert client.receive(raw(answer), 1) == ()
    assert client.take() == raw(read)
    assert client.take() is None
    assert not client.busy
    assert client.wake_at == NEVER


def test_a_name_of_five_bytes_comes_in_segments() -> None:
    # CiA 301: sizes above four bytes go in segments; 0x1008 of a real EPOS2 is "EPOS2" without an end.
    client = SdoClient()
    assert client.start(NAME, 0) == (raw("40 08 10 00 00 00 00 00"),)
    assert client.receive(raw("41 08 10 00 05 00 00 00"), 1) == (raw("60 00 00 00 00 00 00 00"),)
    assert client.receive(raw("05 45 50 4f 53 32 00 00"), 2) == ()
    assert client.take() == b"EPOS2"


def test_segments_alternate_their_toggle() -> None:
    client = SdoClient()
    client.start(NAME, 0)
    client.receive(raw("41 08 10 00 08 00 00 00"), 1)
    assert client.receive(raw("00 31 32 33 34 35 36 37"), 2) == (raw("70 00 00 00 00 00 00 00"),)
    assert client.receive(raw("1d 38 00 00 00 00 00 00"), 3) == ()
    assert client.take() == b"12345678"


def test_a_toggle_that_stands_still_is_aborted() -> None:
    client = SdoClient()
    client.start(NAME, 0)
    client.receive(raw("41 08 10 00 0e 00 00 00"), 1)
    client.receive(raw("00 31 32 33 34 35 36 37"), 2)
    assert client.receive(raw("00 31 32 33 34 35 36 37"), 3) == (raw("80 08 10 00 00 00 03 05"),)
    assert isinstance(client.take(), SdoProtocolError)


@pytest.mark.parametrize("size", [LARGEST_UPLOAD + 1, 0xFFFF_FFFF])
def test_an_upload_without_bounds_is_aborted(size: int) -> None:
    client = SdoClient()
    client.start(NAME, 0)
    announced = raw("41 08 10 00") + size.to_bytes(4, "little")
    assert client.receive(announced, 1) == (raw("80 08 10 00 05 00 04 05"),)
    assert isinstance(client.take(), SdoProtocolError)


def test_an_upload_that_never_ends_is_aborted() -> None:
    client = SdoClient()
    client.start(NAME, 0)
    client.receive(raw("40 08 10 00 00 00 00 00"), 1)
    for number in range(LARGEST_UPLOAD):
        client.receive(bytes((0x10 * (number % 2),)) + b"endless", 2)
        if not client.busy:
            break
    assert isinstance(client.take(), SdoProtocolError)


def test_a_refusal_reports_object_and_meaning() -> None:
    client = SdoClient()
    client.start(Transfer(Address(0x605A)), 0)
    client.receive(raw("80 5a 60 00 00 00 02 06"), 1)
    refused = client.take()
    assert isinstance(refused, SdoRefusedError)
    assert refused.code == 0x0602_0000
    assert str(refused) == "SDO upload 0x605A was refused with 0x06020000 no such object"


def test_no_answer_is_requested_again_and_then_given_up() -> None:
    client = SdoClient()
    request = client.start(STATUS, 0)
    abort = raw("80 41 60 00 00 00 04 05")
    assert client.wake(TIMEOUT - 1) == ()
    assert client.wake(TIMEOUT) == (abort, *request)
    assert client.wake_at == 2 * TIMEOUT
    assert client.wake(2 * TIMEOUT) == (abort,)
    late = client.take()
    assert isinstance(late, SdoTimeoutError)
    assert str(late) == "no answer to SDO upload 0x6041 within 400 ms"
    assert client.wake_at == NEVER


def test_an_answer_to_the_second_attempt_counts() -> None:
    client = SdoClient()
    client.start(STATUS, 0)
    client.wake(TIMEOUT)
    client.receive(ANSWER, TIMEOUT + 1)
    assert client.take() == raw("37 07")


@pytest.mark.parametrize("attempts", [1, ATTEMPTS, 10])
def test_attempts_are_bounded(attempts: int) -> None:
    client = SdoClient()
    requested = len(client.start(Transfer(od.STATUSWORD, attempts=attempts), 0))
    now = 0
    while client.busy:
        now = client.wake_at
        requested += sum(frame[0] == 0x40 for frame in client.wake(now))
    assert requested == attempts
    assert now == attempts * TIMEOUT


@pytest.mark.parametrize(
    "stray",
    [
        "60 41 60 00 00 00 00 00",  # an answer to a write of the same object
        "4b 64 60 00 37 07 00 00",  # a late answer, to another object
        "80 64 60 00 00 00 04 05",  # a late refusal of another object
        "05 45 50 4f 53 32 00 00",  # a segment that was not requested
        "20 00 00 00 00 00 00 00",
        "c0 41 60 00 00 00 00 00",  # block transfer
        "4b 41 60 00 37 07",  # too short
        "",
    ],
)
def test_deviations_change_nothing(stray: str) -> None:
    client = SdoClient()
    client.start(STATUS, 0)
    assert client.receive(raw(stray), 1) == ()
    assert client.busy
    assert client.take() is None
    client.receive(ANSWER, 2)
    assert client.take() == raw("37 07")


def test_one_transfer_at_a_time() -> None:
    client = SdoClient()
    client.start(STATUS, 0)
    with pytest.raises(ValueError, match="SDO upload 0x1008 while SDO upload 0x6041 is in flight"):
        client.start(NAME, 0)


@pytest.mark.parametrize("size", [0, 5])
def test_what_fits_no_frame_is_refused(size: int) -> None:
    with pytest.raises(ValueError, match=f"with {size} bytes; 1 to 4 are possible"):
        SdoClient().start(Transfer(od.CONTROLWORD, bytes(size)), 0)


def test_a_canceled_transfer_leaves_nothing_behind() -> None:
    client = SdoClient()
    client.start(STATUS, 0)
    client.cancel()
    assert client.receive(ANSWER, 1) == ()
    assert client.take() is None
    assert not client.busy


@given(
    st.sampled_from([STATUS, NAME, Transfer(od.CONTROLWORD, b"\6\0")]),
    st.lists(st.binary(max_size=8), max_size=30),
)
def test_no_answers_make_it_raise_and_it_always_ends(transfer: Transfer, answers: list[bytes]) -> None:
    client = SdoClient()
    client.start(transfer, 0)
    now = 0
    for now, answer in enumerate(answers, 1):
        client.receive(answer, now)
    while client.busy:
        now = client.wake_at
        client.wake(now)
    assert client.take() is not None
    assert now <= ATTEMPTS * TIMEOUT + len(answers)
