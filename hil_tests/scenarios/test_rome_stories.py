"""ROME's base over its emulated board: four firmwares drive it; whatever the board does ends in a stand."""

import pytest

from emulators.bench.path_error import Followed, path_error
from emulators.bench.rehearsal import rehearsal_of
from emulators.rig import BRIDGE
from firmware_bridge.packet import Packet
from hil_tests.scenarios.rome_ride import FULL, STANDS_MPS, driven, held, speed


@pytest.mark.long(keeps=["ros-arduino-bridge"])
@pytest.mark.parametrize("protocol", FULL)
def test_each_firmware_drives_the_circle_and_the_guard_has_nothing_to_refuse(protocol: str) -> None:
    with driven(protocol, 'guide = "circle"', 12.0, encoders=FULL[protocol]) as rig:
        rig.runs(9.5)
        assert rig.guard.refused == 0, rig.guard.refusals
        path = rehearsal_of(rig.robot).paths["circle"](rig.robot)
        error = path_error(rig.samples, [Followed(4.5, path)], 2.5)
        assert error.same_instant is not None
        assert error.same_instant < (0.02 if FULL[protocol] == 3 else 0.08)
        assert speed(rig) == pytest.approx(0.25, abs=0.04)
        rig.world.stop(BRIDGE)
        rig.runs(4.0)
        assert rig.bridge.finished
        assert rig.bridge.unconfirmed == ()
        assert not any(axis.powered for axis in rig.devices.bank.axes)
        assert speed(rig) < STANDS_MPS


@pytest.mark.long(beside="test_the_way_is_what_was_measured")
@pytest.mark.parametrize(("protocol", "stops"), [("ros-arduino-bridge", True), ("arduinoio", False)])
def test_a_board_that_nobody_reaches_stops_where_its_firmware_does(protocol: str, *, stops: bool) -> None:
    """The stock auto-stop is of 2 s; without one the motors run on until the line is back: then they stop."""
    fault = '[[fault]]\nkind = "board_silent"\nat_s = 6.5\nfor_s = 3.5\n'
    with driven(protocol, "speed_mps = 0.3", 20.0, fault, FULL[protocol]) as rig:
        rig.runs(9.9)
        assert (speed(rig) < STANDS_MPS) is stops
        assert {"axis silent: one", "speed 0 unconfirmed: one"} <= held(rig)
        rig.runs(2.5)
        assert speed(rig) < STANDS_MPS
        assert not any(axis.powered for axis in rig.devices.bank.axes)


@pytest.mark.long(keeps=["shaft_blocked-holds2"])
@pytest.mark.parametrize(
    ("fault", "holds"),
    [
        ("encoder_cable_off", {"axis position repeats: two"}),
        ("motor_cable_off", {"axis does not follow: two"}),
        ("shaft_blocked", {"axis position repeats: two"}),
    ],
)
def test_a_wire_that_is_off_and_a_wheel_that_is_blocked_are_named_and_the_base_stops(
    fault: str, holds: set[str]
) -> None:
    text = f'[[fault]]\nkind = "{fault}"\nnode = "two"\nat_s = 6.5\n'
    with driven("ros-arduino-bridge", "speed_mps = 0.3", 20.0, text) as rig:
        rig.runs(9.0)
        assert holds <= held(rig)
        assert speed(rig) < STANDS_MPS
        assert not rig.bridge.seen.facts.armed


def test_with_too_low_a_supply_of_the_motors_the_base_does_not_follow_and_is_stopped() -> None:
    text = '[[fault]]\nkind = "motor_supply_sag"\nto_v = 2.0\nat_s = 6.5\n'
    with driven("ros-arduino-bridge", "speed_mps = 0.3", 20.0, text) as rig:
        rig.runs(8.5)
        assert any(name.startswith("axis does not follow") for name in held(rig))
        assert speed(rig) < STANDS_MPS
        assert not rig.bridge.seen.facts.armed


def test_who_takes_control_is_told_what_the_start_has_shown_of_the_boards_reset() -> None:
    said: list[bytes] = []

    def note(_now: int, sender: str, packet: Packet) -> None:
        if sender == BRIDGE:
            said.append(packet.payload)

    with driven("mw", "speed_mps = 0.1", 5.0, encoders=3) as rig:
        rig.operator_wire.observe(note)
        rig.runs(3.9)
        at_start = b"".join(said).count(b"the line's reset works")
        rig.runs(0.5)
    assert at_start == 1
    assert b"the line's reset works" in b"".join(said).partition(b" drives")[2]
