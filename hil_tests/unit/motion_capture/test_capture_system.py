"""The emulated capture system: what it shows of the truth, when, and to whom."""

import math
from dataclasses import replace

import numpy as np
import pytest

from emulators.motion_capture.bodies import Circling, Standing, TrackedBody
from emulators.motion_capture.exposure import Cameras, Hidden, Lost, Swapped, Up
from emulators.motion_capture.server import PATIENCE
from emulators.motion_capture.system import COMMAND, DATA, MotionCapture, Timing
from emulators.wires import DatagramWire
from emulators.world import World
from firmware_bridge.families.motion_capture.wire import frame as frames
from firmware_bridge.families.motion_capture.wire import messages, models
from firmware_bridge.families.motion_capture.wire.frame import BodyFlag, Frame, MarkerFlag
from firmware_bridge.families.motion_capture.wire.layout import Version
from firmware_bridge.families.motion_capture.wire.messages import Connect, MessageId, packet, split
from firmware_bridge.families.motion_capture.wire.models import RigidBodyModel
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, from_seconds, to_seconds

ROUND = Circling(1.0, math.tau / 4.0, 0.2)
V3_1 = Version(3, 1)
EXACT = Cameras(noise_m=0.0, up=Up.Z)
CLIENT = 0x7F00_0001_C000


class Listener:
    """Client that connects, and keeps the received packets."""

    def __init__(self, version: Version = V3_1) -> None:
        self.version = version
        self.received: list[tuple[Nanoseconds, Frame]] = []

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        message, payload = split(packet.payload)
        if message is MessageId.FRAMEOFDATA:
            self.received.append((now, frames.decoded(payload, self.version)))
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        del now
        return Reaction((Packet(COMMAND, CLIENT, packet(MessageId.CONNECT)),))


def watched(
    cameras: Cameras = EXACT, seed: int = 1, timing: Timing | None = None, version: Version = V3_1
) -> tuple[World, MotionCapture, Listener]:
    world, wire = World(), DatagramWire(name="capture")
    bodies = [TrackedBody(7, "robot", ROUND), TrackedBody(8, "box", Standing())]
    system = MotionCapture(
        bodies,
        np.random.default_rng(seed),
        version=version,
        cameras=cameras,
        timing=timing,
        data_link=COMMAND,
    )
    listener = Listener(version)
    world.attach("capture", system, {COMMAND: wire})
    world.attach("listener", listener, {COMMAND: wire})
    return world, system, listener


def test_it_shows_where_the_body_was_at_the_exposure_and_leaves_five_ms_later() -> None:
    world, _, listener = watched()
    world.run(SECOND)
    assert len(listener.received) == pytest.approx(238, abs=1)
    for now, frame in listener.received:
        exposed = frame.number * SECOND // 240
        angle = math.tau * to_seconds(exposed) / 4.0
        body = frame.bodies[0]
        assert body.position == pytest.approx((math.cos(angle), math.sin(angle), 0.2), abs=1e-6)
        assert 2.0 * math.atan2(body.attitude[2], body.attitude[3]) == pytest.approx(angle + math.pi / 2.0)
        assert (frame.sent - frame.exposed) / 1e7 == pytest.approx(to_seconds(now - exposed), abs=1e-6)
        assert body.params == BodyFlag.TRACKED
    ages = [to_seconds(now - frame.number * SECOND // 240) * 1e3 for now, frame in listener.received]
    assert np.mean(ages) == pytest.approx(5.4, abs=0.1)
    assert np.std(ages) == pytest.approx(0.25, abs=0.08)


def test_its_noise_is_what_was_requested_and_no_error_in_the_mean() -> None:
    world, _, listener = watched(Cameras(noise_m=0.0002, up=Up.Z))
    world.run(4 * SECOND)
    seen = np.array([frame.bodies[1].position for _, frame in listener.received])
    assert np.std(seen, axis=0) == pytest.approx([0.0002] * 3, rel=0.1)
    assert np.abs(np.mean(seen, axis=0)).max() < 3e-5


def test_y_up_is_the_room_turned() -> None:
    both = []
    for up in Up:
        world, _, listener = watched(replace(EXACT, up=up))
        world.run(SECOND)
        both.append(listener.received[-1][1])
    y_up, z_up = both
    (x, y, z), (qx, qy, qz, qw) = z_up.bodies[0].position, z_up.bodies[0].attitude
    assert y_up.bodies[0].position == (x, z, -y)
    assert y_up.bodies[0].attitude == (qx, qz, -qy, qw)


@pytest.mark.parametrize("lost", Lost)
def test_a_hidden_body_has_no_flag_and_the_pose_that_was_requested(lost: Lost) -> None:
    world, system, listener = watched(replace(EXACT, lost=lost))
    system.hide(Hidden(7, SECOND, 2 * SECOND))
    world.run(3 * SECOND)
    by_number = {frame.number: frame for _, frame in listener.received}
    last, first, back = (by_number[number].bodies[0] for number in (239, 240, 480))
    assert (last.params, first.params, back.params) == (1, 0, 1)
    expected = {Lost.FREEZE: last.position, Lost.ZERO: (0.0, 0.0, 0.0), Lost.NAN: (math.nan,) * 3}[lost]
    assert first.position == pytest.approx(expected, nan_ok=True)
    assert by_number[300].bodies[1].params == 1
    assert (
        by_number[300].markers[0].params
        == MarkerFlag.OCCLUDED | MarkerFlag.POINT_CLOUD | MarkerFlag.HAS_MODEL
    )


def test_swapped_markers_are_a_jump_that_counts_as_tracked() -> None:
    world, system, listener = watched()
    system.hide(Swapped(8, SECOND, 2 * SECOND, aside=(0.3, 0.0, 0.0), turn=math.pi / 2.0))
    world.run(3 * SECOND)
    by_number = {frame.number: frame.bodies[1] for _, frame in listener.received}
    assert by_number[239].position == by_number[480].position == (0.0, 0.0, 0.0)
    jumped = by_number[240]
    assert jumped.position == pytest.approx((0.3, 0.0, 0.0))
    assert 2.0 * math.atan2(jumped.attitude[2], jumped.attitude[3]) == pytest.approx(math.pi / 2.0)
    assert jumped.params == BodyFlag.TRACKED


def test_a_disturbance_leaves_all_other_chance_as_it_was() -> None:
    runs = []
    for hidden in (False, True):
        world, system, listener = watched(Cameras(up=Up.Z))
        if hidden:
            system.hide(Hidden(7, 0))
        world.run(SECOND)
        runs.append([(now, frame.bodies[1]) for now, frame in listener.received])
    assert runs[0] == runs[1]


def test_one_seed_is_one_run_and_a_run_put_back_goes_on_the_same() -> None:
    world, _, listener = watched(Cameras())
    world.run(SECOND)
    moment, before = world.snapshot(), len(listener.received)
    world.run(2 * SECOND)
    after = listener.received[before:]
    world.restore(moment)
    assert len(listener.received) == before
    world.run(2 * SECOND)
    assert listener.received[before:] == after
    other, _, same = watched(Cameras())
    other.run(2 * SECOND)
    assert same.received == listener.received


def requested(
    system: MotionCapture, message: MessageId, payload: bytes = b"", now: Nanoseconds = 0
) -> tuple[MessageId, bytes] | None:
    sent = system.receive(Packet(COMMAND, CLIENT, packet(message, payload)), now).sent
    assert all((it.link, it.address) == (COMMAND, CLIENT) for it in sent)
    return split(sent[0].payload) if sent else None


@pytest.mark.parametrize("version", [Version(2, 10), Version(3, 1), Version(4, 1)])
def test_it_serves_in_its_version(version: Version) -> None:
    world, system, listener = watched(version=version)
    world.run(from_seconds(0.1))
    assert listener.received
    assert all(frame.bodies[0].id == 7 for _, frame in listener.received)
    answer = requested(system, MessageId.CONNECT)
    assert answer is not None
    assert messages.server_info(answer[1]).version == version
    answer = requested(system, MessageId.REQUEST_MODELDEF)
    assert answer is not None
    assert models.body_named(models.decoded(answer[1], version), "robot") == 7
    assert RigidBodyModel in {type(model) for model in models.decoded(answer[1], version)}


@pytest.mark.parametrize(
    ("server", "wants", "spoken"),
    [
        (Version(4, 1), (3, 1, 0, 0), Version(3, 1)),
        (Version(4, 1), (0, 0, 0, 0), Version(4, 1)),
        (Version(3, 1), (4, 1, 0, 0), Version(3, 1)),
        (Version(4, 0), (4, 4, 0, 0), Version(4, 0)),
    ],
)
def test_a_client_may_choose_from_4_0_on(server: Version, wants: messages.Bytes4, spoken: Version) -> None:
    system = MotionCapture([TrackedBody(1, "a", Standing())], np.random.default_rng(0), version=server)
    connect = messages.connect_payload(Connect("c", (1, 0, 0, 0), (4, 4, 0, 0), wants))
    answer = requested(system, MessageId.CONNECT, connect)
    assert answer is not None
    assert messages.server_info(answer[1]).version == spoken


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        ("FrameRate", (MessageId.RESPONSE, b"\0\0\x70\x43")),
        ("UnitsToMillimeters", (MessageId.RESPONSE, b"\0\0\x7a\x44")),
        ("CurrentMode", (MessageId.RESPONSE, b"\0\0\0\0")),
        ("Bitstream", (MessageId.RESPONSE, b"Bitstream,4.1.0\0")),
        ("Bitstream,3.1", (MessageId.RESPONSE, b"\0\0\0\0")),
        ("Bitstream,5.0", (MessageId.UNRECOGNIZED_REQUEST, b"")),
        ("Bitstream,x", (MessageId.RESPONSE, b"\1\0\0\0")),
        ("TestRequest", (MessageId.UNRECOGNIZED_REQUEST, b"")),
    ],
)
def test_commands_are_answered_by_rows(command: str, answer: tuple[MessageId, bytes]) -> None:
    system = MotionCapture([TrackedBody(1, "a", Standing())], np.random.default_rng(0), version=Version(4, 1))
    requested(system, MessageId.CONNECT)
    assert requested(system, MessageId.REQUEST, messages.text_payload(command)) == answer


def test_the_clock_is_reported_and_a_client_that_falls_silent_is_dropped() -> None:
    system = MotionCapture([TrackedBody(1, "a", Standing())], np.random.default_rng(0))
    requested(system, MessageId.CONNECT)
    echo = requested(system, MessageId.ECHOREQUEST, messages.echo_request(99), 2 * SECOND)
    assert echo is not None
    client, ticks = messages.echo_of(echo[1])
    assert (client, ticks) == (99, 123_456_789_000 + 20_000_600)
    assert {it.link for it in system.wake(3 * SECOND).sent} == {DATA}
    assert requested(system, MessageId.KEEPALIVE, now=3 * SECOND) is None
    assert system.wake(3 * SECOND + PATIENCE).sent
    assert not system.wake(3 * SECOND + PATIENCE + 20 * MILLISECOND).sent
    requested(system, MessageId.CONNECT, now=20 * SECOND)
    requested(system, MessageId.DISCONNECT, now=20 * SECOND)
    assert not system.wake(21 * SECOND).sent


def test_garbage_is_answered_and_no_one_is_served_for_it() -> None:
    system = MotionCapture([TrackedBody(1, "a", Standing())], np.random.default_rng(0))
    for noise in (b"", b"\0", b"\xff\xff\0\0", b"\0\0\xff\xff", packet(MessageId.ECHOREQUEST)):
        sent = system.receive(Packet(COMMAND, CLIENT, noise), 0).sent
        assert [split(it.payload)[0] for it in sent] == [MessageId.UNRECOGNIZED_REQUEST]
    assert system.server.refused == 5
    assert not system.server.clients(0)
