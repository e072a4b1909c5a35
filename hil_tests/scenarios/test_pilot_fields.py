"""Display (Fig. 4.3) and commands (Fig. 4.2) of the thesis's station, at its rate, in the whole chain."""

from collections import Counter
from typing import Final

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.piloted import PilotedMission
from emulators.rig import Rig
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.pilot.profiles import PROFILES
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.robot_types import find
from firmware_bridge.teleop.mavlink import Codec, text_of
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds

ROBOT: Final = find("rars")
BENCH_SETUP: Final = bench_setup_of(ROBOT)
FIELDS: Final = {
    "X, Y, theta": "ODOMETRY",
    "steer angle": "STEER",
    "wheels' angular velocity": "DEBUG_FLOAT_ARRAY",
    "height of the platform": "ZPOS",
    "battery voltage": "BATTERY_STATUS",
    **{f"current of motor {number}": f"I{number}" for number in (1, 2, 3, 4)},
}


class Counted:
    """A node, and how often what came to it in one second."""

    def __init__(self, node: PilotedMission, begin: Nanoseconds) -> None:
        self._node = node
        self._span = (begin, begin + SECOND)
        self._codec = Codec(0, 0)
        self.came: Counter[str] = Counter()
        self.sent: Counter[str] = Counter()

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        self._count(self.came, packet, now)
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


def test_every_field_comes_twenty_times_a_second_and_so_often_the_station_speaks() -> None:
    script = missions.find("pursuit", ROBOT, BENCH_SETUP)
    assert script.pilot is not None
    operator = PilotedMission(ROBOT, script.step, script.pilot)
    target = (ROBOT.operator.system_id, ROBOT.operator.component_id)
    operator.station = PilotStation(operator.follower, target, requests=PROFILES["cycle"])  # type: ignore[misc]
    counted = Counted(operator, 5 * SECOND)
    rig = Rig(ROBOT, BENCH_SETUP, counted, link=script.conditions)
    try:
        rig.run(from_seconds(6.5))
    finally:
        rig.finish()
    assert {field: counted.came[name] for field, name in FIELDS.items()} == dict.fromkeys(FIELDS, 20)
    assert counted.sent["SET_POSITION_TARGET_LOCAL_NED"] == 20
    shown = operator.station.shown
    assert shown.battery_v is not None
    assert 20.0 < shown.battery_v < 25.0
    assert all(speed > 5.0 for speed in shown.speeds[:2]), "0.5 m/s on wheels of 50 mm"
