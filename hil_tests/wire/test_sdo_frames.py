"""The SDO codec, both ends: golden frames, and every message there and back."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen import sdo
from firmware_bridge.canopen.abort import AbortCode, SdoAbort, meaning_of
from firmware_bridge.canopen.address import Address

ADDRESSES = st.builds(Address, st.integers(0, 0xFFFF), st.integers(0, 0xFF))
SEGMENTS = st.binary(max_size=sdo.SEGMENT)


@pytest.mark.parametrize(
    ("frame", "wire"),
    [
        # EPOS2 Application Notes, April 2013, p. 164.
        (sdo.encode_upload(od.DEVICE_TYPE), "4000100000000000"),
        (sdo.encode_upload_response(od.DEVICE_TYPE, bytes.fromhex("92010200")), "4300100092010200"),
        # Driver for EPOS2 drives, Pejman712/CRF.
        (sdo.encode_download(od.CONSUMER_HEARTBEAT_1, bytes.fromhex("D0070100")), "23161001D0070100"),
        (sdo.encode_download(od.PRODUCER_HEARTBEAT, bytes.fromhex("E803")), "2B171000E8030000"),
        (sdo.encode_download_response(od.PRODUCER_HEARTBEAT), "6017100000000000"),
        # Requests sent to EPOS2 drives by a microcontroller, SamsonChau.
        (sdo.encode_download(od.CONTROLWORD, b"\x06\x00"), "2B40600006000000"),
        (sdo.encode_download(Address(0x1400, 2), b"\xff"), "2F001402FF000000"),
        # CiA 301 v4.02, service data object; computed.
        (sdo.encode_abort(Address(0x5555), AbortCode.NO_OBJECT), "8055550000000206"),
        (sdo.encode_upload_response(od.DEVICE_NAME, b"EPOS2"), "4108100005000000"),
        (sdo.encode_upload_segment(toggle=True), "7000000000000000"),
        (sdo.encode_upload_segment_response(b"EPOS2", toggle=False, last=True), "0545504F53320000"),
        (sdo.encode_download_segment_response(toggle=True), "3000000000000000"),
    ],
)
def test_frames_are_those_of_the_sources(frame: bytes, wire: str) -> None:
    assert frame.hex().upper() == wire


@given(ADDRESSES, st.binary(min_size=1, max_size=4))
def test_a_short_download_travels_in_its_request(address: Address, raw: bytes) -> None:
    request = sdo.decode_request(sdo.encode_download(address, raw))
    assert request == sdo.DownloadRequest(address, raw, len(raw))


@given(ADDRESSES, st.binary(min_size=5, max_size=40))
def test_a_long_transfer_announces_its_size(address: Address, raw: bytes) -> None:
    assert sdo.decode_request(sdo.encode_download(address, raw)) == sdo.DownloadRequest(
        address, None, len(raw)
    )
    assert sdo.decode_response(sdo.encode_upload_response(address, raw)) == sdo.UploadResponse(
        address, None, len(raw)
    )


@given(ADDRESSES, st.binary(min_size=1, max_size=4))
def test_a_short_upload_travels_in_its_answer(address: Address, raw: bytes) -> None:
    assert sdo.decode_request(sdo.encode_upload(address)) == sdo.UploadRequest(address)
    assert sdo.decode_response(sdo.encode_upload_response(address, raw)) == sdo.UploadResponse(
        address, raw, len(raw)
    )


@given(SEGMENTS, st.booleans(), st.booleans())
def test_segments_are_the_same_both_ways(raw: bytes, toggle: bool, last: bool) -> None:  # noqa: FBT001
    segment = sdo.SdoSegment(toggle, raw, last)
    assert sdo.decode_request(sdo.encode_download_segment(raw, toggle=toggle, last=last)) == segment
    assert sdo.decode_response(sdo.encode_upload_segment_response(raw, toggle=toggle, last=last)) == segment


@given(ADDRESSES, st.integers(0, 0xFFFF_FFFF))
def test_an_abort_keeps_its_code_whichever_node_sends_it(address: Address, code: int) -> None:
    frame = sdo.encode_abort(address, code)
    assert sdo.decode_request(frame) == sdo.decode_response(frame) == sdo.Abort(address, code)


@given(st.binary(max_size=8))
def test_no_bytes_raise(payload: bytes) -> None:
    for message in (sdo.decode_request(payload), sdo.decode_response(payload)):
        assert isinstance(message, sdo.Request | sdo.Response)


@given(st.binary(max_size=7))
def test_a_cut_answer_is_no_answer(payload: bytes) -> None:
    assert isinstance(sdo.decode_response(payload), sdo.Unknown)


def test_eight_bytes_are_no_segment() -> None:
    with pytest.raises(ValueError, match="at most 7"):
        sdo.encode_download_segment(bytes(8), toggle=False, last=True)


def test_an_abort_states_where_and_why() -> None:
    assert str(SdoAbort(AbortCode.READ_ONLY, od.STATUSWORD)) == "0x6041: 0x06010002 object is read-only"
    assert meaning_of(0x1234_5678) == "0x12345678"


def test_abort_codes_and_meanings_are_unique() -> None:
    codes = list(AbortCode)
    assert len({int(code) for code in codes}) == len({code.meaning for code in codes}) == len(codes)
