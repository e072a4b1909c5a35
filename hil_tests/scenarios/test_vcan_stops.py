"""Effects of a foreign node on a real SocketCAN bus on the robot, and its stop: in two processes."""

import signal
from typing import Final

import pytest

from hil_tests.scenarios.real_bus import ACCEPTED, ACTUATOR, ARM, DISABLED, Bench, Client, sleep, until

pytestmark = [pytest.mark.vcan, pytest.mark.timeout(180)]

NMT: Final = 0x000
PRE_OPERATIONAL: Final = 0x80
RESET_NODE: Final = 0x81
SET_POINT: Final = 0x500
WHEELS: Final = (1, 2)
LIFT: Final = 4
RAISED: Final = -0.7
"""Height of the lift, as a share of its travel, from -1 to 1."""


@pytest.fixture
def client(bench: Bench) -> Client:
    """Return the station in control; the robot is armed."""
    bench.emulates()
    bench.drives()
    made = bench.joins()
    made.arms()
    return made


def comes_to_rest(bench: Bench, within: float) -> None:
    until(lambda: abs(bench.eye.speed()) < 0.005, within, "at rest")


def test_a_drive_that_was_made_unable_to_receive_stops_and_an_end_leaves_it_without_power(
    bench: Bench, client: Client
) -> None:
    bench.gets_under_way(client, 0.3)
    bench.eye.sends(NMT, bytes((PRE_OPERATIONAL, 1)))
    client.states(0.3, 1.0)
    comes_to_rest(bench, 3.0)
    client.states(0.3, 1.0)
    assert abs(bench.eye.speed()) < 0.005
    bridge = bench.programs["drive"]
    assert bridge.ends() == 0, bridge.printed
    for node in (1, 2, 3, 4):
        assert bench.eye.state(node) in DISABLED, (node, bridge.printed)


def test_a_raised_lift_that_was_reset_is_not_driven_with(bench: Bench, client: Client) -> None:
    def height_qc() -> int:
        return bench.eye.ask(LIFT, 0x6064) or 0

    until(lambda: client.requests(ACTUATOR, RAISED) == ACCEPTED, 5.0, "the lift goes up")
    client.states_until(0.0, lambda: height_qc() > 10_000, 20.0, "the lift is up")
    bench.eye.sends(NMT, bytes((RESET_NODE, LIFT)))
    client.states_until(0.0, lambda: client.is_reported("lost"), 10.0, "the zero is lost")
    for _ in range(6):
        assert client.requests(ARM, 1) != ACCEPTED, client.texts
    before = bench.eye.metres()
    client.states(0.3, 1.0)
    assert bench.eye.metres() == pytest.approx(before, abs=0.001), "it believes no 0 m that no one has seen"


def test_another_master_drives_the_disarmed_robot_no_further(bench: Bench, client: Client) -> None:
    until(lambda: client.requests(ARM, 0) == ACCEPTED, 5.0, "disarmed")
    client.receives(0.5)
    frame = (0x000F).to_bytes(2, "little") + (2000).to_bytes(4, "little", signed=True)
    for _ in range(200):
        for node in WHEELS:
            bench.eye.sends(SET_POINT + node, frame)
        sleep(0.01)
    client.states(0.0, 0.2)
    assert client.is_reported("someone else sends"), client.texts
    comes_to_rest(bench, 3.0)
    for node in WHEELS:
        assert bench.eye.state(node) in DISABLED, "what moves uncommanded loses its power"


@pytest.mark.parametrize("at_once", [True, False], ids=["ended at once", "not ended"])
def test_a_second_bridge_leaves_the_first_one_s_robot_alone(
    bench: Bench, client: Client, *, at_once: bool
) -> None:
    """It stands armed meanwhile: to start a program takes all of a small machine, and drives fall behind."""
    first = bench.programs["drive"]
    before = len(first.printed)
    second = bench.drives("second", bench.port + 1000, before=("nice", "-n", "19"))
    if at_once:
        client.states_until(0.0, lambda: second.printed, 40.0, "the second one has begun")
        second.process.send_signal(signal.SIGINT)
    client.states_until(0.0, lambda: second.process.poll() is not None, 40.0, "its end")
    for word in ("second controller", "axis fault", "axis restarted", "axis not enabled"):
        assert f"holds: {word}" not in first.printed[before:], first.printed
    client.arms()  # who was silent for long
    bench.gets_under_way(client, 0.2)
    if not at_once:
        assert second.process.returncode != 0
        assert "someone else sends" in second.printed
