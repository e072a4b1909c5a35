"""One drives: what a second station may do to a robot that someone drives, and how control passes on."""

import pytest

from hil_tests.scenarios.foreign_node import ARM, CLEAR, CONTROL, ForeignNode
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, step

ALONE = {"seconds": 120, "seed": 1}
"""With a seed of its own a ride has a bench of its own, on which a third party may sit down."""
DRIVES = step(4.0, speed_mps=0.3)
ACCEPTED, DENIED, FAILED = 0, 2, 4
STANDS = 31010
FORCE = 21196.0


def beside(ride: Ride, **who: int) -> ForeignNode:
    return ForeignNode(**who).joins(ride)


@pytest.mark.long(keeps=["the same ids"])
@pytest.mark.parametrize("who", [{}, {"system": 255}], ids=["other ids", "the same ids"])
def test_a_second_station_takes_nothing_from_who_drives(rides: Ridden, who: dict[str, int]) -> None:
    ride = rides(ARMED, DRIVES, **ALONE)
    other = beside(ride, **who)
    other.talks(
        ride, 6.0, (ARM, (0.0,)), (193, (0.0,)), (176, (1.0, 4.0)), (181, (1.0, 1.0)), (CONTROL, (1.0,))
    )
    ride.runs_until(10.0)
    slowest = min(row["speed_mps"] for row in ride.rows(6.0, 10.0))
    assert slowest == pytest.approx(0.3, rel=0.02)
    # All nodes on this wire receive everything: of the same ids it is taken for the first one's answer.
    other.results.pop(STANDS, None)
    assert other.results == {ARM: DENIED, 193: DENIED, 176: DENIED, 181: DENIED, CONTROL: FAILED}
    assert ride.now["armed"]


@pytest.mark.long(keeps=["kill"])
@pytest.mark.parametrize(
    "order", [(185, (1.0,)), (CLEAR, (0.0,)), (ARM, (0.0, FORCE))], ids=["terminate", "safe", "kill"]
)
def test_anybodys_emergency_stop_is_obeyed_and_only_the_driver_clears_it(
    rides: Ridden, order: tuple[int, tuple[float, ...]]
) -> None:
    ride = rides(
        ARMED,
        DRIVES,
        step(7.0, speed_mps=0.0),
        step(10.0, clear=True),
        step(11.0, arm=True),
        step(13.0, speed_mps=0.2),
        **ALONE,
    )
    other = beside(ride)
    other.talks(ride, 6.0, order)
    ride.runs_until(6.2)
    other.orders = [(CLEAR, (1.0,)), (ARM, (1.0,))]
    ride.runs_until(9.9)
    assert ride.stands_from(6.0, slower_than=0.005) < 6.6
    assert other.results[ARM] == other.results[CLEAR] == DENIED
    assert "emergency stop" in ride.holding
    other.orders = []
    ride.runs_until(16.0)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)


def test_a_stop_button_of_the_same_ids_elsewhere_is_not_dropped(rides: Ridden) -> None:
    """Each station counts its own frames: this one is far behind the driver's."""
    ride = rides(ARMED, DRIVES, **ALONE)
    other = beside(ride, system=255)
    other.buttons = 4
    other.talks(ride, 6.0)
    ride.runs_until(7.0)
    assert "emergency stop" in ride.holding
    assert ride.stands_from(6.0, slower_than=0.005) < 6.6


def test_a_stick_left_deflected_by_a_station_long_gone_blocks_no_one(rides: Ridden) -> None:
    ride = rides(ARMED, DRIVES, step(6.0, silent_s=200), **ALONE)
    other = beside(ride)
    other.talks(ride, 8.0, (ARM, (1.0,)))
    ride.runs_until(15.5)
    assert other.results[ARM] == DENIED, "who drives has ten seconds to come back"
    assert not ride.now["armed"] or ride.fastest(8.0, 15.5) < 0.002
    ride.runs_until(18.0)
    assert other.results[ARM] == ACCEPTED
    other.x = 400
    ride.runs_until(20.0)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    assert any("no station in control" in text for text in other.texts)


@pytest.mark.long(beside="test_after_a_long_silence_motion_needs_a_new_arm")
def test_the_first_packet_after_a_minute_of_silence_moves_nothing(rides: Ridden) -> None:
    ride = rides(ARMED, DRIVES, step(6.0, silent_s=60), **ALONE)
    ride.runs_until(72.0)
    assert ride.fastest(8.0, 72.0) < 0.002
    assert not ride.now["armed"]


@pytest.mark.long(beside="test_a_lift_target_does_not_outlive_its_operators_link")
def test_a_lift_target_does_not_outlive_its_operator_while_another_one_idles(rides: Ridden) -> None:
    ride = rides(ARMED, step(4.0, lift_m=0.3), step(5.0, silent_s=100), **ALONE)
    other = beside(ride)
    other.talks(ride, 5.0)
    ride.runs_until(6.2)
    left_at = ride.now["lift_m"]
    ride.runs_until(20.0)
    assert 0.01 < left_at < 0.2
    assert ride.now["lift_m"] == pytest.approx(left_at, abs=0.002)


def test_control_that_is_handed_over_starts_nothing(rides: Ridden) -> None:
    """The driver lets others take over; who does is at full stick, and must let it go first."""
    ride = rides(ARMED, DRIVES, **ALONE)
    first, other = beside(ride, system=255, source=0), beside(ride)
    ride.runs_until(5.0)
    first.talks(ride, 5.0, (CONTROL, (1.0, 1.0)))
    first.x = 600
    ride.runs_until(6.0)
    first.talks_from = 1 << 60
    other.x = 1000
    other.talks(ride, 6.0, (CONTROL, (1.0,)))
    ride.runs_until(8.0)
    assert other.results[CONTROL] == ACCEPTED
    assert ride.now["speed_mps"] == pytest.approx(0.0, abs=0.002)
    assert "stick not neutral" in ride.holding
    other.x = 0
    ride.runs_until(8.2)
    other.x = 400
    ride.runs_until(11.0)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    assert any("254/190 at 192.0.2.7:14550" in text for text in ride_texts(ride))


def test_control_that_is_given_up_leaves_the_robot_at_rest_and_disarmed(rides: Ridden) -> None:
    ride = rides(ARMED, DRIVES, **ALONE)
    first = beside(ride, system=255, source=0)
    ride.runs_until(6.0)
    first.x = 600
    first.talks(ride, 6.0, (CONTROL, (0.0,)))
    ride.runs_until(6.1)
    first.talks_from = 1 << 60
    ride.runs_until(8.0)
    assert ride.fastest(7.0, 8.0) < 0.002
    assert not ride.now["armed"]


def ride_texts(ride: Ride) -> list[str]:
    return [entry.text for entry in ride.operator.diary.entries]
