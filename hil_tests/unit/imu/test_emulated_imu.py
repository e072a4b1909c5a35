"""The emulated IMU: what it feels against closed forms, the part's errors, and its faults."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from emulators.imu.device import Imu
from emulators.imu.part import COUNTS_PER_MPS2, COUNTS_PER_RAD_S, Errors, MemsPart
from emulators.imu.sampled import EVERY, Sampled, lacking
from emulators.imu.truth import LEVEL, Felt, Posed, Vector, about_z, felt, posed
from firmware_bridge.families.imu.wire import ImuFrame, Status, decoded
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

DT = 0.005
REST = Felt((0.0, 0.0, 9.81), (0.0, 0.0, 0.0))
PERFECT = Errors(force_noise=0.0, rate_noise=0.0, force_bias=0.0, rate_bias=0.0)


def at(**values: float) -> Posed:
    return posed({"x": 0.0, "y": 0.0, "heading": 0.0, **values})


def moving(path: Callable[[float], dict[str, float]]) -> Felt:
    return felt([at(**path(1.0 + step * DT)) for step in (-1, 0, 1)], DT)


@pytest.mark.parametrize(
    ("values", "force"),
    [
        ({}, (0.0, 0.0, 1.0)),
        ({"pitch": 0.3}, (math.sin(0.3), 0.0, math.cos(0.3))),
        ({"roll": 0.3}, (0.0, math.sin(0.3), math.cos(0.3))),
        # Uphill along x of the room: the nose is up, the left side where it looks to the right.
        ({"slope": 0.3}, (math.sin(0.3), 0.0, math.cos(0.3))),
        ({"slope": 0.3, "heading": math.pi}, (-math.sin(0.3), 0.0, math.cos(0.3))),
        ({"slope": 0.3, "heading": -math.pi / 2}, (0.0, math.sin(0.3), math.cos(0.3))),
        ({"slope": 0.3, "slope_heading": math.pi / 2}, (0.0, math.sin(0.3), math.cos(0.3))),
        # What rocks on a slope adds up.
        ({"slope": 0.3, "pitch": 0.2}, (math.sin(0.5), 0.0, math.cos(0.5))),
    ],
)
def test_gravity_at_rest(values: dict[str, float], force: Vector) -> None:
    found = moving(lambda _: values)
    assert [one / 9.81 for one in found.force] == pytest.approx(force, abs=1e-9)
    assert found.rate == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_acceleration_ahead_whatever_the_heading() -> None:
    found = moving(lambda t: {"x": 0.25 * t * t, "y": 0.25 * math.sqrt(3) * t * t, "heading": math.pi / 3})
    assert found.force == pytest.approx((1.0, 0.0, 9.81), abs=1e-6)


def test_a_circle_to_the_left() -> None:
    # 0.5 m/s on 1 m: 0.25 m/s2 to its middle, 0.5 rad/s.
    found = moving(lambda t: {"x": math.sin(t / 2), "y": -math.cos(t / 2), "heading": t / 2})
    assert found.force == pytest.approx((0.0, 0.25, 9.81), abs=1e-5)
    assert found.rate == pytest.approx((0.0, 0.0, 0.5), abs=1e-9)


def test_rates_of_a_body_that_rocks_and_falls() -> None:
    assert moving(lambda t: {"pitch": 2.0 * t - 2.0}).rate == pytest.approx((0.0, -2.0, 0.0), abs=1e-6)
    assert moving(lambda t: {"roll": 2.0 * t}).rate == pytest.approx((2.0, 0.0, 0.0), abs=1e-6)


def test_a_floor_that_tilts_below_it_lifts_it_nowhere_and_turns_it() -> None:
    found = moving(lambda t: {"x": 100.0, "slope": 0.1 * (t - 1.0)})
    assert found.force == pytest.approx((0.0, 0.0, 9.81), abs=1e-6)
    assert found.rate == pytest.approx((0.0, -0.1, 0.0), abs=1e-9)


def test_a_robot_on_a_wall_by_its_quaternion() -> None:
    half = math.sqrt(0.5)
    # Nose upwards: a quarter turn to the negative side about y.
    wall = {"x": 1.0, "y": 2.0, "z": 3.0, "qx": 0.0, "qy": -half, "qz": 0.0, "qw": half}
    pose = posed(wall)
    assert felt([pose, pose, pose], DT).force == pytest.approx((9.81, 0.0, 0.0), abs=1e-9)


def test_outputs_that_a_plant_lacks() -> None:
    assert lacking(("x", "y", "heading", "speed")) == ()
    assert lacking(("x", "y", "z", "qx", "qy", "qz", "qw")) == ()
    assert lacking(("speed", "x")) == ("y", "heading")


def test_a_part_counts_and_its_range_ends() -> None:
    part = MemsPart(np.random.default_rng(0), LEVEL, PERFECT)
    assert part.counts(REST) == ((0, 0, 8192), (0, 0, 0), Status(0))
    assert pytest.approx(8192) == COUNTS_PER_MPS2 * 9.81
    assert COUNTS_PER_RAD_S * math.radians(1.0) == pytest.approx(65.5)
    top, bottom = 32767 / COUNTS_PER_MPS2, -32768 / COUNTS_PER_RAD_S
    assert part.counts(Felt((top, 0, 0), (0, bottom, 0))) == ((32767, 0, 0), (0, -32768, 0), Status(0))
    beyond = Felt((top + 1.0, 0, 0), (0, bottom - 0.1, 0))
    clipped = Status.FORCE_CLIPPED | Status.RATE_CLIPPED
    assert part.counts(beyond) == ((32767, 0, 0), (0, -32768, 0), clipped)


def test_a_part_that_is_mounted_a_quarter_turn_to_the_left() -> None:
    part = MemsPart(np.random.default_rng(0), about_z(math.pi / 2), PERFECT)
    force, _, _ = part.counts(Felt((9.81 / 2, 0.0, 9.81), (0.0, 0.0, 0.0)))
    # What is ahead of the robot is to the right of the sensor.
    assert force == (0, -4096, 8192)


def test_noise_and_biases_are_of_their_size_and_of_the_seed() -> None:
    def drawn(seed: int) -> np.ndarray:
        part = MemsPart(np.random.default_rng(seed), LEVEL)
        rows = [part.counts(REST)[:2] for _ in range(2_000)]
        return np.array([(*force, *rate) for force, rate in rows], dtype=float)

    values = drawn(1)
    assert (values == drawn(1)).all()
    assert (values != drawn(2)).any()
    spread = values.std(axis=0)
    assert spread[:3] == pytest.approx(0.0033 * 8192, rel=0.06)
    assert spread[3:] == pytest.approx(0.05 * 65.5, rel=0.06)
    means = np.array([drawn(seed).mean(axis=0) for seed in range(40)])
    means[:, 2] -= 8192
    assert means[:, :3].std() == pytest.approx(0.003 * 8192, rel=0.25)
    assert means[:, 3:].std() == pytest.approx(0.3 * 65.5, rel=0.25)


class Driven:
    """A plant that accelerates ahead with 2 m/s2, and physics that has events of its own."""

    output_names = ("speed", "x", "y", "heading")
    variables = {"slope": None}  # noqa: RUF012 - as a plant's

    def __init__(self) -> None:
        self.now: Nanoseconds = 0
        self.events = [7 * MILLISECOND, 12 * MILLISECOND]

    @property
    def outputs(self) -> list[float]:
        seconds = self.now / SECOND
        return [2.0 * seconds, seconds * seconds, 0.0, 0.0]

    def read(self, name: str) -> float:
        assert name == "slope"
        return 0.0

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        if self.events and self.events[0] <= until:
            self.now = self.events.pop(0)
            return self.now, ("drive",)
        self.now = until
        return until, ()


def test_samples_are_taken_between_the_events_of_the_physics() -> None:
    plant = Driven()
    sampled = Sampled(plant, plant)
    assert sampled.advance(0) == (0, ())
    # The first one: it stands where it stands.
    assert sampled(0).force == pytest.approx(REST.force)
    assert sampled.advance(SECOND) == (7 * MILLISECOND, ("drive",))
    assert sampled.advance(SECOND) == (12 * MILLISECOND, ("drive",))
    assert sampled.advance(SECOND) == (SECOND, ())
    assert sampled(SECOND).force == pytest.approx((2.0, 0.0, 9.81), abs=1e-6)
    # On a busy machine the frame of an earlier instant is made later; one of long ago is the oldest.
    assert sampled(SECOND // 2).force == pytest.approx((2.0, 0.0, 9.81), abs=1e-6)
    assert sampled(-EVERY).force == pytest.approx(REST.force)


def frames_of(imu: Imu, until: Nanoseconds) -> list[ImuFrame]:
    sent = imu.wake(until).sent
    assert {packet.link for packet in sent} <= {SERIAL}
    found = [decoded(packet.payload) for packet in sent]
    assert None not in found
    return [one for one in found if one is not None]


def emulated(errors: Errors | None = None) -> Imu:
    def truth(now: Nanoseconds) -> Felt:
        return Felt((now / SECOND, 0.5, 9.81), (0.1, -0.1, 0.0))

    return Imu(truth, MemsPart(np.random.default_rng(0), LEVEL, errors))


def test_a_frame_every_10_ms_with_its_number_and_its_time() -> None:
    imu = emulated(PERFECT)
    frames = frames_of(imu, 50 * MILLISECOND)
    assert [one.sequence for one in frames] == [0, 1, 2, 3, 4, 5]
    assert [one.stamp_ms for one in frames] == [0, 10, 20, 30, 40, 50]
    assert [one.force[0] for one in frames] == [round(0.01 * step * COUNTS_PER_MPS2) for step in range(6)]
    assert imu.wake(55 * MILLISECOND).wake_at == 60 * MILLISECOND
    assert imu.receive(Packet(SERIAL, 0, b"hello"), 55 * MILLISECOND).sent == ()


def test_counter_and_clock_wrap() -> None:
    imu = emulated(PERFECT)
    frames = frames_of(imu, 2_570 * MILLISECOND)
    assert [one.sequence for one in frames][-3:] == [255, 0, 1]


def test_a_frozen_imu_repeats_its_values_and_goes_on_as_if_nothing_had_been() -> None:
    healthy, imu = emulated(), emulated()
    expected = frames_of(healthy, 300 * MILLISECOND)
    found = frames_of(imu, 100 * MILLISECOND)
    imu.frozen = True
    found += frames_of(imu, 200 * MILLISECOND)
    imu.frozen = False
    found += frames_of(imu, 300 * MILLISECOND)
    assert found[:11] == expected[:11]
    last = expected[10]
    assert found[11:21] == [replace_values(one, last) for one in expected[11:21]]
    assert found[21:] == expected[21:]


def replace_values(frame: ImuFrame, values: ImuFrame) -> ImuFrame:
    return frame._replace(force=values.force, rate=values.rate, status=values.status)


def test_swapped_axes_are_x_and_y_of_both() -> None:
    healthy, imu = emulated(), emulated()
    imu.swapped = True
    for one, other in zip(frames_of(healthy, SECOND), frames_of(imu, SECOND), strict=True):
        (ax, ay, az), (gx, gy, gz) = one.force, one.rate
        assert other == one._replace(force=(ay, ax, az), rate=(gy, gx, gz))


def test_a_silent_imu_sends_nothing_and_its_counter_stays() -> None:
    imu = emulated()
    assert len(frames_of(imu, 100 * MILLISECOND)) == 11
    imu.silent = True
    assert frames_of(imu, 200 * MILLISECOND) == []
    imu.silent = False
    frames = frames_of(imu, 220 * MILLISECOND)
    assert [(one.sequence, one.stamp_ms) for one in frames] == [(11, 210), (12, 220)]


def test_errors_are_those_of_the_class_unless_given() -> None:
    part = MemsPart(np.random.default_rng(0), LEVEL)
    assert part.errors == Errors()
    assert replace(part.errors, rate_bias=0.0) != Errors()
