"""Display (Fig. 4.3) and commands (Fig. 4.2) of the thesis's station, at its rate, in the whole chain."""

from collections import Counter
from typing import Final

import pytest

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.piloted import PilotedMission
from emulators.rig import Rig
from firmware_bridge.mavlink.frames import Codec, text_of
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.pilot.driver import Stick
from firmware_bridge.pilot.profiles import PROFILES
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds

ROBOT: Final = find("rars")
BENCH_SETUP: Final = bench_setup_of(ROBOT)
SECONDS: Final = 4
USUAL_BYTES_S: Final = (8_300, 9_100)
THESIS_BYTES_S: Final = (11_500, 12_500)
FIELDS: Final = {
    "X, Y, theta": "ODOMETRY",
    "steer angle": "STEER",
    "wheels' angular velocity": "DEBUG_FLOAT_ARRAY",
    "height of the platform": "ZPOS",
    "battery voltage": "BATTERY_STATUS",
    **{f"current of motor {number}": f"I{number}" for number in (1, 2, 3, 4)},
}


class Counted:
    """A node, and how often what came to it in the seconds that count."""

    def __init__(self, node: PilotedMission, begin: Nanoseconds) -> None:
        self._node = node
        self._span = (begin, begin + SECONDS * SECOND)
        self._codec = Codec(0, 0)
        self.came: Counter[str] = Counter()
        self.sent: Counter[str] = Counter()
        self.bytes = 0
        """Size of what came."""

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self._count(self.came, packet, now)
        if self._span[0] <= now < self._span[1]:
            self.bytes += len(packet.payload)
        return self._counted(self._node.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        return self._counted(self._node.wake(now), now)

    def _counted(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        for packet in reaction.sent:
            self._count(self.sent, packet, now)
        return reaction

    def _count(self, counter: Counter[str], packet: Packet, now: Nanoseconds) -> None:
        if self._span[0] <= now < self._span[1]:
            for message in self._codec.decode(packet.payload):
                kind = message.get_type()
                counter[text_of(message.name) if kind == "NAMED_VALUE_FLOAT" else kind] += 1


def driven(robot: AnyRobot, profile: str) -> tuple[Counted, PilotStation, float]:
    """Return what passed in the seconds that count, the station, and the bytes a second that came to it."""
    script = missions.find("pursuit", robot, BENCH_SETUP)
    assert script.pilot is not None
    operator = PilotedMission(robot, script.step, script.pilot)
    target = (robot.operator.system_id, robot.operator.component_id)
    operator.station = PilotStation(operator.follower, target, requests=PROFILES[profile])  # type: ignore[misc]
    counted = Counted(operator, 5 * SECOND)
    rig = Rig(robot, BENCH_SETUP, counted, link=script.conditions)
    try:
        rig.run(from_seconds(5.5 + SECONDS))
    finally:
        rig.finish()
    return counted, operator.station, counted.bytes / SECONDS


@pytest.mark.parametrize(("name", "profile"), [("rars", "cycle"), ("rars+thesis", "usual")])
def test_every_field_comes_twenty_times_a_second_and_so_often_the_station_speaks(
    name: str, profile: str
) -> None:
    """As the station requests it of the robot, and as the profile of the robot file sends it by itself."""
    counted, station, _ = driven(find(name), profile)
    rates = {field: counted.came[kind] / SECONDS for field, kind in FIELDS.items()}
    assert rates == pytest.approx(dict.fromkeys(FIELDS, 20.0), rel=0.05)
    assert counted.sent["SET_POSITION_TARGET_LOCAL_NED"] / SECONDS == pytest.approx(20.0, rel=0.05)
    shown = station.shown
    assert shown.battery_v is not None
    assert 20.0 < shown.battery_v < 25.0
    assert all(speed > 5.0 for speed in shown.speeds[:2]), "0.5 m/s on wheels of 50 mm"


def test_without_the_profile_a_field_comes_as_often_as_ever_and_with_it_the_link_carries_more() -> None:
    counted, _, usual = driven(ROBOT, "usual")
    rates = {field: counted.came[kind] / SECONDS for field, kind in FIELDS.items()}
    currents = {f"current of motor {number}": 5.0 for number in (1, 2, 3, 4)}
    assert rates == {
        "X, Y, theta": 20.0,
        "steer angle": 10.0,
        "wheels' angular velocity": 10.0,
        "height of the platform": 5.0,
        "battery voltage": 0.5,
        **currents,
    }
    _, _, whole = driven(find("rars+thesis"), "usual")
    assert USUAL_BYTES_S[0] < usual < USUAL_BYTES_S[1]
    assert THESIS_BYTES_S[0] < whole < THESIS_BYTES_S[1]


class Held:
    """A driver that holds one stick."""

    def command(self, _link: object, _now: Nanoseconds, *, armed: bool) -> Stick:
        del armed
        return Stick(0.5, 0.25, 0.3, 0b1011)

    def sees(self, _sight: object) -> None:
        """Look at nothing."""


def test_by_hand_one_message_has_all_fields_of_the_stations_packet_twenty_times_a_second() -> None:
    """Velocity, steer angle, the platform's z, detector and headlamp: Fig. 4.2."""
    station, codec, sent = PilotStation(Held(), (1, 1)), Codec(0, 0), []
    for now in range(0, 2 * SECOND, SECOND // 100):
        for packet in station.wake(now).sent:
            sent += [it for it in codec.decode(packet.payload) if it.get_type() == "MANUAL_CONTROL"]
    assert len(sent) == 40
    assert {(it.x, it.r, it.z, it.buttons) for it in sent} == {(500, -250, 300, 0b1011)}
