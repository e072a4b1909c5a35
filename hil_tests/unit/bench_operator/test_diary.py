"""The operator's diary of received messages: answers with their reasons, texts, odometry, values."""

import math

import pytest

from emulators.bench.log import Subject
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.motion.pose import Pose
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.safety.interlock_base import InterlockBase
from firmware_bridge.safety.snapshot import ActiveInterlock
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.bench_operator.joined import join, mission


def test_a_refusal_and_its_reason_are_in_the_diary() -> None:
    joined = join(mission("1.0 emergency_stop = true", "2.0 arm = true"))
    joined.run(3.0)
    diary = joined.driver.diary
    assert diary.texts(Subject.STEP) == ["emergency_stop = true", "arm = true"]
    assert diary.texts(Subject.ANSWERED) == ["emergency stop: accepted", "arm: denied"]
    [reported] = [entry for entry in diary.entries if entry.kind is Subject.REPORTED]
    assert (reported.at, reported.text, reported.severity) == (2 * SECOND, "the emergency stop is latched", 4)


def test_long_texts_are_read_whole() -> None:
    joined = join(mission("1.0 arm = true"))
    reason = "a reason that is much longer than the fifty characters of one STATUSTEXT, to be sure"
    joined.robotlike.interlock_events = (ActiveInterlock("long", reason, InterlockBase("long", ""), 0),)
    joined.run(0.1)
    assert joined.driver.diary.texts(Subject.REPORTED) == [reason]


def test_arming_shows_in_the_heartbeat() -> None:
    joined = join(mission("1.5 arm = true"))
    seen = []
    for until_s in (1.0, 2.1):
        joined.run(until_s)
        seen.append(joined.driver.diary.armed)
    assert seen == [False, True]
    assert joined.driver.diary.texts(Subject.STATUS) == ["disarmed", "armed"]


def test_odometry_arrives_in_the_robots_own_signs() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.robotlike.pose = Pose(1.0, 2.0, 0.5)
    joined.run(0.1)
    place = joined.driver.diary.odometry[-1]
    assert (place.measured_at, place.x_m, place.y_m) == (100 * MILLISECOND, 1.0, 2.0)
    assert (place.heading_rad, place.speed_mps, place.yaw_rate_rad_s) == pytest.approx(
        (0.5, 0.3, 0.4), abs=1e-6
    )


def test_values_and_parameters_are_read() -> None:
    joined = join(mission("1.0 arm = true"))
    joined.run(1.0)
    diary = joined.driver.diary
    assert diary.values["STEER"] == pytest.approx(math.degrees(0.1), abs=1e-5)
    assert diary.values["ZPOS"] == pytest.approx(0.2)
    assert diary.parameters["SPD_MAX"] == 0.5
    assert len(diary.parameters) == 18


def test_another_system_is_not_our_robot() -> None:
    joined = join(mission("1.0 arm = true"))
    foreign_node = Codec(7, 1).encode(dialect.MAVLink_statustext_message(2, b"boo"))
    joined.driver.receive(Packet(OPERATOR, 0, foreign_node), 0)
    joined.driver.receive(Packet(OPERATOR, 0, b"\xfd junk"), 0)
    assert joined.driver.diary.entries == []
