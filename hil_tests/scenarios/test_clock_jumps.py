"""A station whose clock jumps while it drives, and whose words come late: none that is too old moves it."""

from typing import Any, Final

import pytest

from emulators.bench.bench_setup import bench_setup_of
from emulators.rig import Rig
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, from_seconds

SPEED_MPS: Final = 0.03
LATE: Final[Nanoseconds] = 3 * SECOND
EVERY: Final[Nanoseconds] = 50 * MILLISECOND
VELOCITY: Final = 1511
"""SET_POSITION_TARGET_LOCAL_NED's mask: a velocity and a yaw rate."""
CLOCK: Final[Nanoseconds] = 7200 * SECOND
BOTH: Final = "both clocks"
SYNC: Final = "TIMESYNC alone"


class Station:
    """Station that drives by set-points with its time, and answers TIMESYNC; its messages may be delayed."""

    def __init__(self) -> None:
        self._codec = Codec(255, 190)
        self._wake_at: Nanoseconds = 0
        self._beat_at: Nanoseconds = 0
        self._under_way: list[tuple[Nanoseconds, bytes]] = []
        self._armed = False
        self.jumped: Nanoseconds = 0
        self.sync_jumped: Nanoseconds = 0
        self.late: Nanoseconds = 0
        self.speed_mps = 0.0

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        answers = []
        for message in Codec(255, 1).decode(packet.payload):
            if message.get_type() == "HEARTBEAT":
                self._armed = bool(message.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED)
            elif message.get_type() == "TIMESYNC" and message.tc1 == 0:
                shows = now + CLOCK + self.jumped + self.sync_jumped
                answers.append(dialect.MAVLink_timesync_message(shows, message.ts1))
        return self._sent([self._codec.encode(answer) for answer in answers])

    def wake(self, now: Nanoseconds) -> Reaction:
        stated: list[Any] = []
        if now >= self._beat_at:
            self._beat_at = now + SECOND
            stated.append(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
            if now > 2 * SECOND and not self._armed:
                stated.append(dialect.MAVLink_command_long_message(1, 1, 400, 0, 1.0, *(0.0,) * 6))
        at = (now + CLOCK + self.jumped) // MILLISECOND % (1 << 32)
        moves = dialect.MAVLink_set_position_target_local_ned_message(
            at, 1, 1, 8, VELOCITY, *(0.0,) * 3, self.speed_mps, *(0.0,) * 7
        )
        self._under_way.append((now + self.late, self._codec.encode(moves)))
        come = [frame for due, frame in self._under_way if due <= now]
        self._under_way = [one for one in self._under_way if one[0] > now]
        self._wake_at = now + EVERY
        return self._sent([*(self._codec.encode(message) for message in stated), *come])

    def _sent(self, frames: list[bytes]) -> Reaction:
        return Reaction(tuple(Packet(OPERATOR, 0, frame) for frame in frames), self._wake_at)


@pytest.mark.long(keeps=["both clocks--3.0", "TIMESYNC alone-0.4"])
@pytest.mark.parametrize("jump_s", [-3600.0, -3.0, -0.4, 0.4, 3.0, 3600.0])
@pytest.mark.parametrize("which", [BOTH, SYNC])
def test_no_word_that_is_too_old_moves_it(which: str, jump_s: float) -> None:
    robot, station = find("climber"), Station()
    rig = Rig(robot, bench_setup_of(robot), station)

    def runs(seconds: float) -> None:
        rig.run(rig.world.now + from_seconds(seconds))

    try:
        runs(5.0)
        station.speed_mps = SPEED_MPS
        runs(4.0)
        assert rig.samples[-1]["speed_mps"] > 0.5 * SPEED_MPS
        if which == BOTH:
            station.jumped = from_seconds(jump_s)
        else:
            station.sync_jumped = from_seconds(jump_s)
        runs(4.0)
        # The stick is let go, and later commands come late: by then nothing is under way.
        station.late, station.speed_mps = LATE, 0.0
        runs(7.0)
        station.speed_mps = SPEED_MPS
        begun = rig.world.now
        runs(6.0)
        fastest = max(abs(row["speed_mps"]) for row in rig.samples if row.at >= begun)
        assert fastest < 0.002
    finally:
        rig.finish()
