"""Many stations at once: the station in control receives from the robot, and third parties gain nothing."""

import pytest

from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire.internet import number_of
from hil_tests.scenarios.foreign_node import ForeignNode
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, step

ALONE = {"seconds": 120, "seed": 1}


class Crowd:
    """Forty places that speak in turn, each 10 ms: a heartbeat, a stick and a question, or no MAVLink."""

    def __init__(self, *, beats: bool, speaks: bool) -> None:
        self.sent: dict[int, int] = {}
        codec = Codec(253, 190)
        words = [dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)] if beats else []
        words += [
            dialect.MAVLink_manual_control_message(1, 900, 0, 0, 0, 0),
            dialect.MAVLink_command_long_message(1, 1, 512, 0, 331, *(0.0,) * 6),
        ]
        self._words = b"".join(map(codec.encode, words)) if speaks else b"\xfd no MAVLink at all \xfe"
        self._turn = 0
        self._due: Nanoseconds = 0

    def receive(self, _packet: Packet, _now: Nanoseconds) -> Reaction:
        return Reaction((), self._due)

    def wake(self, now: Nanoseconds) -> Reaction:
        if now < self._due:
            return Reaction((), self._due)
        self._due, self._turn = now + 10 * MILLISECOND, self._turn + 1
        place = number_of("203.0.113.1", 1 + self._turn % 40)
        self.sent[place] = self.sent.get(place, 0) + len(self._words)
        return Reaction((Packet(OPERATOR, place, self._words),), self._due)


def crowded(ride: Ride, crowd: Crowd) -> dict[int, int]:
    """Let the crowd in; return the bytes that will have gone to each place."""
    gone: dict[int, int] = {}

    def note(_now: Nanoseconds, sender: str, packet: Packet) -> None:
        if sender == "bridge":
            gone[packet.address] = gone.get(packet.address, 0) + len(packet.payload)

    ride.rig.operator_wire.observe(note)
    ride.rig.world.attach("crowd", crowd, {OPERATOR: ride.rig.operator_wire})
    return gone


def test_a_crowd_that_beats_does_not_starve_who_drives(rides: Ridden) -> None:
    ride = rides(step(100.0, speed_mps=0.0), **ALONE)
    gone = crowded(ride, Crowd(beats=True, speaks=True))
    driver = ForeignNode().joins(ride)
    ride.runs_until(3.0)
    driver.talks(ride, 3.0, (400, (1.0,)))
    ride.runs_until(4.0)
    assert driver.results == {400: 0}
    before = gone[driver.source]
    ride.runs_until(6.0)
    assert gone[driver.source] - before > 2 * 5_000, "bytes of two seconds' telemetry"
    crowd_of = [place for place in gone if place not in (0, driver.source) and gone[place] > 20_000]
    assert len(crowd_of) <= 8
    assert ride.fastest() < 0.002


@pytest.mark.long(keeps=["garbage"])
@pytest.mark.parametrize("speaks", [False, True], ids=["garbage", "questions"])
def test_a_crowd_that_does_not_beat_gets_no_more_than_it_gives(rides: Ridden, *, speaks: bool) -> None:
    ride = rides(ARMED, step(4.0, speed_mps=0.2), **ALONE)
    crowd = Crowd(beats=False, speaks=speaks)
    gone = crowded(ride, crowd)
    ride.runs_until(8.0)
    assert set(gone) <= {0, *crowd.sent}
    assert all(gone.get(place, 0) <= sent for place, sent in crowd.sent.items())
    assert speaks or set(gone) == {0}, "a station that sends nothing good is not answered"
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    assert gone[0] > 8 * 5_000
