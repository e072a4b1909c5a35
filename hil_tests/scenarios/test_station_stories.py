"""Ground stations that speak otherwise: radio channels, set-points with PX4's modes, MAVLink 1."""

from collections.abc import Callable
from typing import Any

import pytest

from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import UnknownAge
from firmware_bridge.robot_types import find
from firmware_bridge.units import SECOND, Nanoseconds
from firmware_bridge.wire.internet import number_of
from hil_tests.scenarios.ride import Ridden, Ride, step

PERIOD = SECOND // 20
ARM, MODE, FORCE = 400, 176, 21196.0
ALONE = {"seconds": 60, "seed": 1}
KEPT = 0xFFFF


class Station:
    """Station with a command 20 times a second, a heartbeat each second, and orders once; MAVLink 1 or 2."""

    def __init__(self, *, old: bool = False) -> None:
        self.codec = Codec(254, 190)
        self.source = number_of("192.0.2.7", 14550)
        self.message: Callable[[], Any] | None = None
        self.results: dict[int, int] = {}
        self.modes: set[int] = set()
        self.first_bytes: set[int] = set()
        self._old = old
        self._orders: list[Any] = []
        self._due: Nanoseconds = 0
        self._beats_at: Nanoseconds = 0

    def joins(self, ride: Ride) -> "Station":
        ride.rig.world.attach("station", self, {OPERATOR: ride.rig.operator_wire})
        return self

    def orders(self, command: int, *params: float) -> None:
        seven = (*params, *(0.0,) * (7 - len(params)))
        self._orders.append(dialect.MAVLink_command_long_message(1, 1, command, 0, *seven))

    def receive(self, packet: Packet, _now: Nanoseconds) -> Reaction:
        if packet.address != self.source:
            return Reaction((), self._due)
        self.first_bytes.add(packet.payload[0])
        for message in self.codec.decode(packet.payload):
            match message.get_type():
                case "COMMAND_ACK":
                    self.results[message.command] = message.result
                case "HEARTBEAT":
                    self.modes.add(message.custom_mode)
        return Reaction((), self._due)

    def wake(self, now: Nanoseconds) -> Reaction:
        if now < self._due:
            return Reaction((), self._due)
        self._due = now + PERIOD
        stated = self._orders
        self._orders = []
        if now >= self._beats_at:
            self._beats_at = now + SECOND
            stated.append(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
        if self.message is not None:
            stated.append(self.message())
        frames = [self.codec.encode_1(one) if self._old else self.codec.encode(one) for one in stated]
        sent = tuple(Packet(OPERATOR, self.source, frame) for frame in frames if frame is not None)
        return Reaction(sent, self._due)


def channels(throttle: int, steering: int = 1500) -> Callable[[], Any]:
    raw = (steering, KEPT, throttle, *(KEPT,) * 5)
    return lambda: dialect.MAVLink_rc_channels_override_message(1, 1, *raw)


def velocity(vx: float, mask: int = 1479) -> Callable[[], Any]:
    """Return what MAVSDK's set_velocity_body sends."""
    rest = (0.0,) * 5
    return lambda: dialect.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, 8, mask, 0.0, 0.0, 0.0, vx, 0.0, 0.0, *rest
    )


def armed(
    rides: Ridden, message: Callable[[], Any], *, old: bool = False, **how: Any
) -> tuple[Ride, Station]:
    """Return a ride at 4 s whose robot this station has armed; its operator only confirms its pose."""
    ride = rides(step(59.0, speed_mps=0.0), **{**ALONE, **how})
    station = Station(old=old).joins(ride)
    ride.runs_until(3.0)
    station.message = message
    ride.runs_until(3.4)
    station.orders(ARM, 1.0)
    ride.runs_until(4.0)
    assert station.results[ARM] == 0
    return ride, station


def test_a_robot_is_driven_by_channels_and_stops_when_they_cease(rides: Ridden) -> None:
    ride, station = armed(rides, channels(1500))
    station.message = channels(1700)
    ride.runs_until(6.0)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    station.message = None
    ride.runs_until(8.0)
    assert "operator link timeout" in ride.holding
    assert ride.stands_from(6.0, slower_than=0.005) < 6.0 + 0.55 + 0.35
    station.message = channels(1700)
    ride.runs_until(9.0)
    assert "stick not neutral" in ride.holding
    assert ride.fastest(8.0) < 0.005
    station.message = channels(1500)
    ride.runs_until(10.0)
    station.message = channels(1300)
    ride.runs_until(12.0)
    assert ride.now["speed_mps"] == pytest.approx(-0.2, rel=0.02)


def test_channels_that_are_given_back_stop_it_at_the_ramp(rides: Ridden) -> None:
    ride, station = armed(rides, channels(1500))
    station.message = channels(1800)
    ride.runs_until(6.0)
    station.message = channels(0, 0)
    ride.runs_until(7.0)
    assert ride.stands_from(6.0, slower_than=0.005) < 6.0 + 0.1 + 0.35
    assert ride.hardest(6.0, 7.0) < 0.144 * 9.81


@pytest.mark.long(keeps=["refuse-0.0"])
@pytest.mark.parametrize(("age", "speed"), [(UnknownAge.DRIVE, 0.2), (UnknownAge.REFUSE, 0.0)])
def test_channels_report_no_age_and_are_obeyed_where_such_words_are(
    rides: Ridden, age: UnknownAge, speed: float
) -> None:
    robot = find("rars")
    operator = robot.operator.model_copy(update={"unknown_age": age})
    ride, station = armed(rides, channels(1500), robot=robot.model_copy(update={"operator": operator}))
    station.message = channels(1700)
    ride.runs_until(6.0)
    assert ride.now["speed_mps"] == pytest.approx(speed, abs=0.005)
    assert ("command not timestamped" in ride.holding) is (age is UnknownAge.REFUSE)


def test_offboard_drives_and_hold_stops_whatever_set_points_go_on(rides: Ridden) -> None:
    ride, station = armed(rides, velocity(0.0))
    station.orders(MODE, 1.0, 6.0)
    ride.runs_until(4.2)
    station.message = velocity(0.2)
    ride.runs_until(6.0)
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    assert 6 << 16 in station.modes
    station.orders(MODE, 1.0, 4.0, 3.0)
    ride.runs_until(8.0)
    assert "operation paused" in ride.holding
    assert ride.stands_from(6.0, slower_than=0.005) < 6.0 + 0.1 + 0.35
    assert 4 << 16 | 3 << 24 in station.modes
    station.orders(MODE, 1.0, 6.0)
    ride.runs_until(9.0)
    assert station.results[MODE] != 0, "nothing moves by a mode alone"
    assert ride.fastest(8.0) < 0.005
    station.message = velocity(0.0)
    ride.runs_until(9.5)
    station.orders(MODE, 1.0, 6.0)
    ride.runs_until(9.7)
    assert station.results[MODE] == 0
    station.message = velocity(0.1)
    ride.runs_until(11.0)
    assert ride.now["speed_mps"] == pytest.approx(0.1, rel=0.04)


@pytest.mark.long(keeps=["stop0"])
@pytest.mark.parametrize("stop", [(ARM, 0.0, FORCE), (5300, 0.0), (185, 1.0), (ARM, 0.0), (193, 0.0)])
def test_a_station_of_mavlink_1_drives_and_each_of_its_stops_brakes(
    rides: Ridden, stop: tuple[float, ...]
) -> None:
    ride, station = armed(rides, channels(1500), old=True)
    assert station.first_bytes == {0xFE}
    station.message = channels(1800)
    ride.runs_until(6.0)
    assert ride.now["speed_mps"] == pytest.approx(0.3, rel=0.02)
    station.orders(int(stop[0]), *stop[1:])
    ride.runs_until(7.0)
    assert station.results[int(stop[0])] == 0
    assert ride.stands_from(6.0, slower_than=0.005) < 6.0 + 0.1 + 0.4
    assert ride.now["speed_mps"] == pytest.approx(0.0, abs=0.005)
