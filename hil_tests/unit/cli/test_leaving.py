"""Repeated end requests while a robot is stopped: the reports, and the permission to leave it as it is."""

from pathlib import Path

import pytest

from firmware_bridge.bridge import Bridge
from firmware_bridge.cli.leaving import AGAIN_WITHIN, Leaving
from firmware_bridge.cli.narrated import Narrated
from firmware_bridge.cli.remembered import Remembered
from firmware_bridge.mavlink.trust import Trust
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.runtime.last_places import LastPlaces
from firmware_bridge.units import SECOND, Nanoseconds
from hil_tests.safety.driving import robot_of

NOTHING = "link 'board': nothing stops it: its motors may turn on, switch their supply off"


def reported(name: str) -> tuple[Leaving, list[str]]:
    stated: list[str] = []
    return Leaving(robot_of(name), lambda text, _now: stated.append(text)), stated


@pytest.mark.parametrize("name", ["rars", "rars+serial", "climber", "rome:ros-arduino-bridge", "ar2"])
def test_where_the_devices_stop_by_themselves_the_stop_goes_on(name: str) -> None:
    leaving, stated = reported(name)
    assert not any(leaving.may_leave(now) for now in range(5))
    assert set(stated) == {"the stop goes on, and ends the program: each of its steps lasts a bounded time"}
    assert "nothing stops" not in leaving.unattended


@pytest.mark.parametrize("name", ["rome:mw:3", "rome:arduinoio:3", "rome+cameras:firmata", "rome_arm:mw:3"])
@pytest.mark.parametrize(("later", "leaves"), [(AGAIN_WITHIN, True), (AGAIN_WITHIN + 1, False)])
def test_where_nothing_stops_them_it_is_stated_and_only_then_requested_again_they_are_left(
    name: str, later: Nanoseconds, *, leaves: bool
) -> None:
    leaving, stated = reported(name)
    assert NOTHING in leaving.unattended
    assert not leaving.may_leave(SECOND)
    assert stated == [f"the stop goes on. {leaving.unattended}. Once more within 5 s leaves it so"]
    assert leaving.may_leave(SECOND + later) is leaves
    if not leaves:
        assert leaving.may_leave(SECOND + later + 1), "it was printed again"


def test_a_failure_to_report_takes_nothing_from_the_devices_and_is_raised_next(tmp_path: Path) -> None:
    class Beside:
        """A node that sends something to a device at each wake."""

        def receive(self, _packet: Packet, now: Nanoseconds) -> Reaction:
            return self.wake(now)

        def wake(self, now: Nanoseconds) -> Reaction:
            return Reaction((Packet("board", 0, b"stop"),), now + SECOND)

    def broken(_text: str) -> None:
        raise ZeroDivisionError

    robot = robot_of("rome:mw:3")
    path = tmp_path / "state.json"
    bridge = Bridge(robot, robot_type_of(robot))
    node = Narrated(bridge, Beside(), robot, broken, kept=LastPlaces(path), stamps=Remembered(Trust(), path))
    assert node.wake(5) == Reaction((Packet("board", 0, b"stop"),), 5)
    with pytest.raises(ZeroDivisionError):
        node.wake(6)
    assert node.wake(7) == Reaction((Packet("board", 0, b"stop"),), 7 + SECOND)
