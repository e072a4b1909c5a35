"""The bridge's end of an IMU's line: readings, and each reason for having none, at its boundary."""

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.imu.driver.axes import length
from firmware_bridge.families.imu.driver.link_drivers import imu_link_drivers
from firmware_bridge.families.imu.driver.plausibility import BEYOND_MS, STUCK
from firmware_bridge.families.imu.wire import WRAP_MS, ImuFrame, Status, encoded
from firmware_bridge.node import LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.imu.imu_bench import LINK, SETTLED, G, Line, counts, quantity, upwards

STILL = "all six values are the same in 10 frames"


def settled(**more: object) -> Line:
    line = Line(**more)
    line.frames(SETTLED)
    assert line.link.problem == ""
    return line


def test_readings_begin_when_the_filter_has_settled() -> None:
    line = Line()
    assert line.link.problem == "no frame was received"
    line.frames(SETTLED - 1)
    assert (line.value("pitch"), line.link.problem) == (None, "settling")
    line.frames(1)
    assert line.degrees("pitch") == pytest.approx(0.0, abs=0.01)
    assert line.link.problem == ""


def test_all_quantities_in_the_robot_s_axes() -> None:
    line = settled()
    # One deg/s is 65.5 counts; more than 3 deg/s about z is a turn.
    line.frames(1, force=(819, -1638, 8192), rate=(131, -131, 655))
    values = [line.value(f"acceleration_{axis}") for axis in "xyz"]
    # The sensor's last bit trembles.
    assert values == pytest.approx([0.981, -1.962, 9.81], abs=3e-3)
    rates = [line.degrees(f"rate_{axis}") for axis in "xyz"]
    assert rates == pytest.approx([2.0, -2.0, 10.0])


def test_a_reading_s_time_is_the_sample_s() -> None:
    line = settled(latency_ms=12.0)
    reading = line.quantities["pitch"].reading  # type: ignore[index] # a StrEnum is its text
    assert reading is not None
    assert (reading.sampled_at, reading.received_at) == (line.now - 12 * MILLISECOND, line.now)


COUNTS = st.integers(-0x8000, 0x7FFF)
ENDS = st.sampled_from((-0x8000, -G, 0, G, 0x7FFF))
TRIPLES = st.tuples(ENDS, ENDS, ENDS) | st.tuples(COUNTS, COUNTS, COUNTS)
LIES = st.lists(
    st.tuples(TRIPLES, TRIPLES, st.integers(0, 7), st.sampled_from((0, 1, 10, 100, 101, -1))), max_size=30
)


@given(LIES, st.sampled_from((0, SETTLED)))
@example([((0, 0, G), (0, 0, 0), 0, 10), ((0, 0, -G), (0, 0, 0), 0, 10)], 0)
@example([((0, 0, 0), (0, 0, 0), 0, 10), ((0, 0, 0), (0, 0, 0), 0, 10)], 0)
def test_whatever_a_device_sends_there_are_finite_readings_or_none(
    lies: list[tuple[tuple[int, int, int], tuple[int, int, int], int, int]],
    honest: int,
) -> None:
    line, stamp = Line(), 10_000
    line.frames(honest)
    for sequence, (force, rate, status, later) in enumerate(lies):
        stamp = (stamp + later) % WRAP_MS
        frame = ImuFrame(sequence, status, stamp, force, rate)
        line.link.receive(Packet(LINK, 0, encoded(frame)), line.now)
        for one in line.quantities.values():
            assert one.reading is None or math.isfinite(one.reading.value)
        assert math.isclose(length(line.link.attitude.up), 1.0, rel_tol=1e-6)


def test_a_bias_of_the_robot_file_is_subtracted() -> None:
    line = Line()
    other = quantity("pitch", bias=0.05)
    line.link = type(line.link)(LINK, line.link._table, [*line.quantities.values(), other])  # noqa: SLF001 - its own
    line.frames(SETTLED, force=counts(upwards(0.2, 0.0)))
    assert other.reading is not None
    assert other.reading.value == pytest.approx((line.value("pitch") or 0.0) - 0.05)


@pytest.mark.parametrize(
    ("mounted", "force"),
    [
        ({}, (0.5, 0.0, 0.8660254)),
        # A quarter turn to the left: x of the sensor is the robot's left, its y looks back.
        ({"about_z_deg": 90.0}, (0.0, -0.5, 0.8660254)),
        ({"about_z_deg": 180.0}, (-0.5, 0.0, 0.8660254)),
        # Upside down, turned over about x.
        ({"about_x_deg": 180.0}, (0.5, 0.0, -0.8660254)),
        # On its nose: x of the sensor looks down.
        ({"about_y_deg": 90.0}, (-0.8660254, 0.0, 0.5)),
        # First about x, then about z: y of the sensor points upwards, then x to the left.
        ({"about_x_deg": 90.0, "about_z_deg": 90.0}, (0.0, 0.8660254, 0.5)),
        ({"about_z_deg": 45.0}, (0.3535534, -0.3535534, 0.8660254)),
    ],
)
def test_a_nose_30_degrees_up_however_the_sensor_is_mounted(
    mounted: dict[str, float], force: tuple[float, float, float]
) -> None:
    line = Line(mounted=mounted)
    line.frames(SETTLED, force=counts(force))
    assert line.degrees("pitch") == pytest.approx(30.0, abs=0.02)
    assert line.degrees("roll") == pytest.approx(0.0, abs=0.02)


def test_a_stuck_sensor_is_silent_from_its_tenth_frame_on_and_comes_back() -> None:
    line = settled()
    line.trembles = False
    line.frames(STUCK - 1, force=(2, 0, G))
    assert line.value("pitch") is not None
    line.frames(1, force=(2, 0, G))
    assert line.value("pitch") is None
    assert line.link.problem.startswith(STILL)
    assert STILL in line.link.remark
    line.trembles = True
    line.frames(SETTLED - 1)
    assert line.value("pitch") is None
    line.frames(1)
    assert line.degrees("pitch") == pytest.approx(0.0, abs=0.01)
    assert line.link.remark == ""


def test_one_bit_in_ten_frames_is_enough_to_be_alive() -> None:
    line = settled()
    line.trembles = False
    for rest in range(10):
        line.frames(STUCK - 1, rate=(0, 0, (rest + 1) % 2))
    assert line.value("pitch") is not None


@pytest.mark.parametrize(
    ("g", "lies"), [(0.499, True), (0.501, False), (1.0, False), (1.999, False), (2.001, True)]
)
def test_a_length_beyond_half_or_double_of_1_g_is_no_acceleration_of_a_robot(g: float, *, lies: bool) -> None:
    line = settled()
    line.frames(1 + BEYOND_MS // 10, force=(0, 0, round(g * G)))
    assert (line.value("pitch") is None) is lies
    if lies:
        assert "between 0.5 and 2 g is possible" in line.link.problem


def test_a_shock_may_last_200_ms() -> None:
    line = settled()
    line.frames(BEYOND_MS // 10, force=(0, 0, 3 * G))
    assert line.value("pitch") is not None
    line.frames(1, force=(0, 0, 3 * G))
    assert line.value("pitch") is None
    line.frames(SETTLED)
    assert line.value("pitch") is not None


def test_two_shocks_of_200_ms_are_not_one_of_400() -> None:
    line = settled()
    for _ in range(2):
        line.frames(BEYOND_MS // 10, force=(0, 0, 3 * G))
        line.frames(1)
    assert line.value("pitch") is not None


@pytest.mark.parametrize(
    ("status", "problem"),
    [
        (Status.FAILED, "its self-test has failed"),
        (Status.RATE_CLIPPED, "a rate was beyond its range"),
        (Status.FORCE_CLIPPED, ""),
        (0xF8, ""),
    ],
)
def test_flags_of_the_device(status: int, problem: str) -> None:
    line = settled()
    line.status = status
    line.frames(1)
    assert line.link.problem == problem
    assert (line.value("pitch") is None) is bool(problem)


def test_a_silent_line_has_no_readings_after_its_time_and_none_before() -> None:
    line = settled()
    line.passes(99)
    assert line.value("pitch") is not None
    line.passes(1)
    assert (line.value("pitch"), line.link.problem) == (None, "no frame for 100 ms")
    assert line.link.wake_at > line.now + 10**12
    line.frames(SETTLED)
    assert line.value("pitch") is not None


def test_the_sensor_s_own_time_counts_too() -> None:
    line = settled()
    drivers = LinkDrivers(line.link, find("rars+imu").links["imu"], (), line.quantities.values())
    assert "pitch" in drivers.readings(line.now + 100 * MILLISECOND)
    assert drivers.readings(line.now + 101 * MILLISECOND) == {}


def test_a_damaged_frame_is_dropped_and_counted() -> None:
    line = settled()
    (data,) = line.written(1, force=(0, 0, 3 * G))
    line.link.receive(Packet(LINK, 0, data[:-1] + bytes([data[-1] ^ 1])), line.now)
    assert (line.link.refused, line.link.missing) == (1, 0)
    line.frames(1)
    assert (line.link.refused, line.link.missing) == (1, 1)
    assert line.value("acceleration_z") == pytest.approx(9.81)


@pytest.mark.parametrize(("gap_ms", "restarts"), [(90, False), (91, True)])
def test_a_gap_longer_than_the_silence_begins_the_filter_again(gap_ms: int, *, restarts: bool) -> None:
    line = settled()
    # The frames are missing, and the line is not: as where the bridge was suspended.
    line.now += gap_ms * MILLISECOND
    line.frames(1)
    assert (line.value("pitch") is None) is restarts


def test_a_device_that_starts_again_begins_the_filter_again() -> None:
    line = settled()
    device, line.now, line.number = line.now, 0, 0
    line.frames(1)
    assert (line.value("pitch"), line.link.problem) == (None, "settling")
    line.frames(SETTLED)
    assert line.value("pitch") is not None
    assert line.now < 2 * device


def test_a_robot_that_moves_at_its_start_is_reported_so() -> None:
    line = Line()
    for turn in range(30):
        line.frames(10, rate=(0, 0, 65 * (turn % 5)))
    assert line.value("pitch") is None
    assert "the robot moves: the bias of the rates is not known" in line.link.remark


def test_a_cable_that_is_pulled_stops_no_one_unless_the_robot_file_has_it_so() -> None:
    for stops, lost in (((), None), (("base",), "the serial adapter is unplugged")):
        line = settled(stops=stops)
        line.link.receive(Packet(LINK, LINE_LOST, b""), line.now)
        assert (line.link.lost, line.value("pitch")) == (lost, None)
        line.link.receive(Packet(LINK, LINE_BACK, b""), line.now)
        assert line.link.lost is None
        line.frames(SETTLED)
        assert line.value("pitch") is not None


def test_the_readings_are_those_of_the_robot_file() -> None:
    drivers = imu_link_drivers(find("rars+imu"), "imu")
    assert [one.sensor.name for one in drivers.sensors] == ["pitch", "roll"]
    assert [one.measure(0) for one in drivers.sensors] == [(), ()]
    assert drivers.drivers == ()
    assert drivers.sampled(5)


def test_degrees_are_no_radians() -> None:
    line = Line()
    line.frames(SETTLED, force=counts(upwards(0.0, math.radians(20.0))))
    assert line.value("roll") == pytest.approx(math.radians(20.0), abs=1e-3)
