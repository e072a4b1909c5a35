"""The bridge receives from the emulated capture system: pose, age, and its report of a hidden body."""

import math
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.motion_capture.bodies import on_floor
from emulators.motion_capture.exposure import Cameras, Hidden, Lost, Swapped, Up
from firmware_bridge.families.motion_capture.driver.body import SeenBody, Sighting
from firmware_bridge.families.motion_capture.driver.clock import StampClock
from firmware_bridge.families.motion_capture.driver.mavlink import MavlinkPoses
from firmware_bridge.families.motion_capture.driver.natnet import CONNECT, NatNetLink
from firmware_bridge.families.motion_capture.wire import frame as frames
from firmware_bridge.families.motion_capture.wire import messages
from firmware_bridge.families.motion_capture.wire.frame import Frame, FrameFlag, RigidBody
from firmware_bridge.families.motion_capture.wire.layout import Version
from firmware_bridge.families.motion_capture.wire.mavlink_pose import check_sum, poses
from firmware_bridge.families.motion_capture.wire.messages import MessageId, ServerInfo, packet
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, from_seconds, to_seconds
from firmware_bridge.wire.internet import number_of
from hil_tests.unit.capture_driver.capture_bench import LINK, ROUND, SERVER, V3_1, body, joined, table


def stated(seen: SeenBody) -> bool:
    """Return True if it has a reading now; evaluated at each call."""
    return seen.reading is not None


def sighted(seen: SeenBody) -> Sighting:
    return seen.sighting


EXACT = Cameras(noise_m=0.0)
AT = number_of("127.0.0.1", 1510)
DATA = number_of("127.0.0.1", 1511)


@pytest.mark.parametrize("version", [Version(2, 10), V3_1, Version(4, 0), Version(4, 1), Version(4, 4)])
@pytest.mark.parametrize("wanted", ["robot", 7])
def test_it_reports_where_the_body_was_and_when(version: Version, wanted: str | int) -> None:
    seen = body(body=wanted)
    world, _, listening = joined(seen, EXACT, version)
    world.run(SECOND)
    assert len(listening.readings) > 200
    for reading in listening.readings[20:]:
        assert reading.pose is not None
        place = ROUND(reading.sampled_at)
        # 1 ms of 0.5 m/s is the network's delay, and 2.10 does not carry the age of a frame.
        assert math.dist(reading.pose.position, place.position) < 0.5e-3
        heading = math.remainder(0.5 * to_seconds(reading.sampled_at) + math.pi / 2.0, math.tau)
        assert reading.pose.heading_rad == pytest.approx(heading, abs=1e-3)
        assert 4 * MILLISECOND < reading.received_at - reading.sampled_at < 7.5 * MILLISECOND
    assert seen.sighting is Sighting.SEEN
    assert seen.jumps == 0


def test_the_jitter_of_frames_and_network_does_not_reach_their_age() -> None:
    world, _, listening = joined(body(), EXACT)
    world.run(4 * SECOND)
    off = [
        reading.sampled_at - round(reading.sampled_at * 240 / SECOND) * SECOND / 240
        for reading in listening.readings[100:]
    ]
    assert np.std(off) < 10_000
    arrival = np.diff([reading.received_at for reading in listening.readings[100:]])
    assert np.std(arrival) > 200_000


@pytest.mark.parametrize("lost", Lost)
def test_hidden_it_sends_nothing_and_states_why(lost: Lost) -> None:
    seen = body()
    world, system, listening = joined(seen, Cameras(lost=lost))
    system.hide(Hidden(7, SECOND, 2 * SECOND))
    world.run(from_seconds(1.5))
    assert not stated(seen)
    assert seen.sighting.value == Sighting.LOST.value
    assert max(reading.sampled_at for reading in listening.readings) < SECOND
    world.run(from_seconds(2.1))
    assert seen.reading is not None
    assert seen.jumps == 0


def test_swapped_markers_are_counted_as_a_jump_there_and_one_back() -> None:
    seen = body()
    world, system, _ = joined(seen, Cameras())
    system.hide(Swapped(7, SECOND, 2 * SECOND, aside=(0.3, 0.0, 0.0)))
    world.run(SECOND)
    assert seen.jumps == 0
    world.run(from_seconds(1.5))
    assert seen.jumps == 1
    world.run(from_seconds(2.5))
    assert seen.jumps == 2
    assert seen.reading is not None
    assert seen.reading.pose is not None
    assert seen.reading.pose.jumps == 2


def test_an_absent_body_is_stated_to_be() -> None:
    for wanted in (99, "no one"):
        seen = body(body=wanted)
        world, _, listening = joined(seen, EXACT)
        world.run(SECOND)
        assert seen.sighting is Sighting.ABSENT
        assert not listening.readings


def test_where_the_markers_are_mounted_is_taken_off() -> None:
    seen = body(up="z", mount={"x": 0.1, "y": -0.05, "z": 0.3, "heading": 0.4})
    place = on_floor(2.0, 1.0, 1.1)
    c, s = math.cos(1.1), math.sin(1.1)
    pivot = (2.0 + 0.1 * c + 0.05 * s, 1.0 + 0.1 * s - 0.05 * c, 0.3)
    seen.seen(pivot, on_floor(0.0, 0.0, 1.5).attitude, 0.0, 0, 0)
    assert seen.reading is not None
    assert seen.reading.pose is not None
    assert seen.reading.pose.position == pytest.approx(place.position)
    assert seen.reading.pose.attitude == pytest.approx(place.attitude)
    assert seen.reading.pose.heading_rad == pytest.approx(1.1)


def test_a_server_that_is_not_there_is_requested_again_and_one_that_restarts_is_found() -> None:
    seen = body()
    link = NatNetLink(LINK, table(), [seen])
    requested = [link.wake(now) for now in (0, SECOND, 2 * SECOND)]
    assert requested == [(Packet(LINK, AT, CONNECT),)] * 3
    assert link.wake_at == 3 * SECOND
    assert link.beat(0) == ()
    world, system, listening = joined(seen, EXACT)
    world.run(SECOND)
    received = len(listening.readings)
    system.server._clients.clear()  # noqa: SLF001 - what a restart is to a client
    world.run(4 * SECOND)
    assert len(listening.readings) > received + 240


@pytest.mark.parametrize(
    ("host", "received"), [("127.0.0.1", True), ("127.0.0.2", False), ("::1", False), ("10.0.0.1", False)]
)
def test_no_one_else_is_believed(host: str, *, received: bool) -> None:
    seen = body(body=1)
    link = NatNetLink(LINK, table(), [seen])
    info = messages.server_info_payload(ServerInfo("x", (1, 0, 0, 0), (3, 1, 0, 0)))
    pose = RigidBody(1, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    frame = frames.encoded(Frame(1, bodies=(pose,)), V3_1)
    link.receive(Packet(LINK, AT, packet(MessageId.SERVERINFO, info)), 0)
    link.receive(Packet(LINK, number_of(host, 1511), packet(MessageId.FRAMEOFDATA, frame)), 0)
    assert (seen.reading is not None) == received


@given(st.lists(st.binary(max_size=300) | st.sampled_from([messages.MessageId.FRAMEOFDATA]), max_size=5))
def test_whatever_the_server_sends_is_no_exception(noise: list[Any]) -> None:
    seen = body(body=1)
    link = NatNetLink(LINK, table(), [seen])
    info = messages.server_info_payload(ServerInfo("x", (1, 0, 0, 0), (3, 1, 0, 0)))
    link.receive(Packet(LINK, AT, packet(MessageId.SERVERINFO, info)), 0)
    for each in noise:
        datagram = packet(MessageId.FRAMEOFDATA, b"\0" * 20) if isinstance(each, MessageId) else each
        link.receive(Packet(LINK, DATA, datagram), 0)
        link.receive(Packet(LINK, DATA, packet(MessageId.FRAMEOFDATA, datagram)), 0)
    assert link.refused <= 2 * len(noise)
    assert seen.reading is None


NAN = math.nan


@pytest.mark.parametrize(
    ("position", "attitude"),
    [
        ((NAN, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)),
        ((0.0, math.inf, 0.0), (0.0, 0.0, 0.0, 1.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, NAN, 1.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, math.inf, 1.0)),
        ((math.inf, -math.inf, 0.0), (0.0, 0.0, 0.0, 1.0)),
    ],
)
def test_what_is_no_pose_counts_as_not_tracked(position: Any, attitude: Any) -> None:
    seen = body()
    seen.seen((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), 0.0, 0, 0)
    seen.seen(position, attitude, 0.0, 1, 1)
    assert (stated(seen), sighted(seen)) == (False, Sighting.LOST)


@pytest.mark.parametrize(
    ("aside", "turn", "after", "jumps"),
    [
        (0.104, 0.0, 0.1, 0),
        (0.106, 0.0, 0.1, 1),
        (0.0, 0.149, 0.1, 0),
        (0.0, 0.151, 0.1, 1),
        (0.0, -0.151, 0.1, 1),
        (0.0, math.tau, 0.1, 0),
        (0.9, 0.0, 1.0, 0),
    ],
)
def test_what_is_further_than_it_gets_is_a_jump(aside: float, turn: float, after: float, jumps: int) -> None:
    seen = body(up="z")
    for at, place in ((0, on_floor(0.0, 0.0, 0.0)), (from_seconds(after), on_floor(0.0, aside, turn))):
        seen.seen(place.position, place.attitude, 0.0, at, at)
    assert seen.jumps == jumps


@given(st.lists(st.tuples(st.integers(0, 10 * SECOND), st.integers(0, 50 * MILLISECOND)), max_size=30))
def test_nothing_leaves_after_it_was_received_nor_before_it_can_have(received: list[tuple[int, int]]) -> None:
    clock = StampClock()
    for stamp, took in sorted(received):
        left = clock.left_at(stamp + 7 * SECOND, stamp + took)
        assert stamp - MILLISECOND < left <= stamp + took


def test_a_clock_that_is_fast_is_followed_and_one_that_was_set_begins_again() -> None:
    for ppm in (-50, 50):
        clock, left = StampClock(), 0
        for second in range(1, 600):
            now = second * SECOND
            left = clock.left_at(now * (1_000_000 + ppm) // 1_000_000, now)
            assert abs(left - now) <= MILLISECOND // 10
        assert clock.left_at(5, now) == now
        assert left <= now


def test_mavlink_poses_are_turned_into_the_same_room() -> None:
    mavlink: Any = pytest.importorskip("pymavlink.dialects.v20.common")
    codec = mavlink.MAVLink(None, srcSystem=1, srcComponent=197)
    rows: list[tuple[Any, float, int]] = []
    for number, yaw in enumerate((0.0, 0.5, -2.0)):
        vision = codec.vision_position_estimate_encode(
            1_000_000 + number, 1.0, 2.0, -0.3, 0.0, 0.0, yaw, [1e-6, *[0.0] * 20], 3
        )
        half = yaw / 2.0
        q = [math.cos(half), 0.0, 0.0, math.sin(half)]
        cov = [1e-6, *[0.0] * 20]
        odometry = codec.odometry_encode(2_000_000, 20, 12, 1.0, 2.0, -0.3, q, *[0.0] * 6, cov, cov, 3, 6, 50)
        rows += [(vision, yaw, 0), (odometry, yaw, 0)]
    for message, yaw, _ in rows:
        seen = body(up="z")
        link = MavlinkPoses(LINK, table("mavlink-pose"), [seen])
        junk = b"\x00\x01" + codec.heartbeat_encode(6, 8, 0, 0, 0).pack(codec)
        link.receive(Packet(LINK, AT, junk + message.pack(codec)), SECOND)
        assert seen.reading is not None
        assert seen.reading.pose is not None
        assert seen.reading.pose.position == pytest.approx((1.0, -2.0, 0.3))
        assert seen.reading.pose.heading_rad == pytest.approx(-yaw, abs=1e-6)
        assert seen.reading.value == pytest.approx(1e-3)
        assert SECOND - seen.reading.sampled_at == 5_400_000
        damaged = bytearray(message.pack(codec))
        damaged[12] ^= 1
        seen.missed(Sighting.LOST)
        link.receive(Packet(LINK, AT, bytes(damaged)), SECOND)
        assert seen.reading is None


@given(st.lists(st.binary(max_size=60) | st.integers(0, 5), max_size=6))
def test_whatever_comes_in_mavlink_is_no_exception(parts: list[bytes | int]) -> None:
    numbers = (0.0, math.nan, math.inf, -math.inf, 3e38, -1.0)
    seen = body(up="z")
    link = MavlinkPoses(LINK, table("mavlink-pose"), [seen])
    noise = b"".join(it if isinstance(it, bytes) else _vision(numbers[it]) for it in parts)
    link.receive(Packet(LINK, AT, noise), SECOND)
    if seen.reading is not None:
        assert seen.reading.pose is not None
        assert all(map(math.isfinite, (*seen.reading.pose.position, *seen.reading.pose.attitude)))


def _vision(value: float) -> bytes:
    """A whole VISION_POSITION_ESTIMATE of one number, with its check sum."""
    payload = struct.pack("<Q6f", 7, *[value] * 6)
    head = bytes((len(payload), 0, 0, 0, 1, 1, 102, 0, 0))
    crc = check_sum(head + payload + bytes((158,)))
    return b"\xfd" + head + payload + crc.to_bytes(2, "little")


def test_a_pose_of_a_few_bytes_is_read_with_the_zeros_that_were_cut() -> None:
    (pose,) = poses(_vision(0.0))
    assert (pose.stamp_us, pose.position, pose.attitude) == (7, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def test_mavlink_states_itself_that_it_jumped_or_failed() -> None:
    mavlink: Any = pytest.importorskip("pymavlink.dialects.v20.common")
    codec = mavlink.MAVLink(None, srcSystem=1, srcComponent=197)
    seen = body(up="z")
    link = MavlinkPoses(LINK, table("mavlink-pose"), [seen])

    def states(resets: int, quality: int, frame: int = 20, host: str = "127.0.0.1") -> None:
        message = codec.odometry_encode(
            0,
            frame,
            12,
            0.0,
            0.0,
            0.0,
            [1.0, 0.0, 0.0, 0.0],
            *[0.0] * 6,
            *[[math.nan] * 21] * 2,
            resets,
            6,
            quality,
        )
        link.receive(Packet(LINK, number_of(host, 9), message.pack(codec)), SECOND)

    states(1, 90, host="127.0.0.2")
    assert sighted(seen) is Sighting.UNKNOWN
    states(1, 90)
    states(1, 0)
    assert (seen.jumps, sighted(seen)) == (0, Sighting.SEEN)
    states(2, 90)
    assert seen.jumps == 1
    states(2, -1)
    assert (stated(seen), sighted(seen)) == (False, Sighting.LOST)
    states(2, 90, frame=12)
    assert sighted(seen) is Sighting.LOST


def test_up_is_as_the_robot_file_states() -> None:
    for up in Up:
        seen = body(up=up.value)
        world, _, listening = joined(seen, Cameras(noise_m=0.0, up=up))
        world.run(SECOND // 2)
        pose = listening.readings[-1].pose
        assert pose is not None
        assert pose.position[2] == pytest.approx(0.2, abs=1e-6)


@pytest.mark.parametrize(
    ("given_", "stated"),
    [
        ({"server": "motive:1510"}, "motive"),
        ({"server": "127.0.0.1"}, "must be HOST:PORT"),
        ({"driver": "mavlink-pose", "listen": "127.0.0.1:0"}, "give listen a port"),
    ],
)
def test_a_place_that_is_none_is_refused(given_: dict[str, str], stated: str) -> None:
    with pytest.raises(ValueError, match=stated):
        table(**{"driver": "natnet", "server": SERVER, **given_})


def served(link: NatNetLink, version: Version, now: int = 0) -> tuple[Packet, ...]:
    info = ServerInfo("Motive", (1, 0, 0, 0), (*version, 0, 0), 1_000_000)
    payload = messages.server_info_payload(info)
    return link.receive(Packet(LINK, AT, packet(MessageId.SERVERINFO, payload)), now)


def framed(frame: Frame, version: Version) -> Packet:
    return Packet(LINK, DATA, packet(MessageId.FRAMEOFDATA, frames.encoded(frame, version)))


def test_a_tilted_body_is_tilted_the_same_way_whatever_is_up() -> None:
    half = 0.1
    tilts = [(math.sin(half), 0.0, 0.0), (0.0, math.sin(half), 0.0), (0.0, 0.0, math.sin(half))]
    for x, y, z in tilts:
        seen = body(up="y")
        seen.seen((1.0, 0.3, -2.0), (x, z, -y, math.cos(half)), 0.0, 0, 0)
        assert seen.reading is not None
        assert seen.reading.pose is not None
        assert seen.reading.pose.attitude == pytest.approx((x, y, z, math.cos(half)))
        assert seen.reading.pose.position == pytest.approx((1.0, 2.0, 0.3))


def test_a_server_that_was_found_receives_that_someone_listens() -> None:
    link = NatNetLink(LINK, table(), [body(body=1)])
    served(link, V3_1)
    assert link.beat(0) == (Packet(LINK, AT, packet(MessageId.KEEPALIVE)),)


def test_names_are_requested_when_they_are_not_known_and_when_they_have_changed() -> None:
    requests = (Packet(LINK, AT, packet(MessageId.REQUEST_MODELDEF)),)
    link = NatNetLink(LINK, table(), [body(body="robot")])
    assert served(link, V3_1) == requests
    assert link.receive(framed(Frame(1), V3_1), 0) == ()
    assert link.receive(framed(Frame(2, params=FrameFlag.MODELS_CHANGED), V3_1), 0) == requests
    by_number = NatNetLink(LINK, table(), [body(body=1)])
    assert served(by_number, V3_1) == ()
    assert by_number.receive(framed(Frame(2, params=FrameFlag.MODELS_CHANGED), V3_1), 0) == ()


def test_a_server_that_is_another_one_now_is_read_in_its_version() -> None:
    seen = body(body=1)
    link = NatNetLink(LINK, table(), [seen])
    pose = RigidBody(1, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    for version in (V3_1, Version(4, 1), Version(2, 10)):
        served(link, version)
        link.receive(framed(Frame(1, bodies=(pose,), precise=(0, 0)), version), 0)
        assert sighted(seen) is Sighting.SEEN
        seen.missed(Sighting.LOST)
    assert link.refused == 0
