"""Age of a command when it is obeyed: slow links, a go behind a stop, replays, clocks that are set."""

import pytest

from emulators.bench.mission import Noise
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot, UnknownAge
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds, from_seconds
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

RARS = find("rars")
LINKS = {"can": RARS, "serial": over_serial(RARS)}
ALONE = {"seconds": 120, "seed": 1}
"""With a seed of its own a ride has a bench of its own."""
BY_SET_POINT = step(0.1, input="twist")


def texts(ride: Ride) -> list[str]:
    return [entry.text for entry in ride.operator.diary.entries]


def on_a_link(delay_ms: float) -> dict[str, object]:
    return {**ALONE, "noise": Noise(delay_ms=delay_ms)}


@pytest.mark.long(keeps=["300-True-twist-can", "600-False-twist-can"])
@pytest.mark.parametrize("link", LINKS)
@pytest.mark.parametrize("by", ["twist", "stick"])
@pytest.mark.parametrize(("delay_ms", "drives"), [(0, True), (300, True), (600, False)])
def test_a_link_of_half_a_second_is_too_slow_to_drive_on(
    rides: Ridden, link: str, by: str, delay_ms: float, *, drives: bool
) -> None:
    """Both ways are as slow, so that an answer takes twice as long."""
    ride = rides(
        step(0.1, input=by),
        ARMED,
        step(7.0, speed_mps=0.2),
        step(10.0, speed_mps=0.0),
        robot=LINKS[link],
        **on_a_link(delay_ms),
    )
    ride.runs_until(9.9)
    if drives:
        assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
        assert not ride.held("command stale")
    else:
        assert ride.fastest() < 0.002
        assert "command stale" in ride.holding
        [reason] = ride.held("command stale")
        assert "0.60 s old" in reason
    reported = ride.operator.diary.values
    assert reported["RTT"] == pytest.approx(2 * delay_ms / 1000, abs=0.001)
    assert reported["AGE"] == pytest.approx(delay_ms / 1000, abs=0.005)
    assert any("round trip" in text for text in texts(ride)) is (2 * delay_ms >= 500)


@pytest.mark.long(keeps=["can"])
@pytest.mark.parametrize("link", LINKS)
def test_a_link_that_gets_slow_under_way_stops_the_robot_until_the_stick_is_let_go(
    rides: Ridden, link: str
) -> None:
    ride = rides(
        BY_SET_POINT,
        ARMED,
        step(4.0, speed_mps=0.3),
        step(12.0, speed_mps=0.0),
        step(13.0, speed_mps=0.2),
        robot=LINKS[link],
        faults=[fault("datagram_late", 8.0, until_s=10.0, by_ms=600, sender="operator")],
        **ALONE,
    )
    ride.runs_until(7.9)
    assert ride.now["speed_mps"] == pytest.approx(0.3, rel=0.02)
    ride.runs_until(9.9)
    assert ride.stands_from(8.0, slower_than=0.005) < 8.0 + 0.5 + 0.35
    assert "command stale" in ride.holding
    [reason] = ride.held("command stale")
    assert "was 0.60 s old" in reason
    ride.runs_until(11.9)
    assert ride.fastest(9.0, 11.9) < 0.005, "his stick is where it was"
    assert ride.holding == {"stick not neutral"}
    ride.runs_until(16.0)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)


@pytest.mark.long(keeps=["arm-disarm"])
@pytest.mark.parametrize(("go", "stop"), [("arm", "disarm"), ("clear", "emergency_stop")])
def test_an_order_that_was_stated_before_a_stop_does_not_undo_it(rides: Ridden, go: str, stop: str) -> None:
    """It comes 260 ms late, behind the stop."""
    ride = rides(
        ARMED,
        step(5.0, **{stop: True}),
        step(6.0, **{go: True}),
        step(6.1, **{stop: True}),
        faults=[fault("datagram_late", 6.0, until_s=6.01, by_ms=260, sender="operator")],
        **ALONE,
    )
    ride.runs_until(8.0)
    assert any("sent before a stop command" in text for text in texts(ride))
    assert not ride.now["armed"]
    assert ("emergency stop" in ride.holding) is (stop == "emergency_stop")


@pytest.mark.long(keeps=["twist-can"])
@pytest.mark.parametrize("link", LINKS)
@pytest.mark.parametrize("by", ["twist", "stick"])
def test_a_go_that_comes_a_quarter_of_a_second_after_the_stop_moves_nothing(
    rides: Ridden, link: str, by: str
) -> None:
    late = fault("datagram_late", 6.0, until_s=6.06, by_ms=260, sender="operator")
    ride = rides(
        step(0.1, input=by),
        ARMED,
        step(6.0, speed_mps=0.3),
        step(6.06, speed_mps=0.0),
        robot=LINKS[link],
        faults=[late],
        **ALONE,
    )
    ride.runs_until(8.0)
    assert ride.fastest() < 0.002


class Tape:
    """A node that records the operator's messages, and sends them again as they came."""

    def __init__(self, ride: Ride, begin_s: float, end_s: float) -> None:
        self.taken: list[tuple[Nanoseconds, Packet]] = []
        self._span = (from_seconds(begin_s), from_seconds(end_s))
        self._late: Nanoseconds = NEVER
        ride.rig.operator_wire.observe(self._note)
        ride.rig.world.attach("tape", self, {OPERATOR: ride.rig.operator_wire})

    def plays(self, ride: Ride, at_s: float) -> None:
        self._late = from_seconds(at_s) - self._span[0]
        ride.rig.world.detach("tape")
        ride.rig.world.attach("tape", self, {OPERATOR: ride.rig.operator_wire})

    def _note(self, now: Nanoseconds, sender: str, packet: Packet) -> None:
        if sender == "operator" and self._span[0] <= now < self._span[1]:
            self.taken.append((now, packet))

    def receive(self, _packet: Packet, _now: Nanoseconds) -> Reaction:
        return Reaction((), self._due())

    def wake(self, now: Nanoseconds) -> Reaction:
        sent = []
        while self.taken and self._due() <= now:
            sent.append(self.taken.pop(0)[1])
        return Reaction(tuple(sent), self._due())

    def _due(self) -> Nanoseconds:
        return NEVER if self._late == NEVER or not self.taken else self.taken[0][0] + self._late


def test_a_minute_that_is_played_again_moves_nothing(rides: Ridden) -> None:
    """From the operator's own place, under his own numbers; he stands with his stick let go."""
    ride = rides(BY_SET_POINT, ARMED, step(5.0, speed_mps=0.3), step(8.0, speed_mps=0.0), **ALONE)
    tape = Tape(ride, 5.5, 8.0)
    ride.runs_until(26.0)
    tape.plays(ride, 26.0)  # by their numbers these frames are newer than his own
    ride.runs_until(30.0)
    assert not tape.taken
    assert ride.fastest(20.0, 30.0) < 0.002
    assert "command stale" in ride.held_between(26.0, 30.0)


@pytest.mark.long(keeps=["-5.0"])
@pytest.mark.parametrize("ahead_s", [5.0, -5.0])
def test_a_station_whose_clock_is_set_is_requested_again(rides: Ridden, ahead_s: float) -> None:
    """Set back, its words look old, and nothing moves until it has answered; set forward, none looks old."""
    ride = rides(
        BY_SET_POINT,
        ARMED,
        step(5.0, speed_mps=0.2),
        step(12.0, speed_mps=0.0),
        step(13.0, speed_mps=0.2),
        **ALONE,
    )
    ride.runs_until(8.01)
    ride.operator.clock_ahead = round(ahead_s * SECOND)
    ride.runs_until(11.9)
    assert bool(ride.held_between(8.0, 10.0)) is (ahead_s < 0)
    assert ride.holding == ({"stick not neutral"} if ahead_s < 0 else set())
    ride.runs_until(15.0)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    assert ride.operator.diary.values["AGE"] == pytest.approx(0.0, abs=0.01)


def refusing(robot: AnyRobot) -> AnyRobot:
    operator = robot.operator.model_copy(update={"unknown_age": UnknownAge.REFUSE})
    return robot.model_copy(update={"operator": operator})


@pytest.mark.long(keeps=["stick"])
@pytest.mark.parametrize("by", ["twist", "stick"])
def test_where_unknown_is_refused_only_who_reports_his_age_drives(rides: Ridden, by: str) -> None:
    ride = rides(step(0.1, input=by), ARMED, step(6.0, speed_mps=0.2), robot=refusing(RARS), **ALONE)
    ride.runs_until(9.0)
    if by == "twist":
        assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
        return
    assert ride.fastest() < 0.002
    assert "command not timestamped" in ride.holding
    assert ride.now["armed"]
    assert any("the age of" in text for text in texts(ride))


def test_a_lost_share_of_the_operators_frames_is_reported(rides: Ridden) -> None:
    ride = rides(BY_SET_POINT, ARMED, **{**ALONE, "noise": Noise(loss=0.2)})
    ride.runs_until(15.0)
    assert ride.operator.diary.values["LOSS"] == pytest.approx(0.2, abs=0.1)
    assert any("% of this station's frames are lost" in text for text in texts(ride))


def test_the_longest_that_a_word_is_obeyed_is_its_age(rides: Ridden) -> None:
    """On a link of 0.3 s that falls silent, the last command counts for 0.2 s more, not for 0.5 s."""
    ride = rides(BY_SET_POINT, ARMED, step(5.0, speed_mps=0.3), step(8.0, silent_s=4.0), **on_a_link(300))
    ride.runs_until(10.0)
    [event] = [
        one
        for one in ride.rig.interlock_events
        if one.name == "operator link timeout" and one.began > 6 * SECOND
    ]
    assert 8.0 * SECOND + 440 * MILLISECOND <= event.began <= 8.0 * SECOND + 500 * MILLISECOND
    assert not ride.held("command stale")
