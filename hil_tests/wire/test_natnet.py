"""NatNet packets: golden vectors, every version there and back, and whatever else arrives is refused."""

from typing import Any, TypeVar

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_bridge.families.motion_capture.wire import frame as frames
from firmware_bridge.families.motion_capture.wire import layout, messages, models
from firmware_bridge.families.motion_capture.wire.frame import Frame, LabeledMarker, RigidBody
from firmware_bridge.families.motion_capture.wire.glance import glance
from firmware_bridge.families.motion_capture.wire.layout import FIRST, LAST, NatNetError, Version
from firmware_bridge.families.motion_capture.wire.messages import (
    Connect,
    MessageId,
    ServerInfo,
    packet,
    split,
)
from firmware_bridge.families.motion_capture.wire.models import ModelMarker, RigidBodyModel
from hil_tests.rows import every

T = TypeVar("T")
VERSIONS = tuple(Version(*it) for it in ((2, 9), (2, 10), (3, 0), (3, 1), (4, 0), (4, 1), (4, 2), (4, 4)))
HALF = 0.7071067690849304
"""The root of a half in 32 bits."""

# Worked out by hand from the layout; OptiTrack's Python client and PyPI's natnet read the same from them.
TRACKED_3_1 = bytes.fromhex(
    "07008e00b0040000000000000000000001000000010000000000003f0000a03f000040bf00000000f304353f00000000f304353f"
    "6f1283390100000000000100000001000100 0000083f0000a03f000040bf6666663c0a0017b75139 0000000000000000"
    "00000000000000000000000000001440 081a99be1c0000008ccc99be1c00000030ec99be1c000000 0000 00000000"
)
LOST_4_1 = bytes.fromhex(
    "0700a000b0040000 0000000000000000 0000000000000000 0100000026000000"
    "010000000000003f0000a03f000040bf00000000"
    "f304353f00000000f304353f000000000000 00000000000000000000000000000000 00000000000000000000000000000000"
    "00000000000000000000000000000000 0000000000001440 081a99be1c0000008ccc99be1c00000030ec99be1c000000"
    "0000000000000000 0000 00000000"
)
BODY = RigidBody(1, (0.5, 1.25, -0.75), (0.0, HALF, 0.0, HALF), mean_error_m=0.0002500000118743628)
MARKER = LabeledMarker(0x0001_0001, (0.53125, 1.25, -0.75), 0.01406249962747097, 10, 0.00019999999494757503)
SEEN = Frame(
    1200,
    bodies=(BODY,),
    markers=(MARKER,),
    timestamp_s=5.0,
    exposed=123_456_789_000,
    received=123_456_834_700,
    sent=123_456_842_800,
)
LOST = SEEN._replace(bodies=(BODY._replace(mean_error_m=0.0, params=0),), markers=(), precise=(0, 0))


@pytest.mark.parametrize(
    ("datagram", "version", "frame"),
    [(TRACKED_3_1, Version(3, 1), SEEN), (TRACKED_3_1, Version(3, 0), SEEN), (LOST_4_1, Version(4, 1), LOST)],
)
def test_a_golden_frame_is_read_and_written(datagram: bytes, version: Version, frame: Frame) -> None:
    message, payload = split(datagram)
    assert message is MessageId.FRAMEOFDATA
    assert frames.decoded(payload, version) == frame
    assert packet(MessageId.FRAMEOFDATA, frames.encoded(frame, version)) == datagram


TWO = (BODY._replace(id=7, params=0), BODY)
TWICE = (BODY, BODY._replace(mean_error_m=0.5))


# A frame in one stroke, and one that only the rows read; a number that two bodies have is the last one's.
@every("version", VERSIONS)
@every("others", [(), ((0.5, 0.5, 0.5),)])
@every("seen", [TWO, TWICE, ()])
def test_a_glance_sees_what_the_whole_frame_reports(
    version: Version, others: tuple[frames.Point, ...], seen: tuple[RigidBody, ...]
) -> None:
    whole = SEEN._replace(bodies=seen, other_markers=others, params=2, precise=(0, 0))
    payload = frames.encoded(whole, version)
    found, frame = glance(payload, version), frames.decoded(payload, version)
    reported = (found.timestamp_s, found.exposed, found.sent, found.params)
    assert reported == (frame.timestamp_s, frame.exposed, frame.sent, frame.params)
    assert [found.body(number) for number in (1, 7, 8)] == [
        {body.id: body for body in frame.bodies}.get(number) for number in (1, 7, 8)
    ]
    with pytest.raises(NatNetError):
        glance(payload[:-5], version)


@pytest.mark.parametrize("version", [Version(2, 10), Version(3, 1), Version(4, 1)])
def test_a_body_has_the_size_that_its_version_gives_it(version: Version) -> None:
    empty = len(frames.encoded(Frame(1), version))
    assert len(frames.encoded(Frame(1, bodies=(BODY._replace(markers=()),)), version)) - empty == (
        42 if version < (3, 0) else 38
    )


floats = st.floats(width=32, allow_nan=False)
points = st.tuples(floats, floats, floats)
quaternions = st.tuples(floats, floats, floats, floats)
ints = st.integers(-(1 << 31), (1 << 31) - 1)
shorts = st.integers(-(1 << 15), (1 << 15) - 1)
texts = st.text(st.characters(exclude_characters="\0", codec="utf-8"), max_size=5)
ticks = st.integers(0, (1 << 64) - 1)


def several(kind: st.SearchStrategy[T]) -> st.SearchStrategy[tuple[T, ...]]:
    return st.lists(kind, max_size=2).map(tuple)


@st.composite
def bodies(draw: st.DrawFn, version: Version) -> RigidBody:
    old = several(st.builds(frames.BodyMarker, points, ints, floats)) if version < (3, 0) else st.just(())
    return draw(st.builds(RigidBody, ints, points, quaternions, floats, shorts, old))


@st.composite
def some_frames(draw: st.DrawFn, version: Version) -> Frame:
    new, body = version >= (3, 0), bodies(version)
    devices = several(st.builds(frames.Device, ints, several(several(floats))))
    asset_marker = st.builds(frames.AssetMarker, ints, points, floats, shorts, floats)
    return Frame(
        draw(ints),
        draw(several(st.builds(frames.MarkerSet, texts, several(points)))),
        draw(several(points)),
        draw(several(body)),
        draw(several(st.builds(frames.Skeleton, ints, several(body)))),
        draw(several(st.builds(frames.Asset, ints, several(body), several(asset_marker))))
        if version >= (4, 1)
        else (),
        draw(
            several(st.builds(LabeledMarker, ints, points, floats, shorts, floats if new else st.just(0.0)))
        ),
        draw(devices),
        draw(devices) if new else (),
        0.0 if new else draw(floats),
        draw(st.integers(0, 0xFFFF_FFFF)),
        draw(st.integers(0, 0xFFFF_FFFF)),
        draw(st.floats(allow_nan=False)),
        draw(ticks) if new else 0,
        draw(ticks) if new else 0,
        draw(ticks) if new else 0,
        draw(st.none() | st.tuples(*[st.integers(0, 0xFFFF_FFFF)] * 2)) if version >= (4, 1) else None,
        draw(shorts),
    )


@st.composite
def some_models(draw: st.DrawFn, version: Version) -> tuple[Any, ...]:
    marker = st.builds(ModelMarker, points, ints, texts if version >= (4, 0) else st.just(""))
    body = st.builds(
        RigidBodyModel,
        texts,
        ints,
        ints,
        points,
        quaternions if version >= (4, 2) else st.just((0.0, 0.0, 0.0, 1.0)),
        several(marker) if version >= (3, 0) else st.just(()),
    )
    matrix, corners = (st.tuples(*[st.just(0.5)] * size) for size in (144, 12))
    rows: list[st.SearchStrategy[Any]] = [
        st.builds(models.MarkerSetModel, texts, several(texts)),
        body,
        st.builds(models.SkeletonModel, texts, ints, several(body)),
        st.builds(
            models.ForcePlateModel,
            ints,
            texts,
            *[floats] * 2,
            points,
            matrix,
            corners,
            *[ints] * 2,
            several(texts),
        ),
        st.builds(models.DeviceModel, ints, texts, texts, ints, ints, several(texts)),
        st.builds(models.CameraModel, texts, points, quaternions),
    ]
    if version >= (4, 1):
        marked = st.builds(models.AssetMarkerModel, texts, ints, points, floats, shorts)
        rows.append(st.builds(models.AssetModel, texts, ints, ints, several(body), several(marked)))
    return draw(st.lists(st.one_of(rows), max_size=3).map(tuple))


@settings(max_examples=25)
@given(st.data(), st.sampled_from(VERSIONS))
def test_any_frame_comes_back(data: st.DataObject, version: Version) -> None:
    frame = data.draw(some_frames(version))
    assert frames.decoded(frames.encoded(frame, version), version) == frame


@settings(max_examples=50)
@given(st.data(), st.sampled_from(VERSIONS))
def test_the_frames_of_every_exposure_are_the_same_in_one_stroke_and_by_rows(
    data: st.DataObject, version: Version
) -> None:
    frame = data.draw(some_frames(version))
    if data.draw(st.booleans()):
        frame = frame._replace(
            marker_sets=(),
            other_markers=(),
            bodies=tuple(body._replace(markers=()) for body in frame.bodies),
            skeletons=(),
            assets=(),
            force_plates=(),
            devices=(),
        )
    payload = frames.encoded(frame, version)
    assert payload == layout.encode(frames.FRAME, frame, version, "frame")
    assert frames.decoded(payload, version) == layout.decode(frames.FRAME, payload, version, "frame")


@settings(max_examples=25)
@given(st.data(), st.sampled_from(VERSIONS))
def test_any_models_come_back(data: st.DataObject, version: Version) -> None:
    found = data.draw(some_models(version))
    assert models.decoded(models.encoded(found, version), version) == found


@settings(max_examples=25)
@given(st.data(), st.sampled_from(VERSIONS))
def test_a_frame_cut_anywhere_is_refused(data: st.DataObject, version: Version) -> None:
    payload = frames.encoded(data.draw(some_frames(version)), version)
    with pytest.raises(NatNetError):
        frames.decoded(payload[: data.draw(st.integers(0, len(payload) - 1))], version)


@given(st.binary(max_size=400), st.sampled_from(VERSIONS), st.sampled_from(MessageId))
def test_garbage_is_refused_and_nothing_else(noise: bytes, version: Version, message: MessageId) -> None:
    datagram = packet(message, noise)
    for read in (
        lambda: split(noise),
        lambda: frames.decoded(split(datagram)[1], version),
        lambda: models.decoded(noise, version),
        lambda: messages.server_info(noise),
        lambda: messages.echo_of(noise),
        lambda: messages.echo_payload(noise, 0),
    ):
        try:
            read()
        except NatNetError:
            continue
    messages.connected(noise)
    messages.text_of(noise)


@given(st.data())
def test_a_damaged_frame_is_read_or_refused(data: st.DataObject) -> None:
    payload = bytearray(split(TRACKED_3_1)[1])
    for _ in range(3):
        payload[data.draw(st.integers(0, len(payload) - 1))] = data.draw(st.integers(0, 255))
    try:
        frames.decoded(bytes(payload), Version(3, 1))
    except NatNetError:
        return


@pytest.mark.parametrize(
    ("payload", "stated"),
    [
        ("ffffffff", "marker_sets"),
        ("b0040000 ffffffff", "-1 of them do not fit"),
        ("b0040000 00000000 00000000 ffffff7f", "bodies: 2147483647 of them do not fit"),
        ("b0040000 01000000 616263", "name at byte 8 has no end"),
    ],
)
def test_a_refusal_states_where(payload: str, stated: str) -> None:
    with pytest.raises(NatNetError, match=stated):
        frames.decoded(bytes.fromhex(payload), Version(3, 1))


def test_a_4_0_with_precise_stamps_is_read_and_none_is_written() -> None:
    plain = SEEN._replace(precise=(3, 4))
    written = frames.encoded(plain, Version(4, 0))
    assert written == frames.encoded(SEEN, Version(3, 1))
    with_stamps = written[:-6] + bytes.fromhex("0300000004000000") + written[-6:]
    assert frames.decoded(with_stamps, Version(4, 0)) == plain


def test_a_frame_in_the_layout_of_another_version_is_refused() -> None:
    for wrong in VERSIONS:
        if wrong not in {(3, 0), (3, 1), (4, 0)}:  # 4.0 is laid out as 3.1
            with pytest.raises(NatNetError):
                frames.decoded(split(TRACKED_3_1)[1], wrong)


@pytest.mark.parametrize("version", [Version(1, 7), Version(2, 8), Version(5, 0), Version(0, 0)])
def test_a_version_that_no_one_has_described_is_refused(version: Version) -> None:
    with pytest.raises(NatNetError, match=f"NatNet {version} is not known; {FIRST} to {LAST} are"):
        frames.encoded(SEEN, version)


def test_a_list_of_another_length_than_stated_is_refused() -> None:
    payload = bytearray(split(LOST_4_1)[1])
    payload[payload.index(b"\x26\0\0\0")] = 0x27
    with pytest.raises(NatNetError, match="bodies: 39 bytes long by its header, and 38 by its items"):
        frames.decoded(bytes(payload), Version(4, 1))


@pytest.mark.parametrize(
    ("info", "size"),
    [
        (ServerInfo("Motive", (1, 10, 0, 0), (2, 10, 0, 0)), 264),
        (ServerInfo("Motive", (2, 1, 0, 0), (3, 0, 0, 0), ticks_per_s=3_312_787), 279),
        (ServerInfo("Motive", (3, 1, 0, 0), (4, 1, 0, 0), 10_000_000, 1511, 0), 279),
    ],
)
def test_who_serves_states_its_version(info: ServerInfo, size: int) -> None:
    payload = messages.server_info_payload(info)
    assert len(payload) == size
    junk = payload[:7] + bytes([0xAB]) * 249 + payload[256:]
    assert messages.server_info(junk + b"\0\0\0\0") == info


@pytest.mark.parametrize(
    ("payload", "connect"),
    [
        (b"", Connect()),
        (b"Ping\0", Connect()),
        (messages.connect_payload(Connect("NatNetLib", (3, 0, 0, 0), (3, 0, 0, 0))), None),
        (messages.connect_payload(Connect("x", (4, 1, 0, 0), (4, 1, 0, 0), (3, 1, 0, 0))) + b"\0\0", None),
    ],
)
def test_every_client_that_connects_is_understood(payload: bytes, connect: Connect | None) -> None:
    found = messages.connected(payload)
    if connect is not None:
        assert found == connect
    else:
        assert messages.connect_payload(found) == payload[: len(messages.connect_payload(found))]
        assert (found.wants is None) == (len(payload) == 264)


def test_a_model_of_an_unknown_type_is_stepped_over_where_its_length_is_reported() -> None:
    robot = RigidBodyModel("robot", 7)
    payload = models.encoded((robot, RigidBodyModel("other", 8)), Version(4, 1))
    strange = payload[:4] + b"\x63" + payload[5:]
    assert [model.name for model in models.decoded(strange, Version(4, 1))] == ["other"]  # type: ignore[union-attr]
    with pytest.raises(NatNetError, match="type 99 is not known"):
        models.decoded(b"\1\0\0\0\x63\0\0\0", Version(3, 1))
    assert models.body_named((robot,), "robot") == 7
    with pytest.raises(NatNetError, match="0 rigid bodies are called 'rome'; there are: robot"):
        models.body_named((robot,), "rome")
