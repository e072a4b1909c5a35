"""Effects after a fault: a lift whose drive has restarted, late datagrams, the record of a run."""

import pytest

from emulators.robots.rars import RarsStep as Step
from firmware_bridge.units import from_seconds, to_seconds
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

DRIVING = (ARMED, step(4.0, speed_mps=0.3))


def with_a_restarted_lift(rides: Ridden, *steps: Step) -> Ride:
    """Raise the lift, and cut its drive's power for a moment: it counts from 0 where it stands."""
    return rides(
        ARMED,
        step(4.0, lift_m=0.05),
        *steps,
        step(12.5, speed_mps=0.2),
        seconds=20,
        faults=[fault("drive_restart", 9.0, node="lift", for_s=0.2)],
    )


def test_a_lift_whose_drive_has_restarted_is_not_taken_for_retracted(rides: Ridden) -> None:
    ride = with_a_restarted_lift(rides, step(10.0, disarm=True), step(10.5, arm=True), step(11.5, arm=True))
    ride.runs_until(14.0)
    assert ride.now["lift_m"] > 0.01
    assert ride.fastest(12.0, 14.0) < 0.002, "the lift is up"
    assert "reference lost: lift" in ride.holding


def test_a_lift_that_states_it_is_not_where_it_was_sent_is_not_armed(rides: Ridden) -> None:
    """Its target is still 50 mm, and its drive reports 0: to arm now would move it."""
    ride = with_a_restarted_lift(rides, step(10.0, arm=True), step(11.0, arm=True))
    ride.runs_until(14.0)
    answers = [
        (entry.at, entry.text) for entry in ride.operator.diary.entries if entry.at >= from_seconds(11)
    ]
    assert (from_seconds(11), "arm: temporarily rejected") in answers
    assert any("its reference is lost" in text for _, text in answers)
    assert ride.now["lift_m"] == pytest.approx(0.05, abs=2e-4), "it has not moved"
    assert ride.fastest(9.0, 14.0) < 0.002


def test_late_datagrams_are_a_silent_operator_until_the_first_has_come(rides: Ridden) -> None:
    late = fault("datagram_late", 6.0, by_ms=700, sender="operator", for_s=1.0)
    ride = rides(*DRIVING, seconds=20, faults=[late])
    ride.runs_until(9.0)
    (event,) = [
        event
        for event in ride.rig.interlock_events
        if event.name == "operator link timeout" and event.began > from_seconds(4)
    ]
    assert to_seconds(event.began) == pytest.approx(6.45, abs=0.06)
    assert event.ended is not None
    assert to_seconds(event.ended) == pytest.approx(6.95, abs=0.06)


def test_the_record_states_which_faults_were_on_and_when(rides: Ridden) -> None:
    faults = (
        fault("frame_loss", 5.0, node="steer", share=0.1, for_s=0.5, title="a loose contact"),
        fault("nmt_foreign_node", 5.5, command="start"),
        fault("datagram_late", 6.0, by_ms=10),
    )
    ride = rides(*DRIVING, seconds=20, faults=faults)
    ride.runs_until(7.5)
    found = [(one.kind, one.title, to_seconds(one.began), one.ended) for one in ride.rig.faults.records]
    assert found == [
        ("frame_loss", "a loose contact", 5.0, from_seconds(5.5)),
        ("nmt_foreign_node", "", 5.5, from_seconds(5.5)),
        ("datagram_late", "", 6.0, None),
    ]
    assert ride.rig.faults.records[0].nodes == ("steer",)
