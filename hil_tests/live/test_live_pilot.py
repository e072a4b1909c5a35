"""A pilot's station on the live page: what it receives of the robot is shown, and it can be stopped."""

from typing import Any, Final

import pytest

from firmware_bridge.live.pilot import LivePilot
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.pilot.cockpit import Cockpit
from firmware_bridge.pilot.driver import Extras
from firmware_bridge.pilot.keyboard import Keyboard
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.robot_types import find
from hil_tests.live.paged import Paged

ROBOT: Final = Codec(1, 1)
PLACE: Final = 5


class Piloted(Paged):
    """A station whose robot is in the test's hands."""

    def __init__(self) -> None:
        self.ended = 0
        self.station: Final = PilotStation(Keyboard(0.5, Extras((), None)), (1, 1))
        rolling = ("left", "right")
        cockpit = Cockpit(self.station, lambda _: None, rolling=rolling)
        super().__init__(LivePilot(cockpit, self.station, find("rars"), rolling, self._ends))

    def _ends(self) -> None:
        self.ended += 1

    def robot_sends(self, *messages: Any) -> None:
        for message in messages:
            self.receives(Packet(OPERATOR, PLACE, ROBOT.encode(message)))

    def commands(self) -> list[int]:
        """Return the numbers of the commands that have left."""
        wanted = frozenset({dialect.MAVLINK_MSG_ID_COMMAND_LONG})
        reader = Codec(1, 1)
        found = [message for packet in self.sent for message in reader.decode(packet.payload, wanted)]
        return [message.command for message in found]


@pytest.fixture
def piloted() -> Piloted:
    page = Piloted()
    page.opens()
    return page


def heartbeat(*, armed: bool) -> Any:
    mode = dialect.MAV_MODE_FLAG_SAFETY_ARMED if armed else 0
    return dialect.MAVLink_heartbeat_message(2, 0, mode, 0, dialect.MAV_STATE_ACTIVE, 3)


def test_before_the_robot_is_received_nothing_of_it_is_stated() -> None:
    page = Piloted()
    hello, _, state = page.opens()
    assert (hello["mode"], hello["can"]) == ("station", ["stop", "emergency_stop"])
    assert (state["armed"], state["pose"], state["axes"]) == (None, None, [])


def test_what_the_robot_sends_is_shown(piloted: Piloted) -> None:
    text = dialect.MAVLink_statustext_message(dialect.MAV_SEVERITY_WARNING, b"lift extended", 0, 0)
    value = dialect.MAVLink_named_value_float_message(0, b"STEER", 12.5)
    still = (0.0,) * 21
    odometry = dialect.MAVLink_odometry_message(
        1000, 1, 8, 1.0, -2.0, 0.0, (1.0, 0.0, 0.0, 0.0), 0.25, 0.0, 0.0, 0.0, 0.0, 0.0, still, still
    )
    piloted.robot_sends(heartbeat(armed=True), text, value, odometry)
    piloted.runs(0.2)
    state = piloted.kept("state")[-1]
    assert state["armed"] is True
    assert state["pose"] == [1.0, 2.0, 0.0]
    assert (state["measured"]["STEER"], state["measured"]["speed"]) == (12.5, 0.25)
    (event,) = (one for message in piloted.kept("events") for one in message["events"])
    assert (event["text"], event["level"]) == ("lift extended", "warning")


def test_its_emergency_stop_leaves_at_once_and_again_until_it_is_answered(piloted: Piloted) -> None:
    piloted.robot_sends(heartbeat(armed=True))
    piloted.runs(0.3)
    begun, at = len(piloted.sent), piloted.now
    assert piloted.does("emergency_stop")["ok"]
    assert piloted.now == at
    del piloted.sent[:begun]
    assert dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE in piloted.commands()
    del piloted.sent[:]
    piloted.runs(2.0)
    assert dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE in piloted.commands()


def test_its_stop_ends_the_run_in_good_order_and_all_else_is_refused(piloted: Piloted) -> None:
    assert piloted.does("stop")["ok"]
    assert piloted.ended == 1
    for name in ("drive", "arm", "inject", ""):
        refused = piloted.does(name)
        assert (refused["ok"], "own controls" in refused["error"]) == (False, True)
    assert piloted.ended == 1
